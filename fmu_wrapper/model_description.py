"""modelDescription.xml for FMI 2.0 co-simulation."""

from .description_parts import (
    About,
    add,
    add_categories,
    add_experiment,
    add_items,
    add_units,
    attributes,
    enumerations,
    finish,
    start,
)
from .settings import Settings
from .variables import VariableTable

CAPABILITIES = {
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "0",
    "canRunAsynchronuously": "false",  # the standard's own spelling
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}

_TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "string": "String"}


def fmi2_description(table: VariableTable, settings: Settings, about: About) -> bytes:
    """The file's bytes."""
    root = start("2.0", "guid", about, numberOfEventIndicators="0")
    derivatives = {"providesDirectionalDerivative": about.derivatives}
    add(root, "CoSimulation", modelIdentifier=about.identifier, **CAPABILITIES, **derivatives)
    add_units(root, table)
    if types := enumerations(table):
        definitions = add(root, "TypeDefinitions")
        for name, items in types.items():
            add_items(add(add(definitions, "SimpleType", name=name), "Enumeration"), items)
    add_categories(root)
    add_experiment(root, settings)
    variables = add(root, "ModelVariables")
    for variable in table.variables:
        element = add(variables, "ScalarVariable", **attributes(variable))
        if variable.enumeration is not None:
            add(element, "Enumeration", declaredType=variable.enumeration, start=variable.start)
            continue
        limits = {"min": variable.minimum, "max": variable.maximum}
        add(element, _TYPES[variable.kind], start=variable.start, unit=variable.unit, **limits)
    structure = add(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        element = add(structure, part)
        for index, variable in enumerate(table.variables, start=1):
            if variable.role == "output":
                add(element, "Unknown", index=index)
    return finish(root)
