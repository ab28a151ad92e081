"""LuGre's friction in space: tangents against differences, and deflections that stay in the tangent plane."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_seeds import assume, at_seeds
from test_cable_tangents3d import CLOSE, POINTS, plane, states
from test_cable_tangents3d import differences as cable_differences
from test_contact_tangents3d import HUNT, KELVIN, PLACES, TURNS, on_plane, on_sphere
from test_tangents import Point, differences, draw, quick
from test_tangents3d import A, B, P
from tlismni.core import (
    Capsule3D,
    CapsuleOnCapsule3D,
    Ellipsoid3D,
    HalfSpace3D,
    LuGreFriction,
    Model,
    SmoothOnHalfSpace3D,
    Sphere3D,
    SphereInSphere3D,
    SphereOnMesh3D,
    TriangleMesh3D,
)
from tlismni.core.laws.friction.lugre import lugre_formula, lugre_slip
from tlismni.core.state.modes import ACTIVE, OPEN


def in_sphere(law, a, b, **more):
    hollow, ball = Sphere3D(marker=a, radius=2.1), Sphere3D(marker=b, radius=1.6)
    return SphereInSphere3D(name="c", hollow=hollow, sphere=ball, law=law, **more)


def egg_on_plane(law, a, b, **more):
    shape = Ellipsoid3D(marker=b, half_axes=(2.7, 2.2, 2.4))
    return SmoothOnHalfSpace3D(name="c", plane=HalfSpace3D(marker=a), shape=shape, law=law, **more)


def capsules(law, a, b, **more):
    """Both points of contact are free."""
    first, second = Capsule3D(marker=a, length=6.0, radius=1.2), Capsule3D(marker=b, length=7.0, radius=1.1)
    return CapsuleOnCapsule3D(name="c", a=first, b=second, law=law, **more)


def ball_on_capsule(law, a, b, **more):
    first, second = Capsule3D(marker=a, length=6.0, radius=1.2), Sphere3D(marker=b, radius=1.1)
    return CapsuleOnCapsule3D(name="c", a=first, b=second, law=law, **more)


def end_on_capsule(law, a, b, **more):
    """The nearest point of the first one is its end."""
    first, second = Capsule3D(marker=a, length=0.01, radius=1.2), Capsule3D(marker=b, length=7.0, radius=1.1)
    return CapsuleOnCapsule3D(name="c", a=first, b=second, law=law, **more)


def on_mesh(law, a, b, **more):
    vertices = ((0.5, 0.1, 0.2), (-0.4, 0.6, -0.1), (-0.3, -0.5, 0.0), (0.0, 0.0, -0.7))
    faces = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))
    mesh = TriangleMesh3D(marker=a, vertices=vertices, faces=faces)
    return SphereOnMesh3D(name="c", mesh=mesh, sphere=Sphere3D(marker=b, radius=2.0), law=law, **more)


SOFT = LuGreFriction(
    coefficient=0.4, static_coefficient=0.6, stribeck_speed=1.5, bristle_stiffness=0.7, bristle_damping=0.4,
    viscous_damping=0.2,
)  # fmt: skip
# the normal forces of these tests are below its least one, where bristles slip and rub in proportion to them
STIFF = SOFT.model_copy(update={"bristle_stiffness": 3e9, "bristle_damping": 1.0})
SHAPES = (
    on_plane, on_sphere, in_sphere, egg_on_plane, capsules, ball_on_capsule, end_on_capsule, on_mesh,
)  # fmt: skip
TURNING = (egg_on_plane, capsules, end_on_capsule)
CASES = {
    f"{shape.__name__}, {where}, {name}": shape(law, *ends, friction=friction, **more)
    for shape in SHAPES
    for where, ends in PLACES.items()
    for law, name, friction, more in (
        (KELVIN, "linear", SOFT, {}), (HUNT, "turning", SOFT, {"turning": TURNS}), (HUNT, "stiff", STIFF, {}),
    )
    if where != "a point mass" or not (shape in TURNING or more)  # a point does not turn
}  # fmt: skip


def point_of(case, mode=ACTIVE):
    return Point(Model(gravity=(0.3, -0.4, -9.0), bodies=[A, P, B], contacts=[CASES[case]]), mode)


def some_state(point, case, seed):
    state = draw(point, seed)
    if case.endswith("stiff"):
        # bent by no more than forces of one
        state[2][point.n - point.workspace.assembly.n_internal :] *= 1.0 / STIFF.bristle_stiffness
    return state


@pytest.mark.parametrize("case", CASES)
def test_tangent_is_the_derivative_of_the_residual(case):
    point = point_of(case)
    n = point.n

    @at_seeds
    def check(seed):
        state = some_state(point, case, seed)
        point.at(*state)
        # friction has a kink where the normal force vanishes
        assume(abs(point.workspace.arrays["monitor"][0]) > 0.3)
        matrix, no_lam = point.tangent(0.6, 0.8), np.zeros(point.m)
        s, off = differences(point, 0, [(0.0, 0.6 * e, 0.8 * e, e, no_lam) for e in np.eye(n)], state)
        assert np.abs(matrix[:n, :n] - s).max() < off

    check()


@pytest.mark.parametrize("place", POINTS)
def test_tangent_of_a_cable_on_a_half_space(place):
    point = Point(plane(place, law=HUNT, friction=SOFT), ACTIVE)
    for state in states(point):
        point.at(*state)
        assert abs(point.workspace.arrays["monitor"][0]) > 0.01
        matrix, s = point.tangent(0.6, 0.8), cable_differences(point, state)
        assert np.abs(matrix[: point.n, : point.n] - s).max() < CLOSE * max(1.0, np.abs(s).max())


@pytest.mark.parametrize("case", [case for case in CASES if case.endswith("linear") and "sphere" in case])
def test_deflections_stay_in_the_tangent_plane(case):
    """zeta' as the residual says it: where n.z = 0 it stays so, wherever the normal goes."""
    point, contact = point_of(case), CASES[case]
    first = point.n - 3

    def normal(q):
        """Along the axes of the first marker."""
        (place, axes), (other, _) = (_placed(point, marker, q) for marker in contact.markers())
        away = axes.T @ (other - place)
        return away / np.linalg.norm(away)

    for seed in range(6):
        state = draw(point, seed)
        q, v = _on_the_norm(point, state[1], state[2])
        state[1], state[2], state[3] = q, v, np.zeros(point.n)
        along, moved, h = normal(q), np.concatenate([v[:first], np.zeros(3)]), 1e-5
        v[first:] -= along * (along @ v[first:])
        turns = (normal(q + h * moved) - normal(q - h * moved)) / (2.0 * h)
        rates = -point.at(*state)[0][first:]
        assert abs(along @ rates + turns @ v[first:]) < 1e-8
        assert np.abs(rates).max() > 1e-2


