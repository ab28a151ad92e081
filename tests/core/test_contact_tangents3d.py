"""Tangents and levels of contacts in space against differences of their residuals, friction included."""

from itertools import product

import numpy as np
import pytest
from random_seeds import assume, at_seeds
from test_tangents import Point, check_levels, check_matrix, differences, draw
from test_tangents3d import GROUND, LEFT, MASS, RIGHT, A, B, P
from tlismni.core import (
    BrownMcPheeFriction,
    CoulombFriction,
    HalfSpace3D,
    Hertz,
    HuntCrossley,
    KelvinVoigt,
    LuGreFriction,
    Model,
    NewtonImpact,
    Sine,
    Sphere3D,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
    TanhFriction,
    TurningFriction,
)
from tlismni.core.contacts.coulomb3d import TURNED
from tlismni.core.state.modes import ACTIVE, AT_LIMIT, CLOSED, IDLE, STICKS

HARD = NewtonImpact(restitution=0.5)
TANH = TanhFriction(coefficient=0.6, transition_speed=2.0)
PEAK = BrownMcPheeFriction(coefficient=0.4, static_coefficient=0.6, transition_speed=1.5)


def on_plane(law, a, b, **more):
    return SphereOnHalfSpace3D(
        name="c", plane=HalfSpace3D(marker=a), sphere=Sphere3D(marker=b, radius=2.7), law=law, **more
    )


def on_sphere(law, a, b, **more):
    first, second = Sphere3D(marker=a, radius=1.6), Sphere3D(marker=b, radius=2.1)
    return SphereOnSphere3D(name="c", a=first, b=second, law=law, **more)


def on_belt(law, a, b, **more):
    """A surface of the first shape that moves, not along the tangent alone."""
    belt = {"surface_speed": SPEED, "surface_direction": (0.8, -0.5, 0.3)}
    return on_plane(law, a, b, **(belt if more.get("friction") is not None else {}), **more)


def on_tracks(law, a, b, **more):
    """The same of the second shape."""
    tracks = {"surface_speed": SPEED, "surface_direction": (0.8, -0.5, 0.3), "surface_body": b.body}
    return on_sphere(law, a, b, **(tracks if more.get("friction") is not None else {}), **more)


SPEED = Sine(amplitude=1.3, angular_frequency=2.0, phase=0.4, offset=0.8)
KELVIN = KelvinVoigt(stiffness=4.0, damping=0.8)
HUNT = HuntCrossley(stiffness=3.0, exponent=1.5, restitution=0.6, release_rule="gap")
PLACES = {"two bodies": (LEFT, RIGHT), "ground": (GROUND, RIGHT), "a point mass": (LEFT, MASS)}
TURNABLE = {name: ends for name, ends in PLACES.items() if name != "a point mass"}
CASES = {
    f"{shape.__name__}, {where}, {law.type}, {None if friction is None else friction.type}": (
        shape(law, *ends, friction=friction), CLOSED if law is HARD else ACTIVE,
    )
    for shape in (on_plane, on_sphere)
    for where, ends in PLACES.items()
    for law, friction in ((HARD, None), (KELVIN, None), (KELVIN, TANH), (HUNT, PEAK), (Hertz(stiffness=2.0), TANH))
}  # fmt: skip


TURNS = TurningFriction(rolling=0.3, spinning=0.2, transition_speed=0.7)
CASES |= {
    f"{shape.__name__}, {where}, {law.type}, turning": (shape(law, *ends, friction=TANH, turning=TURNS), ACTIVE)
    for shape in (on_plane, on_sphere)
    for where, ends in TURNABLE.items()
    for law in (KELVIN, HUNT)
}
PATCH = TurningFriction(rolling=0.3, friction_radius=0.8, transition_speed=0.7)
CASES |= {
    f"{shape.__name__}, {where}, {law.type}, {friction.type} on a patch": (
        shape(law, *ends, friction=friction, turning=PATCH), ACTIVE,
    )
    for shape in (on_plane, on_sphere)
    for where, ends in TURNABLE.items()
    for law, friction in ((KELVIN, TANH), (HUNT, PEAK))
}  # fmt: skip

BRISTLY = LuGreFriction(
    bristle_stiffness=3.0, bristle_damping=0.5, viscous_damping=0.2, coefficient=0.4, static_coefficient=0.6,
    stribeck_speed=1.5,
)  # fmt: skip
CASES |= {
    f"{shape.__name__}, {where}, {law.type}, {friction.type}": (shape(law, *ends, friction=friction), ACTIVE)
    for shape in (on_belt, on_tracks)
    for where, ends in TURNABLE.items()
    for law, friction in ((KELVIN, TANH), (KELVIN, BRISTLY))
}


def system(case):
    contact, mode = CASES[case]
    return Point(Model(gravity=(0.3, -0.4, -9.0), bodies=[A, P, B], contacts=[contact]), mode)


def is_smooth(point, state):
    """Whether differences of two widths agree: between their points is no kink, as of friction at small speeds."""
    none, no_lam = np.zeros(point.n), np.zeros(point.m)
    for e in np.eye(point.n):
        for along in ((0.0, e, none, none, no_lam), (0.0, none, e, none, no_lam)):
            wide, narrow = (point.derivative(0, along, state, h) for h in (4e-3, 2e-3))
            if np.abs(wide - narrow).max() > 1e-6 * max(1.0, np.abs(wide).max()):
                return False
    return True


