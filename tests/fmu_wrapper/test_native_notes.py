"""What an FMU without Python says of parameters that are fixed or exclude each other: in descriptions, when one is set,
and on the command line."""

import json

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from native_pair import Side
from tlismni.cli.app import app
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import export_fmu
from tlismni.models import load
from typer.testing import CliRunner

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """The pendulum at its stop, unzipped, with its description and the notes of its export."""
    folder, notes = tmp_path_factory.mktemp("notes"), []
    path = export_fmu(load("pendulum_stop"), folder / "x.fmu", "3.0", native=True, on_note=notes.append)
    unzipped = fmpy.extract(str(path), unzipdir=str(folder / "unzipped"))
    return unzipped, fmpy.read_model_description(unzipped), notes


@pytest.mark.sampled(1)
@pytest.mark.parametrize("first, second", [("length", "start_angle"), ("start_angle", "length")])
def test_the_error_names_the_parameter_that_excludes(exported, first, second):
    said = []
    side = Side("3.0", *exported[:2], logMessage=lambda e, status, c, text: said.append(text.decode()))
    side.set(**{first: 0.5})
    with pytest.raises(FMICallException):
        side.set(**{second: 0.3})
    assert f"'{second}' was set to 0.3" in said[-1] or f"'{first}' was set to 0.5" in said[-1]
    assert all(f"'{name}'" in said[-1] for name in (first, second)) and "must keep the value" in said[-1]
    # the first one stands, and the other one is free again where it goes back
    start = float(side.by_name[first].start)
    side.set(**{first: start})
    side.set(**{second: 0.3})
    side.begin()


def test_descriptions_and_notes_name_pairs_and_what_is_fixed(exported):
    _, description, notes = exported
    found = {v.name: v.description for v in description.modelVariables}
    assert "excludes start_angle" in found["length"] and "excludes length" in found["start_angle"]
    assert "excludes" not in found["mass"]
    assert "fixed in this FMU: it is a setting of the solver" in found["solver.rtol"]
    assert any("exclude each other: length and start_angle" in note for note in notes)
    assert any(note.startswith("fixed in the FMU: ") and "solver.rtol" in note for note in notes)


def test_the_command_says_so(tmp_path):
    path = tmp_path / "x.fmu"
    shown = CliRunner().invoke(app, ["export", "pendulum_stop", "-o", str(path), "--native"])
    assert shown.exit_code == 0, shown.output
    assert "exclude each other: length and start_angle" in " ".join(shown.output.split())
    data = CliRunner().invoke(app, ["export", "pendulum_stop", "-o", str(path), "--native", "--json"])
    assert any("length and start_angle" in note for note in json.loads(data.stdout)["notes"])
