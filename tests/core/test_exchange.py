"""`Simulation.exchange` is `set_inputs`, `advance` and `values` in one call: the same bits, and the same errors."""

import math

import numpy as np
import pytest
from helpers import circle_pendulum, floor_contact, on, rod_pendulum
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Input,
    InputSignal,
    MarkerOutput2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Simulation,
    SimulationError,
    Step,
)
from tlismni.models import load

TORQUE = Input(name="u", unit="N.m")


def rod(**parts):
    """A swinging rod with a torque as input, another that jumps, and a marker at its end."""
    torques = (InputSignal(channel="u"), Step(time=0.137, after=0.02), Step(time=0.2, before=0.01))
    return rod_pendulum(
        0.2,
        forces=[AppliedTorque2D(name=f"m{k}", body="rod", torque=signal) for k, signal in enumerate(torques)],
        inputs=[TORQUE],
        outputs=[MarkerOutput2D(name="end", marker=on("rod", 0.3))],
        **parts,
    )


def ball():
    """A ball that bounces, pushed by an input."""
    push = AppliedForce2D(name="push", marker=on("ball"), force_y=InputSignal(channel="u"))
    return Model(
        bodies=[PointMass2D(name="ball", mass=1.0, position=(0.0, 0.1))],
        contacts=[floor_contact(NewtonImpact(restitution=0.5))],
        gravity=(0.0, -9.81),
        forces=[push],
        inputs=[Input(name="u", unit="N")],
    )


def chain():
    """The catalogue's chain with a torque on its first body."""
    model = load("chain", links=3).model
    drive = AppliedTorque2D(name="drive", body=model.bodies[0].name, torque=InputSignal(channel="u"))
    return Model(**{**dict(model), "forces": (*model.forces, drive), "inputs": (TORQUE,)})


CASES = {
    "rod with steps": (rod, 0.01, 40),
    "ball": (ball, 0.02, 40),
    "stop": (lambda: load("pendulum_stop").model, 0.02, 40),
    "chain": (chain, 0.004, 60),
}


def inputs_of(points):
    """Such that hold, change and come back, at no regular times."""
    rng = np.random.default_rng(3)
    return np.where(rng.random(points) < 0.4, rng.normal(size=points), 0.0).tolist()


@pytest.mark.parametrize("method", ["ebdf", "irk", "newmark"])
@pytest.mark.parametrize("case", CASES)
def test_the_same_bits_as_three_calls(case, method):
    build, h, points = CASES[case]
    model = build()
    name = model.inputs[0].name
    long, short = Simulation(model, method), Simulation(model, method)
    quick = 0
    for k, u in enumerate(inputs_of(points)):
        t = (k + 1) * h
        long.set_inputs({name: u})
        long.advance(t)
        expected = long.values()
        found = short.exchange([u], t)
        quick += found is not None
        found = short.values() if found is None else found
        assert found.tobytes() == expected.tobytes()
        assert long.state() == short.state()
    assert long.events == short.events
    assert quick > 0.5 * points or case in ("ball", "stop")


def test_values_that_are_not_wanted_are_not_computed():
    sim = Simulation(rod())
    assert sim.exchange([0.0], 0.01, read=False) is None
    before = sim.stats["residual_evaluations"]
    assert sim.exchange([0.0], 0.0100001, read=False) is None  # within the newest step
    assert sim.stats["residual_evaluations"] == before
    assert sim.t == 0.0100001


@pytest.mark.parametrize("t", [0.005, math.nan, math.inf])
def test_times_that_cannot_be(t):
    sim = Simulation(rod())
    sim.exchange([0.0], 0.01)
    with pytest.raises(ModelError, match="cannot advance from"):
        sim.exchange([0.0], t)
    assert sim.t == 0.01


@pytest.mark.parametrize("u", [math.nan, math.inf])
def test_inputs_that_are_not_finite(u):
    sim, other = Simulation(rod()), Simulation(rod())
    for s in (sim, other):
        s.exchange([0.1], 0.01)
    with pytest.raises(ModelError, match="a finite number is needed"):
        sim.exchange([u], 0.02)
    assert sim.t == 0.01
    assert sim.exchange([0.2], 0.02).tobytes() == other.exchange([0.2], 0.02).tobytes()


def test_an_input_that_makes_the_run_fail():
    """The same error as in three calls, and the run goes on from a state."""
    sim, other = Simulation(rod()), Simulation(rod())
    for s in (sim, other):
        s.exchange([0.1], 0.01)
    start = sim.state()
    with pytest.raises(SimulationError) as found:
        sim.exchange([1e308], 0.02)
    with pytest.raises(SimulationError) as expected:
        other.set_inputs({"u": 1e308})
        other.advance(0.02)
    assert str(found.value) == str(expected.value)
    sim.restore(start)
    other.restore(start)
    other.set_inputs({"u": 0.1})
    other.advance(0.02)
    assert sim.exchange([0.1], 0.02).tobytes() == other.values().tobytes()


def test_runs_that_have_no_quick_way():
    recorded, plain = Simulation(rod(), record=True), Simulation(rod())
    assert recorded.exchange([0.1], 0.05) is None and recorded.t == 0.05
    assert recorded.values().tobytes() == plain.exchange([0.1], 0.05).tobytes()
    own = Simulation(circle_pendulum())
    assert own.exchange([], 0.05) is None and own.t == 0.05


@pytest.mark.parametrize("value", [0.2, 0.115])
def test_an_input_with_a_derivative_ends(value):
    """Whether or not it jumps then."""
    sloped, other = Simulation(rod()), Simulation(rod())
    for sim in (sloped, other):
        sim.set_inputs({"u": 0.1}, {"u": (0.5,)})
        sim.advance(0.03)
    found = sloped.exchange([value], 0.05)
    other.set_inputs({"u": value})
    other.advance(0.05)
    assert found.tobytes() == sloped.values().tobytes() == other.values().tobytes()


@pytest.mark.parametrize("inputs", [[], [0.1, 0.2]])
def test_as_many_inputs_as_there_are(inputs):
    with pytest.raises(ModelError, match=rf"{len(inputs)} inputs were given: there are 1, in the order \['u'\]"):
        Simulation(rod()).exchange(inputs, 0.1)
