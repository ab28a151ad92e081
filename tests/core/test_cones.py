"""Forces of several contacts as compiled code: the conditions themselves, units, scratch, and no solution."""

from typing import NamedTuple

import numpy as np
import pytest
from tlismni.core.compiled.jit import address_of, compiled
from tlismni.core.contact_solvers.planar_contacts import (
    BELOW_LIMITS,
    CONES_SIGNATURE,
    NONE,
    PLANAR_VECTORS,
    SOLVED,
    Cones,
    call_cones,
    solve_cones,
    work_size,
)

FOUND = PLANAR_VECTORS[-4:]


class Problem(NamedTuple):
    nn: np.ndarray
    nt: np.ndarray
    tt: np.ndarray
    b_n: np.ndarray
    b_t: np.ndarray
    mu: np.ndarray
    direction: np.ndarray
    base: np.ndarray


def random_problem(rng, n, friction=True, known=False, based=False):
    """Contacts of a few bodies, some of which repeat each other, before an impact."""
    coordinates = 3 * int(rng.integers(1, 5))
    inverse_mass = np.diag(rng.uniform(0.3, 3.0, coordinates))
    normal, tangential = rng.normal(size=(2, n, coordinates))
    if rng.random() < 0.5:
        some = rng.integers(0, n, n)
        normal, tangential = normal[some], tangential[some]
    v = rng.normal(size=coordinates)
    mu = rng.choice([0.0, 0.1, 0.3, 0.6], n) if friction else np.zeros(n)
    return Problem(
        normal @ inverse_mass @ normal.T,
        normal @ inverse_mass @ tangential.T,
        tangential @ inverse_mass @ tangential.T,
        normal @ v,
        tangential @ v,
        np.minimum(mu, 0.05) if known else mu,
        rng.choice([-1.0, 0.0, 1.0], n) if known else np.zeros(n),
        rng.uniform(0.0, 1.0, n) * (rng.random(n) < 0.5) if based else np.zeros(n),
    )


def fill(cones, problem):
    n = len(problem.mu)
    cones.set_size("n", n)
    for name, values in problem._asdict().items():
        cones.arrays[name].reshape(-1)[: values.size] = values.reshape(-1)
    return n


def solve(problem, cones=None):
    cones = Cones(len(problem.mu)) if cones is None else cones
    n = fill(cones, problem)
    status = solve_cones(cones.record)
    return status, *(cones.arrays[name][:n].copy() for name in FOUND)


def violation(problem, normal, tangential):
    """Of the conditions, in parts of the largest motion."""
    p = problem
    w_n = p.b_n + p.nn @ normal + p.nt @ tangential
    w_t = p.b_t + p.nt.T @ normal + p.tt @ tangential
    size = max(np.max(np.abs(p.b_n)), np.max(np.abs(p.b_t)))
    beyond, limit = (normal - p.base) * np.diag(p.nn), p.mu * normal
    c = np.diag(p.tt)
    known = -p.direction * limit
    free = np.clip(tangential - w_t / c, -limit, limit)
    off = np.where(p.mu > 0.0, tangential - np.where(p.direction == 0.0, free, known), tangential)
    return max(np.max(np.abs(np.minimum(beyond, w_n))), np.max(np.abs(off * c))) / size


@pytest.mark.sampled(12)
@pytest.mark.parametrize("based", [False, True])
@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("n", [1, 2, 3, 5, 8, 9, 14, 30, 60])
def test_the_conditions_hold(n, known, based):
    rng = np.random.default_rng(n)
    for _ in range(40 if n < 20 else 6):
        problem = random_problem(rng, n, True, known, based)
        status, normal, tangential, w_n, w_t = solve(problem)
        # every impact has a solution (Stewart and Trinkle 1996), unless friction is given the wrong way
        assert status != NONE or known
        if status == NONE:
            continue
        assert violation(problem, normal, tangential) < (2e-7 if n > 8 else 1e-9)
        size = np.max(np.abs(problem.b_n)) + np.max(np.abs(problem.b_t)) + np.max(np.abs(normal))
        assert w_n == pytest.approx(problem.b_n + problem.nn @ normal + problem.nt @ tangential, abs=1e-12 * size)
        assert w_t == pytest.approx(problem.b_t + problem.nt.T @ normal + problem.tt @ tangential, abs=1e-12 * size)


@pytest.mark.parametrize("n", [1, 4, 8, 20])
def test_without_friction_the_motion_is_that_of_least_energy(n):
    """Then the problem is that of a convex quadratic program; the same contacts in another order move alike."""
    rng = np.random.default_rng(n + 100)
    for _ in range(20):
        problem = random_problem(rng, n, friction=False)
        status, normal, _, w_n, w_t = solve(problem)
        assert status == SOLVED
        assert violation(problem, normal, np.zeros(n)) < 1e-9
        order = rng.permutation(n)
        turned = Problem(*(x[np.ix_(order, order)] if x.ndim == 2 else x[order] for x in problem))
        _, _, _, other_n, other_t = solve(turned)
        size = max(np.max(np.abs(problem.b_n)), np.max(np.abs(problem.b_t)))
        assert other_n == pytest.approx(w_n[order], abs=1e-8 * size)
        assert other_t == pytest.approx(w_t[order], abs=1e-8 * size)


