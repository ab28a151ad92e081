"""Exact friction cones of several contacts: residuals of random problems, one contact against its closed forms."""

import math

import numba
import numpy as np
import pytest
from tlismni.core.compiled.jit import address_of
from tlismni.core.contact_solvers.friction_cones import (
    CONES_SOLVED,
    MOST_SWEEPS,
    friction_cones_size,
    solve_friction_cones,
)
from tlismni.core.contact_solvers.least_forces import least_forces_size, take_least_forces
from tlismni.core.linalg.small import LEAST_NORM_SIGNATURE, least_norm


@numba.njit
def _solve(address, n, a, b, mu, base, known, way, p, work):
    return solve_friction_cones(address, n, a, b, mu, base, known, way, p, work, MOST_SWEEPS)


def solve(a, b, mu, base=None, known=None, way=None):
    n = len(mu)
    p, work = np.zeros(3 * n), np.zeros(friction_cones_size(n))
    base = np.zeros(n) if base is None else base
    known, way = np.zeros(n) if known is None else known, np.zeros((3, n)) if way is None else way
    address = address_of(least_norm, LEAST_NORM_SIGNATURE)
    status = _solve(address, n, a, b, np.asarray(mu, float), base, known, way, p, work.ctypes.data)
    assert status == CONES_SOLVED
    return p, b + a @ p


@numba.njit
def _least(address, n, a, b, mu, base, known, way, p, work):
    return take_least_forces(address, n, a, b, mu, base, known, way, p, work)


def least(p, a, b, mu):
    """Forces of least norm, from the forces p."""
    n = len(mu)
    found, work = p.copy(), np.zeros(friction_cones_size(n) + least_forces_size(n))
    nothing, way = np.zeros(n), np.zeros((3, n))
    address = address_of(least_norm, LEAST_NORM_SIGNATURE)
    assert _least(address, n, a, b, np.asarray(mu, float), nothing, nothing, way, found, work.ctypes.data)
    return found


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(20))
def test_least_forces_of_a_box_that_rests_are_the_pseudoinverse(seed):
    """Loads that hold the box with friction to spare: of all forces the least, whatever the solver began with."""
    random = np.random.default_rng(seed)
    g, mu = box(), np.full(4, 0.8)
    load = np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0]) + random.normal(size=6) * [0.3, 0.3, 0.3, 0.02, 0.02, 0.02]
    a, b = g @ INVERSE @ g.T, g @ load
    wanted = -np.linalg.pinv(g.T) @ np.linalg.solve(INVERSE, load)
    assert np.all(np.hypot(wanted[4:8], wanted[8:]) < 0.8 * wanted[:4])
    p, _ = solve(a, b, mu)
    np.testing.assert_allclose(least(p, a, b, mu), wanted, atol=1e-9 * np.abs(wanted).max())


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", range(20))
def test_least_forces_are_the_limit_of_compliant_contacts(seed):
    """Some feet at their limits: null vectors n of the rows that are held leave n^T P = 0 for the rest to share."""
    random = np.random.default_rng(100 + seed)
    g, mu = box(), np.full(4, 0.3)
    push = 2.6 * np.array([np.cos(seed), np.sin(seed)])
    load = np.array([*push, -9.81, 0.0, 0.0, 0.0]) + random.normal(size=6) * [0, 0, 0, 0.02, 0.02, 0.02]
    a, b = g @ INVERSE @ g.T, g @ load
    p, _ = solve(a, b, mu)
    found = least(p, a, b, mu)
    assert off(found, b + a @ found, mu) < 1e-8
    # the same from other forces that give this motion
    order = np.r_[3, 1, 0, 2]
    rows = np.concatenate([order, 4 + order, 8 + order])
    other, _ = solve(a[np.ix_(rows, rows)], b[rows], mu)
    np.testing.assert_allclose(
        least(other, a[np.ix_(rows, rows)], b[rows], mu), found[rows], atol=1e-8 * np.abs(found).max()
    )


