"""What modelDescription.xml says is what the slave does: dependencies, limits, magnitudes, terminals, start values."""

import zipfile
from itertools import cycle

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu
from fmu_helpers import ball_model
from lxml import etree
from tlismni.core import Simulation, simulate
from tlismni.core.contacts.contact2d import Disk2D, DiskOnDisk2D
from tlismni.core.elements import (
    AppliedForce2D,
    AppliedTorque2D,
    CoordinateDriver,
    CoordinateLoad,
    Distance2D,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    SpringDamper2D,
)
from tlismni.core.laws import Hertz, KelvinVoigt, NewtonImpact
from tlismni.core.model.channels import Input, Parameter
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.outputs import MarkerOutput2D
from tlismni.core.model.signals import InputSignal
from tlismni.core.multibody_model import Model
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.fmu_wrapper.dependencies import Dependencies
from tlismni.fmu_wrapper.nominal import estimates
from tlismni.fmu_wrapper.scales import Scales, round_number
from tlismni.fmu_wrapper.terminals import terminals
from tlismni.models import load, names


def three_masses(law):
    """Two masses on a rod and one beside them that touches the second; a spring to a fourth, pulled by itself."""
    at = {name: Marker2D(body=name) for name in "abcd"}
    return Model(
        name="three_masses",
        gravity=(0.0, 0.0),
        bodies=[
            PointMass2D(name=name, mass=1.0, position=(x, 0.0))
            for name, x in (("a", 0.0), ("b", 1.0), ("c", 1.2), ("d", 3.0))
        ],
        joints=[Distance2D(name="rod", a=at["a"], b=at["b"], length=1.0)],
        forces=[
            AppliedForce2D(name="push", marker=at["a"], force_x=InputSignal(channel="force")),
            AppliedForce2D(name="pull", marker=at["d"], force_x=InputSignal(channel="tug")),
            SpringDamper2D(name="spring", a=at["c"], b=at["d"], stiffness=5.0, damping=0.1, natural_length=1.8),
        ],
        contacts=[
            DiskOnDisk2D(
                name="touch", law=law, a=Disk2D(marker=at["b"], radius=0.1), b=Disk2D(marker=at["c"], radius=0.1)
            )
        ],
        inputs=[Input(name="force", unit="N", start=2.0), Input(name="tug", unit="N", start=1.0)],
        parameters=[Parameter(name="mass", unit="kg", targets=["a.mass"])],
    )  # fmt: skip


def driven_crank():
    """A crank that a driver turns, with a load on a body that hangs on a spring."""
    crank, bob = Marker2D(body="crank"), Marker2D(body="bob")
    return Model(
        name="driven_crank",
        bodies=[
            RigidBody2D(name="crank", mass=1.0, inertia=0.1, position=(0.0, 0.0)),
            PointMass2D(name="bob", mass=0.5, position=(0.0, -1.0)),
        ],
        joints=[
            Revolute2D(name="pin", a=Marker2D(), b=crank),
            CoordinateDriver(name="motor", body="crank", coordinate="angle", motion=InputSignal(channel="angle")),
        ],
        forces=[
            SpringDamper2D(name="spring", a=Marker2D(body="crank", point=(0.3, 0.0)), b=bob, stiffness=50.0,
                           natural_length=1.0),
            CoordinateLoad(name="lift", body="bob", coordinate="y", load=InputSignal(channel="weight")),
        ],
        inputs=[Input(name="angle", unit="rad"), Input(name="weight", unit="N")],
    )  # fmt: skip


def read(slave):
    return {v.name: slave[v.name] for v in slave.variables.of_role("output")}


def feel(slave, name, amount):
    """Names of the outputs that differ, by more than the tolerances, when the input `name` differs by `amount` now."""
    before, snapshot = read(slave), slave.snapshot()
    slave.set_by_name({name: slave[name] + amount})
    after = read(slave)
    slave.restore(snapshot)
    return {key for key in before if abs(before[key] - after[key]) > 1e-6 * (1.0 + abs(before[key]))}


