"""Derivatives of all channels of all scenarios, along inputs and in time, against difference quotients."""

import numpy as np
import pytest
from added_inputs import settable, with_inputs
from tlismni.core import Simulation
from tlismni.fmu_wrapper import Slave
from tlismni.fmu_wrapper.fmi3_calls import Fmi3Calls
from tlismni.models import load, names

NO_FORCE = 1e-6
"""N: a friction force that is less is that of a sphere that rolls, or nothing; a norm of zero has a derivative on
either side only."""
SLOW = {"bricard", "cable_ground", "cantilever", "flexible_slider_crank_stop", "four_bar", "mass_on_rod", "rod_rod"}
WAVES = {"mass_on_rod", "rod_rod"}
"""Waves along rods are as fast as the steps: differences are those of the dense output."""


def quotients(at, forces):
    """Difference quotients of `at(value)` about the present value 0, extrapolated.

    Channels are affine in the inputs, but for norms of forces and for contacts that pull, which show no force: `forces`
    of contacts (N) change by a hundredth at most, by the derivatives that stand beside them.
    """
    size = min([1e-3, *(0.01 * abs(x / slope) for x, slope in forces if abs(x) > NO_FORCE and slope != 0.0)])
    slopes = [(at(d) - at(-d)) / (2.0 * d) for d in (size, 2.0 * size)]
    return (4.0 * slopes[0] - slopes[1]) / 3.0


def contact_forces(names_of, values, found):
    """Forces of contacts and their derivatives, of all channels."""
    of = (".normal_force", ".friction_force")
    return [(x, slope) for name, x, slope in zip(names_of, values, found, strict=True) if name.endswith(of)]


def along(sim, name, found):
    """Difference quotients of all channels along an input of a simulation; `found`: what they shall be."""
    state, before = sim.state(), {x.name: x.start for x in sim.system.inputs}[name]

    def at(change):
        sim.restore(state)
        sim.set_inputs({name: before + change})
        return np.array(sim.values())

    slopes = quotients(at, contact_forces([c.name for c in sim.channels], sim.values(), found))
    sim.restore(state)
    return slopes


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
@pytest.mark.parametrize("name", names())
def test_along_inputs_and_in_time(name):
    scenario = load(name)
    model, added = with_inputs(scenario.model)
    assert added
    h = 2e-5 * min(scenario.t_end, 1.0)
    sim = Simulation(model, "irk", rtol=1e-9, atol=1e-12)
    real = np.array([c.kind == "real" for c in sim.channels])
    residual = np.array([c.name.startswith("residual.") for c in sim.channels])
    frictions = np.array([c.name.endswith(".friction_force") for c in sim.channels])
    for part in (0.021, 0.13, 0.37):
        sim.advance(part * scenario.t_end)
        for channel in settable(scenario, added):
            found = np.array(sim.input_derivatives({channel: 1.0}))
            wanted = along(sim, channel, found)
            kept = real & ~residual & ~(frictions & (np.abs(sim.values()) < NO_FORCE))
            worst = off(sim, found, wanted, kept, 1e-3 * np.abs(sim.values()) + 1e-6)
            assert worst[0] < 1e-6, (part, channel, worst)
        wanted, happened = in_time(sim, h)
        found = np.array(sim.output_rates())
        if not happened:
            known = np.isfinite(found) & real
            worst = off(sim, found, wanted, known, np.abs(sim.values()) / scenario.t_end + 1e-6)
            assert worst[0] < (1e-3 if name in WAVES else 1e-5), (part, worst)


@pytest.mark.parametrize("name", [pytest.param(x, marks=pytest.mark.full) if x in SLOW else x for x in names()])
def test_adjoint_of_the_fmu(name):
    """`fmi3GetAdjointDerivative` of all outputs with random weights, with respect to all inputs at once, and
    `fmi3GetDirectionalDerivative` of all along random directions, against quotients of what the FMU gives."""
    scenario = load(name)
    model, added = with_inputs(scenario.model)
    inputs = settable(scenario, added)
    slave = Slave(model, method="irk", rtol=1e-9, atol=1e-12)
    slave.enter_initialization()
    slave.exit_initialization()
    slave.do_step(0.0, 0.13 * scenario.t_end)
    calls, table = Fmi3Calls(slave), slave.variables.by_name
    values = {v.name: slave[v.name] for v in slave.variables.block("channel") if v.kind == "real"}
    outputs = [
        n
        for n, x in values.items()
        if not n.startswith("residual.") and not (n.endswith(".friction_force") and abs(x) < NO_FORCE)
    ]
    unknowns, knowns = (np.array([table[n].reference for n in of], dtype=np.uint32) for of in (outputs, inputs))
    columns = np.empty((len(outputs), len(inputs)))
    for k in range(len(inputs)):
        columns[:, k] = slave.directional_derivative(unknowns, knowns[k : k + 1], np.ones(1))
    random, kept = np.random.default_rng(len(name)), slave.snapshot()
    start = np.array([slave[n] for n in inputs])

    def at(direction, change):
        slave.restore(kept)
        slave.set_by_name(dict(zip(inputs, (start + change * direction).tolist(), strict=True)))
        return np.array([slave[n] for n in outputs])

    wanted = np.empty_like(columns)
    for k, direction in enumerate(np.eye(len(inputs))):
        forces = contact_forces(outputs, [values[n] for n in outputs], columns[:, k])
        wanted[:, k] = quotients(lambda x, along=direction: at(along, x), forces)
    slave.restore(kept)
    units, least = np.array([table[n].unit for n in outputs]), np.array([1e-3 * abs(values[n]) + 1e-6 for n in outputs])
    sizes = np.empty_like(columns)
    for unit in set(units):
        rows = units == unit
        sizes[rows] = np.maximum(np.max(np.abs(wanted[rows]), axis=0), np.max(least[rows]))
    assert np.all(np.abs(columns - wanted) < 1e-6 * sizes)
    for _ in range(3):
        weights = random.uniform(-1.0, 1.0, len(outputs)) / sizes.max(axis=1)
        adjoint = np.zeros(len(inputs))
        assert calls.fmi3GetAdjointDerivative(unknowns, knowns, weights, adjoint) == 0
        most = np.abs(weights) @ sizes
        assert np.all(np.abs(adjoint - weights @ wanted) < 1e-6 * most)
        seed, along_seed = random.uniform(-1.0, 1.0, len(inputs)), np.zeros(len(outputs))
        assert calls.fmi3GetDirectionalDerivative(unknowns, knowns, seed, along_seed) == 0
        assert np.all(np.abs(along_seed - wanted @ seed) < 1e-6 * (sizes @ np.abs(seed)))
        # the transpose, to rounding
        assert abs(adjoint @ seed - weights @ along_seed) < 1e-9 * (most @ np.abs(seed))


def test_friction_in_space_goes_with_the_force_that_presses():
    """A sphere that slides and spins: |F| = mu N, N = m g - F_z; the speed of its lowest point falls by 7/2 mu g."""
    scenario = load("spinning_sphere", height=0.0, restitution=0.0)
    model, _ = with_inputs(scenario.model)
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
