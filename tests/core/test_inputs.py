"""Inputs of a run: how they go on, when the run keeps its steps past them, and what happens when they change."""

import itertools

import numpy as np
import pytest
from helpers import on, rod_pendulum
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    ConsistencyError,
    Constant,
    CoordinateLoad,
    Input,
    InputSignal,
    LinearSystem,
    Model,
    ModelError,
    PointMass2D,
    Polynomial,
    Simulation,
    SimulationError,
    Table,
    simulate,
)
from tlismni.models import load

METHODS = ("ebdf", "bdf", "irk", "adams", "newmark")


def pushed(signal, inputs=()):
    """A swinging rod under a torque."""
    return rod_pendulum(0.2, forces=[AppliedTorque2D(name="m", body="rod", torque=signal)], inputs=list(inputs))


def driven(method="ebdf", start=0.0, **options):
    return Simulation(
        pushed(InputSignal(channel="u"), [Input(name="u", start=start)]),
        method,
        **({"rtol": 1e-8, "atol": 1e-11} | options),
    )


def state_at(sim, t):
    sim.advance(t)
    return sim.values()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["pendulum_stop", "slider_crank_stop"])
def test_while_inputs_hold_a_fine_grid_changes_nothing(name, method):
    """The run keeps its own steps: equal bits, and not a step more."""
    scenario = load(name, driven=True) if name == "slider_crank_stop" else load(name)
    channel = scenario.model.inputs[0].name
    found = []
    for points in (7, 700):
        sim = Simulation(scenario.model, method, rtol=1e-6)
        for t in np.linspace(0.0, 0.7 * scenario.t_end, points + 1)[1:]:
            sim.set_inputs({channel: scenario.model.inputs[0].start})
            sim.advance(float(t))
        found.append((sim.sample().tobytes(), sim.stats["steps"], len(sim.events)))
    assert found[0] == found[1]


