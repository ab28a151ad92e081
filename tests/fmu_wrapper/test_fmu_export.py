"""What an exported FMU holds: its description, its resources, its checks (on the fake simulation)."""

import getpass
import json
import re
import sys
import zipfile
from datetime import UTC, datetime
from types import SimpleNamespace

import fmpy
import numpy as np
import pytest
import tlismni.fmu_wrapper.export as export_module
from fake_simulation import FakeSimulation
from fmpy.validation import validate_fmu
from fmu_helpers import LAW_NAMES, METHODS, ball_model
from lxml import etree
from tlismni.core.errors import ModelError
from tlismni.core.multibody_model import Model
from tlismni.fmu_wrapper import ExportError, FmuValueError, archive, export_fmu
from tlismni.fmu_wrapper.export import c_identifier


def test_fmpy_finds_nothing_to_complain_about(fake_fmu):
    assert validate_fmu(str(fake_fmu(order=4, variant="b", light=True))) == []
    assert validate_fmu(str(fake_fmu(t_end=None))) == []
    assert validate_fmu(str(fake_fmu(fmi_version="3.0", order=4, variant="b", light=True))) == []
    assert validate_fmu(str(fake_fmu(fmi_version="3", t_end=None))) == []


def test_variables_and_value_references(fake_fmu):
    description = fmpy.read_model_description(fake_fmu(order=4, variant="b", light=True))
    found = {
        v.name: (v.valueReference, v.type, v.causality, v.variability, v.unit, v.start)
        for v in description.modelVariables
    }
    assert found == {
        "time": (1, "Real", "independent", "continuous", "s", None),
        "solver.method": (2, "Enumeration", "parameter", "fixed", None, str(METHODS.index("auto"))),
        "solver.rtol": (3, "Real", "parameter", "fixed", "1", "1e-06"),
        "solver.atol": (4, "Real", "parameter", "fixed", "1", "1e-09"),
        "solver.step": (5, "Real", "parameter", "fixed", "s", "0.0"),
        "solver.light": (6, "Boolean", "parameter", "fixed", None, "true"),
        "solver.order": (7, "Integer", "parameter", "fixed", None, "4"),
        "solver.variant": (8, "String", "parameter", "fixed", None, "b"),
        "solver.events": (9, "Integer", "output", "discrete", None, None),
        "restitution": (10, "Real", "parameter", "fixed", "1", "0.7"),
        "mass": (11, "Real", "parameter", "fixed", "kg", "2.0"),
        "floor.law": (12, "Enumeration", "local", "constant", None, str(LAW_NAMES.index("NewtonImpact"))),
        "push": (13, "Real", "input", "continuous", "N", "1.0"),
        "ball.y": (14, "Real", "output", "continuous", "m", None),
        "ball.vy": (15, "Real", "output", "continuous", "m/s", None),
        "ball.ay": (16, "Real", "output", "continuous", "m/s2", None),
        "floor.in_contact": (17, "Boolean", "output", "discrete", None, None),
        "floor.mode": (18, "Integer", "output", "discrete", None, None),
        "floor.state": (19, "Enumeration", "output", "discrete", None, None),
    }
    outputs = {name for name, row in found.items() if row[2] == "output"}
    assert {u.variable.name for u in description.outputs} == outputs
    assert {u.variable.name for u in description.initialUnknowns} == outputs


def test_units_have_base_units(fake_fmu):
    with zipfile.ZipFile(fake_fmu()) as archive:
        root = etree.fromstring(archive.read("modelDescription.xml"))
    base = {u.get("name"): dict(u.find("BaseUnit").attrib) for u in root.iter("Unit")}
    assert base["N"] == {"kg": "1", "m": "1", "s": "-2"}
    assert base["m/s2"] == {"m": "1", "s": "-2"}
    assert base["1"] == {}


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_enumerations_name_their_values(fake_fmu, version):
    description = fmpy.read_model_description(fake_fmu(fmi_version=version))
    state = next(v for v in description.modelVariables if v.name == "floor.state")
    assert state.declaredType.name == "FloorState"
    assert [(item.name, item.value) for item in state.declaredType.items] == [("untouched", "0"), ("touched", "1")]


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_the_documentation_names_parts_and_variables(fake_fmu, version):
    source = ball_model().model_copy(update={"description": "a <ball> & a floor"})
    path = fake_fmu(fmi_version=version, source=source)
    with zipfile.ZipFile(path) as archive:
        page = archive.read("documentation/index.html").decode()
    root = etree.HTML(page)
    assert page.startswith("<!DOCTYPE html>") and root.findtext("body/p") == "a <ball> & a floor"
    cells = {cell.text for cell in root.iter("td")}
    assert {v.name for v in fmpy.read_model_description(path).modelVariables} - {"time"} <= cells
    assert {"DiskOnHalfPlane2D", "AppliedForce2D", "PointMass2D", "FloorState", "N", "auto"} <= cells


def test_default_experiment_and_capabilities(fake_fmu):
    description = fmpy.read_model_description(fake_fmu(t_end=2.5, rtol=1e-7))
    experiment = description.defaultExperiment
    given = [float(x) for x in (experiment.startTime, experiment.stopTime, experiment.tolerance, experiment.stepSize)]
    assert given == [0.0, 2.5, 1e-7, 0.01]
    flags = description.coSimulation
    assert flags.canHandleVariableCommunicationStepSize and flags.canGetAndSetFMUstate and flags.canSerializeFMUstate
    assert flags.canInterpolateInputs and flags.providesDirectionalDerivative and flags.needsExecutionTool


