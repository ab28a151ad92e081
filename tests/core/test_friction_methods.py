"""Friction with every method; states across stick and slip; regularised laws tend to Coulomb's."""

import math

import numpy as np
import pytest
from helpers import G, events, on
from sliders import Belt, roller, slider
from test_comparison_methods import VARIANTS
from test_comparison_methods import run as compare
from tlismni.core import (
    METHODS,
    AmbrosioFriction,
    AppliedForce2D,
    BrownMcPheeFriction,
    Constant,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    Gonthier,
    HalfPlane2D,
    Hertz,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    RigidBody2D,
    Simulation,
    Sine,
    State,
    StepFriction,
    TanhFriction,
    ThrelfallFriction,
    simulate,
)

MU = 0.3
COMPARISON = ("baumgarte", "hht_i3", "hht_ggl", "generalized_alpha")
FAMILY = [
    *((name, {}) for name, method in METHODS.items() if method.family == "TLISMNI"),
    ("irk", {"tableau": "sdirk4"}),
    ("ebdf", {"k": "auto"}),
    ("ebdf", {"outer": "jfnk"}),
]


# ---- every method ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method, options", FAMILY)
def test_every_method_brings_the_disk_to_roll(method, options):
    """Accelerations are constant: every formula of order 2 is exact but for the first steps' error control."""
    result = simulate(roller(1.5), 0.4, method, rtol=1e-7, **options)
    (stick,) = events(result, "stick")
    assert stick.t == pytest.approx(1.5 / (3.0 * MU * G), abs=1e-9)
    assert result["b.vx"][-1] == pytest.approx(1.0, abs=1e-9)
    for level in ("position", "velocity", "acceleration"):
        assert result[f"residual.{level}"].max() < 1e-9


@pytest.mark.parametrize("method, options", FAMILY)
def test_every_method_follows_the_belt(method, options):
    belt = Belt()
    times = belt.times(4)
    result = simulate(belt.model(), times[-1] + 0.01, method, rtol=1e-7, atol=1e-9, **options)
    assert [e.kind for e in result.events[1:]] == ["slip", "stick"] * 2
    assert [e.t for e in result.events[1:]] == pytest.approx(times, abs=1e-4)
    assert result["residual.acceleration"].max() < 1e-8


@pytest.mark.parametrize("name", VARIANTS)
def test_comparison_methods_find_the_same_events(name):
    result = compare(name, roller(1.5), 0.4)
    (stick,) = events(result, "stick")
    assert stick.t == pytest.approx(1.5 / (3.0 * MU * G), abs=1e-6)
    assert result["b.vx"][-1] == pytest.approx(1.0, abs=1e-6)
    belt = Belt()
    times = belt.times(4)
    result = compare(name, belt.model(), times[-1] + 0.01, 1e-7, 1e-9)
    assert [e.kind for e in result.events[1:]] == ["slip", "stick"] * 2
    assert [e.t for e in result.events[1:]] == pytest.approx(times, abs=1e-3)


# ---- state ----------------------------------------------------------------------------------------------------------


def trajectory(sim, times):
    rows = []
    for t in times:
        sim.advance(float(t))
        rows += [sim.sample(), sim.values()]
    return b"".join(row.tobytes() for row in rows), [event.to_dict() for event in sim.events], sim.stats


@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
@pytest.mark.parametrize("phase", range(5))
def test_states_across_stick_and_slip_repeat_bit_for_bit(method, phase):
    """Stored before, at and between the changes, as bytes; restored into the same run and into a new one."""
    belt = Belt(0.3)
    marks = belt.times(4)
    stored = [0.5 * marks[0], 0.5 * (marks[0] + marks[1]), marks[1], 0.5 * (marks[1] + marks[2]), marks[2]][phase]
    times = np.linspace(stored, marks[3] + 0.1, 9)[1:]
    sim = Simulation(belt.model(), method, rtol=1e-7, atol=1e-10)
    sim.advance(stored)
    kept = sim.state().to_bytes()
    first = trajectory(sim, times)
    assert {event["kind"] for event in first[1]} >= {"stick", "slip"}
    sim.restore(State.from_bytes(kept))
    assert sim.state().to_bytes() == kept
    assert trajectory(sim, times) == first
    other = Simulation(belt.model(), method, rtol=1e-7, atol=1e-10)
    other.restore(State.from_bytes(kept))
    assert trajectory(other, times) == first


# ---- regularised laws -----------------------------------------------------------------------------------------------

LAWS = {
    "tanh": lambda v: TanhFriction(coefficient=MU, transition_speed=v),
    "threlfall": lambda v: ThrelfallFriction(coefficient=MU, transition_speed=v),
    "ambrosio": lambda v: AmbrosioFriction(coefficient=MU, upper_speed=v),
    "step": lambda v: StepFriction(coefficient=MU, stiction_speed=v, sliding_speed=2.0 * v),
    "brown_mcphee": lambda v: BrownMcPheeFriction(coefficient=MU, transition_speed=v),
}


def resting_disk(friction, speed=1.5, push=0.0, law=None):
    """A disk of radius 0.1 that lies on a soft floor, in the static depth of its weight."""
    mass, radius, stiffness = 2.0, 0.1, 1e5
    law = law or Hertz(stiffness=stiffness)
    depth = (mass * G / stiffness) ** (2.0 / 3.0)
    body = RigidBody2D(
        name="b", mass=mass, inertia=0.5 * mass * radius**2, position=(0.0, radius - depth), velocity=(speed, 0.0)
    )
    contact = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("b"), radius=radius), law=law, friction=friction
    )
    forces = [AppliedForce2D(name="push", marker=on("b"), force_x=Constant(value=push))] if push else []
    return Model(bodies=[body], forces=forces, contacts=[contact])