def half():
    """A wall that moves by inputs, and an anvil with a marker on it that it strikes."""
    model = load("split_wall", law="hertz").model
    output = MarkerOutput2D(name="far", marker=Marker2D(body="anvil", point=(-0.1, 0.0)))
    push = AppliedForce2D(name="wind", marker=Marker2D(body="anvil"), force_x=InputSignal(channel="wind"))
    inputs = (*model.inputs, Input(name="wind", unit="N"))
    return model.model_copy(update={"outputs": (output,), "forces": (*model.forces, push), "inputs": inputs})


CASES = {
    "half": (half(), 0.02),
    "ball": (ball_model(), 0.7),
    "impact law": (three_masses(NewtonImpact(restitution=0.5)), 0.5),
    "force law": (three_masses(Hertz(stiffness=1e4)), 0.5),
    "pendulum": (load("pendulum_stop").model, 0.9),
    "crank": (load("slider_crank_stop").model, 0.3),
    "driver": (driven_crank(), 0.2),
}


@pytest.mark.parametrize("name", CASES)
def test_dependencies_are_those_of_the_slave(name):
    """No output feels an input that it does not list, before, in and after contact; accelerations feel theirs."""
    model, t_end = CASES[name]
    slave = Slave(model)
    known = Dependencies(model, slave.variables)
    listed = {
        v.name: {o.name for o in slave.variables.of_role("output") if v in known.of_output(o)}
        for v in slave.variables.block("input")
    }
    slave.enter_initialization()
    slave.exit_initialization()
    felt = {name: set() for name in listed}
    steps = 12
    for k in range(steps):
        for channel in listed:
            for amount in (0.01, -1.0):
                felt[channel] |= feel(slave, channel, amount)
        slave.do_step(k * t_end / steps, (k + 1) * t_end / steps - k * t_end / steps)
    for channel, outputs in listed.items():
        assert felt[channel] <= outputs, channel
        if channel not in slave.drivers:
            assert any(name.endswith(("ay", "ax", "acceleration")) for name in felt[channel])


def test_motions_are_felt_at_the_start_only():
    slave = Slave(half())
    known = Dependencies(slave.model, slave.variables)

    def of(name):
        output = slave.variables.by_name[name]
        return [{v.name for v in f(output)} - {"stiffness", "restitution"} for f in (known.of_output, known.at_start)]

    motion = {"hammer_x", "hammer_vx"}
    assert of("blow.gap") == of("anvil.x") == [set(), motion | (of("anvil.x")[1] - motion)]
    assert of("anvil.ax") == of("far.ax") == [{"wind"}, of("anvil.ax")[1]] and motion | {"wind"} <= of("far.ax")[1]
    slave.enter_initialization()
    before = slave["blow.gap"]
    slave.set_by_name({"hammer_x": 0.02})
    assert slave["blow.gap"] == pytest.approx(before + 0.01, abs=1e-15)


def test_dependencies_tell_laws_and_springs_apart():
    """A constraint passes a force on at once, a spring and a force law do not."""
    for law, passes in ((NewtonImpact(restitution=0.5), True), (Hertz(stiffness=1e4), False)):
        slave = Slave(three_masses(law))
        known = Dependencies(slave.model, slave.variables)

        def of(name, known=known, slave=slave):
            return {v.name for v in known.of_output(slave.variables.by_name[name])}

        assert of("b.ax") == {"force"} and of("a.x") == of("a.vx") == of("energy.kinetic") == set()
        assert of("c.ax") == ({"force"} if passes else set())
        assert of("touch.normal_force") == ({"force"} if passes else set())
        assert of("rod.tension") == {"force"} and of("d.ax") == {"tug"}


