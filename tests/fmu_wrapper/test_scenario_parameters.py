"""Parameters of a scenario's builder as parameters of the slave: it does what the scenario built with them does."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tlismni.core.errors import ModelError
from tlismni.core.model.units import parse_unit
from tlismni.fmu_wrapper import Slave
from tlismni.fmu_wrapper.effective import effective
from tlismni.fmu_wrapper.errors import CallOrderError, FmuValueError, SnapshotError
from tlismni.fmu_wrapper.origin import Origin
from tlismni.fmu_wrapper.run import Run
from tlismni.fmu_wrapper.settings import Settings
from tlismni.fmu_wrapper.structure import difference
from tlismni.fmu_wrapper.values import Values
from tlismni.fmu_wrapper.variable_list import build_table
from tlismni.models import catalogue, load, names

ENTRIES = {entry.name: entry for entry in catalogue()}
DT, STEPS = 0.05, 8


def table_of(scenario):
    """The variables of a scenario's slave, its channels aside (they need the solver), and its origin."""
    model, settings = Settings.of(scenario)
    origin = Origin.of(scenario, model)
    return build_table(model, settings, (), origin), origin


def exposed(scenario):
    return {v.name: v for v in table_of(scenario)[0].block("scenario")}


def moved(p, value):
    """Another value that the parameter may take: far away, else near."""
    if p.kind == "integer":
        return (value + 1,)
    step = 0.1 * abs(value) or 0.01
    return tuple(x for x in (value + step, value - step) if (p.maximum is None or x <= p.maximum))


def motion(slave, steps=STEPS, dt=DT):
    """What all real outputs of a slave do."""
    slave.enter_initialization()
    slave.exit_initialization()
    names = [v.name for v in slave.variables.block("channel") if v.kind == "real"]
    rows = []
    for k in range(steps):
        slave.do_step(k * dt, dt)
        rows.append([slave[name] for name in names])
    return np.array(rows)


# every scenario


@pytest.mark.parametrize("name", names())
def test_each_number_of_a_builder_is_a_parameter_or_can_be_none(name):
    """What is no parameter changes nothing, changes the structure, or is a choice made at the export."""
    scenario = load(name)
    found = exposed(scenario)
    assert found
    for p in ENTRIES[name].parameters:
        value = scenario.parameters[p.name]
        if p.name in found:
            v = found[p.name]
            assert (v.start, v.minimum, v.maximum, v.role) == (value, p.minimum, p.maximum, "parameter")
            assert p.description in v.description
            if v.kind == "real":
                assert parse_unit(v.unit) == (parse_unit(p.unit) or (parse_unit("1") if p.unit == "-" else None))
            continue
        if p.kind != "number" or value is None:
            continue
        others = []
        for x in moved(p, value):
            try:
                others.append(load(name, **{p.name: x}))
            except ModelError:
                continue
        assert all(
            difference(scenario.model, other.model)
            or (other.model == scenario.model and dict(other.options) == dict(scenario.options))
            for other in others
        ), p.name


@pytest.mark.parametrize("name", names())
def test_a_changed_parameter_makes_the_model_that_the_builder_makes(name):
    """Model and solver's settings, for each parameter of each scenario."""
    scenario = load(name)
    table, origin = table_of(scenario)
    model, settings = Settings.of(scenario)
    for v in table.block("scenario"):
        p = next(p for p in ENTRIES[name].parameters if p.name == v.name)
        for value in moved(p, v.start):
            try:
                expected = load(name, **{v.name: value})
            except ModelError:
                continue
            origin.check(v, value)
            values = Values(table)
            values[v] = value
            found = effective(model, settings, values, origin)
            assert found.model.model_dump() == expected.model.model_dump(), (v.name, value)
            assert replace(found.settings, t_end=None) == replace(Settings.of(expected)[1], t_end=None), v.name
            break
        else:
            pytest.fail(f"no other value of {v.name} was possible")


@pytest.mark.parametrize("name", names())
def test_what_is_left_to_a_builder_can_be_given_to_it(name):
    """A parameter that a builder derives, given as it was derived, makes the same model."""
    scenario = load(name)
    assert load(name, **scenario.parameters).model == scenario.model