@pytest.mark.parametrize("name", LAWS)
def test_regularised_friction_tends_to_coulombs(name):
    """The disk begins to roll: at the time at which it does by Coulomb's law, the error in its place goes with the
    square of the transition speed v_s (over the time v_s/(mu g) friction is off by its own size)."""
    start = 1.5 / (3.0 * MU * G)
    t_end = 2.0 * start
    exact = 1.5 * start - 0.5 * MU * G * start**2 + start
    errors = []
    for speed in (0.1, 0.01, 1e-3):
        result = simulate(resting_disk(LAWS[name](speed)), t_end, rtol=1e-9, atol=1e-12)
        errors.append(abs(result["b.x"][-1] - exact))
        assert np.all(result["c.friction_force"] * result["c.sliding_velocity"] <= 1e-15)
        assert np.abs(result["energy.balance"]).max() < 1e-6
    assert errors[0] < 1e-3
    assert errors[1] == pytest.approx(1e-2 * errors[0], rel=0.01)
    assert errors[2] == pytest.approx(1e-4 * errors[0], rel=0.01)


@pytest.mark.parametrize(
    "name, ratio", [("tanh", math.atanh(0.5)), ("threlfall", math.log(2.0) / 3.0), ("ambrosio", 0.5)]
)
def test_regularised_friction_creeps_where_coulombs_sticks(name, ratio):
    """Pushed with half of mu N a point creeps with the speed at which the law gives half of mu N; Coulomb sticks."""
    speed, mass, push = 1e-3, 2.0, 0.5 * MU * 2.0 * G
    depth = (mass * G / 1e5) ** (2.0 / 3.0)
    contact = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("b")), law=Hertz(stiffness=1e5),
        friction=LAWS[name](speed),
    )  # fmt: skip
    body = PointMass2D(name="b", mass=mass, position=(0.0, -depth))
    force = AppliedForce2D(name="push", marker=on("b"), force_x=Constant(value=push))
    result = simulate(Model(bodies=[body], forces=[force], contacts=[contact]), 0.2, rtol=1e-9, atol=1e-12)
    assert result["b.vx"][-1] == pytest.approx(ratio * speed, rel=1e-6)
    assert result["c.friction_force"][-1] == pytest.approx(-push, rel=1e-6)


def test_friction_of_a_force_law_over_a_whole_contact_keeps_its_ledger():
    """A spinning disk on a soft floor: while it slips, the impulse along the floor is mu times the normal one."""
    mass, radius, rate = 2.0, 0.1, 100.0
    body = RigidBody2D(name="b", mass=mass, inertia=0.5 * mass * radius**2, position=(0.0, 0.4), angular_velocity=rate)
    contact = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("b"), radius=radius),
        law=Gonthier(stiffness=1e6, restitution=0.6), friction=TanhFriction(coefficient=MU, transition_speed=1e-4),
    )  # fmt: skip
    result = simulate(Model(bodies=[body], contacts=[contact]), 0.4, rtol=1e-9, atol=1e-12)
    closed, opened = result.events
    assert result["b.vx"][-1] == pytest.approx(-MU * opened.impulse / mass, rel=1e-7)
    fall = mass * (closed.approach_speed + opened.separation_speed) + mass * G * (opened.t - closed.t)
    assert opened.impulse == pytest.approx(fall, rel=1e-8)
    assert np.abs(result["energy.balance"]).max() < 1e-6


# ---- refused at the door --------------------------------------------------------------------------------------------


def test_friction_that_does_not_fit_its_law_is_refused_by_name():
    ends = {"name": "shoe", "plane": HalfPlane2D(), "disk": Disk2D(marker=on("b"))}
    with pytest.raises(ModelError, match=r"'shoe'.*Coulomb.*constraint law.*not Hertz.*regularised"):
        DiskOnHalfPlane2D(**ends, law=Hertz(stiffness=1e5), friction=CoulombFriction(coefficient=MU))
    with pytest.raises(ModelError, match=r"'shoe'.*'Tanh' is regularised.*NewtonImpact is a constraint.*Coulomb"):
        DiskOnHalfPlane2D(
            **ends, law=NewtonImpact(restitution=0.5), friction=TanhFriction(coefficient=MU, transition_speed=0.1)
        )
    for bad in (-0.1, math.nan, math.inf):
        with pytest.raises(ModelError, match="coefficient"):
            CoulombFriction(coefficient=bad)
    with pytest.raises(ModelError, match="below coefficient"):
        CoulombFriction(coefficient=0.5, static_coefficient=0.3)


def test_a_limit_passed_for_a_moment_is_found_by_steps_that_resolve_it():
    """The force exceeds the limit by a ten-thousandth, for 9 ms in each half swing."""
    w, excess = 3.0, 1e-4
    push = Sine(amplitude=(1.0 + excess) * MU * 2.0 * G, angular_frequency=w)
    result = simulate(slider(push=push), 4.0 * math.pi / w, max_step=2e-3)
    times = (np.arange(4) * math.pi + math.asin(1.0 / (1.0 + excess))) / w
    assert [e.t for e in events(result, "slip")] == pytest.approx(times, abs=1e-9)
    assert len(events(result, "stick")) == 4
