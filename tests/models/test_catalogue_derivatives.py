"""Derivatives of all channels of all scenarios, along inputs and in time, against difference quotients."""

import numpy as np
import pytest
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    Input,
    InputSignal,
    Marker2D,
    Marker3D,
    PointMass2D,
    PointMass3D,
    RigidBody2D,
    RigidBody3D,
    Simulation,
)
from tlismni.models import load, names

PLANAR, SPATIAL = (PointMass2D, RigidBody2D), (PointMass3D, RigidBody3D)
MOTIONS = {"split_wall"}
"""Their inputs are motions, which change nothing at once."""


WAVES = {"mass_on_rod", "rod_rod"}
"""Waves along rods are as fast as the steps: differences are those of the dense output."""


def with_force(model):
    """The model with a force on its first body as inputs `u_x`, `u_y` (`u_z`), and their names; none for a model
    without rigid bodies and points."""
    body = next((b for b in model.bodies if isinstance(b, (*PLANAR, *SPATIAL))), None)
    if body is None:
        return model, [x.name for x in model.inputs]
    axes = "xy" if isinstance(body, PLANAR) else "xyz"
    forces = {f"force_{axis}": InputSignal(channel=f"u_{axis}") for axis in axes}
    kind, marker = (AppliedForce2D, Marker2D) if isinstance(body, PLANAR) else (AppliedForce3D, Marker3D)
    push = kind(name="push_in_test", marker=marker(body=body.name), **forces)
    inputs = (*model.inputs, *(Input(name=f"u_{axis}", unit="N") for axis in axes))
    found = model.model_copy(update={"inputs": inputs, "forces": (*model.forces, push)})
    return found, [f"u_{axis}" for axis in axes]


def along(sim, name):
    """Difference quotients of all channels along an input, extrapolated, of a size that channels are smooth in."""
    state, size = sim.state(), 1e-3

    def at(value):
        sim.restore(state)
        sim.set_inputs({name: value})
        return np.array(sim.values())

    slopes = [(at(d) - at(-d)) / (2.0 * d) for d in (size, 2.0 * size)]
    sim.restore(state)
    return (4.0 * slopes[0] - slopes[1]) / 3.0


def in_time(sim, h):
    """Central differences about the present time, of order 4; and the events that there were on the way."""
    state, t, events = sim.state(), sim.t, len(sim.events)

    def at(time):
        sim.restore(state)
        sim.advance(time)
        return np.array(sim.values())

    y = {k: at(t + (k + 2) * h) for k in (-2, -1, 0, 1, 2)}
    happened = len(sim.events) > events
    sim.restore(state)
    sim.advance(t + 2 * h)
    return (8.0 * (y[1] - y[-1]) - (y[2] - y[-2])) / (12.0 * h), happened


def off(sim, found, wanted, kept, least):
    """How far channels are off, in parts of the largest of their unit, and which is the worst; `least`: of all channels
    what counts as large."""
    units = np.array([c.unit for c in sim.channels])
    worst = (0.0, "")
    for unit in set(units[kept]):
        group = kept & (units == unit)
        scale = max(np.max(np.abs(wanted[group])), np.max(np.abs(found[group])), np.max(least[group]))
        part = np.abs(found - wanted)[group] / scale
        k = int(np.argmax(part))
        worst = max(worst, (float(part[k]), np.array([c.name for c in sim.channels])[group][k]))
    return worst


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", sorted(set(names()) - MOTIONS))
def test_along_inputs_and_in_time(name):
    scenario = load(name)
    model, inputs = with_force(scenario.model)
    h = 2e-5 * min(scenario.t_end, 1.0)
    sim = Simulation(model, "irk", rtol=1e-9, atol=1e-12)
    real = np.array([c.kind == "real" for c in sim.channels])
    residual = np.array([c.name.startswith("residual.") for c in sim.channels])
    frictions = np.array([c.name.endswith(".friction_force") for c in sim.channels])
    for part in (0.021, 0.13, 0.37):
        sim.advance(part * scenario.t_end)
        for channel in inputs:
            found, wanted = np.array(sim.input_derivatives({channel: 1.0})), along(sim, channel)
            # a norm that is zero has a derivative on either side only
            real &= ~(frictions & (np.abs(sim.values()) < 1e-6))
            worst = off(sim, found, wanted, real & ~residual, 1e-3 * np.abs(sim.values()) + 1e-6)
            assert worst[0] < 1e-6, (part, channel, worst)
        wanted, happened = in_time(sim, h)
        found = np.array(sim.output_rates())
        if not happened:
            known = np.isfinite(found) & real
            worst = off(sim, found, wanted, known, np.abs(sim.values()) / scenario.t_end + 1e-6)
            assert worst[0] < (1e-3 if name in WAVES else 1e-5), (part, worst)


def test_friction_in_space_goes_with_the_force_that_presses():
    """A sphere that slides and spins: |F| = mu N, N = m g - F_z; the speed of its lowest point falls by 7/2 mu g."""
    scenario = load("spinning_sphere", height=0.0, restitution=0.0)
    model, _ = with_force(scenario.model)
    sim = Simulation(model, scenario.method, rtol=scenario.rtol, atol=scenario.atol)
    sim.advance(0.01)
    names_of = [c.name for c in sim.channels]
    (contact,) = (c.name for c in model.contacts)
    values, rates = dict(zip(names_of, sim.values(), strict=True)), dict(zip(names_of, sim.output_rates(), strict=True))
    assert values[f"{contact}.sliding_velocity"] > 0.1
    found = dict(zip(names_of, sim.input_derivatives({"u_z": 1.0}), strict=True))
    assert found[f"{contact}.normal_force"] == pytest.approx(-1.0, rel=1e-12)
    assert found[f"{contact}.friction_force"] == pytest.approx(-0.3, rel=1e-9)
    gravity = -model.gravity[2]
    assert rates[f"{contact}.sliding_velocity"] == pytest.approx(-3.5 * 0.3 * gravity, rel=1e-6)