@pytest.mark.parametrize("name", CASES)
def test_initial_values_depend_on_what_is_listed(name):
    """Other solver settings give the same initial values, bit for bit."""
    model, _ = CASES[name]
    first = Slave(model)
    first.enter_initialization()
    rows = []
    for settings in ({}, {"solver.rtol": 1e-3}, {"solver.atol": 1e-4}, {"solver.method": "irk"}):
        slave = Slave(model, variables=first.variables)
        slave.set_by_name(settings)
        slave.enter_initialization()
        rows.append(read(slave))
    assert rows[1:] == rows[:1] * 3


# limits and magnitudes


def test_limits_come_from_the_model_and_its_fields():
    model = ball_model().model_copy(
        update={"parameters": (
            Parameter(name="e", maximum=0.9, targets=["floor.law.restitution"]),
            Parameter(name="mass", unit="kg", targets=["ball.mass"]),
        )}
    )  # fmt: skip
    found = {v.name: (v.minimum, v.maximum) for v in Slave(model).variables.block("parameter")}
    assert found == {"e": (0.0, 0.9), "mass": (0.0, None)}


@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_nominal_values_follow_the_dimensions(scale):
    """A ball of 2 kg that falls 1 m: 2 kg, 1 m, sqrt(1/9.81) s; shrunk by a factor, all lengths shrink by it."""
    scales = Scales.of(ball_model(height=scale), None)
    assert (scales.mass, scales.length) == (2.0, scale)
    assert scales.time == pytest.approx(np.sqrt(scale / 9.81))
    assert scales.nominal("m") == pytest.approx(scale)
    assert scales.nominal("m/s2") == 10.0
    assert scales.nominal("N") == 20.0
    assert scales.nominal("mm") == pytest.approx(1e3 * scale)
    assert scales.nominal("1") is scales.nominal("rad") is scales.nominal("furlong") is scales.nominal("-") is None
    assert scales.nominal("J") == pytest.approx(20.0 * scale)


def test_nominal_values_are_round():
    assert [round_number(x) for x in (0.9, 3.4, 8.0, 2e-5, 130.0)] == [1.0, 5.0, 10.0, 2e-5, 100.0]


def compare_nominals(name, tmp_path):
    """Of the FMU of a scenario: every real output reaches a hundredth of its nominal value in the default experiment,
    and not a hundred times it, unless it stays zero but for rounding."""
    scenario = load(name)
    path = export_fmu(scenario, tmp_path / f"{name}.fmu", "3.0")
    variables = [v for v in read_model_description(path).modelVariables if v.causality == "output"]
    declared = {v.name: float(v.nominal or 1.0) for v in variables if v.type == "Float64"}
    result = simulate(
        scenario.model, scenario.t_end, scenario.method, scenario.rtol, scenario.atol, **scenario.options
    )  # fmt: skip
    seen = 0
    for channel, nominal in declared.items():
        reached = float(np.max(np.abs(result[channel])))
        if reached <= 1e-9 * nominal:
            continue
        seen += 1
        assert 0.01 * nominal <= reached <= 100.0 * nominal, (name, channel, nominal, reached)
    assert seen >= 5


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", ["rod_wall", "stick_slip", "sphere_beam", "split_wall", "hub_beam_stop"])
def test_nominal_values_are_near_what_comes(name, tmp_path):
    compare_nominals(name, tmp_path)


@pytest.mark.full
@pytest.mark.parametrize("name", names())
def test_nominal_values_are_near_what_comes_in_the_whole_catalogue(name, tmp_path):
    compare_nominals(name, tmp_path)