def test_a_scenario_gives_its_settings(fake_fmu, model):
    scenario = SimpleNamespace(
        name="s", model=model, t_end=0.5, method="bdf", rtol=1e-3, atol=1e-4, options={"order": 2}, description="text"
    )
    description = fmpy.read_model_description(fake_fmu(source=scenario, t_end=None, rtol=1e-5))
    start = {v.name: v.start for v in description.modelVariables}
    assert (start["solver.method"], start["solver.order"], start["solver.atol"]) == (
        str(METHODS.index("bdf")),
        "2",
        "0.0001",
    )
    assert start["solver.rtol"] == "1e-05"  # given beats the scenario's
    assert float(description.defaultExperiment.stopTime) == 0.5
    assert description.description == "text"


def test_the_model_travels_as_data(fake_fmu, model):
    with zipfile.ZipFile(fake_fmu()) as archive:
        assert Model.from_json(archive.read("resources/model.json")) == model
        python = json.loads(archive.read("resources/python.json"))
        assert re.fullmatch(r"3\.\d+", python["version"])
        assert "driven_ball.so" in " ".join(archive.namelist()) or len(archive.namelist()) == 7


def test_equal_models_give_equal_files_and_others_another_guid(fake_fmu, model, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1763800000")

    def guid(path):
        return fmpy.read_model_description(path).guid

    first = fake_fmu("a.fmu")
    assert first.read_bytes() == fake_fmu("b.fmu").read_bytes()
    assert guid(first) != guid(fake_fmu("c.fmu", source=ball_model(height=1.5)))
    assert guid(first) != guid(fake_fmu("d.fmu", rtol=1e-5))


def test_versions_that_are_not_written_are_refused(model, tmp_path):
    for version in ("1.0", "3.1", "latest"):
        with pytest.raises(ExportError, match=f"fmi_version '{version}': there is no such FMI version; use one of"):
            export_fmu(model, tmp_path / "x.fmu", fmi_version=version)


def test_bad_settings_leave_no_file(fake_fmu, tmp_path, monkeypatch):
    with pytest.raises(ModelError, match="unknown method 'euler'"):
        fake_fmu(method="euler")
    with pytest.raises(FmuValueError, match=r"'rtol' = -1.0 must be greater than 0"):
        fake_fmu(rtol=-1.0)
    with pytest.raises(ExportError, match="no JSON data"):
        fake_fmu(variant=np.ones(3))
    monkeypatch.setattr(export_module, "SHIM", "absent.so")
    with pytest.raises(ExportError, match=r"absent.so' is missing: it is compiled when tlismni is installed"):
        fake_fmu()
    monkeypatch.undo()
    with pytest.raises(ExportError, match=r"cannot be written: there is no folder '.*/missing'"):
        export_fmu(ball_model(), tmp_path / "missing" / "x.fmu")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "identifier"), [("ball", "ball"), ("2 balls", "_2_balls"), ("Stoß", "Sto_"), ("", "model")]
)
def test_identifiers(name, identifier):
    assert c_identifier(name) == identifier


def test_a_file_that_cannot_be_written_is_named(tmp_path, monkeypatch):
    """A folder in the file's place, and a folder that takes no files: never the name of a temporary file."""
    target = tmp_path / "x.fmu"
    target.mkdir()
    with pytest.raises(ExportError, match=re.escape(f"'{target}' cannot be written: Is a directory")):
        export_fmu(ball_model(), target, simulation_factory=FakeSimulation)
    assert list(tmp_path.iterdir()) == [target]

    def refused(*arguments, dir, **options):
        raise PermissionError(13, "Permission denied", str(dir / "tmp1234.fmu"))

    monkeypatch.setattr(archive.tempfile, "mkstemp", refused)
    with pytest.raises(ExportError) as caught:
        archive.write_archive(tmp_path / "y.fmu", {})
    assert str(caught.value) == f"'{tmp_path / 'y.fmu'}' cannot be written: Permission denied"


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_author_version_and_date(fake_fmu, version, monkeypatch):
    def read(**arguments):
        with zipfile.ZipFile(fake_fmu(fmi_version=version, **arguments)) as archive:
            root = etree.fromstring(archive.read("modelDescription.xml"))
        return root, root.find("CoSimulation").get("needsExecutionTool")

    earliest = datetime.now(UTC).replace(microsecond=0)
    root, tool = read()
    date = datetime.strptime(root.get("generationDateAndTime"), "%Y-%m-%dT%H:%M:%SZ").replace(tzinfo=UTC)
    assert earliest <= date <= datetime.now(UTC) and tool == "true"  # it takes a Python
    assert root.get("author") == getpass.getuser() and root.get("version")
    other, _ = read(source=ball_model(height=1.5))
    assert other.get("version") != root.get("version") == read()[0].get("version")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    root, tool = read(author="A. Nother", version="2.1", needs_execution_tool=False)
    assert (root.get("author"), root.get("version"), tool) == ("A. Nother", "2.1", "false")
    assert root.get("generationDateAndTime") == "1970-01-02T00:00:00Z"
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "yesterday")
    with pytest.raises(ExportError, match="SOURCE_DATE_EPOCH = 'yesterday'"):
        fake_fmu(fmi_version=version)


def test_install_without_the_extra_is_told_what_is_missing(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "lxml", None)
    with pytest.raises(ExportError, match=r"export_fmu needs lxml, which.*pip install 'tlismni\[fmu\]'"):
        export_fmu(ball_model(), tmp_path / "x.fmu")
    assert not list(tmp_path.iterdir())
