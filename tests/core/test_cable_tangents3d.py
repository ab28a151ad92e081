"""Tangents and levels of contacts with a cable in space against differences of their residuals, friction included."""

import numpy as np
import pytest
from test_contact_tangents3d import GRIP, HARD, HUNT, KELVIN, PEAK, SLIDES, TANH, forward
from test_tangents import Point, check_levels, check_matrix, draw
from tlismni.core import (
    AxisAngles,
    Cable3D,
    CableOnHalfSpace3D,
    HalfSpace3D,
    Marker3D,
    Model,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnCable3D,
)
from tlismni.core.state.modes import ACTIVE, AT_LIMIT, CLOSED, STICKS

SPAN = 2e-3
CLOSE = 1e-7
SHAPE = ((0.0, 0.0, 0.0, 1.1, 0.4, 0.2), (0.9, 0.3, 0.3, 0.9, 0.2, -0.3), (2.0, 0.2, 0.1, 1.0, -0.5, 0.1))
CABLE = Cable3D(
    name="cable", elements=2, length=2.0, mass_per_length=1.3, axial_stiffness=5.0, bending_stiffness=0.7, shape=SHAPE
)
PLACES = {
    "first element": (0.4, 0.5, 0.6), "second element": (1.5, 0.9, -0.5), "beyond the end": (2.7, 0.6, 0.3),
    "before the start": (-0.6, 0.3, 0.4),
}  # fmt: skip
POINTS = {"a node": 0.5, "between": 0.31, "an end": 1.0}


def body(place):
    return RigidBody3D(
        name="b", mass=0.7, inertia=(0.2, 0.25, 0.3), position=place, attitude=AxisAngles(angles=(0.1, 0.3, -0.2))
    )


def ball(place, **more):
    sphere = Sphere3D(marker=Marker3D(body="b", point=(0.1, -0.1, 0.05)), radius=1.1)
    contact = SphereOnCable3D(name="c", cable="cable", thickness=0.3, sphere=sphere, **more)
    return Model(bodies=[body(PLACES[place]), CABLE], contacts=[contact])


def plane(place, **more):
    marker = Marker3D(body="b", point=(0.1, -0.1, 0.05), attitude=RotationVector(vector=(0.2, -0.3, 0.4)))
    contact = CableOnHalfSpace3D(
        name="c", cable="cable", thickness=0.3, place=POINTS[place], plane=HalfSpace3D(marker=marker), **more
    )
    return Model(bodies=[body((0.3, 0.2, 1.1)), CABLE], contacts=[contact])


CASES = {f"{kind.__name__}, {place}": (kind, place) for kind, places in ((ball, PLACES), (plane, POINTS))
         for place in places}  # fmt: skip


def states(point, count=3):
    """Near the start: a foot that is beyond an end stays there."""
    for seed in range(count):
        state = draw(point, seed)
        state[1] = point.workspace.assembly.q0 + 0.2 * (state[1] - point.workspace.assembly.q0)
        yield state


def differences(point, state):
    """S by differences."""
    zero = np.zeros(point.m)
    units = np.eye(point.n)
    return np.array([point.derivative(0, (0.0, 0.6 * e, 0.8 * e, e, zero), state, SPAN) for e in units]).T


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("law", [HARD, KELVIN], ids=["constraint", "force"])
def test_tangent_and_levels_without_friction(case, law):
    build, place = CASES[case]
    point = Point(build(place, law=law), CLOSED if law is HARD else ACTIVE)
    for state in states(point):
        assert law is HARD or point.at(*state)[1][-1] < 0.0
        check_matrix(point, state, h=SPAN)
        check_levels(point, state, SPAN)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("friction", [TANH, PEAK], ids=["tanh", "peak"])
def test_tangent_of_regularised_friction(case, friction):
    build, place = CASES[case]
    point = Point(build(place, law=HUNT, friction=friction), ACTIVE)
    for state in states(point):
        point.at(*state)
        assert abs(point.workspace.arrays["monitor"][0]) > 0.01
        matrix, s = point.tangent(0.6, 0.8), differences(point, state)
        assert np.abs(matrix[: point.n, : point.n] - s).max() < CLOSE * max(1.0, np.abs(s).max())


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("slides", [kind for kind in SLIDES if SLIDES[kind] is not None])
def test_tangent_and_rates_of_coulomb_friction(case, slides):
    """Rows of sticking at velocity level: their W is the derivative of phid by v; phidd is the rate of phid."""
    build, place = CASES[case]
    point, slide = Point(build(place, law=HARD, friction=GRIP)), SLIDES[slides]
    twice = {STICKS: {0, 1}, AT_LIMIT: {0}}.get(slide, set())
    point.workspace.engage(frozenset({0}), frozenset(), frozenset(twice))
    axis = 1 if build is plane else 2
    columns = ["mode", "slide_mode", "friction_ratio", "tangent_angle", "tangent_axis"]
    point.remember(columns, (CLOSED, slide, -0.4 if slide == 1.0 else 0.3, 0.7, axis))
    n, active = point.n, point.workspace.structure.active
    rows = point.workspace.assembly.contacts[0].slide_row + np.arange(2)
    found = 0
    for state in states(point, 12):
        if slide == 1.0 and not forward(point, state):
            continue
        found += 1
        if found > 3:
            break
        _, q, v, a, lam = state
        second = point.derivative(2, (1.0, v, a, np.zeros_like(q), np.zeros_like(lam)), state, SPAN)
        here = point.at(*state)[3]
        assert np.abs(here[rows] - second[rows]).max() < CLOSE * max(1.0, np.abs(second[rows]).max())
        matrix, zero, no_lam = point.tangent(0.6, 0.8), np.zeros(n), np.zeros(point.m)
        s = differences(point, state)
        assert np.abs(matrix[:n, :n] - s).max() < CLOSE * max(1.0, np.abs(s).max())
        units = np.eye(n)
        jacobian = np.array([point.derivative(2, (0.0, zero, e, zero, no_lam), state, SPAN) for e in units]).T[active]
        assert np.abs(matrix[n:, :n] - jacobian).max(initial=0.0) < CLOSE
        for i, row in enumerate(active):
            force = point.derivative(0, (0.0, zero, zero, zero, np.eye(point.m)[row]), state)
            assert np.abs(force - matrix[:n, n + i]).max() < 1e-9
    assert found


def test_gap_is_the_distance_from_the_curve():
    """Against the nearest of many points of the cubics; the sphere sweeps over the border between the elements."""
    point = Point(ball("first element", law=HARD))
    nodes = np.array(SHAPE).reshape(3, 2, 3)
    curve = []
    for e in range(2):
        for x in np.linspace(0.0, 1.0, 20001):
            w = (1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2)
            vectors = (nodes[e, 0], nodes[e, 1], nodes[e + 1, 0], nodes[e + 1, 1])
            curve.append(sum(k * vector for k, vector in zip(w, vectors, strict=True)))
    curve = np.array(curve)
    q, none = point.workspace.assembly.q0.copy(), np.zeros(point.n)
    q[3:7] = 1.0, 0.0, 0.0, 0.0
    for x in np.linspace(-0.6, 2.6, 9):
        for y, z in ((0.9, 0.2), (-0.6, 0.5), (0.1, -0.8)):
            q[:3] = x, y, z
            gap = point.at(0.0, q, none, none, np.zeros(point.m))[1][-1]
            away = curve - np.array([x + 0.1, y - 0.1, z + 0.05])
            assert abs(gap - (np.linalg.norm(away, axis=1).min() - 1.4)) < 1e-8
