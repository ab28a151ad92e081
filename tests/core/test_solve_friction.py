"""The contact problem with friction against closed forms, an independent check of its conditions, and a collection."""

import dataclasses
import itertools
import logging
import os
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import nnls
from tlismni.core import ConvergenceError, solve_friction

COLLECTION = Path(os.environ.get("TLISMNI_FRICTION_PROBLEMS", "/work/shared/data/friction_problems.npz"))


def left_of_conditions(w, q, mu, r, tangents=2):
    """Largest residual of Coulomb's law and Signorini's condition, contact by contact, as a velocity."""
    rows, u = 1 + tangents, w @ r + q
    worst = 0.0
    for i in range(len(q) // rows):
        at = slice(rows * i, rows * (i + 1))
        force, velocity = r[at], u[at]
        own = np.mean([w[j, j] for j in range(at.start, at.stop)])
        normal, friction, sliding = own * force[0], own * force[1:], velocity[1:]
        worst = max(worst, -normal, -velocity[0], min(abs(normal), abs(velocity[0])))
        speed, limit = np.linalg.norm(sliding), mu[i] * max(normal, 0.0)
        worst = max(worst, np.linalg.norm(friction) - limit)
        # sliding: at the limit, against the motion
        short = np.linalg.norm(friction + limit * sliding / speed) if speed > 0.0 else 0.0
        worst = max(worst, min(speed, short) if tangents else 0.0)
    return worst


def free(rng, bodies, contacts, tangents=2):
    """W, q of random contacts between bodies (six directions each) or with the ground, which share no redundancy but
    that of their number; they all can open."""
    g = np.zeros(((1 + tangents) * contacts, 6 * bodies))
    for i in range(contacts):
        a, b = rng.choice(bodies + 1, 2, replace=False)
        for body, sign in ((a, -1.0), (b, 1.0)):
            if body < bodies:
                g[(1 + tangents) * i : (1 + tangents) * (i + 1), 6 * body : 6 * body + 6] = sign * rng.normal(
                    size=(1 + tangents, 6)
                )
    inverse = np.repeat(rng.uniform(0.5, 2.0, bodies), 6)
    return g * inverse @ g.T, g @ rng.normal(size=6 * bodies)


def on_feet(places, velocity, height=0.5, inertia=0.2):
    """W, q of a body of 1 kg on feet at the places (n, 2), `height` below its centre: linear and angular velocity."""
    blocks = []
    for x, y in places:
        arm = np.array([x, y, -height])
        turning = np.array([[0, arm[2], -arm[1]], [-arm[2], 0, arm[0]], [arm[1], -arm[0], 0]])
        blocks.append(np.hstack([np.eye(3), turning])[[2, 0, 1]])
    g = np.vstack(blocks)
    return g * np.r_[1.0, 1.0, 1.0, np.full(3, 1.0 / inertia)] @ g.T, g @ velocity


def ring(n, radius=0.3):
    angles = 2 * np.pi * np.arange(n) / n
    return radius * np.c_[np.cos(angles), np.sin(angles)]


@pytest.mark.parametrize(
    ("q", "mode", "u", "r"),
    [
        ((0.5, 1.0, 2.0), "open", (0.5, 1.0, 2.0), (0, 0, 0)),
        ((-2.0, 0.3, 0.4), "stick", (0, 0, 0), (4.0, -0.6, -0.8)),
        ((-2.0, 3.0, 4.0), "slip", (0, 2.64, 3.52), (4.0, -0.72, -0.96)),
    ],
)
def test_a_block_on_a_plane(q, mode, u, r):
    """2 kg that meet the plane at 2 m/s, mu = 0.3: friction takes at most 0.3 * 2 m/s of the sliding speed."""
    found = solve_friction(np.eye(3) / 2.0, q, 0.3)
    assert found.modes.tolist() == [mode] and found.converged
    np.testing.assert_allclose(found.velocities, u, atol=1e-12)
    np.testing.assert_allclose(found.forces, r, atol=1e-12)


@pytest.mark.parametrize("n", [3, 4, 17, 60])
def test_a_body_that_slides_on_many_feet(n):
    """The feet share the load as they like: together they carry the momentum, and the speed falls by mu times it."""
    w, q = on_feet(ring(n), np.array([3.0, 0, -1.0, 0, 0, 0]), height=0.1)
    found = solve_friction(w, q, 0.4)
    assert found.converged and (found.modes[found.forces[::3] > 0] == "slip").all()
    assert found.forces[::3].sum() == pytest.approx(1.0, rel=1e-10)
    np.testing.assert_allclose(found.velocities[1::3], 3.0 - 0.4, rtol=1e-10)
    np.testing.assert_allclose(found.velocities[::3], 0.0, atol=1e-11)
    assert left_of_conditions(w, q, np.full(n, 0.4), found.forces) < 1e-11


@pytest.mark.parametrize("n", [3, 8, 40])
def test_a_body_that_spins_on_a_ring_of_feet(n):
    """mu times the momentum at the radius brakes the spin, whatever each foot carries."""
    w, q = on_feet(ring(n), np.array([0, 0, -1.0, 0, 0, 9.0]), height=0.0)
    found = solve_friction(w, q, 0.4)
    spin = 9.0 - 0.4 * 0.3 / 0.2
    np.testing.assert_allclose(np.hypot(found.velocities[1::3], found.velocities[2::3]), 0.3 * spin, rtol=1e-10)
    held = solve_friction(w, q / np.tile([1.0, 30.0, 30.0], n), 0.4)
    np.testing.assert_allclose(held.velocities, 0.0, atol=1e-12)
    assert (held.modes[held.forces[::3] > 1e-9] == "stick").all()


@pytest.mark.parametrize("angle", [0.3, 1.0])
def test_a_wedge_between_two_walls(angle):
    """A point of 1 kg falls at 1 m/s between walls that meet there: the squeeze is open, what they carry is not."""
    g = np.array([[c * np.cos(angle), np.sin(angle), np.sin(angle), -c * np.cos(angle)] for c in (1, -1)]).reshape(4, 2)
    found = solve_friction(g @ g.T, g @ [0.0, -1.0], 0.5, tangents=1)
    np.testing.assert_allclose(g.T @ found.forces, [0.0, 1.0], atol=1e-11)
    np.testing.assert_allclose(found.velocities, 0.0, atol=1e-12)
    assert left_of_conditions(g @ g.T, g @ [0.0, -1.0], [0.5, 0.5], found.forces, 1) < 1e-12


@pytest.mark.sampled(12)
@pytest.mark.parametrize("tangents", [0, 1, 2])
@pytest.mark.parametrize("seed", range(12))
def test_random_problems(seed, tangents):
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(1, 8))
    n = int(rng.integers(1, 5 * bodies))
    w, q = free(rng, bodies, n, tangents)
    mu = rng.uniform(0.0, 0.6, n) * (rng.random(n) > 0.2)
    found = solve_friction(w, q, mu, tangents=tangents)
    assert found.converged and found.residual <= 1e-12
    assert left_of_conditions(w, q, mu, found.forces, tangents) < 1e-11 * np.linalg.norm(q)
    np.testing.assert_array_equal(found.forces.reshape(n, -1)[found.modes == "open"], 0.0)


