"""FMI 3.0 with the solver: bit for bit the simulation, impacts at their instants, states elsewhere, a C host."""

import ctypes
import json
import os
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from fmu_helpers import ball_model
from tlismni.core import Simulation
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.fmu_wrapper.errors import ExportError
from tlismni.fmu_wrapper.export import fmi3_platform, shim_path
from tlismni.fmu_wrapper.in_process3 import InProcess3
from tlismni.models import load

HERE = Path(__file__).parent
CC = shutil.which("cc")
STEP, STEPS = 0.1, 20
WAYS = [(False, False), (False, True), (True, False), (True, True)]


class Fmu3:
    """An FMI 3.0 FMU, exported and unzipped, with its instances."""

    def __init__(self, source, folder, **solver):
        self.path = export_fmu(source, folder / "model.fmu", "3.0", **solver)
        self.open(fmpy.extract(str(self.path), unzipdir=str(folder / "unzipped")))

    def open(self, unzipped):
        self.unzipped = unzipped
        self.description = fmpy.read_model_description(unzipped)
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.identifier = self.description.coSimulation.modelIdentifier
        return self

    def instance(self, event_mode=False, early_return=False, **reals):
        fmu = FMU3Slave(guid=self.description.guid, unzipDirectory=self.unzipped, modelIdentifier=self.identifier)
        fmu.instantiate(eventModeUsed=event_mode, earlyReturnAllowed=early_return)
        return self.start(fmu, event_mode, **reals)

    def start(self, fmu, event_mode=False, **reals):
        for name, value in reals.items():
            fmu.setFloat64([self.vr[name]], [value])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        if event_mode:
            leave_event_mode(fmu)
        return fmu

    def step(self, fmu, first, last, event_mode=False):
        """Values after each step and at each early return, the push varying."""
        rows = []
        for k in range(first, last):
            fmu.setFloat64([self.vr["push"]], [float(k % 3)])
            t, end = k * STEP, k * STEP + STEP
            while t < end:
                due, _, _, t = fmu.doStep(t, end - t)
                rows.append(fmu.getFloat64([self.vr[n] for n in ("time", "ball.y", "ball.vy", "energy.balance")]))
                if due:
                    fmu.enterEventMode()
                    leave_event_mode(fmu)
        return rows


def leave_event_mode(fmu):
    while fmu.updateDiscreteStates()[0]:
        pass
    fmu.enterStepMode()


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return Fmu3(ball_model("ball3"), tmp_path_factory.mktemp("ball3"), t_end=2.0)


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory):
    return Fmu3(load("pendulum_stop"), tmp_path_factory.mktemp("pendulum3"))


def simulation_of(scenario):
    return Simulation(scenario.model, scenario.method, scenario.rtol, scenario.atol, **scenario.options)


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "name", ["bouncing_ball", "double_pendulum_wall", "newtons_cradle", "slider_crank_stop", "stick_slip"]
)
def test_scenarios_through_the_binary_are_the_simulation(tmp_path, name):
    """All real channels, bit for bit, over an irregular grid that passes the first events."""
    scenario = load(name)
    fmu = Fmu3(scenario, tmp_path)
    instance, simulation = fmu.instance(), simulation_of(scenario)
    columns = [c.name for c in simulation.channels if c.kind == "real"]
    real = [k for k, c in enumerate(simulation.channels) if c.kind == "real"]
    t, end = 0.0, min(scenario.t_end, 1.0)
    for h in end / 12 * np.random.default_rng(4).uniform(0.5, 1.5, 12):
        instance.doStep(t, h)
        simulation.advance(t + h)
        t = t + h
        assert instance.getFloat64([fmu.vr[c] for c in columns]) == simulation.values()[real].tolist()
    assert instance.getInt32([fmu.vr["solver.events"]]) == [len(simulation.events)]
    instance.freeInstance()


