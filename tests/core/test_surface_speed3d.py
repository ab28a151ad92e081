"""Surfaces that move, in space: belts in any direction, on bodies that move, with ends, and vehicles on tracks."""

import math

import numpy as np
import pytest
from helpers import events, integrate
from test_space_friction import UP, G, R, at_end, thrown
from tlismni.core import (
    AngleDriver3D,
    Box3D,
    ContactGroup3D,
    CoulombFriction,
    HalfSpace3D,
    KelvinVoigt,
    LuGreFriction,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass3D,
    Polynomial,
    Revolute3D,
    RigidBody3D,
    RotationVector,
    Sine,
    Sphere3D,
    SphereOnHalfSpace3D,
    Step,
    TanhFriction,
    contacts_between,
    simulate,
)

MU, STATIC, SPEED, MASS = 0.3, 0.4, 0.9, 2.0
WAY = np.array([0.6, 0.8, 0.0])
DULL = NewtonImpact(restitution=0.0)
RUBS = CoulombFriction(coefficient=MU, static_coefficient=STATIC)
FAMILY = [("ebdf", {}), ("irk", {}), ("bdf", {}), ("adams", {}), ("hht", {})]
DOWN = (0.0, 0.0, -G)


def on(body, *point):
    return Marker3D(body=body, point=point or (0.0, 0.0, 0.0))


def belt(speed=SPEED, direction=(3.0, 4.0, 0.0), friction=RUBS, plane=None, law=DULL, **more):
    sphere, plane = Sphere3D(marker=on("b"), radius=0.0), HalfSpace3D() if plane is None else plane
    return SphereOnHalfSpace3D(
        name="belt", plane=plane, sphere=sphere, law=law, friction=friction, surface_speed=speed,
        surface_direction=direction, **more,
    )  # fmt: skip


def block(speed=SPEED, velocity=(0.0, 0.0, 0.0), position=(0.0, 0.0, 0.0), **more):
    body = PointMass3D(name="b", mass=MASS, velocity=velocity, position=position)
    return Model(gravity=DOWN, bodies=[body], contacts=[belt(speed, **more)])


def check_energy(result, size=1.0):
    assert np.abs(result["energy.balance"]).max() < 1e-9 * size


def place(result, at=-1):
    return np.array([result[f"b.{axis}"][at] for axis in "xyz"])


@pytest.mark.parametrize(("method", "options"), FAMILY)
def test_a_block_is_carried_along(method, options):
    result = simulate(block(), 1.0, method, rtol=1e-7, **options)
    (stick,) = events(result, "stick")
    taken = SPEED / (MU * G)
    assert stick.t == pytest.approx(taken, abs=1e-8)
    assert place(result) == pytest.approx((SPEED - 0.5 * SPEED * taken) * WAY, abs=1e-7)
    close = 1e-7 if method != "hht" else 1e-6
    assert result["energy.input_work"][-1] == pytest.approx(MASS * SPEED**2, rel=close)
    assert result["belt.dissipation"][-1] == pytest.approx(0.5 * MASS * SPEED**2, rel=close)
    check_energy(result, close / 1e-9)


def test_a_block_that_comes_from_the_side_turns_towards_the_belt():
    """Sliding goes along a straight line of the belt: v = w + u (1 - mu g t/|u|)."""
    start = np.array([0.5, -0.4, 0.0])
    slip = start - SPEED * WAY
    size = np.linalg.norm(slip)
    result = simulate(block(velocity=tuple(start)), 1.0, rtol=1e-9, atol=1e-11)
    (stick,) = events(result, "stick")
    taken = size / (MU * G)
    assert stick.t == pytest.approx(taken, abs=1e-8)
    assert place(result) == pytest.approx(SPEED * WAY + 0.5 * taken * slip, abs=1e-8)
    check_energy(result, 10.0)


@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_a_ball_on_a_belt_rolls(method):
    """It gets 2/7 of the sliding velocity that it starts with."""
    start = np.array([0.4, 0.2, 0.0])
    model = thrown(start, (0.0, 0.0, 0.0))
    contact = model.contacts[0].model_copy(update={"surface_speed": SPEED, "surface_direction": tuple(WAY)})
    result = simulate(Model(gravity=DOWN, bodies=model.bodies, contacts=[contact]), 0.5, method, rtol=1e-9, atol=1e-11)
    slip = start - SPEED * WAY
    (stick,) = events(result, "stick")
    assert stick.t == pytest.approx(np.linalg.norm(slip) / (3.5 * 0.3 * G), abs=1e-8)
    v, w = at_end(result, "ball")
    assert v == pytest.approx(start - 2.0 / 7.0 * slip, abs=1e-8)
    assert v - R * np.cross(w, UP) == pytest.approx(SPEED * WAY, abs=1e-8)
    check_energy(result, 10.0)


