"""Runs of a compiled model: the bits of runs that are built for themselves, and nothing shared that a run changes."""

import numpy as np
import pytest
from helpers import ball_over_floor
from tlismni.core import (
    METHODS,
    AppliedForce2D,
    EquationSystem,
    GapContact,
    Input,
    InputSignal,
    Marker2D,
    MarkerOutput2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Simulation,
    Step,
    compile_model,
)
from tlismni.core.simulation.blueprint import Blueprint, Unstarted
from tlismni.models import load


def seen(sim, times):
    """All that can be seen of a run: channels and states at each time as bytes."""
    found = []
    for t in times:
        sim.advance(float(t))
        found += [sim.values().tobytes(), sim.state().to_bytes()]
    return found


SCENARIOS = {
    "bouncing_ball": ({}, {"restitution": 0.55}, 1.5),
    "pendulum_stop": ({}, {"restitution": 0.4}, 1.5),
    "woodpecker": ({}, {}, 0.4),
    "stick_slip": ({}, {}, 1.0),
    "slider_crank_stop": ({}, {"restitution": 0.6}, 0.3),
    "newtons_cradle": ({}, {}, 0.6),
    "chain": ({"links": 12}, {}, 0.3),
    "impact_oscillator": ({"law": "hunt_crossley"}, {"restitution": 0.6}, 1.0),
}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", SCENARIOS)
@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
def test_runs_are_those_that_are_built_for_themselves_bit_for_bit(name, method):
    options, parameters, end = SCENARIOS[name]
    model = load(name, **options).model
    if not set(parameters) <= {p.name for p in model.parameters}:
        parameters = {}
    times = np.linspace(0.0, end, 4)[1:]
    compiled = compile_model(model, method, rtol=1e-6)
    assert seen(compiled.simulation(), times) == seen(Simulation(model, method, rtol=1e-6), times)
    if parameters:
        other = model.with_parameters(parameters)
        assert seen(compiled.simulation(parameters), times) == seen(Simulation(other, method, rtol=1e-6), times)
        assert seen(compiled.simulation(), times) == seen(Simulation(model, method, rtol=1e-6), times)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_repeats_an_impact_with_other_parameters(method):
    model = load("pendulum_stop").model
    compiled, other = compile_model(model, method, step=1e-3), model.with_parameters({"restitution": 0.3})
    run, alone = compiled.simulation({"restitution": 0.3}), Simulation(other, method, step=1e-3)
    assert seen(run, [0.7]) == seen(alone, [0.7])
    assert any(event.kind == "impact" for event in run.events)


def test_places_of_numbers_are_parameters_too():
    model = load("bouncing_ball").model
    run = compile_model(model).simulation({"ball.mass": 2.5, "floor.law.restitution": 0.5})
    assert run.system == model.with_parameters({"ball.mass": 2.5, "restitution": 0.5})
    run.advance(1.0)
    # an inelastic share of the energy of a mass of 2.5 kg that fell 1 m
    assert run.events[0].energy_loss == pytest.approx(0.75 * 2.5 * 9.81, rel=1e-6)
    with pytest.raises(ModelError, match=r"ball\.weight.*no field 'weight'"):
        compile_model(model).simulation({"ball.weight": 1.0})


def falling(velocity):
    ball = PointMass2D(name="ball", mass=2.0, position=(0.0, 1.0), velocity=velocity)
    return Model(bodies=(ball,), outputs=(MarkerOutput2D(name="eye", marker=Marker2D(body="ball")),))


def test_start_values_are_those_of_a_model_that_starts_so():
    run = compile_model(falling((0.0, 0.0))).simulation(start={"ball.vx": 0.5, "ball.vy": 3.0})
    alone = Simulation(falling((0.5, 3.0)))
    for t in (0.1, 0.4):
        run.advance(t)
        alone.advance(t)
        assert run.values().tobytes() == alone.values().tobytes()
    assert run.values()[run.table.index["eye.y"]] == pytest.approx(1.0 + 3.0 * 0.4 - 0.5 * 9.81 * 0.4**2, abs=1e-9)


def test_start_values_have_to_meet_the_joints():
    compiled = compile_model(load("pendulum_stop").model)
    name = next(name for name in compiled.start_names if name.endswith(".x"))
    with pytest.raises(Exception, match="violate the constraints beyond repair"):
        compiled.simulation(start={name: 100.0})
    assert compiled.simulation().t == 0.0


def pushed(start):
    return Model(
        bodies=(PointMass2D(name="ball", mass=2.0, position=(0.0, 1.0)),),
        forces=(
            AppliedForce2D(name="push", marker=Marker2D(body="ball"), force_x=InputSignal(channel="force")),
            AppliedForce2D(name="jolt", marker=Marker2D(body="ball"), force_y=Step(time=0.2, after=3.0)),
            AppliedForce2D(name="kick", marker=Marker2D(body="ball"), force_x=Step(time=0.3, after=3.0)),
        ),
        inputs=(Input(name="force", unit="N", start=start),),
    )


