"""Tangents and levels of contacts whose points move on their bodies, against differences of their residuals."""

import numpy as np
import pytest
from random_seeds import assume, at_seeds
from test_contact_tangents3d import HUNT, PEAK, SLIDES, forward, is_smooth
from test_tangents import Point, check_levels, check_matrix, differences, draw
from test_tangents3d import GROUND, LEFT, RIGHT, RIGHT_WHEEL, A, B, P
from tlismni.core import (
    Axes,
    Capsule3D,
    CapsuleOnCapsule3D,
    CoulombFriction,
    Cylinder3D,
    Ellipsoid3D,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    Rim3D,
    SmoothOnHalfSpace3D,
    Sphere3D,
    SphereInSphere3D,
    SphereOnCylinder3D,
    SphereOnRing3D,
    SphereOnSmooth3D,
    Torus3D,
)
from tlismni.core.state.modes import ACTIVE, AT_LIMIT, CLOSED, STICKS

SPAN = 1e-3
"""Of the differences: these gaps bend more than those of spheres."""
HARD, GRIP = NewtonImpact(restitution=0.5), CoulombFriction(coefficient=0.4)
TOWARDS = Marker3D(body="a", point=(0.3, -0.2, 0.1), attitude=Axes(z=(0.7, 0.5, -0.1)))
ASLANT = Marker3D(body="a", point=(0.3, -0.2, 0.1), attitude=Axes(z=(0.7, 0.5, 0.9)))
BALL = Sphere3D(marker=RIGHT, radius=2.1)
LYING = Marker3D(body="b", point=(-0.4, 0.1, 0.25), attitude=Axes(z=(0.2, 0.1, 1.0)))
FAR = Marker3D(body="b", point=(-0.4, 2.6, 0.25), attitude=Axes(z=(1.0, 0.2, 0.1)))


def smooth(shape, a, **more):
    return SmoothOnHalfSpace3D(name="c", plane=HalfSpace3D(marker=a), shape=shape, **more)


def capsules(a, b, first, second, **more):
    """By their ends where these are short, by their sides where they are long."""
    pair = Capsule3D(marker=a, length=first, radius=1.6), Capsule3D(marker=b, length=second, radius=2.1)
    return CapsuleOnCapsule3D(name="c", a=pair[0], b=pair[1], **more)


def on_cylinder(marker, radius, length, **more):
    """By its side where it is long, by its end where it is wide, by its rim where it is small."""
    return SphereOnCylinder3D(
        name="c", shape=Cylinder3D(marker=marker, radius=radius, length=length), sphere=BALL, **more
    )


SHAPES = {
    "ellipsoid": lambda **more: smooth(Ellipsoid3D(marker=RIGHT, half_axes=(2.1, 3.2, 2.6)), LEFT, **more),
    "torus": lambda **more: smooth(Torus3D(marker=RIGHT_WHEEL, radius=2.4, rim_radius=0.7), GROUND, **more),
    "rim": lambda **more: smooth(Rim3D(marker=LYING, radius=2.4, rim_radius=0.7, flat_tilt=0.5), GROUND, **more),
    "hollow sphere": lambda **more: SphereInSphere3D(
        name="c", hollow=Sphere3D(marker=LEFT, radius=1.6), sphere=Sphere3D(marker=RIGHT, radius=1.5), **more
    ),
    "ends": lambda **more: capsules(LEFT, RIGHT_WHEEL, 0.02, 0.03, **more),
    "nearly parallel": lambda **more: capsules(LEFT, RIGHT, 0.02, 0.03, parallel_tilt=0.5, **more),
    "crossed": lambda **more: capsules(LEFT, FAR, 30.0, 30.0, **more),
    "end on side": lambda **more: capsules(LEFT, RIGHT_WHEEL, 0.02, 30.0, **more),
    "ball on ellipsoid": lambda **more: SphereOnSmooth3D(
        name="c", shape=Ellipsoid3D(marker=LEFT, half_axes=(0.15, 0.25, 0.1)), sphere=BALL, **more
    ),
    "ball on side": lambda **more: on_cylinder(LEFT, 0.1, 30.0, **more),
    "ball on end": lambda **more: on_cylinder(TOWARDS, 8.0, 0.02, **more),
    "ball on rim": lambda **more: on_cylinder(ASLANT, 0.1, 0.02, **more),
    "ball on disk": lambda **more: SphereOnCylinder3D(
        name="c", shape=Torus3D(marker=ASLANT, radius=0.1), sphere=BALL, **more
    ),
    "ball on ring": lambda **more: SphereOnRing3D(
        name="c", ring=Torus3D(marker=ASLANT, radius=0.05, rim_radius=0.06), sphere=BALL, **more
    ),
    "sphere on capsule": lambda **more: CapsuleOnCapsule3D(
        name="c", a=Capsule3D(marker=LEFT, length=30.0, radius=1.6), b=Sphere3D(marker=RIGHT, radius=2.1), **more
    ),
}  # fmt: skip