def test_no_names_are_taken_twice():
    """With other laws and switches too: an input `torque` beside a parameter of this name."""
    for name in ("pendulum_stop", "slider_crank_stop"):
        for driven in (True, False):
            table_of(load(name, driven=driven, law="kelvin_voigt"))


def test_a_name_that_is_taken_gets_another():
    scenario = load("pendulum")
    variables = list(Origin.of(scenario, scenario.model).variables({"mass"}, iter(range(1, 99))))
    assert [v.name for v in variables] == ["scenario.mass", "length", "gravity", "angle"]


# the motion is that of the scenario built with the values

CASES = [
    ("pendulum_stop", {}, {"length": 0.7, "gravity": 3.7, "restitution": 0.4}),
    ("pendulum_stop", {"law": "kelvin_voigt", "stiffness": 1e5}, {"restitution": 0.5, "mass": 2.0}),
    ("bouncing_ball", {}, {"height": 0.3, "restitution": 0.5}),
    ("newtons_cradle", {}, {"released": 2, "angle": 0.3}),
    ("stick_slip", {}, {"belt_speed": 0.2, "friction": 0.25}),
]


@pytest.mark.parametrize(("name", "given", "changes"), CASES)
def test_motion_is_that_of_the_scenario(name, given, changes):
    slave = Slave(load(name, **given))
    slave.set_by_name(changes)
    expected = motion(Slave(load(name, **given, **changes)))
    found = motion(slave)
    assert np.array_equal(found, expected)
    slave.reset()
    assert np.array_equal(motion(slave), motion(Slave(load(name, **given))))
    assert not np.array_equal(found, motion(Slave(load(name, **given))))


def test_solver_settings_follow_where_the_export_left_them_to_the_builder():
    """The step of a rod is a part of the time that a wave takes through an element."""
    scenario = load("rod_wall")
    table, origin = table_of(scenario)
    model, settings = Settings.of(scenario)
    values = Values(table)
    values[table.by_name["youngs_modulus"]] *= 4.0
    found = effective(model, settings, values, origin)
    assert found.settings.step == pytest.approx(0.5 * scenario.options["step"])
    assert found.following == {table.by_name["solver.step"].reference: found.settings.step}
    values[table.by_name["solver.step"]] = 1e-7
    assert effective(model, settings, values, origin).settings.step == 1e-7
    _, chosen = Settings.of(scenario, step=2e-7)  # at the export
    table = build_table(model, chosen, (), origin)
    values = Values(table)
    values[table.by_name["youngs_modulus"]] *= 4.0
    assert effective(model, chosen, values, origin).settings.step == 2e-7


# parameters that are derived


def test_a_derived_parameter_follows_until_it_is_set():
    base = load("pendulum_stop", law="kelvin_voigt")
    other = load("pendulum_stop", law="kelvin_voigt", restitution=0.4)
    slave = Slave(base)
    slave.set_by_name({"restitution": 0.4})
    slave.enter_initialization()
    assert slave["damping"] == other.parameters["damping"] != base.parameters["damping"]
    slave.exit_initialization()
    assert slave["damping"] == other.parameters["damping"]
    slave.reset()
    slave.set_by_name({"damping": 20.0, "stiffness": 2e6})
    slave.enter_initialization()
    slave.exit_initialization()
    assert (slave["damping"], slave["stiffness"]) == (20.0, 2e6)
    given = load("pendulum_stop", law="kelvin_voigt", damping=20.0, stiffness=2e6)
    found = effective(slave.model, slave.settings, slave._values, slave.origin)
    assert found.model == given.model


# what is refused


@pytest.mark.parametrize(
    ("value", "words"),
    [(math.nan, "not finite"), (math.inf, "not finite"), (-1.0, "outside"), (0.0, "outside (0, inf)")],
)
def test_values_out_of_range_are_refused_when_set(value, words):
    slave = Slave(load("pendulum_stop"))
    with pytest.raises(FmuValueError, match=r"'length' \(value reference") as refused:
        slave.set_by_name({"length": value})
    assert words in str(refused.value)
    slave.enter_initialization()
    assert slave["length"] == 1.0