def test_inputs_begin_with_other_values():
    run, alone = compile_model(pushed(0.0)).simulation(inputs={"force": 4.0}), Simulation(pushed(4.0))
    assert seen(run, [0.25, 0.5]) == seen(alone, [0.25, 0.5])


def test_parameters_that_change_the_tables_give_the_right_run_too():
    """Two breakpoints become one: the tables have another size."""
    compiled = compile_model(pushed(1.0))
    run = compiled.simulation({"kick.force_x.time": 0.2})
    assert seen(run, [0.5]) == seen(Simulation(run.system), [0.5])
    assert list(run.assembly.breakpoints) == [0.2]


def addresses(sim):
    """Where the numbers that a run may write stand."""
    arrays, tables = sim.workspace.memory()
    for record in (sim._method, sim._loop, sim.drive.record):
        arrays, tables = [*arrays, *record.arrays.values()], [*tables, record.table]
    return {x.ctypes.data: x for x in (*arrays, *tables) if x.nbytes}, tables


def test_no_run_reaches_what_another_one_writes():
    model = load("pendulum_stop").model
    compiled = compile_model(model)
    runs = [compiled.simulation(), compiled.simulation(), compiled.simulation({"restitution": 0.2})]
    for one in runs:
        own, tables = addresses(one)
        for other in runs:
            if other is one:
                continue
            theirs, _ = addresses(other)
            for table in tables:
                assert not set(theirs) & set(np.atleast_1d(table.view(np.int64)).ravel().tolist())
            assert not any(np.shares_memory(x, y) for x in own.values() for y in theirs.values())


def test_spoiling_one_run_leaves_the_others_as_they_are():
    model = load("pendulum_stop").model
    compiled = compile_model(model)
    first, second = compiled.simulation(), compiled.simulation()
    second.advance(0.8)
    for array in addresses(second)[0].values():
        if array.dtype == np.float64:
            array[...] = np.nan
    assert seen(first, [0.8, 1.5]) == seen(Simulation(model), [0.8, 1.5])
    assert seen(compiled.simulation(), [1.5]) == seen(Simulation(model), [1.5])


def test_a_run_is_copied_in_the_middle_of_its_way():
    """What comes after is the same, with the events so far; each goes its own way."""
    sim = Simulation(ball_over_floor(NewtonImpact(restitution=0.5)))
    sim.advance(0.9)
    blueprint = Blueprint(sim)
    copies = [blueprint.simulation(), blueprint.simulation()]
    expected = seen(sim, [1.0, 2.0])
    for copy in copies:
        assert seen(copy, [1.0, 2.0]) == expected
        assert copy.events == sim.events


def test_more_room_for_later_runs_leaves_those_before_alone():
    """A thread may be copying while another one gives room."""
    model = load("bouncing_ball").model
    first = Blueprint(Unstarted(model))
    larger = first.simulation()
    larger.begin()
    assert first.with_room(first.simulation()) is first
    larger.workspace.slots.ask(3.0)
    larger.workspace.give_room()
    wider = first.with_room(larger)
    before, copies = seen(Simulation(model), [1.5]), [first.simulation(), first.simulation(), wider.simulation()]
    pools = [copy.workspace.slots.pool for copy in copies]
    assert pools[0].size == pools[1].size < pools[2].size
    assert not any(np.shares_memory(x, y) for k, x in enumerate(pools) for y in pools[:k])
    for copy in copies:
        copy.begin()
        assert seen(copy, [1.5]) == before


def ball_equations():
    return EquationSystem(
        mass=lambda t, q: np.array([[2.0]]),
        force=lambda t, q, v: np.array([-2.0 * 9.81]),
        q0=[1.0],
        v0=[0.0],
        contacts=[GapContact("floor", lambda t, q: q[0], NewtonImpact(restitution=0.5))],
    )


def test_own_equations_run_with_other_start_values():
    compiled = compile_model(ball_equations())
    (height, _), (other, rate) = compiled.start_names, compiled.start_names
    assert height == other
    runs = [compiled.simulation(start={rate: speed}) for speed in (0.0, -2.0)]
    for speed, run in zip((0.0, 2.0), runs, strict=True):
        run.advance(1.0)
        landing = (-speed + np.sqrt(speed**2 + 2.0 * 9.81)) / 9.81
        assert run.events[0].t == pytest.approx(landing, abs=1e-7)
    with pytest.raises(ModelError, match="belong to a Model"):
        compiled.simulation({"mass": 1.0})


@pytest.mark.parametrize(
    "numbers, words",
    [
        ({"parameters": {"restitution": 1.5}}, "restitution"),
        ({"parameters": {"bounce": 0.5}}, "has no parameter 'bounce'"),
        ({"start": {"ball.z": 0.5}}, "no start value 'ball.z'"),
        ({"start": {"ball.y": float("nan")}}, "finite number"),
        ({"inputs": {"force": 1.0}}, "no input 'force'"),
    ],
)
def test_wrong_numbers_are_refused_by_name(numbers, words):
    with pytest.raises(ModelError, match=words):
        compile_model(load("bouncing_ball").model).simulation(**numbers)