def test_before_anything_has_run_a_blow_gives_the_force():
    """A ball of 2 kg falls 1 m on a spring of 1 MN/m: v sqrt(k m), and half that speed's energy."""
    model = ball_model()
    model = model.model_copy(update={"contacts": (model.contacts[0].model_copy(update={"law": KelvinVoigt(
        stiffness=1e6, damping=0.0)}),), "parameters": ()})  # fmt: skip
    slave = Slave(model)
    found = estimates(slave.variables, slave.model, slave.settings, Simulation(model))
    speed = np.sqrt(9.81 * 1.0)
    assert found["floor.normal_force"] == pytest.approx(speed * np.sqrt(1e6 * 2.0), rel=1e-6)
    assert found["floor.dissipation"] == pytest.approx(0.5 * 2.0 * speed**2, rel=1e-6)


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_the_file_says_it(tmp_path, version):
    path = export_fmu(three_masses(NewtonImpact(restitution=0.5)), tmp_path / "m.fmu", version, t_end=1.0)
    assert validate_fmu(str(path)) == []
    description = read_model_description(path)
    variables = {v.name: v for v in description.modelVariables}
    assert float(variables["a.x"].nominal) == pytest.approx(2.0, rel=0.6)
    assert float(variables["mass"].min) == 0.0
    by_name = {u.variable.name: u for u in description.outputs}
    assert [v.name for v in by_name["b.ax"].dependencies] == ["force"]
    assert by_name["b.ax"].dependenciesKind == ["dependent"] and by_name["a.x"].dependencies == []
    initial = {u.variable.name: [v.name for v in u.dependencies] for u in description.initialUnknowns}
    assert initial["b.ax"] == ["mass", "force"] and initial["a.x"] == ["mass"]
    units = {u.name: u for u in description.unitDefinitions}
    assert {d.name for d in units["m"].displayUnits} == {"mm"}


def test_display_units_turn_into_their_unit(tmp_path):
    path = export_fmu(load("pendulum_stop"), tmp_path / "p.fmu", "3.0")
    description = read_model_description(path)
    units = {u.name: {d.name: float(d.factor) for d in u.displayUnits} for u in description.unitDefinitions}
    assert np.deg2rad(1.0) * units["rad"]["deg"] == pytest.approx(1.0)
    assert 2.0 * np.pi / 60.0 * units["rad/s"]["rev/min"] == pytest.approx(1.0)
    angle = next(v for v in description.modelVariables if v.name == "pendulum.angle")
    assert angle.displayUnit == "deg"


# terminals


def test_terminals_group_what_belongs_together():
    found = {t.name: t.members for t in terminals(driven_crank(), Slave(driven_crank()).variables)}
    assert found["motor"] == {"angle": "angle", "torque": "motor.reaction"}
    assert found["lift"] == {"force_y": "weight", "y": "bob.y", "vy": "bob.vy"}
    pendulum = load("pendulum_stop").model
    torque = {t.name: t.members for t in terminals(pendulum, Slave(pendulum).variables)}
    assert torque["drive"] == {
        "torque": "torque", "angle": "pendulum.angle", "angular_velocity": "pendulum.angular_velocity"
    }  # fmt: skip


def test_a_force_off_the_centre_has_no_motion_of_its_own():
    body = RigidBody2D(name="b", mass=1.0, inertia=1.0)
    force = AppliedForce2D(name="f", marker=Marker2D(body="b", point=(1.0, 0.0)), force_y=InputSignal(channel="u"))
    torque = AppliedTorque2D(name="t", body="b", torque=InputSignal(channel="w"))
    model = Model(bodies=[body], forces=[force, torque], inputs=[Input(name="u"), Input(name="w")])
    found = {t.name: t.members for t in terminals(model, Slave(model).variables)}
    assert found["f"] == {"force_y": "u"} and set(found["t"]) == {"torque", "angle", "angular_velocity"}