@pytest.mark.parametrize("part", [1e-4, 1e-6, 5e-8])
def test_least_forces_where_a_contact_opens_next_to_nothing(part):
    """A corner with two feet, of which one accelerates away by a small part of the weight: it carries nothing, however
    near the limit of no compliance that shows."""
    g, mu = box(), np.full(5, 0.8)
    g = g[[0, 1, 2, 3, 3, 4, 5, 6, 7, 7, 8, 9, 10, 11, 11]]
    load = np.array([0.3, -0.2, -9.81, 0.0, 0.0, 0.0])
    a, b = g @ INVERSE @ g.T, g @ load
    b[4] += part * 9.81
    p, _ = solve(a, b, mu)
    rest = [0, 1, 2, 3, 5, 6, 7, 8, 10, 11, 12, 13]
    wanted = -np.linalg.pinv(g[rest].T) @ np.linalg.solve(INVERSE, load)
    found = least(p, a, b, mu)
    np.testing.assert_allclose(found[rest], wanted, atol=1e-6 * np.abs(wanted).max())
    assert np.all(found[[4, 9, 14]] == 0.0)


def off(p, w, mu, base=0.0):
    """The largest violation of the cones, of complementarity and of opposite directions."""
    n = len(mu)
    normal, friction, slide = p[:n], p[n:].reshape(2, n), w[n:].reshape(2, n)
    speed = np.hypot(*slide)
    return max(
        np.max(base - normal), np.max(-w[:n]), np.max(np.abs((normal - base) * w[:n])),
        np.max(np.hypot(*friction) - mu * normal), np.max(np.abs(friction * speed + mu * normal * slide)),
    )  # fmt: skip


def box(height=0.1):
    """Rows of the velocities of a box's lower corners: normals, first and second tangents."""
    corners = [np.array([x, y, -height]) for x in (0.2, -0.2) for y in (0.15, -0.15)]
    return np.array([np.r_[axis, np.cross(c, axis)] for axis in np.eye(3)[[2, 0, 1]] for c in corners])


INVERSE = np.diag([0.5, 0.5, 0.5, 50.0, 33.0, 25.0])


@pytest.mark.sampled(60)
@pytest.mark.parametrize("mu", [0.1, 0.4, 0.8])
@pytest.mark.parametrize("seed", range(60))
def test_four_corners_of_a_box(mu, seed):
    """Four contacts with six degrees of freedom: forces are not unique, motion is."""
    random = np.random.default_rng(seed)
    g = box()
    v = random.normal(size=6) * [1, 1, 0.3, 2, 2, 2] - [0, 0, 0.5, 0, 0, 0]
    a, b, friction = g @ INVERSE @ g.T, g @ v, np.full(4, mu)
    p, w = solve(a, b, friction)
    assert off(p, w, friction) < 1e-8
    # friction takes energy away
    after = v + INVERSE @ g.T @ p
    mass = np.linalg.inv(INVERSE)
    assert after @ mass @ after <= v @ mass @ v * (1.0 + 1e-9)


@pytest.mark.sampled(40)
@pytest.mark.parametrize("seed", range(100))
def test_one_contact_of_any_body(seed):
    """A full block: the direction of sliding turns in the blow."""
    random = np.random.default_rng(seed)
    g = random.normal(size=(3, 6))
    a, b = g @ g.T, random.normal(size=3) * [0.2, 1, 1] - [1, 0, 0]
    friction = np.array([random.uniform(0.0, 0.6)])
    p, w = solve(a, b, friction)
    assert off(p, w, friction) < 1e-12 * max(1.0, np.abs(p).max() * np.abs(a).max())


