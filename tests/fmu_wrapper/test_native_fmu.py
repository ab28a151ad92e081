"""FMUs without Python: the same bits as those with it, by FMI 2.0 and 3.0, and where there is no Python at all."""

import ctypes
import os
import random
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu
from fmu_helpers import ball_model
from native_pair import TAKE_PYTHON, Pair, Side, scenario_pair
from tlismni.core import Model
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.errors import ExportError
from tlismni.fmu_wrapper.export import fmi2_platform, fmi3_platform
from tlismni.models import load, names

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
HERE = Path(__file__).parent
CC = shutil.which("cc")
WAYS = [(False, False), (False, True), (True, False), (True, True)]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "version"),
    [
        ("bouncing_ball", "2.0"),
        ("chain", "3.0"),
        ("slider_crank_stop", "2.0"),
        ("stick_slip", "3.0"),
        ("impact_oscillator", "3.0"),
        ("spatial_slider_crank_stop", "2.0"),
    ],
)
def test_the_same_bits_as_with_python(name, version, tmp_path):
    pair = scenario_pair(name, tmp_path, version)
    assert validate_fmu(str(pair.sides[0][0])) == []
    sides = pair.instances()
    draw, end = random.Random(5), load(name).t_end
    inputs = [n for n, v in sides[0].by_name.items() if v.causality == "input"]
    for side in sides:
        side.begin()
    for k in range(60):
        h = end / 60.0 * draw.uniform(0.2, 1.5)
        change = {n: draw.uniform(-20.0, 20.0) for n in inputs if draw.random() < 0.4}
        for side in sides:
            side.set(**change)
        if draw.random() < 0.3:  # outputs at once, with the new inputs
            assert sides[0].read() == sides[1].read(), k
        assert sides[0].step(h) == sides[1].step(h)
        if draw.random() < 0.7:
            assert sides[0].read() == sides[1].read(), k


