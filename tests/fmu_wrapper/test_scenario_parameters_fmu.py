"""An FMU of a scenario with a builder's parameter changed by the host: the scenario built with it, bit for bit."""

import io
import json
import re
import shutil
import subprocess
import sys
import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from fmu_helpers import Messages
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.fmu_wrapper.bundle import package_archive
from tlismni.fmu_wrapper.embedded import SETTINGS_FILE, read_slave
from tlismni.fmu_wrapper.errors import ExportError, FmuValueError
from tlismni.fmu_wrapper.in_process import InProcess
from tlismni.fmu_wrapper.in_process3 import InProcess3
from tlismni.models import load

CHANGES = {"length": 0.7, "gravity": 3.7, "restitution": 0.4}
OUTPUTS = ["pendulum.angle", "pendulum.angular_velocity", "stop.normal_force", "energy.balance"]
DT, STEPS = 0.1, 12


class Exported:
    """An FMU of `pendulum_stop`, unzipped, and its instances in the binary or in this process."""

    def __init__(self, folder, version, **given):
        self.path = export_fmu(load("pendulum_stop", **given), folder / "p.fmu", version)
        self.unzipped = fmpy.extract(str(self.path), unzipdir=str(folder / "unzipped"))
        self.description = fmpy.read_model_description(self.unzipped)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.three = version == "3.0"

    def new(self, in_process=False):
        if in_process:
            fmu = (InProcess3 if self.three else InProcess).of(self.unzipped)
        else:
            fmu = (FMU3Slave if self.three else FMU2Slave)(
                guid=self.description.guid, unzipDirectory=self.unzipped,
                modelIdentifier=self.description.coSimulation.modelIdentifier,
            )  # fmt: skip
        fmu.instantiate()
        return fmu

    def give(self, fmu, **reals):
        put = fmu.setFloat64 if self.three else fmu.setReal
        for name, value in reals.items():
            put([self.variables[name].valueReference], [value])

    def ask(self, fmu, names):
        get = fmu.getFloat64 if self.three else fmu.getReal
        return list(get([self.variables[name].valueReference for name in names]))

    def run(self, fmu, first=0, last=STEPS):
        rows = []
        if first == 0:
            fmu.enterInitializationMode()
            fmu.exitInitializationMode()
        for k in range(first, last):
            fmu.doStep(k * DT, DT)
            rows.append(self.ask(fmu, OUTPUTS))
        return rows


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def exported(request, tmp_path_factory):
    return Exported(tmp_path_factory.mktemp("parameters"), request.param)


@pytest.fixture(scope="module")
def expected():
    """The scenario built with the changes, stepped as the FMU is."""
    slave = Slave(load("pendulum_stop", **CHANGES))
    slave.enter_initialization()
    slave.exit_initialization()
    rows = []
    for k in range(STEPS):
        slave.do_step(k * DT, DT)
        rows.append([slave[name] for name in OUTPUTS])
    return rows


def test_description(exported):
    assert validate_fmu(str(exported.path)) == []
    length, torque = exported.variables["length"], exported.variables["torque"]
    assert (length.causality, length.variability, length.initial) == ("parameter", "fixed", "exact")
    assert (float(length.start), float(length.min), length.unit) == (1.0, 0.0, "m")
    assert torque.causality == "input"
    assert not {"law", "driven", "stiffness", "damping"} & set(exported.variables)


@pytest.mark.parametrize("in_process", [False, True])
def test_a_host_changes_parameters(exported, expected, in_process):
    """Beside an instance without changes; the same again after a reset."""
    fmu, other = exported.new(in_process), exported.new(in_process)
    exported.give(fmu, **CHANGES)
    found, plain = exported.run(fmu), exported.run(other)
    assert found == expected != plain
    fmu.reset()
    assert exported.run(fmu) == plain
    assert exported.ask(fmu, ["length"]) == [1.0]