def test_sphere_slides_against_its_slip_or_sticks():
    """P_T = min(mu P_N, 2/7 m |slip|)."""
    a, slip = np.diag([1.0, 3.5, 3.5]), np.array([0.6, -0.8])
    for mu in (0.05, 0.5):
        p, _ = solve(a, np.array([-2.0, *slip]), [mu])
        assert p[0] == pytest.approx(2.0, rel=1e-15)
        assert p[1:] == pytest.approx(-min(mu * 2.0, 2.0 / 7.0) * slip, rel=1e-14)


def test_known_directions_and_forces_that_act_in_any_case():
    a, way = np.diag([1.0, 3.5, 3.5]), np.array([[0.6], [0.8], [0.0]])
    p, _ = solve(a, np.array([-2.0, 0.0, 0.0]), [0.3], known=np.ones(1), way=way)
    assert p == pytest.approx([2.0, -0.36, -0.48])
    p, w = solve(a, np.array([1.0, 0.9, 0.0]), [0.1], base=np.array([0.5]))
    assert p == pytest.approx([0.5, -0.05, 0.0]) and w[0] == pytest.approx(1.5)


def test_a_polygon_would_err_in_direction():
    """Sliding at 20 degrees: the force is against it to rounding, not along the nearest edge."""
    angle = math.radians(20.0)
    p, _ = solve(np.diag([1.0, 3.5, 3.5]), np.array([-1.0, 5.0 * math.cos(angle), 5.0 * math.sin(angle)]), [0.3])
    assert math.atan2(p[2], p[1]) == pytest.approx(angle - math.pi, abs=1e-14)


@pytest.mark.sampled(60)
@pytest.mark.parametrize("seed", range(300))
def test_corners_that_are_nearly_at_rest(seed):
    """Weight of a moment and speeds from far less than it to far more: sticking, sliding, and what is between."""
    random = np.random.default_rng(seed)
    g, size = box(), 10.0 ** random.uniform(-12, 1)
    v = random.normal(size=6) * [1, 1, 0, 0, 0, 5] * size
    if seed % 2:
        v[2:5] = random.normal(size=3) * [1, 5, 5] * size * 10.0 ** random.uniform(-4, 0)
    v[2] -= 9.81 * 10.0 ** random.uniform(-6, 0)
    largest, friction = np.abs(g @ v).max(), np.full(4, random.uniform(0.05, 1.2))
    p, w = solve(g @ INVERSE @ g.T, g @ v / largest, friction)
    assert off(p, w, friction) < 1e-8


def test_a_sliding_contact_near_jamming_is_found():
    """Its pole, where friction lifts as much as the normal force, lies between two of the angles that are tried."""
    found = 0
    for seed in range(400):
        random = np.random.default_rng(seed)
        jacobian = random.normal(size=(3, 4))
        a, v = jacobian @ jacobian.T, random.normal(size=4)
        b = jacobian @ v
        if b[0] >= 0.0:
            continue
        mu = np.array([random.uniform(0.5, 1.5) * a[0, 0] / np.hypot(a[0, 1], a[0, 2])])
        p, w = solve(a, b, mu)
        assert off(p, w, mu) < 1e-8 * max(1.0, p[0]) ** 2
        found += 1
    assert found > 100


def spheres(seed):
    """Inverse masses and motion of contacts of spheres of different size with each other and with walls, of which many
    hold each other in rings."""
    random = np.random.default_rng(seed)
    count, most = int(random.integers(3, 12)), random.integers(2, 4)
    radii = random.uniform(0.03, 0.05, count)
    mass, pairs = 2000.0 * 4.0 / 3.0 * np.pi * radii**3, []
    for i in range(count):
        for _ in range(int(random.integers(1, most + 1))):
            j, normal = int(random.integers(-2, i)) if i else -1, random.normal(size=3)
            normal[2] = abs(normal[2]) + 0.3
            pairs.append((i, j, normal / np.linalg.norm(normal)))
    n = len(pairs)
    g, inverse = np.zeros((3, n, count, 6)), np.repeat(1.0 / mass, 6).reshape(count, 6)
    inverse[:, 3:] /= 0.4 * radii[:, None] ** 2
    for k, (i, j, normal) in enumerate(pairs):
        first = np.cross(normal, [1.0, 0.0, 0.3])
        first /= np.linalg.norm(first)
        for block, along in enumerate((normal, first, np.cross(normal, first))):
            g[block, k, i] = np.r_[along, np.cross(-radii[i] * normal, along)]
            if j >= 0:
                g[block, k, j] = -np.r_[along, np.cross(radii[j] * normal, along)]
    g = g.reshape(3 * n, 6 * count)
    v = np.tile([0.0, 0.0, -9.81, 0.0, 0.0, 0.0], count)
    v += 0.5 * random.normal(size=6 * count) * np.tile([1.0] * 3 + [20.0] * 3, count)
    return (g * inverse.ravel()) @ g.T, g @ v, np.full(n, 0.4)