@pytest.mark.sampled(2)
@pytest.mark.parametrize("way", WAYS)
def test_events_and_early_return(way, tmp_path):
    event_mode, early_return = way
    pair = scenario_pair("woodpecker", tmp_path, "3.0")
    sides = pair.instances(eventModeUsed=event_mode, earlyReturnAllowed=early_return)
    ends = set()
    for side in sides:
        side.begin()
    while sides[0].time < 0.3:
        ended = sides[0].step(0.01)
        assert ended == sides[1].step(0.01)
        ends.add(ended[:3])
        assert sides[0].read() == sides[1].read()
        if ended[0]:
            for side in sides:
                side.fmu.enterEventMode()
            assert sides[0].leave_event_mode() == sides[1].leave_event_mode()
            assert sides[0].read() == sides[1].read()
    assert (any(e[2] for e in ends), any(e[0] for e in ends)) == (early_return, event_mode and early_return)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_going_back_here_and_in_another_instance(version, tmp_path):
    pair = scenario_pair("slider_crank_stop", tmp_path, version)
    here, there = pair.instances()[0], pair.instances()[0]
    names = ("getFMUState", "setFMUState", "freeFMUState", "serializeFMUState", "deserializeFMUState")
    if version == "2.0":
        names = ("getFMUstate", "setFMUstate", "freeFMUstate", "serializeFMUstate", "deSerializeFMUstate")
    get, put, free, write, read = names
    here.begin()
    there.begin()
    kept, rows = [], []
    for k in range(20):
        here.set(load=float(k % 7)) if "load" in here.by_name else None
        kept.append((here.time, getattr(here.fmu, get)()))
        here.step(0.05)
        rows.append(here.read())
    for first in (16, 2, 9):
        time, state = kept[first]
        getattr(here.fmu, put)(state)
        getattr(there.fmu, put)(getattr(there.fmu, read)(getattr(here.fmu, write)(state)))
        here.time = there.time = time
        for k in range(first, 20):
            for side in (here, there):
                side.set(load=float(k % 7)) if "load" in here.by_name else None
                side.step(0.05)
                assert side.read() == rows[k]
    state = kept[3][1]
    getattr(here.fmu, free)(state)
    data = bytearray(getattr(here.fmu, write)(kept[4][1]))
    data[len(data) // 2] ^= 1
    with pytest.raises(FMICallException):
        getattr(here.fmu, read)(bytes(data))


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_parameters_are_set_before_the_run(version, tmp_path):
    """The bits of the FMU with Python; a reset and a stored state take them along."""
    pair = scenario_pair("impact_oscillator", tmp_path, version)
    sides = pair.instances()
    for side in sides:
        side.set(restitution=0.37, frequency=2.2)
        side.begin(damping_ratio=0.11)
    for _ in range(12):
        assert sides[0].step(0.9) == sides[1].step(0.9)
        assert sides[0].read() == sides[1].read()
    side, number = sides[0], sides[0].by_name["restitution"].valueReference
    get = side.fmu.getFloat64 if side.three else side.fmu.getReal
    assert get([number]) == [0.37]
    for wrong in ({"restitution": 0.5}, {"restitution": 2.0}):
        with pytest.raises(FMICallException):
            side.set(**wrong)
    side.fmu.reset()
    side.time = 0.0
    with pytest.raises(FMICallException):
        side.set(restitution=2.0)
    plain = pair.instances()[1]
    for s in (side, plain):
        s.begin()
        s.step(7.0)
    assert side.read() == plain.read()


def test_what_is_fixed_is_named(tmp_path, caplog):
    with caplog.at_level("INFO", logger="tlismni.fmu_wrapper.export"):
        path = export_fmu(load("bricard"), tmp_path / "x.fmu", native=True)
    assert re.search(r"fixed in the FMU: .*\bmass\b.*: the start follows from it", caplog.text)
    found = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
    assert found["mass"].variability == "constant" and found["solver.rtol"].variability == "constant"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_derivatives_are_those_of_the_fmu_with_python(version, tmp_path):
    pair = scenario_pair("slider_crank_stop", tmp_path, version)
    sides = pair.instances()
    names = ("crank.ax", "crank.angular_acceleration", "stop.normal_force", "slider.x")
    weights = (1.0, 0.5, -2.0, 0.0)
    for side in sides:
        side.begin(torque=1.5)
    for _ in range(6):
        found = []
        for side in sides:
            side.step(0.07)
            fmu, known = side.fmu, [side.by_name["torque"].valueReference]
            unknown = [side.by_name[name].valueReference for name in names]
            along = fmu.getDirectionalDerivative(unknown, known, [0.3])
            if side.three:
                (adjoint,) = fmu.getAdjointDerivative(unknown, known, list(weights), nSensitivity=1)
                assert adjoint == pytest.approx(np.dot(weights, along) / 0.3, rel=1e-9)
                rates = fmu.getOutputDerivatives(unknown[3:], [1])
                with pytest.raises(FMICallException):  # of accelerations there are none
                    fmu.getOutputDerivatives(unknown[:1], [1])
            else:
                rates = fmu.getRealOutputDerivatives(unknown[3:], [1])
            found.append((list(along), list(rates)))
            with pytest.raises(FMICallException):
                fmu.getDirectionalDerivative(known, unknown[:1], [1.0])
        assert found[0] == found[1] and found[0][0][1] != 0.0 and found[0][0][3] == 0.0
        assert sides[0].read() == sides[1].read()


def test_intermediate_updates(tmp_path):
    """A host that looks at each step of the solver, and ends one early, sees the same of both."""
    pair, seen = scenario_pair("slider_crank_stop", tmp_path, "3.0"), ([], [])
    for k in range(2):
        holder = {}

        def update(environment, time, set_requested, get_allowed, finished, may_return, returns, return_time, k=k,
                   holder=holder):  # fmt: skip
            side = holder["side"]
            seen[k].append((time, *side.fmu.getFloat64([side.by_name["crank.angular_velocity"].valueReference])))
            if len(seen[k]) % 7 == 0:
                side.set(torque=float(len(seen[k]) % 5))
            returns[0], return_time[0] = bool(may_return and len(seen[k]) % 11 == 0), time

        _, unzipped, description = pair.sides[k]
        torque = next(v.valueReference for v in description.modelVariables if v.name == "torque")
        holder["side"] = side = Side("3.0", unzipped, description, earlyReturnAllowed=True,
                                     requiredIntermediateVariables=[torque], intermediateUpdate=update)  # fmt: skip
        side.begin()
        for _ in range(12):
            seen[k].append(side.step(0.02))
        seen[k].append(side.read())
    assert seen[0] == seen[1] and len(seen[0]) > 30


def test_reset_is_a_new_instance(tmp_path):
    pair = scenario_pair("bouncing_ball", tmp_path, "2.0")
    side, fresh = pair.instances()[0], pair.instances()[0]
    side.begin()
    side.step(1.0)
    side.fmu.reset()
    side.time = 0.0
    for s in (side, fresh):
        s.begin()
        s.step(0.7)
    assert side.read() == fresh.read()


def test_errors_leave_a_living_instance(tmp_path):
    """Wrong calls are errors with a reason, change nothing, and the run goes on."""
    pair = Pair(ball_model(), tmp_path, "2.0", t_end=2.0)
    side, plain = pair.instances()[0], pair.instances()[0]
    vr = {name: v.valueReference for name, v in side.by_name.items()}
    with pytest.raises(FMICallException):
        side.step(0.1)
    for s in (side, plain):
        s.begin()
        s.step(0.25)
    for wrong in (
        lambda: side.fmu.doStep(0.1, 0.1), lambda: side.fmu.doStep(0.25, -0.1), lambda: side.fmu.doStep(0.25, np.nan),
        lambda: side.fmu.getReal([9999]), lambda: side.fmu.getInteger([vr["ball.y"]]),
        lambda: side.fmu.setReal([vr["solver.rtol"]], [1e-3]), lambda: side.fmu.setReal([vr["push"]], [np.inf]),
        lambda: side.fmu.setReal([vr["push"], vr["ball.y"]], [5.0, 1.0]), lambda: side.fmu.setupExperiment(),
        lambda: side.fmu.enterInitializationMode(), lambda: side.fmu.getString([1]),
        lambda: side.fmu.setRealInputDerivatives([vr["push"]], [3], [1.0]),
    ):  # fmt: skip
        with pytest.raises(FMICallException):
            wrong()
    for s in (side, plain):
        s.step(0.5)
    assert side.read() == plain.read()


def test_wrong_token_and_missing_resources(tmp_path):
    pair = Pair(ball_model(), tmp_path, "2.0", t_end=2.0)
    _, unzipped, description = pair.sides[0]
    identifier = description.coSimulation.modelIdentifier
    with pytest.raises(Exception, match=r"[Ii]nstantiate"):
        FMU2Slave(guid="{other}", unzipDirectory=unzipped, modelIdentifier=identifier).instantiate()
    Path(unzipped, "resources", "model.image").unlink()
    with pytest.raises(Exception, match=r"[Ii]nstantiate"):
        FMU2Slave(guid=description.guid, unzipDirectory=unzipped, modelIdentifier=identifier).instantiate()


def test_it_holds_numbers_not_the_model(tmp_path):
    path = export_fmu(load("pendulum_stop"), tmp_path / "x.fmu", "3.0", native=True)
    with zipfile.ZipFile(path) as archive:
        held = sorted(archive.namelist())
    folder = f"binaries/{fmi3_platform()}/pendulum_stop"
    assert [name for name in held if not name.startswith(("terminalsAndIcons", "documentation", folder))] == [
        "modelDescription.xml", "resources/model.image", "resources/variables.bin",
    ]  # fmt: skip
    description = fmpy.read_model_description(str(path))
    assert not description.coSimulation.needsExecutionTool
    assert [v.name for v in description.modelVariables if v.causality == "parameter"] == [
        "length", "mass", "gravity", "start_angle", "stop_angle", "restitution",
    ]  # fmt: skip


def test_with_sources_it_holds_the_model(tmp_path):
    path = export_fmu(load("pendulum_stop"), tmp_path / "x.fmu", "3.0", native=True, sources=True)
    with zipfile.ZipFile(path) as archive:
        assert Model.from_json(archive.read("resources/model.json").decode()) == load("pendulum_stop").model
        assert "documentation/index.html" in archive.namelist()
    for wrong in ({}, {"native": True, "protect": True}):
        with pytest.raises(ExportError, match="sources are for FMUs without Python"):
            export_fmu(load("pendulum_stop"), tmp_path / "y.fmu", sources=True, **wrong)


@pytest.mark.parametrize("name, text", [("split_wall", "motion of a driver"), ("four_bar", "singular position")])
def test_what_takes_python_is_refused_by_name(name, text, tmp_path):
    with pytest.raises(ExportError, match=f"'{name}' cannot be an FMU without Python: .*{text}"):
        export_fmu(load(name), tmp_path / "x.fmu", native=True)
    assert not list(tmp_path.iterdir())


def test_no_bundle(tmp_path):
    with pytest.raises(ExportError, match="no package to bundle"):
        export_fmu(load("pendulum"), tmp_path / "x.fmu", "3.0", native=True, bundle=True)


def test_arrays_are_their_scalars(tmp_path):
    """Values, derivatives along inputs and in time of vectors, mixed with scalars: those of the FMU with Python."""
    pair = Pair(load("slider_crank_stop", driven=True), tmp_path, "3.0", arrays=True)
    assert validate_fmu(str(pair.sides[0][0])) == []
    found = []
    for side in pair.instances():
        fmu, arrays = side.fmu, [v for v in side.by_name.values() if v.dimensions]
        side.begin()
        side.set(torque=0.3)
        side.step(0.05)
        references, torque = [v.valueReference for v in arrays], [side.by_name["torque"].valueReference]
        count = 2 * len(arrays)
        mixed = [side.by_name["time"].valueReference, *references, side.by_name["crank.x"].valueReference]
        values = fmu.getFloat64(mixed, nValues=count + 2)
        moving = [v.valueReference for v in arrays if v.name.endswith(("position", "velocity"))]
        rates, along, back = (ctypes.c_double * count)(), (ctypes.c_double * count)(), (ctypes.c_double * 1)()
        unknowns, known = (ctypes.c_uint32 * len(references))(*references), (ctypes.c_uint32 * 1)(*torque)
        fmu.fmi3GetOutputDerivatives(
            fmu.component, (ctypes.c_uint32 * len(moving))(*moving), len(moving),
            (ctypes.c_int32 * len(moving))(*[1] * len(moving)), rates, 2 * len(moving),
        )  # fmt: skip
        fmu.fmi3GetDirectionalDerivative(
            fmu.component, unknowns, len(references), known, 1, (ctypes.c_double * 1)(1.0), 1, along, count
        )
        fmu.fmi3GetAdjointDerivative(
            fmu.component, unknowns, len(references), known, 1, (ctypes.c_double * count)(*range(1, count + 1)), count,
            back, 1,
        )  # fmt: skip
        assert back[0] == pytest.approx(sum((k + 1) * x for k, x in enumerate(along)), rel=1e-12) != 0.0
        with pytest.raises(FMICallException):
            fmu.getFloat64(references)  # room for one number each
        with pytest.raises(FMICallException):
            fmu.setFloat64(references[:1], [0.0, 0.0])
        place = 1 + 2 * [v.name for v in arrays].index("crank.position")
        scalars = fmu.getFloat64([side.by_name[f"crank.{x}"].valueReference for x in ("x", "y")])
        assert values[place : place + 2] == scalars and values[-1] == scalars[0] and values[0] == 0.05
        found.append([np.array(list(x)).tobytes() for x in (values, rates, along)])
    assert len(moving) > 5 and found[0] == found[1]


def jail_of(folder, *programs):
    """A folder with these files and what they are linked with, and nothing else."""
    found = {str(p) for p in programs}
    for program in programs:
        listed = subprocess.run(["ldd", str(program)], capture_output=True, text=True, check=True).stdout
        found |= set(re.findall(r"(/\S+)", listed))
    for name in found:
        target = folder / name.lstrip("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists():
            shutil.copy(os.path.realpath(name), target)
    assert not [p for p in folder.rglob("*") if "python" in p.name.lower() and "pytest" not in str(p)]


ALONE = [
    "woodpecker",
    *(pytest.param(x, marks=pytest.mark.full) for x in names() if x not in (*TAKE_PYTHON, "woodpecker")),
]


@pytest.mark.skipif(CC is None or os.name != "posix" or os.getuid() != 0, reason="needs cc, and root for chroot")
@pytest.mark.parametrize("name", ALONE)
def test_where_there_is_no_python(name, tmp_path):
    """A C host in a root folder with the C library alone."""
    headers, scenario = Path(fmpy.__file__).parent / "c-code", load(name)
    step = 0.01 if name == "woodpecker" else scenario.t_end / 64.0
    pair = Pair(scenario, tmp_path, "2.0")
    _, unzipped, description = pair.sides[0]
    jail = tmp_path / "jail"
    library = Path("/fmu/binaries", fmi2_platform(), f"{description.coSimulation.modelIdentifier}.so")
    shutil.copytree(unzipped, jail / "fmu")
    host = tmp_path / "host_of_native"
    subprocess.run(
        [CC, "-Wall", "-Werror", f"-I{headers}", "-o", str(host), str(HERE / "host_native.c"), "-ldl"], check=True
    )
    jail_of(jail, host, jail / str(library).lstrip("/"))
    references = [str(v.valueReference) for v in description.modelVariables if v.causality == "output"
                  and v.type == "Real"]  # fmt: skip
    command = [
        "chroot",
        str(jail),
        str(host),
        str(library),
        "file:///fmu/resources",
        description.guid,
        repr(step),
        "60",
    ]
    done = subprocess.run([*command, *references], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr + done.stdout
    found = [[float.fromhex(x) for x in line.split()] for line in done.stdout.splitlines()]
    side = pair.instances()[1]
    side.begin()
    for k, row in enumerate(found):
        side.fmu.doStep(step * k, step)
        assert row == side.fmu.getReal([int(r) for r in references])
    assert len(found) == 60