def test_least_forces_are_shared_alike():
    """Four feet of a square carry a quarter each; many that hold, what the pseudoinverse says."""
    w, q = on_feet(ring(4), np.array([3.0, 0, -1.0, 0, 0, 0]), height=0.0)
    found = solve_friction(w, q, 0.4, least=True)
    assert found.least and found.converged
    np.testing.assert_allclose(found.forces[::3], 0.25, rtol=1e-6)
    w, q = on_feet(ring(20), np.array([0.1, 0.05, -1.0, 0.1, 0, 0]), height=0.1)
    found = solve_friction(w, q, 0.7, least=True)
    assert found.least and set(found.modes) == {"stick"}
    np.testing.assert_allclose(found.forces, -np.linalg.pinv(w, rcond=1e-10) @ q, atol=1e-6)
    assert not solve_friction(w, q, 0.7).least


@pytest.mark.parametrize("seed", [6, 19])
def test_large_friction(seed):
    """Whole Newton steps do not find these: the subproblems of proximal points are solved."""
    w, q = free(np.random.default_rng(seed), 6, 20)
    found = solve_friction(w, q, 1.0)
    assert found.converged and found.newton_iterations > 40
    assert left_of_conditions(w, q, np.ones(20), found.forces) < 1e-11 * np.linalg.norm(q)
    # beside others that are solved at once
    other, motion = free(np.random.default_rng(0), 6, 40)
    both = solve_friction(sparse.block_diag([w, other]), np.r_[q, motion], np.r_[np.ones(20), np.full(40, 0.1)])
    assert both.converged


