"""modelDescription.xml for FMI 2.0 co-simulation."""

from typing import Any

from .log import CATEGORIES
from .settings import Settings
from .units import parse_unit
from .variables import Variable, VariableTable

CAPABILITIES = {
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "maxOutputDerivativeOrder": "0",
    "canRunAsynchronuously": "false",  # the standard's own spelling
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "false",
}

_TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "string": "String"}


def fmi2_description(
    table: VariableTable,
    settings: Settings,
    *,
    identifier: str,
    name: str,
    token: str,
    description: str,
    generator: str,
) -> bytes:
    """The file's bytes. `identifier` is the file name of the binary, `token` the guid."""
    from lxml import etree  # only the export needs it, the exported FMU does not

    def add(parent: Any, tag: str, **attributes: Any) -> Any:
        given = {k: _text(v) for k, v in attributes.items() if v is not None}
        return etree.SubElement(parent, tag, given)

    root = etree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": name,
            "guid": token,
            "description": description,
            "generationTool": generator,
            "variableNamingConvention": "structured",
            "numberOfEventIndicators": "0",
        },
    )
    add(root, "CoSimulation", modelIdentifier=identifier, **CAPABILITIES)
    units = add(root, "UnitDefinitions")
    for unit in sorted({v.unit for v in table.variables if v.unit is not None}):
        element, base = add(units, "Unit", name=unit), parse_unit(unit)
        if base is not None:
            factor = None if base.factor == 1.0 else base.factor
            add(element, "BaseUnit", **base.exponents, factor=factor)
    categories = add(root, "LogCategories")
    for category, text in CATEGORIES.items():
        add(categories, "Category", name=category, description=text)
    add(
        root,
        "DefaultExperiment",
        startTime=0.0,
        stopTime=settings.t_end,
        tolerance=settings.rtol,
        stepSize=settings.communication_step,
    )
    variables = add(root, "ModelVariables")
    for variable in table.variables:
        element = add(variables, "ScalarVariable", **_attributes(variable))
        limits = {"min": variable.minimum, "max": variable.maximum}
        add(element, _TYPES[variable.kind], start=variable.start, unit=variable.unit, **limits)
    structure = add(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        element = add(structure, part)
        for index, variable in enumerate(table.variables, start=1):
            if variable.role == "output":
                add(element, "Unknown", index=index)
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def _attributes(variable: Variable) -> dict[str, Any]:
    variability = "continuous" if variable.kind == "real" else "discrete"
    initial = {"parameter": "exact", "output": "calculated"}.get(variable.role)
    return {
        "name": variable.name,
        "valueReference": variable.reference,
        "description": variable.description or None,
        "causality": variable.role,
        "variability": "fixed" if variable.role == "parameter" else variability,
        "initial": initial,
    }


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