def test_terminals_are_written_as_the_schema_wants(tmp_path):
    from importlib.resources import files

    schema = etree.XMLSchema(etree.parse(str(files("fmpy") / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd")))
    path = export_fmu(driven_crank(), tmp_path / "m.fmu", "3.0", t_end=1.0)
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        assert archive.read("terminalsAndIcons/icon.png").startswith(b"\x89PNG")
        assert etree.fromstring(archive.read("terminalsAndIcons/icon.svg")).tag.endswith("svg")
    schema.assertValid(root)
    variables = {v.name for v in read_model_description(path).modelVariables}
    members = [m.get("variableName") for m in root.iter("TerminalMemberVariable")]
    assert members and set(members) <= variables
    # forces are flows: a force that is taken flows in, the one that answers a motion flows out
    kinds = {m.get("variableName"): m.get("variableKind") for m in root.iter("TerminalMemberVariable")}
    assert kinds["weight"] == "inflow" and kinds["motor.reaction"] == "outflow"
    assert kinds["angle"] == kinds["bob.y"] == kinds["bob.vy"] == "signal"


def test_what_flows_out_of_one_half_flows_into_the_other():
    """The halves of a mechanism: coupled by the members' names, their forces have the sum zero at every instant."""
    flanges = {}
    for name in ("split_striker", "split_wall"):
        model = load(name).model
        (flanges[name],) = terminals(model, Slave(model).variables)
    taken, given = flanges["split_striker"], flanges["split_wall"]
    assert taken.flows == {"force_x": "inflow"} and given.flows == {"force_x": "outflow"}
    # the striker is pushed back, to the right, by what the wall's half gives; its frame is pushed the same way
    wall = load("split_wall")
    slave = Slave(wall)
    slave.enter_initialization()
    slave.exit_initialization()
    position, velocity = given.members["x"], given.members["vx"]
    slave.set_by_name({position: slave[position] - 2.0 * wall.parameters["gap"], velocity: -1.0})
    slave.do_step(0.0, 0.001)
    assert slave[given.members["force_x"]] > 0.0


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_without_pillow_there_is_no_icon_but_all_else(tmp_path, monkeypatch, caplog, version):
    def none(drawing):
        raise ImportError("No module named 'PIL'")

    monkeypatch.setattr("tlismni.fmu_wrapper.pictures.to_png", none)
    with zipfile.ZipFile(export_fmu(driven_crank(), tmp_path / "m.fmu", version, t_end=1.0)) as archive:
        held = archive.namelist()
        assert not [name for name in held if name.endswith((".png", "icon.svg"))]
        assert ("terminalsAndIcons/terminalsAndIcons.xml" in held) == (version == "3.0")
    assert "the FMU gets no icon: that needs Pillow" in caplog.text
    assert validate_fmu(str(tmp_path / "m.fmu")) == []


# checkers


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_fmutool_finds_nothing_to_complain_about(tmp_path, caplog, version):
    checker = pytest.importorskip("fmu_manipulation_toolbox.checker")
    operations = pytest.importorskip("fmu_manipulation_toolbox.operations")
    path = export_fmu(driven_crank(), tmp_path / "m.fmu", version, t_end=1.0, method="bdf", order=2)
    fmu = operations.FMU(str(path))
    for check in (checker.OperationGenericCheck(), checker.OperationSemanticCheck()):
        fmu.apply_operation(check)
        assert not [r.getMessage() for r in caplog.records if r.levelname in ("ERROR", "WARNING", "CRITICAL")]
    assert caplog.records or check


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("name", "version"), list(zip(names(), cycle(("2.0", "3.0")))))
def test_every_scenario_is_described_validly(tmp_path, name, version):
    """A sample, each in one version; `-m full`: all, in the other one, too."""
    path = export_fmu(load(name), tmp_path / "x.fmu", version)
    assert validate_fmu(str(path)) == []


@pytest.mark.full
@pytest.mark.parametrize(("name", "version"), list(zip(names(), cycle(("3.0", "2.0")))))
def test_every_scenario_is_described_validly_in_the_other_version(tmp_path, name, version):
    path = export_fmu(load(name), tmp_path / "x.fmu", version)
    assert validate_fmu(str(path)) == []
