"""End stops of hinges and sliders in space, and ropes: closed forms, the planar stops, turns counted."""

import math

import numpy as np
import pytest
from random_seeds import at_seeds
from test_tangents import Point, check_levels, check_matrix, draw
from test_tangents3d import LEFT, RIGHT, A, B, P
from tlismni.core import (
    AngleStop2D,
    AngleStop3D,
    Axes,
    CoulombFriction,
    HuntCrossley,
    KelvinVoigt,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    PointMass3D,
    Prismatic3D,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    Rope3D,
    Simulation,
    SlideStop3D,
    simulate,
)
from tlismni.core.state.modes import ACTIVE, CLOSED

HARD = NewtonImpact(restitution=0.6)
SOFT = KelvinVoigt(stiffness=4.0, damping=0.8)
TIGHT = {"rtol": 1e-12, "atol": 1e-14}
STOPS = {
    f"{kind.__name__} {side} {law.type}": (kind(name="c", a=LEFT, b=RIGHT, limit=limit, side=side, law=law), law)
    for kind, limits in ((AngleStop3D, {"upper": -1.6, "lower": 1.9}), (SlideStop3D, {"upper": -1.8, "lower": 1.8}))
    for side, limit in limits.items()
    for law in (HARD, SOFT)
}
STOPS |= {f"Rope3D {law.type}": (Rope3D(name="c", a=LEFT, b=RIGHT, length=0.2, law=law), law) for law in (HARD, SOFT)}


@pytest.mark.parametrize("case", STOPS)
def test_tangents_and_levels(case):
    contact, law = STOPS[case]
    point = Point(
        Model(gravity=(0.3, -0.4, -9.0), bodies=[A, P, B], contacts=[contact]), CLOSED if law is HARD else ACTIVE
    )

    @at_seeds
    def check(seed):
        state = draw(point, seed)
        check_matrix(point, state, h=2e-3)
        if law is HARD:
            check_levels(point, state, 4e-3)

    check()


def hinge_pendulum(z, law, limit, side="upper"):
    """A rod of 1 m, 1 kg, that falls from the horizontal about a hinge whose axis is z, with a stop."""
    axes = Axes(z=z)
    t = np.array(axes_of(axes))
    middle = tuple(0.5 * t[:, 0])
    rod = RigidBody3D(name="rod", mass=1.0, inertia=(1e-3, 1.0 / 12.0, 1.0 / 12.0), position=middle, attitude=axes)
    own = Marker3D(body="rod", point=(-0.5, 0.0, 0.0))
    ends = {"a": Marker3D(attitude=axes), "b": own}
    stop = AngleStop3D(name="stop", **ends, limit=limit, side=side, law=law)
    return Model(
        gravity=tuple(-9.81 * t[:, 1]), bodies=[rod], joints=[Revolute3D(name="hinge", **ends)], contacts=[stop]
    )


def axes_of(attitude):
    return Marker3D(attitude=attitude).axes()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("law", [HARD, HuntCrossley(stiffness=1e5, exponent=1.5, restitution=0.5)])
@pytest.mark.parametrize("z", [(0.0, 0.0, 1.0), (0.3, -0.5, 0.6)])
def test_a_hinge_strikes_its_stop_as_the_planar_one(z, law):
    limit = -0.5 * math.pi - 0.3
    times = np.linspace(0.0, 2.5, 31)
    rod = RigidBody2D(name="rod", mass=1.0, inertia=1.0 / 12.0, position=(0.5, 0.0))
    own = Marker2D(body="rod", point=(-0.5, 0.0))
    flat = Model(
        bodies=[rod], joints=[Revolute2D(name="hinge", a=Marker2D(), b=own)],
        contacts=[AngleStop2D(name="stop", b=own, limit=limit, side="lower", law=law)],
    )  # fmt: skip
    one, other = (simulate(m, 2.5, t_eval=times, **TIGHT) for m in (flat, hinge_pendulum(z, law, limit, "lower")))
    assert [e.kind for e in one.events] == [e.kind for e in other.events] and one.events
    for e, f in zip(one.events, other.events, strict=True):
        assert f.t == pytest.approx(e.t, abs=1e-10) and f.impulse == pytest.approx(e.impulse, abs=1e-9)
    assert np.abs(one["rod.angle"] - other["hinge.angle"]).max() < 1e-10
    assert np.abs(one["stop.gap"] - other["stop.gap"]).max() < 1e-10
    units = {c.name: c.unit for c in other.channel_records}
    assert units["stop.normal_force"] == "N.m" and units["stop.gap"] == "rad"


