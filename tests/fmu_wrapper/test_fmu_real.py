"""FMUs that run the solver: in fmpy, in a host without Python, across processes; bit for bit the simulation."""

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
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu
from fmu_helpers import ball_model
from tlismni.core import Simulation
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.export import fmi2_platform, shim_path
from tlismni.fmu_wrapper.in_process import InProcess
from tlismni.models import load

HERE = Path(__file__).parent
CC = shutil.which("cc")
STEP, STEPS = 0.1, 20


class Fmu:
    """An exported and unzipped FMU, with its instances."""

    def __init__(self, source, folder, **solver):
        self.path = export_fmu(source, folder / "model.fmu", **solver)
        self.unzipped = fmpy.extract(str(self.path), unzipdir=str(folder / "unzipped"))
        self.description = fmpy.read_model_description(self.unzipped)
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.identifier = self.description.coSimulation.modelIdentifier

    def instance(self, **reals):
        fmu = FMU2Slave(guid=self.description.guid, unzipDirectory=self.unzipped, modelIdentifier=self.identifier)
        fmu.instantiate()
        return self.start(fmu, **reals)

    def start(self, fmu, **reals):
        for name, value in reals.items():
            fmu.setReal([self.vr[name]], [value])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        return fmu

    def step(self, fmu, first, last):
        """Values after each step, the push varying."""
        rows = []
        for k in range(first, last):
            fmu.setReal([self.vr["push"]], [float(k % 3)])
            fmu.doStep(k * STEP, STEP)
            rows.append(fmu.getReal([self.vr["ball.y"], self.vr["ball.vy"], self.vr["energy.balance"]]))
        return rows


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    return Fmu(ball_model(), tmp_path_factory.mktemp("ball"), t_end=2.0)


@pytest.fixture(scope="module")
def bdf_ball(tmp_path_factory):
    return Fmu(ball_model("bdf_ball", 1.5), tmp_path_factory.mktemp("bdf"), t_end=2.0, method="bdf", order=2)


def test_fmpy_finds_nothing_to_complain_about(ball, bdf_ball):
    assert validate_fmu(str(ball.path)) == validate_fmu(str(bdf_ball.path)) == []


