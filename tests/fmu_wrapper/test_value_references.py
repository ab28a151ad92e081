"""Value references are the variables' indices: who reads FMI 3.0 dependencies as indices finds the same variables."""

import zipfile

import pytest
from fmu_helpers import ball_model
from lxml import etree
from tlismni.fmu_wrapper import ExportError, export_fmu
from tlismni.fmu_wrapper.variables import VariableTable
from tlismni.models import load


def described(source, folder, **arguments):
    path = export_fmu(source, folder / "x.fmu", **arguments)
    with zipfile.ZipFile(path) as archive:
        return etree.fromstring(archive.read("modelDescription.xml"))


@pytest.mark.parametrize("version, arrays", [("2.0", False), ("3.0", False), ("3.0", True)])
@pytest.mark.parametrize("name", ["ball", "split_striker"])
def test_references_are_indices(tmp_path, name, version, arrays):
    source = ball_model() if name == "ball" else load(name)
    root = described(source, tmp_path, fmi_version=version, arrays=arrays, method="bdf", order=2)
    variables = [v for v in root.find("ModelVariables") if v.tag is not etree.Comment]
    assert [int(v.get("valueReference")) for v in variables] == list(range(1, len(variables) + 1))
    named = {v.get("name"): i for i, v in enumerate(variables, start=1)}
    inputs = {i for i, v in enumerate(variables, start=1) if v.get("causality") == "input"}
    knowns = inputs | {i for i, v in enumerate(variables, start=1) if v.get("causality") == "parameter"}
    structure, dependent = root.find("ModelStructure"), 0
    for unknown in structure.iter("Unknown", "Output", "InitialUnknown"):
        own = int(unknown.get("valueReference") or unknown.get("index"))
        found = {int(x) for x in unknown.get("dependencies").split()}
        at_start = unknown.tag == "InitialUnknown" or unknown.getparent().tag == "InitialUnknowns"
        # read as indices, as references, it is the same: outputs that depend on inputs, at the start on parameters too
        assert variables[own - 1].get("causality") == "output"
        assert found <= (knowns if at_start else inputs)
        dependent += bool(found) and not at_start
    assert dependent and named["time"] == 1


def test_a_table_with_other_references_is_none_of_this_version():
    record = {"reference": 1_000_000, "name": "push", "kind": "real", "role": "input", "block": "input", "items": []}
    with pytest.raises(ExportError, match=r"another version.*export the FMU anew"):
        VariableTable.from_data([record])