@pytest.mark.parametrize("spin", [0.0, 2.0, 9.0])
def test_least_forces_do_not_depend_on_the_order_nor_on_the_start(spin):
    w, q = on_feet(ring(9), np.array([3.0, 0, -1.0, 0, 0.1, spin]), height=0.1)
    order = np.random.default_rng(0).permutation(9)
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    found = solve_friction(w, q, 0.4, least=True)
    other = solve_friction(w[np.ix_(rows, rows)], q[rows], 0.4, least=True)
    assert found.least and other.least
    np.testing.assert_allclose(other.forces, found.forces[rows], atol=1e-6)
    assert left_of_conditions(w, q, np.full(9, 0.4), found.forces) < 1e-11


def by_modes(w, q, mu):
    """Velocities of every combination of open, stick, slip to either side that fulfils Coulomb's law in the plane."""
    n, all_found = len(mu), []
    for modes in itertools.product(("open", "stick", 1.0, -1.0), repeat=n):
        rows, columns = [], np.zeros((2 * n, 0))
        for i, mode in enumerate(modes):
            normal, along = np.eye(2 * n)[:, [2 * i]], np.eye(2 * n)[:, [2 * i + 1]]
            if mode == "stick":
                rows += [2 * i, 2 * i + 1]
                columns = np.hstack([columns, normal, along])
            elif mode != "open":
                rows.append(2 * i)
                columns = np.hstack([columns, normal - mode * mu[i] * along])
        r = columns @ np.linalg.lstsq(w[rows] @ columns, -q[rows], rcond=None)[0] if rows else np.zeros(2 * n)
        if left_of_conditions(w, q, mu, r, 1) < 1e-9:
            all_found.append(w @ r + q)
    return all_found


@pytest.mark.parametrize("seed", range(10))
def test_in_the_plane_against_all_combinations_of_modes(seed):
    rng = np.random.default_rng(seed)
    g = rng.normal(size=(6, 6))
    w, q, mu = g @ g.T, g @ rng.normal(size=6), rng.uniform(0.1, 0.5, 3)
    found = solve_friction(w, q, mu, tangents=1)
    assert min(np.abs(found.velocities - u).max() for u in by_modes(w, q, mu)) < 1e-9


@pytest.mark.parametrize("n", [5, 30])
def test_without_friction_against_nonnegative_least_squares(n):
    """min |J^T r + v| over r >= 0: its conditions are those of contacts without friction."""
    rng = np.random.default_rng(n)
    g, v = rng.normal(size=(n, 8)), rng.normal(size=8)
    wanted = g @ (g.T @ nnls(g.T, -v)[0] + v)
    for tangents in (0, 1, 2):
        rows = np.zeros(((1 + tangents) * n, 8 + tangents * n))
        rows[:: 1 + tangents, :8] = g
        for i in range(tangents):
            rows[1 + i :: 1 + tangents, 8 + i * n : 8 + (i + 1) * n] = np.eye(n)
        motion = np.r_[v, rng.normal(size=tangents * n)]
        found = solve_friction(rows @ rows.T, rows @ motion, 0.0, tangents=tangents)
        np.testing.assert_allclose(found.velocities[:: 1 + tangents], wanted, atol=1e-9)
        assert set(found.modes) <= {"open", "slip"}
        for i in range(tangents):
            np.testing.assert_allclose(
                found.velocities[1 + i :: 1 + tangents], (rows @ motion)[1 + i :: 1 + tangents], atol=1e-12
            )


def test_units_do_not_matter():
    w, q = free(np.random.default_rng(5), 6, 20)
    mu = np.full(20, 0.4)
    plain = solve_friction(w, q, mu)
    rough = solve_friction(w, q, mu, tolerance=1e-3, newton_iterations=0)
    for of_w, of_q in ((1e12, 1.0), (1.0, 1e9), (2.0**-40, 2.0**30)):
        other = solve_friction(of_w * w, of_q * q, mu)
        assert other.converged and (other.modes == plain.modes).all()
        np.testing.assert_allclose(other.velocities / of_q, plain.velocities, atol=1e-10)
        same = solve_friction(of_w * w, of_q * q, mu, tolerance=1e-3, newton_iterations=0)
        assert same.residual == pytest.approx(rough.residual, rel=1e-6)


