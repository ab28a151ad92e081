"""`tlismni info`: what an FMU is, says of itself, and needs."""

import json as json_module
import zipfile
from pathlib import Path
from typing import Any

from ..errors import Failure, one_line_errors
from ..options import Debug, ExistingFmu, Json
from ..screen import print_json, print_table, stdout

EXAMPLES = "Examples:\n\n  tlismni info pendulum.fmu\n\n  tlismni info pendulum.fmu --json"

_FLAGS = {
    "state": ("canGetAndSetFMUstate", "canGetAndSetFMUState"),
    "serialised state": ("canSerializeFMUstate", "canSerializeFMUState"),
    "variable steps": ("canHandleVariableCommunicationStepSize",),
    "early return": ("mightReturnEarlyFromDoStep",),
    "event mode": ("hasEventMode",),
    "directional derivatives": ("providesDirectionalDerivative", "providesDirectionalDerivatives"),
    "adjoint derivatives": ("providesAdjointDerivatives",),
}
"""Attributes of the co-simulation interface in FMI 2.0 and 3.0, read here: fmpy leaves some out."""

_RECORDS = ("settings.json", "python.json")


@one_line_errors
def info(fmu: ExistingFmu, json: Json = False, debug: Debug = False) -> None:
    """Show what an FMU is: version, experiment, capabilities, variables, and the Python that it was exported with."""
    found = _read(fmu)
    if json:
        print_json(found)
        return
    out = stdout()
    out.print(f"{found['model']} (FMI {found['fmi']}): {found['description']}", markup=False)
    rows = [(key, found[key]) for key in ("generator", "token", "t_end", "communication_step", "tolerance")]
    rows += [("binaries", ", ".join(found["binaries"])), ("it can do", ", ".join(found["capabilities"]))]
    if found["python"]:
        rows.append(("Python", f"{found['python']['version']} in {found['python']['prefix']}"))
        rows.append(("solver", ", ".join(f"{k}={v}" for k, v in found["solver"].items())))
    print_table("", ("", ""), [(key, "-" if value is None else value) for key, value in rows], left=2)
    columns = ("variable", "start", "unit", "meaning")
    for kind in ("parameter", "input", "output"):
        of_kind = [v for v in found["variables"] if v["causality"] == kind]
        if of_kind:
            print_table(f"{kind}s", columns, [[v[c] or "" for c in _COLUMNS] for v in of_kind], left=4)


_COLUMNS = ("name", "start", "unit", "description")


def _read(fmu: Path) -> dict[str, Any]:
    import fmpy
    from lxml import etree

    try:
        with zipfile.ZipFile(fmu) as archive:
            names = archive.namelist()
            records = [
                json_module.loads(archive.read(f"resources/{name}")) if f"resources/{name}" in names else {}
                for name in _RECORDS
            ]
            root = etree.fromstring(archive.read("modelDescription.xml"))
        description = fmpy.read_model_description(str(fmu))
    except (zipfile.BadZipFile, KeyError, etree.XMLSyntaxError) as error:
        raise Failure(f"'{fmu}' is no FMU: {error}") from None
    settings, python = records
    experiment, interface = description.defaultExperiment, root.find("CoSimulation")
    flags = set() if interface is None else {name for name, value in interface.items() if value in ("true", "1")}
    return {
        "file": str(fmu),
        "fmi": description.fmiVersion,
        "model": description.modelName,
        "description": description.description or "",
        "generator": description.generationTool,
        "token": description.guid,
        **{key: _number(getattr(experiment, name, None)) for key, name in _EXPERIMENT.items()},
        "capabilities": [name for name, attributes in _FLAGS.items() if flags.intersection(attributes)],
        "binaries": sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name[9:]}),
        "python": {key: python[key] for key in ("version", "prefix", "tlismni") if key in python},
        "solver": {k: v for k, v in settings.get("solver", {}).items() if v is not None},
        "variables": [_variable(v) for v in description.modelVariables],
    }


_EXPERIMENT = {"t_end": "stopTime", "communication_step": "stepSize", "tolerance": "tolerance"}


def _number(text: Any) -> float | None:
    return None if text is None else float(text)


def _variable(variable: Any) -> dict[str, Any]:
    own = {c: getattr(variable, c) for c in ("name", "causality", "variability", "type", "unit", "description")}
    return {**own, "reference": variable.valueReference, "start": variable.start}