@pytest.mark.parametrize("case", CASES)
def test_tangent_is_the_derivative_of_the_residual(case):
    point = system(case)

    @at_seeds
    def check(seed):
        state = draw(point, seed)
        point.at(*state)
        # friction has a kink where the normal force vanishes
        assume(abs(point.workspace.arrays["monitor"][0]) > 0.5)
        assume(is_smooth(point, state))
        check_matrix(point, state, h=4e-3)

    check()


@pytest.mark.parametrize("case", [case for case in CASES if case.endswith("None")])
def test_velocity_and_acceleration_level_are_the_derivatives_of_the_position_level(case):
    point = system(case)

    @at_seeds
    def check(seed):
        check_levels(point, draw(point, seed), 4e-3)

    check()


# (bristles are coordinates of their own)
@pytest.mark.parametrize("case", [case for case in CASES if not case.endswith("LuGre")])
def test_contact_forces_really_act_in_these_tests(case):
    point, free = system(case), Point(Model(gravity=(0.3, -0.4, -9.0), bodies=[A, P, B]))
    for seed in range(5):
        state = draw(point, seed)
        with_force = point.at(*state)
        rows = point.m - free.m
        without = free.at(*state[:4], state[4][: free.m])
        if CASES[case][1] == ACTIVE:
            assert with_force[1][free.m] < 0.0
        assert rows >= 1
        assert np.abs(with_force[0] - without[0]).max() > 1e-3


GRIP = CoulombFriction(coefficient=0.4)
SLIDES = {"sliding": 1.0, "sticking": STICKS, "held along one": AT_LIMIT, "carrying a share": IDLE, "open": None}


def gripping(shape, where, slide, turning=None):
    contact = shape(HARD, *PLACES[where], friction=GRIP, turning=turning)
    point = Point(Model(gravity=(0.3, -0.4, -9.0), bodies=[A, P, B], contacts=[contact]))
    if slide is not None:
        twice = {STICKS: {0, 1}, AT_LIMIT: {0}}.get(slide, set())
        point.workspace.engage(frozenset({0}), frozenset(), frozenset(twice))
        axis = 1 if shape in (on_plane, on_belt) else (3 if where == "a point mass" else 2)
        columns = ["mode", "slide_mode", "friction_ratio", "tangent_angle", "tangent_axis", "sliding_lean"]
        lean = 0.5 if slide == 1.0 and turning is PATCH else 0.0
        point.remember(columns, (CLOSED, slide, -0.4 if slide == 1.0 else 0.3, 0.7, axis, lean))
        if turning is PATCH:  # sticking creeps with a speed that differences see
            point.remember(["slow_sliding"], [0.4])
    return point


def forward(point, state):
    """True if it slides along the direction of the last event, not about across it."""
    first = point.workspace.assembly.contacts[0].slide_row
    point.at(*state)
    arrays = point.workspace.arrays
    x = arrays["phid"][first] + TURNED * arrays["phid"][first + 1]
    return x > 0.3 * arrays["phid"][first + 1]


ENDS = [*((where, None) for where in PLACES), *((where, turns) for where in TURNABLE for turns in (TURNS, PATCH))]


def grips():
    """Shapes at rest with all ends; those whose surface moves, which are the same contacts, between two bodies, and the
    rest of them with `-m full`."""
    for shape, (where, turning) in product((on_plane, on_sphere, on_belt, on_tracks), ENDS):
        moves = shape in (on_belt, on_tracks)
        yield pytest.param(shape, where, turning, marks=[pytest.mark.full] if moves and where != "two bodies" else [])


@pytest.mark.sampled(40)
@pytest.mark.parametrize(("shape", "where", "turning"), list(grips()))
@pytest.mark.parametrize("slides", SLIDES)
def test_tangent_of_coulomb_friction(shape, where, slides, turning):
    """Rows of sticking at velocity level: their W is the derivative of phid by v."""
    point = gripping(shape, where, SLIDES[slides], turning)
    n, active = point.n, point.workspace.structure.active

    @at_seeds
    def check(seed):
        state = draw(point, seed)
        assume(SLIDES[slides] != 1.0 or forward(point, state))
        point.at(*state)
        matrix, zero, unit, no_lam = point.tangent(0.6, 0.8), np.zeros(n), np.eye(n), np.zeros(point.m)
        s, off = differences(point, 0, [(0.0, 0.6 * e, 0.8 * e, e, no_lam) for e in unit], state)
        assert np.abs(matrix[:n, :n] - s).max() < off
        jacobian, off = differences(point, 2, [(0.0, zero, e, zero, no_lam) for e in unit], state)
        assert np.abs(matrix[n:, :n] - jacobian[active]).max(initial=0.0) < off
        for i, row in enumerate(active):
            force = point.derivative(0, (0.0, zero, zero, zero, np.eye(point.m)[row]), state)
            assert np.abs(force - matrix[:n, n + i]).max() < 1e-9

    check()


@pytest.mark.parametrize("shape", [on_plane, on_sphere, on_belt, on_tracks])
@pytest.mark.parametrize("turning", [None, PATCH], ids=["point", "patch"])
@pytest.mark.parametrize("slides", SLIDES)
def test_rates_of_the_tangents_rows_fit_their_velocities(shape, slides, turning):
    point = gripping(shape, "two bodies", SLIDES[slides], turning)
    rows = point.workspace.assembly.contacts[0].slide_row + np.arange(2)

    @at_seeds
    def check(seed):
        state = draw(point, seed)
        _, q, v, a, lam = state
        second, off = differences(point, 2, [(1.0, v, a, np.zeros_like(q), np.zeros_like(lam))], state)
        assert np.abs(point.at(*state)[3][rows] - second[rows, 0]).max() < off

    check()