def test_the_order_of_contacts_does_not_matter():
    rng = np.random.default_rng(6)
    w, q = free(rng, 6, 25)
    mu = rng.uniform(0.1, 0.5, 25)
    order = rng.permutation(25)
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    plain, other = solve_friction(w, q, mu), solve_friction(w[np.ix_(rows, rows)], q[rows], mu[order])
    np.testing.assert_allclose(other.velocities, plain.velocities[rows], atol=1e-9)


def test_turned_tangents_give_turned_forces():
    """The cones are round: other tangents at each contact, the same forces."""
    rng = np.random.default_rng(7)
    w, q = free(rng, 5, 10)
    turns = np.zeros((30, 30))
    for i, angle in enumerate(rng.uniform(0, 7, 10)):
        c, s = np.cos(angle), np.sin(angle)
        turns[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = [[1, 0, 0], [0, c, -s], [0, s, c]]
    plain, other = solve_friction(w, q, 0.3), solve_friction(turns @ w @ turns.T, turns @ q, 0.3)
    np.testing.assert_allclose(other.velocities, turns @ plain.velocities, atol=1e-9)


def test_sparse_and_dense_matrices_give_the_same():
    rng = np.random.default_rng(8)
    parts = [free(rng, 5, 15) for _ in range(10)]
    w, q = sparse.block_diag([part[0] for part in parts]), np.concatenate([part[1] for part in parts])
    of_sparse, of_dense = solve_friction(w, q, 0.3), solve_friction(w.toarray(), q, 0.3)
    np.testing.assert_array_equal(of_sparse.forces, of_dense.forces)
    for i, (own, motion) in enumerate(parts):
        np.testing.assert_allclose(
            solve_friction(own, motion, 0.3).velocities, of_sparse.velocities[45 * i : 45 * i + 45], atol=1e-9
        )


def test_a_start_saves_iterations():
    w, q = on_feet(ring(30), np.array([3.0, 0, -1.0, 0.1, 0.2, 4.0]), height=0.1)
    cold = solve_friction(w, q, 0.4)
    again = solve_friction(w, q, 0.4, start=cold.forces)
    assert (again.first_order_iterations, again.newton_iterations) == (0, 0)
    near = solve_friction(w, q * (1.0 + 1e-4 * np.sin(np.arange(len(q)))), 0.4, start=cold.forces)
    assert near.converged and near.first_order_iterations < cold.first_order_iterations
    # a poor start does no harm
    poor = solve_friction(w, q, 0.4, start=np.full(len(q), 1e6))
    np.testing.assert_allclose(poor.velocities, cold.velocities, atol=1e-9)


@pytest.mark.parametrize("w", [np.zeros((0, 0)), sparse.csr_array((0, 0)), []])
def test_no_contacts(w):
    found = solve_friction(w, [], 0.3)
    assert found.converged and found.residual == 0.0 and len(found.forces) == len(found.modes) == 0


def test_contacts_that_leave_or_rest_have_no_forces():
    w, _ = free(np.random.default_rng(9), 3, 5)
    for motion in (np.zeros(15), np.tile([1.0, 3.0, -2.0], 5)):
        found = solve_friction(w, motion, 0.5)
        assert found.residual == 0.0 and not found.forces.any() and set(found.modes) == {"open"}
        np.testing.assert_array_equal(found.velocities, motion)


def crushed():
    """A body between two walls that come nearer to each other."""
    return np.array([[1.0, -1.0], [-1.0, 1.0]]), np.array([-1.0, -1.0])


def test_a_problem_without_a_solution_says_so(caplog):
    with caplog.at_level(logging.WARNING):
        found = solve_friction(*crushed(), 0.0, tangents=0, first_order_iterations=600)
    assert not found.converged and found.residual > 0.1
    assert "of 2 contacts is solved to a residual of" in caplog.text
    with pytest.raises(ConvergenceError, match="there may be no solution") as raised:
        solve_friction(*crushed(), 0.0, tangents=0, first_order_iterations=600, must_converge=True)
    assert raised.value.solution.residual == pytest.approx(found.residual)


def test_a_contact_that_nothing_moves():
    """W = 0: it can open, not be held."""
    assert solve_friction(np.zeros((3, 3)), [1.0, 2.0, 0.0], 0.5).converged
    assert not solve_friction(np.zeros((3, 3)), [-1.0, 2.0, 0.0], 0.5, first_order_iterations=600).converged


def test_budgets_end_the_work(caplog):
    w, q = free(np.random.default_rng(10), 6, 20)
    assert solve_friction(w, q, 0.4, seconds=0.0).first_order_iterations == 0
    few = solve_friction(w, q, 0.4, first_order_iterations=20, newton_iterations=1)
    assert few.newton_iterations <= 1 and few.first_order_iterations <= 20
    assert few.residual < solve_friction(w, q, 0.4, seconds=0.0).residual
    rough = solve_friction(w, q, 0.4, tolerance=1e-3)
    assert rough.converged and rough.residual <= 1e-3


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"tangents": 3}, "needed is 0, 1 or 2"),
        ({"q": np.zeros(4)}, r"needed is \(3 n,\)"),
        ({"q": np.full(6, np.nan)}, "q has elements that are not finite"),
        ({"W": np.eye(3)}, r"W has the shape \(3, 3\); needed is \(6, 6\)"),
        ({"W": np.full((6, 6), np.inf)}, "W has elements that are not finite"),
        ({"W": -np.eye(6)}, "negative diagonal elements at contact 0"),
        ({"W": np.eye(6) + np.triu(np.ones((6, 6)), 1)}, "W differs from its transpose by 1"),
        ({"mu": [0.3, -0.1]}, "negative coefficient -0.1"),
        ({"mu": [0.3, 0.1, 0.2]}, "mu has the shape"),
        ({"mu": [0.3, np.nan]}, "mu has elements that are not finite"),
        ({"start": np.zeros(3)}, "needed are finite forces"),
        ({"tolerance": 0.0}, "tolerance = 0.0"),
    ],
)
def test_what_is_wrong_is_said(change, words):
    given = {"W": np.eye(6), "q": -np.ones(6), "mu": 0.3, **change}
    with pytest.raises(ValueError, match=words):
        solve_friction(given.pop("W"), given.pop("q"), given.pop("mu"), **given)