@pytest.mark.parametrize("n", [1, 2, 6, 12, 25])
def test_units_change_no_digit(n):
    """Masses and speeds in other units, by powers of four (roots are taken): the same forces, bit for bit."""
    rng = np.random.default_rng(n + 200)
    for _ in range(10):
        p = random_problem(rng, n, known=n % 2 == 0, based=True)
        status, normal, tangential, w_n, w_t = solve(p)
        mass, speed = 4.0 ** rng.integers(-6, 7), 4.0 ** rng.integers(-6, 7)
        force = speed * mass
        scaled = Problem(
            p.nn / mass, p.nt / mass, p.tt / mass, p.b_n * speed, p.b_t * speed, p.mu, p.direction, p.base * force
        )
        found = solve(scaled)
        assert found[0] == status
        if status != NONE:
            assert np.array_equal(found[1:3], np.stack([normal, tangential]) * force)
            assert np.array_equal(found[3:], np.stack([w_n, w_t]) * speed)


@pytest.mark.parametrize("n", [1, 2, 5, 8, 9, 20])
def test_memory_decides_nothing(n):
    """Scratch full of NaN, or more room than it takes: no bit changes; what is given and what lies behind stays."""
    rng = np.random.default_rng(n + 300)
    roomy = Cones(n + 5)
    roomy.set_array("work", np.full(work_size(n) + 50, np.nan))
    for k in range(20):
        problem = random_problem(rng, n, known=k % 3 == 0, based=k % 2 == 0)
        wanted = solve(problem)
        roomy.arrays["work"][:] = np.nan
        roomy.arrays["work"][-50:] = 7.0
        found = solve(problem, roomy)
        assert found[0] == wanted[0]
        if found[0] != NONE:
            for x, y in zip(found[1:], wanted[1:], strict=True):
                assert x.tobytes() == y.tobytes()
        assert np.all(roomy.arrays["work"][-50:] == 7.0)
        for name, values in problem._asdict().items():
            assert np.array_equal(roomy.arrays[name].reshape(-1)[: values.size], values.reshape(-1))


@pytest.mark.parametrize("n", [1, 2, 9, 12])
def test_a_jammed_rod_has_no_solution(n):
    """Painleve's paradox: friction of a sliding rod's end turns the effect of its normal force round, a - mu b < 0,
    while its weight presses it down. Neighbours that are not concerned do not help."""
    nn, nt, tt = np.eye(n), np.zeros((n, n)), np.eye(n)
    nt[0, 0] = 0.9
    problem = Problem(
        nn, nt, tt, -np.ones(n), np.zeros(n), np.full(n, 1.5), np.eye(n)[0], np.zeros(n)
    )  # fmt: skip
    assert solve(problem)[0] == NONE
    # with less friction, or sliding the other way, there is one
    assert solve(problem._replace(mu=np.full(n, 0.5)))[0] != NONE
    assert solve(problem._replace(direction=-np.eye(n)[0]))[0] != NONE


@pytest.mark.parametrize("what", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("n", [1, 3, 10])
def test_what_is_no_number_does_no_harm(n, what):
    rng = np.random.default_rng(n)
    for k in range(len(Problem._fields)):
        problem = random_problem(rng, n)
        problem[k].reshape(-1)[-1] = what
        cones = Cones(n)
        cones.set_array("work", np.full(work_size(n) + 50, 7.0))
        assert solve(problem, cones)[0] in (NONE, SOLVED, BELOW_LIMITS)
        assert np.all(cones.arrays["work"][-50:] == 7.0)


def test_what_sticks_says_so():
    one, none = np.eye(2), np.zeros(2)
    p = Problem(one, np.zeros((2, 2)), one, -np.ones(2), np.full(2, 0.1), np.full(2, 0.3), none, none)
    assert solve(p)[0] == BELOW_LIMITS
    assert solve(p._replace(b_t=np.ones(2)))[0] == SOLVED
    assert solve(p._replace(direction=np.ones(2)))[0] == SOLVED


@compiled
def call(address, cn):
    return call_cones(address, cn)


def test_compiled_code_calls_it_by_address():
    problem = random_problem(np.random.default_rng(1), 4)
    wanted, cones = solve(problem), Cones(4)
    fill(cones, problem)
    assert call(address_of(solve_cones, CONES_SIGNATURE), cones.record) == wanted[0]
    assert np.array_equal(cones.arrays["normal"], wanted[1])


def test_no_contacts():
    cones = Cones(1)
    cones.set_size("n", 0)
    assert solve_cones(cones.record) == SOLVED