def test_fmpy_simulates_with_start_values(exported, expected):
    result = fmpy.simulate_fmu(
        exported.unzipped, start_values=CHANGES, output=OUTPUTS, output_interval=DT, stop_time=STEPS * DT
    )
    np.testing.assert_allclose(np.array([list(row)[1:] for row in result])[1:], expected, rtol=1e-9, atol=1e-12)


def test_states_hold_the_parameters(exported, expected):
    """As bytes into a new instance, which has not been told them."""
    fmu, other = exported.new(), exported.new()
    exported.give(fmu, **CHANGES)
    exported.run(fmu, 0, 5)
    two, three = ("serializeFMUstate", "deSerializeFMUstate"), ("serializeFMUState", "deserializeFMUState")
    names = three if exported.three else two
    state = (fmu.getFMUState if exported.three else fmu.getFMUstate)()
    data = getattr(fmu, names[0])(state)
    exported.run(other, 0, 3)
    (other.setFMUState if exported.three else other.setFMUstate)(getattr(other, names[1])(data))
    assert exported.ask(other, ["length", "gravity"]) == [0.7, 3.7]
    assert exported.run(other, 5) == expected[5:]


@pytest.mark.parametrize("value", [float("nan"), -1.0, 0.0])
def test_a_wrong_value_is_an_error_and_changes_nothing(exported, value):
    fmu = exported.new()
    with pytest.raises(FMICallException):
        exported.give(fmu, length=value)
    exported.run(fmu, 0, 1)
    assert exported.ask(fmu, ["length"]) == [1.0]
    with pytest.raises(FMICallException):
        exported.give(fmu, length=2.0)  # fixed by now


@pytest.mark.parametrize(
    "scenario",
    [5, {"name": 1, "parameters": {}}, {"name": "pendulum_stop"}, {"name": "pendulum", "parameters": {"mass": [1.0]}}],
)
def test_a_broken_scenario_in_the_resources_gets_words(exported, tmp_path, scenario):
    shutil.copytree(f"{exported.unzipped}/resources", tmp_path / "resources")
    file = tmp_path / "resources" / SETTINGS_FILE
    file.write_text(json.dumps({**json.loads(file.read_text()), "scenario": scenario}))
    with pytest.raises(ExportError, match=re.escape(f"'scenario' in '{SETTINGS_FILE}'")):
        read_slave(tmp_path / "resources")


def test_an_fmu_whose_scenario_is_gone_runs_as_exported(exported, tmp_path):
    shutil.copytree(f"{exported.unzipped}/resources", tmp_path / "resources")
    file = tmp_path / "resources" / SETTINGS_FILE
    data = json.loads(file.read_text())
    file.write_text(json.dumps({**data, "scenario": {**data["scenario"], "name": "not_there"}}))
    slave = read_slave(tmp_path / "resources", on_log=Messages())
    with pytest.raises(FmuValueError, match="no scenario 'not_there'"):
        slave.set_by_name({"length": 2.0})
    slave.enter_initialization()
    slave.exit_initialization()
    assert slave["length"] == 1.0


CARRIED = """
import importlib, importlib.machinery, importlib.util, sys

spec = importlib.machinery.ModuleSpec("carried", None, is_package=True)
spec.submodule_search_locations = [sys.argv[1]]
sys.modules["carried"] = importlib.util.module_from_spec(spec)
load = importlib.import_module("carried.models").load
Origin = importlib.import_module("carried.fmu_wrapper.origin").Origin
scenario = load("pendulum")
changed = Origin("pendulum", dict(scenario.given)).changed({"length": 2.0}, scenario.model)
print(changed.model == load("pendulum", length=2.0).model, any(name.startswith("tlismni") for name in sys.modules))
"""


def test_a_bundle_carries_the_catalogue(tmp_path):
    """Under another name than `tlismni`, which is not imported."""
    with zipfile.ZipFile(io.BytesIO(package_archive()[0])) as archive:
        archive.extractall(tmp_path)
    command = [sys.executable, "-c", CARRIED, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.stdout.split() == ["True", "False"], done.stderr