def test_an_uneven_matrix_is_taken_as_it_is_when_asked():
    w = np.eye(3) + 0.1 * np.triu(np.ones((3, 3)), 1)
    found = solve_friction(w, [-1.0, 1.0, 0.0], 0.2, asymmetry=0.2)
    np.testing.assert_allclose(found.velocities, w @ found.forces + [-1.0, 1.0, 0.0], atol=1e-14)
    assert left_of_conditions(w, np.array([-1.0, 1.0, 0.0]), [0.2], found.forces) < 1e-12


def test_a_solution_is_frozen():
    found = solve_friction(np.eye(3), [-1.0, 0.0, 0.0], 0.2)
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.residual = 0.0


def test_many_bodies_at_once():
    """300 bodies on three feet each, independent of each other: each does what it does alone."""
    rng = np.random.default_rng(11)
    bodies = [on_feet(ring(3), rng.normal(size=6) - [0, 0, 3, 0, 0, 0], height=0.2) for _ in range(300)]
    w, q = sparse.block_diag([body[0] for body in bodies]), np.concatenate([body[1] for body in bodies])
    found = solve_friction(w, q, 0.5)
    assert found.converged
    for i in (0, 100, 299):
        alone = solve_friction(*bodies[i], 0.5)
        np.testing.assert_allclose(found.velocities[9 * i : 9 * i + 9], alone.velocities, atol=1e-8)


def collection():
    if not COLLECTION.exists():
        return [pytest.param("", marks=pytest.mark.skip(reason=f"{COLLECTION} is not here"))]
    with np.load(COLLECTION) as file:
        return sorted({name.split("|")[0] for name in file.files})


@pytest.mark.sampled(12)
@pytest.mark.parametrize("name", collection())
def test_collected_problems(name):
    with np.load(COLLECTION) as file:
        data, indices, indptr, q, mu = (file[f"{name}|{part}"] for part in ("data", "indices", "indptr", "q", "mu"))
    w = sparse.csr_array((data, indices, indptr), shape=(len(q), len(q)))
    found = solve_friction(w, q, mu)
    assert found.converged and found.residual <= 1e-12
    assert found.newton_iterations < 40
    assert left_of_conditions(w, q, mu, found.forces) < 1e-11 * np.linalg.norm(q)
