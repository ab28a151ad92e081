"""Time derivatives of channels against the channels themselves at neighbouring instants."""

import numpy as np
import pytest
from sliders import PLASTIC, foot
from tlismni.core import (
    AppliedForce2D,
    BrownMcPheeFriction,
    CoulombFriction,
    Hertz,
    KelvinVoigt,
    LuGreFriction,
    Marker2D,
    MarkerOutput2D,
    Model,
    NewtonImpact,
    RigidBody2D,
    Simulation,
    Sine,
    SpringDamper2D,
)
from tlismni.models import load


def differences(sim, h):
    """Central differences of all channels about the present time, extrapolated to order 4."""
    state, t = sim.state(), sim.t

    def at(time):
        sim.restore(state)
        sim.advance(time)
        return np.array(sim.values())

    sim.restore(state)
    y = {k: at(t + (k + 2) * h) for k in (-2, -1, 0, 1, 2)}
    sim.restore(state)
    sim.advance(t + 2 * h)
    return (8.0 * (y[1] - y[-1]) - (y[2] - y[-2])) / (12.0 * h)


def check(model, t, h=1e-4, tolerance=1e-6):
    """The known rates at t + 2 h of a run with small steps; gives the names of the channels whose rate is known."""
    sim = Simulation(model, "irk", rtol=1e-11, atol=1e-13, max_step=h)
    sim.advance(t)
    wanted = differences(sim, h)
    found = sim.output_rates()
    known = np.isfinite(found)
    real = np.array([c.kind == "real" for c in sim.channels])
    assert not known[~real].any() or set(found[~real & known]) <= {0.0}
    scale = np.maximum(np.abs(wanted), np.max(np.abs(found[known & real])))
    off = np.abs(found - wanted)[known & real] / scale[known & real]
    assert np.max(off) < tolerance, [
        (c.name, x) for c, x in zip(np.array(sim.channels)[known & real], off, strict=True)
    ]
    return {c.name for c, k in zip(sim.channels, known, strict=True) if k and c.kind == "real"}


def block(law, friction, speed=1.0):
    body = RigidBody2D(name="b", mass=2.0, inertia=0.4, position=(0.0, 0.49), velocity=(speed, 0.0))
    return Model(
        bodies=[body],
        forces=[
            AppliedForce2D(name="push", marker=Marker2D(body="b", point=(0.0, -0.1)),
                           force_x=Sine(amplitude=2.0, angular_frequency=20.0)),
            SpringDamper2D(name="s", a=Marker2D(point=(0.0, 2.0)), b=Marker2D(body="b", point=(0.1, 0.0)),
                           stiffness=20.0, damping=1.5, natural_length=1.4),
        ],
        contacts=[foot("c", "b", y=-0.4, mu=None, radius=0.1, law=law).model_copy(update={"friction": friction})],
        outputs=[MarkerOutput2D(name="m", marker=Marker2D(body="b", point=(0.2, 0.3)))],
    )  # fmt: skip


@pytest.mark.parametrize(
    "law, friction",
    [
        (Hertz(stiffness=1e4), BrownMcPheeFriction(coefficient=0.3, static_coefficient=0.4, transition_speed=0.01)),
        (KelvinVoigt(stiffness=1e4, damping=20.0), None),
        (Hertz(stiffness=1e4), LuGreFriction(coefficient=0.3, stribeck_speed=0.01, bristle_stiffness=1e4)),
    ],
)  # fmt: skip
def test_a_block_on_a_force_law(law, friction):
    known = check(block(law, friction), 0.02)
    contact = {"c.gap", "c.gap_rate", "c.impulse", "c.dissipation"} | ({"c.sliding_velocity"} if friction else set())
    body = {f"{frame}.{name}" for frame in ("b", "m") for name in ("x", "y", "angle", "vx", "vy", "angular_velocity")}
    assert body | contact | {"energy.input_work", "energy.dissipation", "energy.impact_loss"} <= known
    assert not known & {"b.ax", "m.ay", "c.normal_force", "energy.kinetic", "energy.balance", "residual.position"}


@pytest.mark.parametrize("speed", [1.0, 0.0])
def test_a_block_that_slides_or_sticks_on_a_constraint(speed):
    model = block(PLASTIC, CoulombFriction(coefficient=0.3), speed)
    lifted = model.bodies[0].model_copy(update={"position": (0.0, 0.5)})
    check(model.model_copy(update={"bodies": (lifted,)}), 0.02)


def test_joints_and_an_open_contact():
    known = check(load("pendulum_stop", law="newton").model, 0.1)
    assert "pendulum.angle" in known and "pin.force_x" not in known and "stop.gap_rate" in known


def test_before_an_impact_the_rates_are_those_of_the_flight():
    scenario = load("bouncing_ball")
    sim = Simulation(scenario.model)
    assert sim.advance_to_event(scenario.t_end)
    found = dict(zip((c.name for c in sim.channels), sim.output_rates(), strict=True))
    values = dict(zip((c.name for c in sim.channels), sim.values(), strict=True))
    assert found["ball.y"] == values["ball.vy"] < 0.0 and found["ball.vy"] == values["ball.ay"] < 0.0
    assert isinstance(scenario.model.contacts[0].law, NewtonImpact)