HARD = (152, 491, 1085, 1273, 1602, 2441, 2516, 2695, 2761)
"""Of the first 3000, those in which contacts wedge each other so that sweeps, Newton's method, and forces that grow
with friction find nothing; and two (2516, 2761) in which a long step along the path ends on another one."""


@pytest.mark.sampled(1)
@pytest.mark.parametrize("seeds", [range(100), range(100, 200), HARD], ids=["100", "200", "hard"])
def test_rings_of_spheres_that_wedge_each_other(seeds):
    for seed in seeds:
        a, b, friction = spheres(seed)
        p, w = solve(a, b, friction)
        assert off(p, w, friction) < 1e-8, seed


def test_forces_that_do_not_exist_are_not_found():
    """Sliding along the known way, friction presses more than the normal force lifts (Painleve)."""
    a = np.array([[1.0, 3.0, 0.0], [3.0, 10.0, 0.0], [0.0, 0.0, 10.0]])
    args = np.array([-1.0, 0.0, 0.0]), np.array([0.5]), np.zeros(1), np.ones(1), np.array([[1.0], [0.0]])
    p, work = np.zeros(3), np.zeros(friction_cones_size(1))
    address = address_of(least_norm, LEAST_NORM_SIGNATURE)
    assert _solve(address, 1, a, *args, p, work.ctypes.data) != CONES_SOLVED


@pytest.mark.sampled(10)
@pytest.mark.parametrize("rank", [6, 4, 2])
@pytest.mark.parametrize("seed", range(10))
def test_friction_with_three_tangents_lies_in_a_ball(seed, rank):
    """Two loads whose friction has three tangents each, in contacts 0 and 1, 2 and 3, and moves that of the other."""
    random, n = np.random.default_rng(seed), 4
    rows = np.array([[n, 2 * n, n + 1], [n + 2, 2 * n + 2, n + 3]])
    a, b, mu = np.zeros((3 * n, 3 * n)), np.zeros(3 * n), np.full(n, 0.7)
    a[:n, :n], b[:n] = np.diag(random.uniform(0.5, 2.0, n)), -1.0
    b[1], b[3] = b[0] * a[1, 1] / a[0, 0], b[2] * a[3, 3] / a[2, 2]
    root = random.normal(size=(6, rank))
    a[np.ix_(rows.ravel(), rows.ravel())] = root @ root.T
    b[rows.ravel()] = root @ random.normal(size=rank) * random.choice([0.3, 3.0])
    way = np.zeros((3, n))
    way[2] = [1.0, -1.0, 1.0, -1.0]
    p, w = solve(a, b, mu, way=way)
    assert p[:n] == pytest.approx(-b[:n] / np.diag(a)[:n], rel=1e-12)
    for k, three in enumerate(rows):
        force, motion, limit = p[three], w[three], 0.7 * p[2 * k]
        size, speed = np.linalg.norm(force), np.linalg.norm(motion)
        assert size <= limit * (1.0 + 1e-9)
        if speed > 1e-6 * np.abs(b).max():
            assert force == pytest.approx(-limit * motion / speed, abs=1e-6 * limit)