@pytest.mark.parametrize("irregular", [False, True], ids=["fixed", "irregular"])
def test_fmpy_gives_the_simulation_bit_for_bit(ball, irregular):
    signal = None
    if irregular:  # fmpy steps to the instants where an input jumps, and from there on to its own grid
        jumps = np.repeat(np.sort(np.random.default_rng(1).uniform(0.01, 1.99, 40)), 2)
        signal = np.array(
            [(t, k // 2 % 5) for k, t in enumerate([0.0, *jumps, 2.0])], dtype=[("time", float), ("push", float)]
        )
    columns = [name for name in ball.vr if ball.vr[name] > ball.vr["push"]]
    given = {
        "output": ["push", "solver.events", *columns], "input": signal, "output_interval": 0.05,
        "start_values": {"restitution": 0.8}, "fmi_type": "CoSimulation",
    }  # fmt: skip
    binary = fmpy.simulate_fmu(str(ball.path), **given)
    in_process = fmpy.simulate_fmu(ball.unzipped, fmu_instance=InProcess3.of(ball.unzipped), **given)
    assert binary.tobytes() == in_process.tobytes()

    simulation = Simulation(ball_model("ball3").with_parameters({"restitution": 0.8}))
    index = [c.name for c in simulation.channels]
    simulation.set_inputs({"push": binary["push"][0]})
    rows = [simulation.values()]
    for (t0, t1), push in zip(pairwise(binary["time"]), binary["push"][1:], strict=True):
        simulation.set_inputs({"push": push})
        simulation.advance(t0 + (t1 - t0))
        rows.append(simulation.values())
    table = np.array(rows)
    for name in columns:
        assert (binary[name] == table[:, index.index(name)]).all(), name
    assert binary["solver.events"][-1] == len(simulation.events) > 2


@pytest.mark.parametrize(("event_mode", "early"), WAYS)
def test_impacts_at_their_instants(pendulum, event_mode, early):
    """fmpy's own loop; the reference is stepped in this process over the same communication points."""
    scenario = load("pendulum_stop")
    interval = scenario.t_end / 20
    result = fmpy.simulate_fmu(
        str(pendulum.path), use_event_mode=event_mode, early_return_allowed=early, output_interval=interval,
        output=["pendulum.angular_velocity", "pendulum.angle", "solver.events"],
    )  # fmt: skip
    reference = simulation_of(scenario)
    column = [c.name for c in reference.channels].index("pendulum.angle")
    regular = [t for t in np.unique(result["time"]) if abs(t / interval - round(t / interval)) < 1e-9]
    assert len(regular) == 21
    for t in regular:
        reference.advance(t)
        here = result["pendulum.angle"][result["time"] == t]
        assert here == pytest.approx([reference.values()[column]] * len(here), rel=0.0, abs=1e-13)
    impacts = [e.t for e in reference.events]
    stops = sorted(set(np.unique(result["time"])) - set(regular))
    assert len(impacts) == result["solver.events"][-1] > 2
    assert stops == pytest.approx(impacts if early else [], rel=0.0, abs=1e-14)
    for t in stops:
        speeds = result["pendulum.angular_velocity"][result["time"] == t]
        assert len(speeds) == (2 if event_mode else 1)
        assert not event_mode or speeds[0] * speeds[1] < 0.0  # both sides of the impact


@pytest.mark.parametrize("way", WAYS)
def test_rollback_at_random_instants_is_bit_equal(ball, way):
    """Before and after impacts; with early return also at them. Reset equals a new instance."""
    fmu = ball.instance(*way)
    whole = ball.step(fmu, 0, STEPS)
    fmu.reset()
    ball.start(fmu, way[0])
    rng, states = np.random.default_rng(2), []
    for k in range(STEPS):
        states.append(fmu.getFMUState())
        ball.step(fmu, k, k + 1)
    for k in rng.integers(0, STEPS, 12):
        fmu.setFMUState(states[k])
        assert ball.step(fmu, int(k), STEPS) == [row for row in whole if row[0] > k * STEP * (1.0 + 1e-12)]
    fmu.freeInstance()


def test_a_state_survives_the_process(ball, tmp_path):
    script = """
import sys, json
sys.path.insert(0, sys.argv[1])
from test_fmi3_real import Fmu3, STEPS
from pathlib import Path
ball = object.__new__(Fmu3).open(sys.argv[2])
instance = ball.instance(True, True)
instance.setFMUState(instance.deserializeFMUState(Path(sys.argv[3]).read_bytes()))
print(json.dumps([[x.hex() for x in row] for row in ball.step(instance, 5, STEPS)]))
"""
    fmu = ball.instance(True, True, restitution=0.9)
    ball.step(fmu, 0, 5)
    (tmp_path / "state").write_bytes(fmu.serializeFMUState(fmu.getFMUState()))
    rows = ball.step(fmu, 5, STEPS)
    command = [sys.executable, "-c", script, str(HERE), ball.unzipped, str(tmp_path / "state")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [[x.hex() for x in row] for row in rows]


def test_the_command_of_fmpy(pendulum, tmp_path):
    table = tmp_path / "x.csv"
    command = [sys.executable, "-m", "fmpy", "simulate", str(pendulum.path), "--output-file", str(table)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stdout + done.stderr
    result = np.genfromtxt(table, delimiter=",", names=True, deletechars="")
    assert result["time"][-1] == pytest.approx(load("pendulum_stop").t_end)
    assert abs(result["energy.balance"]).max() < 1e-3 and result["solver.events"][-1] > 0


# a host that is no Python


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    if CC is None:
        pytest.skip("needs a C compiler")
    program = tmp_path_factory.mktemp("host3") / "host3"
    headers = Path(fmpy.__file__).parent / "c-code"  # the standard's own
    command = [CC, "-Wall", "-Werror", f"-I{headers}", "-o", str(program), str(HERE / "host3.c"), "-ldl"]
    subprocess.run(command, check=True)
    return program


def run_host(host, fmu, token=None):
    library = Path(fmu.unzipped, "binaries", fmi3_platform(), fmu.identifier + shim_path().suffix)
    resources = os.path.join(fmu.unzipped, "resources") + os.sep
    arguments = [host, library, resources, token or fmu.description.guid, fmu.vr["ball.y"], STEP, STEPS]
    kept = {k: v for k, v in os.environ.items() if k in ("HOME", "NUMBA_CACHE_DIR")}  # nothing of this Python
    return subprocess.run(list(map(str, arguments)), capture_output=True, text=True, timeout=1200, env=kept)


def test_a_host_without_python(host, ball):
    """Steps with event mode and early return, rolls back over the impacts, and equals the simulation."""
    done = run_host(host, ball)
    assert done.returncode == 0, done.stdout + done.stderr
    *lines, last = done.stdout.splitlines()
    assert last == "end"
    rows = [tuple(float.fromhex(x) for x in line.split()[1:]) for line in lines]
    half = len(rows) // 2
    assert rows[:half] == rows[half:]  # again, from the state of the start
    simulation = Simulation(ball_model("ball3"))
    index = [c.name for c in simulation.channels].index("ball.y")
    kinds = [line.split()[0] for line in lines[:half]]
    for kind, (t, y) in zip(kinds, rows[:half], strict=True):
        if kind == "step":
            simulation.advance(t)
            assert simulation.values()[index] == pytest.approx(y, rel=0.0, abs=1e-13)
    events = [t for kind, (t, _) in zip(kinds, rows[:half], strict=True) if kind == "event"]
    assert events == pytest.approx([e.t for e in simulation.events], rel=0.0, abs=1e-14) and len(events) >= 2


def test_a_host_without_python_hears_what_is_wrong(host, ball):
    done = run_host(host, ball, token="{wrong}")
    assert done.returncode == 4
    assert done.stdout.startswith(
        "log 3 logStatusError fmi3InstantiateCoSimulation: FmuValueError: the instantiation token given is '{wrong}'"
    )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("event_mode", [False, True])
def test_steps_that_the_binary_makes_alone_are_those_of_the_slave(tmp_path, event_mode):
    """On a grid far finer than the solver's steps most of them never reach Python: nothing may tell the two apart."""
    fmu = Fmu3(ball_model(), tmp_path, rtol=1e-8)
    binary = fmu.instance(event_mode=event_mode, early_return=event_mode)
    slave = Slave(ball_model(), rtol=1e-8, t_end=20.0, event_mode=event_mode, early_return=event_mode)
    slave.enter_initialization()
    slave.exit_initialization()
    if event_mode:
        slave.update_discrete_states()
        slave.enter_step_mode()
    random, t, stored = np.random.default_rng(3), 0.0, None
    for _ in range(3000):
        h = float(random.choice([1e-5, 1e-3, 3e-3]))
        due, _, early, last = binary.doStep(t, h)
        end = slave.do_step(t, h)
        assert (due, early, last) == (end.event_due, end.early, end.time)
        t = last
        if due:
            binary.enterEventMode()
            slave.enter_event_mode()
            assert binary.updateDiscreteStates()[0] == slave.update_discrete_states()
            binary.enterStepMode()
            slave.enter_step_mode()
        what = random.integers(40)
        if what == 0:
            push = float(random.integers(-3, 3))
            binary.setFloat64([fmu.vr["push"]], [push])
            slave.set_by_name({"push": push})
        elif what == 1:
            assert binary.getFloat64([fmu.vr["ball.y"], fmu.vr["time"]]) == [slave["ball.y"], t]
        elif what == 2:
            stored = t, binary.getFMUState(), slave.snapshot()
        elif what == 3 and stored is not None and random.random() < 0.1:
            t = stored[0]
            binary.setFMUState(stored[1])
            slave.restore(stored[2])
            assert binary.getFloat64([fmu.vr["time"]]) == [t]
        elif what == 4:
            for wrong in ((t, -h), (t + 0.5, h), (t - 0.5, h), (float("nan"), h), (t, float("nan")), (t, 1e-30)):
                with pytest.raises(FMICallException):
                    binary.doStep(*wrong)
            assert binary.getFloat64([fmu.vr["time"]]) == [t]
    assert binary.getInt32([fmu.vr["solver.events"]]) == [slave["solver.events"]] and slave["solver.events"] > 3
    binary.terminate()
    assert binary.getFloat64([fmu.vr["time"], fmu.vr["ball.vy"]]) == [t, slave["ball.vy"]]
    binary.freeInstance()


def test_flags_of_a_step_that_are_null_are_refused(ball):
    """By the first step, which Python makes, and by one that the binary could make alone."""
    fmu = ball.instance()
    step = ctypes.CDLL(fmu.dll._name).fmi3DoStep
    step.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_bool, *[ctypes.c_void_p] * 4]
    component = fmu.component if isinstance(fmu.component, int) else fmu.component.value
    assert step(component, 0.0, 1e-5, True, None, None, None, None) == 3
    for k in range(3):
        fmu.doStep(k * 1e-5, 1e-5)
    assert step(component, 3e-5, 1e-5, True, None, None, None, None) == 3
    fmu.doStep(3e-5, 1e-5)
    assert fmu.getFloat64([ball.vr["time"]]) == [pytest.approx(4e-5)]
    fmu.freeInstance()


def test_arrays_are_their_scalars(tmp_path):
    """Vectors of bodies and joints: values, dependencies and derivatives of the elements, two behind one reference."""
    fmu = Fmu3(load("slider_crank_stop", driven=True), tmp_path, arrays=True)
    assert validate_fmu(str(fmu.path)) == []
    arrays = {v.name: v for v in fmu.description.modelVariables if v.dimensions}
    assert {"crank.position", "crank.velocity", "crank.acceleration", "rod.position"} <= set(arrays)
    parts = {
        "position": ("x", "y"),
        "velocity": ("vx", "vy"),
        "acceleration": ("ax", "ay"),
        "force": ("force_x", "force_y"),
    }
    instance = fmu.instance()
    instance.setFloat64([fmu.vr["torque"]], [0.3])
    instance.doStep(0.0, 0.05)
    units = {v.name: v.unit for v in fmu.description.modelVariables}
    for name, array in arrays.items():
        owner, _, vector = name.rpartition(".")
        scalars = [f"{owner}.{part}" for part in parts[vector]]
        references = [fmu.vr[scalar] for scalar in scalars]
        assert instance.getFloat64([array.valueReference], nValues=2) == instance.getFloat64(references)
        assert {units[scalar] for scalar in scalars} == {array.unit}
    mixed = [fmu.vr["time"], fmu.vr["crank.position"], fmu.vr["crank.x"]]
    values = instance.getFloat64(mixed, nValues=4)
    assert values[0] == 0.05 and values[1] == values[3]
    gradient = instance.getDirectionalDerivative([fmu.vr["crank.ax"], fmu.vr["crank.ay"]], [fmu.vr["torque"]], [1.0])
    assert any(gradient)
    with pytest.raises(FMICallException):
        instance.getFloat64([fmu.vr["crank.position"]])  # room for one
    with pytest.raises(FMICallException):
        instance.setFloat64([fmu.vr["crank.position"]], [0.0, 0.0])
    unknowns = {u.variable.name: u for u in fmu.description.outputs}
    felt = {v.name for v in unknowns["crank.acceleration"].dependencies}
    assert felt == {v.name for part in ("ax", "ay") for v in unknowns[f"crank.{part}"].dependencies} == {"torque"}
    instance.freeInstance()


def test_arrays_are_left_out_unless_asked_for(ball, tmp_path):
    assert not any(v.dimensions for v in ball.description.modelVariables)
    with pytest.raises(ExportError, match=r"arrays were asked of FMI 2\.0"):
        export_fmu(ball_model(), tmp_path / "x.fmu", "2.0", arrays=True)


def test_derivatives_of_arrays_are_those_of_their_elements(tmp_path):
    fmu = Fmu3(load("slider_crank_stop", driven=True), tmp_path, arrays=True)
    instance = fmu.instance()
    instance.setFloat64([fmu.vr["torque"]], [0.3])
    instance.doStep(0.0, 0.05)
    known = [fmu.vr["torque"]]
    scalars, array = [fmu.vr["crank.ax"], fmu.vr["crank.ay"]], [fmu.vr["crank.acceleration"]]
    forward = instance.getDirectionalDerivative(scalars, known, [1.0])
    values = (ctypes.c_double * 1)()
    for unknowns in (scalars, array):
        instance.fmi3GetAdjointDerivative(
            instance.component, (ctypes.c_uint32 * len(unknowns))(*unknowns), len(unknowns),
            (ctypes.c_uint32 * 1)(*known), 1, (ctypes.c_double * 2)(2.0, -3.0), 2, values, 1,
        )  # fmt: skip
        assert values[0] == pytest.approx(2.0 * forward[0] - 3.0 * forward[1], rel=1e-12) != 0.0
    rates = (ctypes.c_double * 3)()
    mixed = [fmu.vr["crank.y"], fmu.vr["crank.position"]]
    instance.fmi3GetOutputDerivatives(
        instance.component, (ctypes.c_uint32 * 2)(*mixed), 2, (ctypes.c_int32 * 2)(1, 1), rates, 3
    )
    vx, vy = instance.getFloat64([fmu.vr["crank.vx"], fmu.vr["crank.vy"]])
    assert list(rates) == [vy, vx, vy]
    instance.freeInstance()