def _placed(point, marker, q):
    """Place and axes (3, 3) of a marker."""
    columns = point.workspace.assembly.body_columns
    at = [index for body, _, index in columns if body == marker.body]
    axes, place = marker.axes(), np.array(marker.point)
    if not at:
        return place, axes
    own = q[at]
    if len(own) == 3:
        return own, axes
    e0, e = own[3], own[4:7]
    skew = np.array([[0.0, -e[2], e[1]], [e[2], 0.0, -e[0]], [-e[1], e[0], 0.0]])
    turn = (e0 * e0 - e @ e) * np.eye(3) + 2.0 * np.outer(e, e) + 2.0 * e0 * skew
    return own[:3] + turn @ place, turn @ axes


def _on_the_norm(point, q, v):
    """The same with Euler parameters of norm 1 that keep it."""
    q, v = q.copy(), v.copy()
    for body in ("a", "b"):
        at = [index for name, _, index in point.workspace.assembly.body_columns if name == body][3:7]
        q[at] /= np.linalg.norm(q[at])
        v[at] -= q[at] * (q[at] @ v[at])
    return q, v


@pytest.mark.parametrize("case", [case for case in CASES if case.endswith("linear")])
def test_bristles_of_an_open_contact_do_nothing(case):
    point = point_of(case, OPEN)
    first = point.n - point.workspace.assembly.n_internal
    state = draw(point, 3)
    here = point.at(*state)[0]
    assert np.array_equal(here[first:], state[3][first:])
    state[2][first:] += 1.0
    assert np.array_equal(point.at(*state)[0][:first], here[:first])


@quick
@given(z=st.floats(-0.2, 0.2), v=st.floats(-3.0, 3.0), normal=st.floats(0.01, 10.0))
def test_slip_is_that_of_the_law_in_one_dimension(z, v, normal):
    numbers = (2.0, 0.3, 0.5, 0.7)  # s0, mu, mu_s, v_s
    s0, kinetic, static, vs = numbers
    rate, rate_z, rate_v, rate_n, *_ = lugre_formula(z, v, normal, s0, 0.0, 0.0, kinetic, static, vs)
    h, h_speed, h_normal = lugre_slip.py_func(abs(v), normal, s0, kinetic, static, vs)
    sign = 1.0 if v >= 0.0 else -1.0
    size = 1.0 + abs(v) + abs(h) + abs(h_speed)
    assert v - h * z == pytest.approx(rate, abs=1e-12 * size)
    assert -h == pytest.approx(rate_z, abs=1e-12 * size)
    assert 1.0 - sign * h_speed * z == pytest.approx(rate_v, abs=1e-12 * size)
    assert -h_normal * z == pytest.approx(rate_n, abs=1e-12 * (1.0 + abs(h_normal)))
