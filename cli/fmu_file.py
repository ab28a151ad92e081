"""What an FMU says of itself: read from its files, for `tlismni info`."""

import json
import zipfile
from pathlib import Path
from typing import Any

from .errors import Failure

_FLAGS = {
    "state": ("canGetAndSetFMUstate", "canGetAndSetFMUState"),
    "serialised state": ("canSerializeFMUstate", "canSerializeFMUState"),
    "variable steps": ("canHandleVariableCommunicationStepSize",),
    "input derivatives": ("canInterpolateInputs",),
    "intermediate update": ("providesIntermediateUpdate",),
    "early return": ("mightReturnEarlyFromDoStep",),
    "event mode": ("hasEventMode",),
    "directional derivatives": ("providesDirectionalDerivative", "providesDirectionalDerivatives"),
    "adjoint derivatives": ("providesAdjointDerivatives",),
}
"""Attributes of the co-simulation interface in FMI 2.0 and 3.0, read here: fmpy leaves some out."""

_RECORDS = ("settings.json", "python.json")
_EXPERIMENT = {"t_end": "stopTime", "communication_step": "stepSize", "tolerance": "tolerance"}
_NUMBERS = ("min", "max", "nominal")


def binaries(names: list[str]) -> list[str]:
    """The platforms that an FMU with files of these names has binaries for."""
    return sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name[9:]})


def read_fmu(fmu: Path) -> dict[str, Any]:
    """All that the FMU says, as JSON data. Raises Failure if it is none."""
    import fmpy
    from lxml import etree

    try:
        with zipfile.ZipFile(fmu) as archive:
            names = archive.namelist()
            records = [
                json.loads(archive.read(f"resources/{name}")) if f"resources/{name}" in names else {}
                for name in _RECORDS
            ]
            root = etree.fromstring(archive.read("modelDescription.xml"))
            terminals = _terminals(archive, names)
        description = fmpy.read_model_description(str(fmu))
    except (zipfile.BadZipFile, KeyError, ValueError, etree.XMLSyntaxError) as error:
        raise Failure(f"'{fmu}' is no FMU: {error}") from None
    settings, python = records
    experiment, interface = description.defaultExperiment, root.find("CoSimulation")
    attributes = {} if interface is None else dict(interface.items())
    flags = {name for name, value in attributes.items() if value in ("true", "1")}
    capabilities = [name for name, attributes in _FLAGS.items() if flags.intersection(attributes)]
    if (order := int(attributes.get("maxOutputDerivativeOrder", 0))) > 0:
        capabilities.append(f"output derivatives up to order {order}")
    return {
        "file": str(fmu),
        "fmi": description.fmiVersion,
        "model": description.modelName,
        "description": description.description or "",
        "generator": description.generationTool,
        "token": description.guid,
        **{key: _number(getattr(experiment, name, None)) for key, name in _EXPERIMENT.items()},
        "capabilities": capabilities,
        "binaries": binaries(names),
        "icon": bool({"model.png", "terminalsAndIcons/icon.png"} & set(names)),
        "documentation": "documentation/index.html" in names,
        "python": {key: python[key] for key in ("version", "prefix", "tlismni") if key in python},
        "native": "resources/model.image" in names,
        "bundle": python.get("bundle"),
        "requires": [f"{name}>={least}" for name, least in python.get("requires", [])],
        "solver": {k: v for k, v in settings.get("solver", {}).items() if v is not None},
        "terminals": terminals,
        "variables": [_variable(v) for v in description.modelVariables],
    }


def _terminals(archive: zipfile.ZipFile, names: list[str]) -> list[dict[str, Any]]:
    from lxml import etree

    path = "terminalsAndIcons/terminalsAndIcons.xml"
    if path not in names:
        return []
    return [
        {
            "name": terminal.get("name"),
            "kind": terminal.get("terminalKind"),
            "description": terminal.get("description") or "",
            "members": {m.get("memberName"): m.get("variableName") for m in terminal.iter("TerminalMemberVariable")},
        }
        for terminal in etree.fromstring(archive.read(path)).iter("Terminal")
    ]


def _number(text: Any) -> float | None:
    return None if text is None else float(text)


def _variable(variable: Any) -> dict[str, Any]:
    own = {c: getattr(variable, c) for c in ("name", "causality", "variability", "type", "unit", "description")}
    items = {item.value: item.name for item in getattr(variable.declaredType, "items", None) or ()}
    numbers = {c: _number(getattr(variable, c, None)) for c in _NUMBERS}
    start = items.get(variable.start, variable.start)
    choices = {} if not items else {"choices": list(items.values())}
    return {**own, "reference": variable.valueReference, "start": start, **numbers, **choices}