def test_a_belt_that_reverses():
    forth = Step(time=0.5, before=SPEED, after=-SPEED)
    result = simulate(block(forth, velocity=tuple(SPEED * WAY)), 1.5)
    stop = 2.0 * SPEED / (MU * G)
    assert [(e.kind, pytest.approx(e.t, abs=1e-8)) for e in result.events] == [
        ("close", 0.0), ("slip", 0.5), ("stick", 0.5 + stop)
    ]  # fmt: skip
    assert place(result) == pytest.approx(SPEED * (0.5 - (1.0 - stop)) * WAY, abs=1e-8)
    check_energy(result, 10.0)


@pytest.mark.parametrize(("method", "order"), [("hht", 2), ("irk", 5), ("ebdf", 5), ("bdf", 3), ("adams", 4)])
def test_the_place_of_what_sticks_is_found_to_the_order(method, order):
    w, amplitude, errors = 6.0, 0.6, []
    for h in (0.04, 0.02, 0.01):
        result = simulate(block(Sine(amplitude=amplitude, angular_frequency=w)), 1.0, method, step=h)
        exact = amplitude * (1.0 - np.cos(w * result.t)) / w
        errors.append(np.abs(result["b.y"] - 0.8 * exact).max())
    assert np.log2(np.array(errors[:2]) / errors[1:]) == pytest.approx([order] * 2, abs=0.35)


def test_an_inclined_belt_in_the_axes_of_its_marker():
    """mu < tan(angle) < mu_s, straight up the slope: carried with the belt's speed."""
    angle = math.atan(0.35)
    plane = HalfSpace3D(marker=Marker3D(attitude=RotationVector(vector=(0.0, -angle, 0.0))))
    up = SPEED * np.array([math.cos(angle), 0.0, math.sin(angle)])
    result = simulate(block(velocity=tuple(up), plane=plane, direction=(2.0, 0.0, 0.0)), 1.0)
    assert [e.kind for e in result.events] == ["close"]
    assert place(result) == pytest.approx(up, abs=1e-8)
    assert result["energy.input_work"][-1] == pytest.approx(MASS * G * up[2], rel=1e-7)


# ---- a belt on a table that turns ------------------------------------------------------------------------------------

RATE = 1.5


def turning_belt(mu, velocity, radius=0.4):
    table = RigidBody3D(name="table", mass=5.0, inertia=(1.0, 1.0, 1.0), angular_velocity=(0.0, 0.0, RATE))
    ends = {"a": Marker3D(), "b": Marker3D(body="table")}
    joints = [
        Revolute3D(name="axle", **ends),
        AngleDriver3D(name="turn", **ends, angle=Polynomial(coefficients=(0.0, RATE))),
    ]
    body = PointMass3D(name="b", mass=MASS, velocity=velocity, position=(radius, 0.0, 0.0))
    contact = belt(0.5, (1.0, 0.0, 0.0), CoulombFriction(coefficient=mu), HalfSpace3D(marker=Marker3D(body="table")))
    return Model(gravity=DOWN, bodies=[table, body], joints=joints, contacts=[contact])


def test_what_sticks_to_a_belt_that_turns_goes_along_a_spiral():
    """r = r_0 + s t at the angle W t; the belt works against the centrifugal force, the table against Coriolis'."""
    result = simulate(turning_belt(1.0, (0.5, RATE * 0.4, 0.0)), 2.0, rtol=1e-9, atol=1e-11)
    assert [e.kind for e in result.events] == ["close"]
    r, angle = 0.4 + 0.5 * result.t, RATE * result.t
    assert result["b.x"] == pytest.approx(r * np.cos(angle), abs=1e-7)
    assert result["b.y"] == pytest.approx(r * np.sin(angle), abs=1e-7)
    pull = MASS * np.hypot(RATE**2 * r, 2.0 * RATE * 0.5)
    assert result["belt.friction_force"] == pytest.approx(pull, rel=1e-6)
    assert result["residual.acceleration"].max() < 1e-8
    check_energy(result, 100.0)


def test_what_slides_on_a_belt_that_turns():
    """Against the equation of motion with the velocity field of the belt."""
    mu, times = 0.05, np.linspace(0.0, 1.0, 11)
    result = simulate(turning_belt(mu, (0.0, 0.0, 0.0)), 1.0, rtol=1e-9, atol=1e-11, t_eval=times)

    def rhs(t, y):
        c, s = math.cos(RATE * t), math.sin(RATE * t)
        slip = y[2:] - (RATE * np.array([-y[1], y[0]]) + 0.5 * np.array([c, s]))
        return np.concatenate((y[2:], -mu * G * slip / np.linalg.norm(slip)))

    exact = integrate(rhs, (0.4, 0.0, 0.0, 0.0), times)
    assert result["b.x"] == pytest.approx(exact[:, 0], abs=1e-7)
    assert result["b.y"] == pytest.approx(exact[:, 1], abs=1e-7)
    check_energy(result, 100.0)


# ---- shapes that end, tracks -----------------------------------------------------------------------------------------


def ball_group(**more):
    shapes = {
        "boxes": [Box3D(marker=Marker3D(point=(0.0, 0.0, -0.1)), size=(1.0, 0.6, 0.2))],
        "spheres": [Sphere3D(marker=on("b"), radius=R)],
    }
    return ContactGroup3D(name="g", **shapes, law=DULL, friction=CoulombFriction(coefficient=MU), **more)