@pytest.mark.parametrize("irregular", [False, True], ids=["fixed", "irregular"])
def test_fmpy_gives_the_simulation_bit_for_bit(ball, irregular):
    signal = None
    if irregular:  # fmpy steps to the instants where an input jumps, and from there on to its own grid
        jumps = np.repeat(np.sort(np.random.default_rng(1).uniform(0.01, 1.99, 40)), 2)
        times = [0.0, *jumps, 2.0]
        signal = np.array([(t, k // 2 % 5) for k, t in enumerate(times)], dtype=[("time", float), ("push", float)])
    columns = [name for name in ball.vr if ball.vr[name] > ball.vr["push"]]
    given = {
        "output": ["push", "solver.events", *columns], "input": signal, "output_interval": 0.05,
        "start_values": {"restitution": 0.8}, "fmi_type": "CoSimulation",
    }  # fmt: skip
    binary = fmpy.simulate_fmu(str(ball.path), **given)
    in_process = fmpy.simulate_fmu(ball.unzipped, fmu_instance=InProcess.of(ball.unzipped), **given)
    assert binary.tobytes() == in_process.tobytes()

    simulation = Simulation(ball_model().with_parameters({"restitution": 0.8}))
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
    assert len(np.unique(np.diff(binary["time"]).round(12))) > (40 if irregular else 0)


def test_rollback_over_impacts_is_bit_equal(ball):
    fmu = ball.instance()
    ball.step(fmu, 0, 4)
    state = fmu.getFMUstate()
    first = ball.step(fmu, 4, STEPS)
    for _ in range(2):
        fmu.setFMUstate(state)
        assert ball.step(fmu, 4, STEPS) == first
    fmu.freeFMUstate(state)
    fmu.reset()
    assert ball.step(ball.start(fmu), 0, STEPS)[4:] == first
    fmu.freeInstance()


def test_instances_and_fmus_do_not_touch_each_other(ball, bdf_ball):
    cases = [(fmu, e) for fmu in (ball, bdf_ball) for e in (0.5, 0.9)]
    alone = [fmu.step(fmu.instance(restitution=e), 0, STEPS) for fmu, e in cases]
    instances = [fmu.instance(restitution=e) for fmu, e in cases]
    rows = [[] for _ in cases]
    for k in range(STEPS):
        for (fmu, _), instance, out in zip(cases, instances, rows, strict=True):
            out += fmu.step(instance, k, k + 1)
    assert rows == alone
    assert len({str(row) for row in rows}) == 4


def test_a_state_survives_the_process(ball, tmp_path):
    script = """
import sys, json
sys.path.insert(0, sys.argv[1])
from test_fmu_real import Fmu, STEPS
import fmpy
from pathlib import Path
fmu = object.__new__(Fmu)
fmu.unzipped = sys.argv[2]
fmu.description = fmpy.read_model_description(fmu.unzipped)
fmu.vr = {v.name: v.valueReference for v in fmu.description.modelVariables}
fmu.identifier = fmu.description.coSimulation.modelIdentifier
instance = fmu.instance()
instance.setFMUstate(instance.deSerializeFMUstate(Path(sys.argv[3]).read_bytes()))
print(json.dumps([[x.hex() for x in row] for row in fmu.step(instance, 5, STEPS)]))
"""
    fmu = ball.instance(restitution=0.9)
    ball.step(fmu, 0, 5)
    (tmp_path / "state").write_bytes(fmu.serializeFMUstate(fmu.getFMUstate()))
    rows = ball.step(fmu, 5, STEPS)
    command = [sys.executable, "-c", script, str(HERE), ball.unzipped, str(tmp_path / "state")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == [[x.hex() for x in row] for row in rows]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["pendulum_stop", "bouncing_ball"])
def test_scenarios_of_the_catalogue_by_the_command_of_fmpy(tmp_path, name):
    scenario = load(name)
    path, table = tmp_path / "x.fmu", tmp_path / "x.csv"
    export_fmu(scenario, path)
    assert validate_fmu(str(path)) == []
    command = [sys.executable, "-m", "fmpy", "simulate", str(path), "--output-file", str(table)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stdout + done.stderr
    result = np.genfromtxt(table, delimiter=",", names=True, deletechars="")
    assert result["time"][-1] == pytest.approx(scenario.t_end)
    assert abs(result["energy.balance"]).max() < 1e-3
    assert result["solver.events"][-1] > 0


# a host that is no Python


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    if CC is None:
        pytest.skip("needs a C compiler")
    program = tmp_path_factory.mktemp("host") / "host"
    headers = Path(fmpy.__file__).parent / "c-code"  # the standard's own
    command = [CC, "-Wall", "-Werror", f"-I{headers}", "-o", str(program), str(HERE / "host.c"), "-ldl", "-lpthread"]
    subprocess.run(command, check=True)
    return program


def run_host(host, ball, folder, guid=None, **environment):
    library = Path(ball.unzipped, "binaries", fmi2_platform(), ball.identifier + shim_path().suffix)
    resources = Path(ball.unzipped, "resources").as_uri()
    command = [
        host,
        library,
        resources,
        guid or ball.description.guid,
        ball.vr["ball.y"],
        STEP,
        STEPS,
        folder / "state",
    ]
    # nothing of this Python in the environment
    kept = {k: v for k, v in os.environ.items() if k in ("HOME", "NUMBA_CACHE_DIR")}
    return subprocess.run(
        list(map(str, command)), capture_output=True, text=True, timeout=1200, env={**kept, **environment}
    )


def test_a_host_without_python(host, ball, tmp_path):
    y = ball.vr["ball.y"]
    done = run_host(host, ball, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = done.stdout.splitlines()
    assert lines[-2:] == ["python in the environment: no", "end"]
    fmu = ball.instance()
    expected = []
    for k in range(STEPS):
        fmu.doStep(k * STEP, STEP)
        expected.append(fmu.getReal([y])[0])
    rows = [float.fromhex(line.split()[1]) for line in lines[:-2]]
    assert rows == expected + expected[STEPS // 2 :]
    # and its state goes on here
    fmu.setFMUstate(fmu.deSerializeFMUstate((tmp_path / "state").read_bytes()))
    for k in range(STEPS // 2, STEPS):
        fmu.doStep(k * STEP, STEP)
        assert fmu.getReal([y])[0] == expected[k]


def test_a_host_without_python_hears_what_is_wrong(host, ball, tmp_path):
    done = run_host(host, ball, tmp_path, guid="{wrong}")
    assert done.returncode == 4
    assert done.stdout.startswith(
        "log host 3 logStatusError fmi2Instantiate: FmuValueError: the guid given is '{wrong}'"
    )
    done = run_host(host, ball, tmp_path, TLISMNI_LIBPYTHON="/nowhere/libpython.so")
    assert done.returncode == 4
    assert "TLISMNI_LIBPYTHON names '/nowhere/libpython.so', which cannot be loaded" in done.stdout
    broken = Fmu(ball_model(), tmp_path)
    record = Path(broken.unzipped, "resources", "libpython.txt")
    library, home, _ = record.read_text().splitlines()
    record.write_text(f"{library}\n{home}\n/nowhere/os.py\n")
    done = run_host(host, broken, tmp_path)
    assert done.returncode == 4 and "is incomplete: '/nowhere/os.py' cannot be read" in done.stdout
    python = Path(broken.unzipped, "resources", "python.json")
    data = json.loads(python.read_text())
    python.write_text(json.dumps({**data, "folders": ["/nowhere"]}))
    record.write_text(f"{library}\n{home}\n{os.__file__}\n")
    done = run_host(host, broken, tmp_path)
    assert done.returncode == 4
    assert "fmi2Instantiate: ImportError: this FMU needs packages that Python" in done.stdout
    assert "this FMU needs tlismni==" in done.stdout