def rotor(limit, law, speed=6.0):
    body = RigidBody3D(name="rotor", mass=1.0, inertia=(1.0, 1.0, 0.5), angular_velocity=(0.0, 0.0, speed))
    ends = {"a": Marker3D(), "b": Marker3D(body="rotor")}
    stop = AngleStop3D(name="stop", **ends, limit=limit, law=law)
    return Model(gravity=(0.0, 0.0, 0.0), bodies=[body], joints=[Revolute3D(name="hinge", **ends)], contacts=[stop])


def test_turns_are_counted():
    """A free rotor meets its stop after two and a half turns, and not before."""
    result = simulate(rotor(5.0 * math.pi, HARD), 4.0, **TIGHT)
    strike = result.events[0]
    assert len([e for e in result.events if e.kind == "impact"]) == 1
    assert strike.t == pytest.approx(5.0 * math.pi / 6.0, abs=1e-9)
    assert strike.impulse == pytest.approx(0.5 * 1.6 * 6.0, rel=1e-9)
    after = 5.0 * math.pi - 3.6 * (4.0 - strike.t)
    assert result["hinge.angle"][-1] == pytest.approx(after, abs=1e-8)


def test_turns_of_a_stop_go_back_with_the_state():
    sim = Simulation(rotor(5.0 * math.pi, HARD))
    sim.advance(2.0)
    kept = sim.state()
    sim.advance(4.0)
    later = sim.values().copy()
    sim.restore(kept)
    sim.advance(4.0)
    assert np.array_equal(sim.values(), later)


@pytest.mark.parametrize("side", ["upper", "lower"])
def test_a_slider_bounces_on_its_stop(side):
    """A block on an inclined slider from rest: v = sqrt(2 g s d), and e of it behind the blow."""
    axis, sign = (0.6, 0.0, 0.8), 1.0 if side == "lower" else -1.0
    z = tuple(sign * x for x in axis)
    block = RigidBody3D(name="block", mass=2.0, inertia=(0.1, 0.1, 0.1), attitude=Axes(z=z))
    ends = {"a": Marker3D(attitude=Axes(z=z)), "b": Marker3D(body="block")}
    stop = SlideStop3D(name="stop", **ends, limit=-0.5 * sign, side=side, law=HARD)
    model = Model(
        gravity=(0.0, 0.0, -9.81), bodies=[block], joints=[Prismatic3D(name="slider", **ends)], contacts=[stop]
    )
    result = simulate(model, 0.6, **TIGHT)
    strike = next(e for e in result.events if e.kind == "impact")
    speed = math.sqrt(2.0 * 9.81 * 0.8 * 0.5)
    assert strike.t == pytest.approx(speed / (9.81 * 0.8), abs=1e-9)
    assert strike.approach_speed == pytest.approx(speed, rel=1e-9)
    assert strike.separation_speed == pytest.approx(0.6 * speed, rel=1e-9)
    assert result["stop.gap"].min() > -1e-10


def test_a_rope_becomes_taut():
    """A mass falls beside its anchor until the rope of 1 m is taut; the blow takes the part of the speed along it."""
    bob = PointMass3D(name="bob", mass=1.0, position=(0.6, 0.0, 0.0))
    rope = Rope3D(name="rope", b=Marker3D(body="bob"), length=1.0, law=NewtonImpact(restitution=0.0))
    result = simulate(Model(gravity=(0.0, 0.0, -9.81), bodies=[bob], contacts=[rope]), 1.0, **TIGHT)
    strike = next(e for e in result.events if e.kind == "impact")
    assert strike.t == pytest.approx(math.sqrt(2.0 * 0.8 / 9.81), abs=1e-9)
    assert strike.impulse == pytest.approx(0.8 * math.sqrt(2.0 * 9.81 * 0.8), rel=1e-9)
    distance = np.sqrt(result["bob.x"] ** 2 + result["bob.z"] ** 2)
    assert distance.max() < 1.0 + 1e-9


def test_what_stops_and_ropes_refuse():
    ends = {"a": Marker3D(), "b": Marker3D(body="bob")}
    with pytest.raises(ValueError, match="nothing slides"):
        AngleStop3D(name="s", **ends, limit=1.0, law=HARD, friction=CoulombFriction(coefficient=0.3))
    bob = PointMass3D(name="bob", mass=1.0)
    with pytest.raises(ValueError, match="meet at the start"):
        Model(bodies=[bob], contacts=[Rope3D(name="rope", b=Marker3D(body="bob"), length=1.0, law=HARD)])