def test_a_value_that_changes_the_structure_is_refused_when_set():
    """Without stiffness there is no bushing but a joint."""
    assert "length_ratio" not in exposed(load("rod_rod"))  # from which the number of elements follows
    slave = Slave(load("slider_crank", bushing_stiffness=1e4))
    with pytest.raises(FmuValueError, match=r"'bushing_stiffness' .* another structure .* --set bushing_stiffness=0.0"):
        slave.set_by_name({"bushing_stiffness": 0.0})


def test_values_that_do_not_fit_together_are_refused_at_the_end_of_initialization():
    """One after the other they may pass: both angles are moved beyond where the other one was."""
    slave = Slave(load("pendulum_stop"))
    slave.set_by_name({"start_angle": -2.0, "stop_angle": -2.0})
    slave.enter_initialization()
    assert slave["start_angle"] == -2.0
    with pytest.raises(ModelError, match="must differ"):
        slave.exit_initialization()
    slave.set_by_name({"stop_angle": -3.0})
    slave.exit_initialization()
    assert slave["pendulum.angle"] == -2.0
    with pytest.raises(CallOrderError, match="'length' is fixed after initialization"):
        slave.set_by_name({"length": 2.0})


def test_a_catalogue_that_builds_otherwise_is_refused():
    """The model in the FMU is what counts; without changes it runs."""
    scenario = load("pendulum")
    slave = Slave(scenario.model, origin=Origin("pendulum", {**scenario.given, "mass": 3.0}))
    assert not slave.variables.block("parameter")
    slave.set_by_name({"length": 2.0})
    slave.enter_initialization()
    with pytest.raises(ModelError, match="otherwise"):
        slave.exit_initialization()


def test_models_of_others_have_no_builder():
    scenario = load("pendulum")
    heavy = load("pendulum", mass=2.0).model
    assert Slave(scenario.model).origin is None
    assert Slave(replace(scenario, model=heavy)).origin is None
    assert Slave(replace(scenario, name="mine")).origin is None


# states, instances


def test_a_state_holds_the_parameters():
    """It leads back in an instance that has other values, and as bytes; never into another scenario."""
    changes = {"length": 0.7, "restitution": 0.4}
    one, other = Slave(load("pendulum_stop")), Slave(load("pendulum_stop"))
    one.set_by_name(changes)
    motion(one)
    motion(other)
    data = one.snapshot().data
    other.restore(other.snapshot_from_bytes(data))
    for slave in (one, other):
        slave.do_step(STEPS * DT, DT)
    assert {n: other[n] for n in changes} == changes
    assert all(one[v.name] == other[v.name] for v in one.variables.variables)
    longer = Slave(load("pendulum_stop", length=0.7))
    with pytest.raises(SnapshotError, match="another model"):
        longer.snapshot_from_bytes(data)


def test_a_forged_value_in_a_state_is_refused():
    slave = Slave(load("pendulum_stop"))
    motion(slave, 2)
    snapshot = slave.snapshot()
    snapshot.values[slave.variables.by_name["length"]] = -1.0
    with pytest.raises(SnapshotError, match="'length'"):
        slave.snapshot_from_bytes(snapshot.data)


def test_instances_do_not_know_of_one_another():
    slaves = [Slave(load("bouncing_ball")) for _ in range(3)]
    for height, slave in zip((0.5, 1.0, 2.0), slaves, strict=True):
        slave.set_by_name({"height": height})
    for slave in slaves:
        slave.enter_initialization()
        slave.exit_initialization()
    assert [slave["ball.y"] for slave in slaves] == [0.5, 1.0, 2.0]


def test_runs_are_shared_between_equal_values_only():
    slave = Slave(load("pendulum"))
    keys = []
    for length in (1.0, 2.0, 1.0):
        slave.reset()
        slave.set_by_name({"length": length})
        keys.append(Run.key_of(slave._values, 0.0))
    assert keys[0] == keys[2] != keys[1]