@pytest.mark.parametrize("method", METHODS)
def test_inputs_with_derivatives_are_the_polynomial_that_they_say(method):
    """Set anew at every point, by value and derivatives with their rounding: the run of a Polynomial to its tolerance,
    with no step ended by the points."""
    c0, c1, c2 = 0.3, -0.7, 1.9
    whole = Simulation(pushed(Polynomial(coefficients=(c0, c1, c2))), method, rtol=1e-8, atol=1e-11)
    sim = driven(method, start=c0)
    sim.set_inputs({"u": c0}, {"u": (c1, 2.0 * c2)})
    for t in np.linspace(0.0, 1.0, 101)[1:]:
        expected = state_at(whole, t)
        assert state_at(sim, t) == pytest.approx(expected, rel=1e-8, abs=3e-8)
        sim.set_inputs({"u": c0 + c1 * t + c2 * t * t}, {"u": (c1 + 2.0 * c2 * t, 2.0 * c2)})
    assert abs(sim.stats["steps"] - whole.stats["steps"]) <= 0.05 * whole.stats["steps"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("every", [1, 10])
def test_inputs_that_change_give_the_motion_of_the_step_function(method, every):
    """Against a mass under a force that is constant by intervals: parabolas, whatever steps were dropped."""
    force = AppliedForce2D(name="f", marker=on("p"), force_x=InputSignal(channel="u"))
    sim = Simulation(
        Model(bodies=[PointMass2D(name="p", mass=2.0)], forces=[force], inputs=[Input(name="u")]), method, rtol=1e-10
    )
    x = v = 0.0
    changes = itertools.cycle([1.0, -3.0, 0.5, 5.0, -2.5])
    u, h = 0.0, 0.01
    channels = [c.name for c in sim.channels]
    for k in range(200):
        if k % every == 0:
            u = next(changes)
            sim.set_inputs({"u": u})
        sim.advance(h * (k + 1))
        x, v = x + h * v + 0.25 * u * h * h, v + 0.5 * u * h
        values = sim.values()
        assert values[channels.index("p.x")] == pytest.approx(x, abs=1e-9)
        assert values[channels.index("p.vx")] == pytest.approx(v, abs=1e-9)
    assert values[channels.index("energy.balance")] == pytest.approx(0.0, abs=1e-8)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("method", METHODS)
def test_changes_at_irregular_points_give_the_motion_of_the_step_function(method):
    """Steps that end where a change is expected can be tiny beside their neighbours: samples between must not feel it.
    An oscillator under a force that is constant by intervals, in closed form."""
    w = 10.0
    system = LinearSystem(name="s", coordinates=("s",), mass=((2.0,),), stiffness=((2.0 * w * w,),))
    load = CoordinateLoad(name="f", body="s", coordinate="s", load=InputSignal(channel="u"))
    options = {"rtol": 1e-7, "atol": 1e-10} if method == "newmark" else {"rtol": 1e-10, "atol": 1e-13}
    sim = Simulation(Model(bodies=[system], forces=[load], inputs=[Input(name="u")]), method, **options)
    random = np.random.default_rng(3)
    x = v = u = 0.0
    channels = [c.name for c in sim.channels]
    for _ in range(2000):
        before = sim.t
        sim.advance(before + float(random.choice([1e-5, 1e-3, 3e-3])))
        c, s, rest = np.cos(w * (sim.t - before)), np.sin(w * (sim.t - before)), 0.5 * u / w**2
        x, v = rest + (x - rest) * c + v / w * s, v * c - (x - rest) * w * s
        values = sim.values()
        assert values[channels.index("s.s")] == pytest.approx(x, abs=5e-5 if method == "newmark" else 5e-8)
        assert values[channels.index("s.d_s")] == pytest.approx(v, abs=5e-4 if method == "newmark" else 5e-7)
        if random.integers(40) == 0:
            u = float(random.integers(-30, 30))
            sim.set_inputs({"u": u})


def test_changes_at_expected_times_cost_no_dropped_steps():
    """A change at every tenth point: steps end there, and only the first change comes as a surprise."""
    sim = driven(record=True)
    changed = []
    for k in range(200):
        if k % 10 == 0:
            sim.set_inputs({"u": 0.1 * np.sin(k)})
            changed.append(sim.t)
        sim.advance(0.01 * (k + 1))
    sim.flush()
    times = np.concatenate([block[:, 0] for block in sim.samples])
    assert (np.diff(times) >= 0.0).all()
    assert sum(np.abs(times - t).min() < 1e-12 for t in changed[2:]) == len(changed[2:])


def test_records_of_dropped_steps_are_dropped():
    sim = driven(record=True, step_records=True)
    sim.advance(0.51)
    assert sim.t_internal > 0.51
    sim.set_inputs({"u": 3.0})
    sim.flush()
    assert sim.samples[-1][-1, 0] <= 0.51 and sim.step_logs[-1][-1, 0] <= 0.51
    sim.advance(1.0)
    sim.flush()
    assert (np.diff(np.concatenate([block[:, 0] for block in sim.samples])) >= 0.0).all()


@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_an_input_that_changes_before_an_impact_beyond_the_point_undoes_it(method):
    """The step that was made beyond the point ended at an impact that does not happen after all."""
    scenario = load("pendulum_stop")
    sim = Simulation(scenario.model, method, rtol=1e-8)
    sim.advance(0.46)
    while not sim.pending:
        sim.advance(sim.t + 1e-3)
    assert sim.t < sim.t_internal and not sim.events
    sim.set_inputs({"torque": 5000.0})
    assert not sim.pending
    late = sim.t
    sim.advance(late + 0.02)
    assert not sim.events
    angle = [c.name for c in sim.channels].index("pendulum.angle")
    assert sim.values()[angle] > -0.5 * np.pi


@pytest.mark.parametrize("method", METHODS)
def test_result_does_not_depend_on_the_communication_grid(method):
    """An input given by cubic values and slopes of a sine at points: the error falls with the points alone, down to the
    tolerance of the run; here against the same signal as a spline table of many points."""
    t = np.linspace(0.0, 1.0, 401)
    whole = simulate(
        pushed(Table(times=tuple(t), values=tuple(np.sin(6.0 * t)))), 1.0, rtol=1e-10, atol=1e-13, t_eval=[1.0]
    )
    errors = []
    for points in (50, 100, 200):
        sim, h = driven(method, rtol=1e-10, atol=1e-13), 1.0 / points
        for k in range(points):
            s = k * h
            sim.set_inputs({"u": np.sin(6.0 * s)}, {"u": (6.0 * np.cos(6.0 * s), -36.0 * np.sin(6.0 * s))})
            sim.advance((k + 1) * h)
        errors.append(abs(sim.values()[2] - whole[whole.channels[2]][0]))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert ((orders > 2.6) | (np.array(errors[1:]) < 2e-8)).all(), (errors, orders)


def test_state_keeps_the_course_of_inputs_and_their_rhythm():
    sim = driven()
    for k in range(5):
        sim.set_inputs({"u": 0.3 * k}, {"u": (0.1 * k,)})
        sim.advance(0.07 * (k + 1))
    stored = sim.state()
    sim.advance(0.9)
    expected = sim.sample().tobytes()
    other = driven()
    other.restore(type(stored).from_bytes(stored.to_bytes()))
    assert other.state() == stored
    other.advance(0.9)
    assert other.sample().tobytes() == expected


@pytest.mark.parametrize(
    ("values", "derivatives", "message"),
    [
        ({"no": 1.0}, {}, "there is no input 'no'"),
        ({"u": np.nan}, {}, "'u' = nan"),
        ({"u": True}, {}, "'u' = True"),
        ({"u": 1.0}, {"u": (np.inf,)}, "derivative of input 'u' = inf"),
        ({"u": 1.0}, {"u": (1.0, 2.0, 3.0)}, "3 derivatives: at most 2"),
        ({}, {"u": (1.0,)}, "without values"),
    ],
)
def test_wrong_inputs_are_refused_and_change_nothing(values, derivatives, message):
    sim = driven()
    sim.advance(0.3)
    before = sim.state()
    with pytest.raises(ModelError, match=message):
        sim.set_inputs(values, derivatives)
    assert sim.state() == before


def test_an_input_without_accelerations_is_refused_and_the_run_goes_on():
    force = AppliedForce2D(name="f", marker=on("p"), force_x=InputSignal(channel="u"))
    mass = Model(
        gravity=(0.0, -1.0), bodies=[PointMass2D(name="p", mass=1e-10)], forces=[force], inputs=[Input(name="u")]
    )
    sim, other = Simulation(mass), Simulation(mass)
    for s in (sim, other):
        s.advance(0.3)
    with pytest.raises((ConsistencyError, SimulationError), match="not finite"):
        sim.set_inputs({"u": 1e300})
    assert state_at(sim, 0.6).tobytes() == state_at(other, 0.6).tobytes()


def test_held_input_is_a_constant_load():
    held, constant = driven(start=1.5), Simulation(pushed(Constant(value=1.5)), "ebdf", 1e-8, 1e-11)
    for t in np.linspace(0.0, 1.0, 30)[1:]:
        held.set_inputs({"u": 1.5})
        assert state_at(held, t).tobytes() == state_at(constant, t).tobytes()