def test_a_ball_rolls_off_the_end_of_a_belt():
    """The face of a box: with 2/7 of its speed to the edge, round it, and down."""
    moment = 0.4 * MASS * R * R
    body = RigidBody3D(name="b", mass=MASS, inertia=(moment,) * 3, position=(0.0, 0.0, R))
    group = ball_group(surface_speed=SPEED, surface_direction=(1.0, 0.0, 0.0), surface_body="ground")
    result = simulate(Model(gravity=DOWN, bodies=[body], groups=[group]), 2.5, rtol=1e-8, atol=1e-10)
    taken, speed = 2.0 * SPEED / (7.0 * MU * G), 2.0 * SPEED / 7.0
    edge = taken + (0.5 - 0.5 * speed * taken) / speed
    assert events(result, "stick")[0].t == pytest.approx(taken, abs=1e-7)
    on_it = result.t < edge - 1e-6
    assert result["b.z"][on_it] == pytest.approx(R, abs=1e-9)
    assert np.interp(edge, result.t, result["b.x"]) == pytest.approx(0.5, abs=1e-5)
    assert result["b.z"][-1] < -0.1
    check_energy(result, 100.0)


def test_a_vehicle_on_tracks():
    """The second shape has the surface, which goes backwards below: the vehicle goes forwards, and up a slope."""
    angle = 0.2
    plane = HalfSpace3D(marker=Marker3D(attitude=RotationVector(vector=(0.0, -angle, 0.0))))
    tilted = RotationVector(vector=(0.0, -angle, 0.0))
    body = RigidBody3D(
        name="b", mass=MASS, inertia=(0.05, 0.08, 0.1), attitude=tilted,
        position=(-0.1 * math.sin(angle), 0.0, 0.1 * math.cos(angle)),
    )  # fmt: skip
    box = Box3D(marker=on("b"), size=(0.8, 0.4, 0.2))
    feet = contacts_between(
        "feet", [plane], [box], law=DULL, friction=CoulombFriction(coefficient=0.5), surface_speed=SPEED,
        surface_direction=(-1.0, 0.0, 0.0), surface_body="b",
    )  # fmt: skip
    result = simulate(Model(gravity=DOWN, bodies=[body], contacts=feet), 1.0, rtol=1e-8, atol=1e-10)
    gains = G * (0.5 * math.cos(angle) - math.sin(angle))
    taken = SPEED / gains
    assert events(result, "stick")[0].t == pytest.approx(taken, abs=1e-6)
    way = SPEED * (1.0 - 0.5 * taken)
    start = np.array([-0.1 * math.sin(angle), 0.0, 0.1 * math.cos(angle)])
    assert place(result) - start == pytest.approx(way * np.array([math.cos(angle), 0.0, math.sin(angle)]), abs=1e-6)
    check_energy(result, 100.0)


# ---- laws of force ---------------------------------------------------------------------------------------------------

SOFT = KelvinVoigt(stiffness=1e4, damping=200.0)


def pressed(friction):
    return block(friction=friction, law=SOFT, position=(0.0, 0.0, -MASS * G / 1e4))


def test_a_regularised_law_in_closed_form():
    v = 0.3
    result = simulate(pressed(TanhFriction(coefficient=MU, transition_speed=v)), 1.0, rtol=1e-10, atol=1e-12)
    left = v * np.arcsinh(math.sinh(SPEED / v) * np.exp(-MU * G * result.t / v))
    assert result["b.vx"] == pytest.approx(0.6 * (SPEED - left), abs=1e-7)
    assert result["b.vy"] == pytest.approx(0.8 * (SPEED - left), abs=1e-7)
    check_energy(result, 10.0)


def test_bristles_tend_to_the_constraint():
    friction = LuGreFriction(
        bristle_stiffness=1e5, bristle_damping=300.0, viscous_damping=0.0, coefficient=MU, static_coefficient=MU,
        stribeck_speed=0.1,
    )  # fmt: skip
    result = simulate(pressed(friction), 1.0, rtol=1e-8, atol=1e-10)
    taken = SPEED / (MU * G)
    assert place(result)[:2] == pytest.approx((SPEED - 0.5 * SPEED * taken) * WAY[:2], rel=5e-3)
    assert np.abs(result["energy.balance"]).max() < 1e-6


# ---- refusals --------------------------------------------------------------------------------------------------------


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ModelError, match="needs one of a length that is not zero"):
        belt(direction=None)
    with pytest.raises(ModelError, match="needs one of a length that is not zero"):
        belt(direction=(0.0, 0.0, 0.0))
    with pytest.raises(ModelError, match="has no `surface_speed`"):
        belt(speed=None)
    with pytest.raises(ModelError, match="without friction"):
        belt(friction=None)
    with pytest.raises(ModelError, match="no marker on 'other'"):
        belt(surface_body="other")
    for wrong in ((1.0, math.nan, 0.0), (1.0, 0.0)):
        with pytest.raises(ModelError, match="surface_direction"):
            belt(direction=wrong)
    with pytest.raises(ModelError, match=r"surface_speed .* surface_body"):
        ball_group(surface_speed=1.0).contacts()