def system(contact):
    return Model(gravity=(0.3, -0.4, -9.0), bodies=[A, P, B], contacts=[contact])


@pytest.mark.parametrize("name", SHAPES)
def test_levels_and_tangent_without_friction(name):
    point = Point(system(SHAPES[name](law=HARD)), CLOSED)

    @at_seeds
    def check(seed):
        state = draw(point, seed)
        assume(is_smooth(point, state))
        check_matrix(point, state, h=SPAN)
        check_levels(point, state, SPAN)

    check()


@pytest.mark.parametrize("name", SHAPES)
def test_tangent_of_regularised_friction(name):
    point = Point(system(SHAPES[name](law=HUNT, friction=PEAK)), ACTIVE)
    n = point.n

    @at_seeds
    def check(seed):
        state = draw(point, seed)
        point.at(*state)
        # friction has a kink where the normal force vanishes
        assume(abs(point.workspace.arrays["monitor"][0]) > 0.5)
        matrix, zero = point.tangent(0.6, 0.8), np.zeros(point.m)
        s, off = differences(point, 0, [(0.0, 0.6 * e, 0.8 * e, e, zero) for e in np.eye(n)], state, SPAN)
        assert np.abs(matrix[:n, :n] - s).max() < off

    check()


def gripping(name, slide):
    point = Point(system(SHAPES[name](law=HARD, friction=GRIP)))
    twice = {STICKS: {0, 1}, AT_LIMIT: {0}}.get(slide, set())
    point.workspace.engage(frozenset({0}), frozenset(), frozenset(twice))
    columns = ["mode", "slide_mode", "friction_ratio", "tangent_angle", "tangent_axis"]
    axis = 1 if name in ("ellipsoid", "torus", "rim") else 2
    point.remember(columns, (CLOSED, slide, -0.4 if slide == 1.0 else 0.3, 0.7, axis))
    return point


@pytest.mark.sampled(30)
@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("slides", [kind for kind in SLIDES if SLIDES[kind] is not None])
def test_tangent_and_rates_of_coulomb_friction(name, slides):
    """Rows of sticking at velocity level: their W is the derivative of phid by v; phidd is the rate of phid."""
    point = gripping(name, SLIDES[slides])
    n, active = point.n, point.workspace.structure.active
    rows = point.workspace.assembly.contacts[0].slide_row + np.arange(2)

    @at_seeds
    def check(seed):
        state = draw(point, seed)
        assume(SLIDES[slides] != 1.0 or forward(point, state))
        _, q, v, a, lam = state
        second, off = differences(point, 2, [(1.0, v, a, np.zeros_like(q), np.zeros_like(lam))], state, SPAN)
        found = point.at(*state)[3]
        assert np.abs(found[rows] - second[rows, 0]).max() < off
        matrix, zero, unit, no_lam = point.tangent(0.6, 0.8), np.zeros(n), np.eye(n), np.zeros(point.m)
        s, off = differences(point, 0, [(0.0, 0.6 * e, 0.8 * e, e, no_lam) for e in unit], state, SPAN)
        assert np.abs(matrix[:n, :n] - s).max() < off
        jacobian, off = differences(point, 2, [(0.0, zero, e, zero, no_lam) for e in unit], state, SPAN)
        assert np.abs(matrix[n:, :n] - jacobian[active]).max(initial=0.0) < off
        for i, row in enumerate(active):
            force = point.derivative(0, (0.0, zero, zero, zero, np.eye(point.m)[row]), state)
            assert np.abs(force - matrix[:n, n + i]).max() < 1e-9

    check()
