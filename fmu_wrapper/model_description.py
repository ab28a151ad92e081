"""modelDescription.xml for FMI 2.0 co-simulation."""

from .dependencies import Dependencies
from .description_parts import (
    About,
    add,
    add_categories,
    add_experiment,
    add_items,
    add_units,
    attributes,
    dependencies,
    enumerations,
    finish,
    limits,
    start,
)
from .output_derivatives import HIGHEST_ORDER
from .settings import Settings
from .variables import VariableTable

CAPABILITIES = {
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": str(HIGHEST_ORDER),
    "canRunAsynchronuously": "false",  # the standard's own spelling
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}

_TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "string": "String"}


def fmi2_description(table: VariableTable, settings: Settings, about: About, known: Dependencies) -> bytes:
    """The file's bytes."""
    root = start("2.0", "guid", about, numberOfEventIndicators="0")
    derivatives = {"providesDirectionalDerivative": about.derivatives}
    add(
        root, "CoSimulation", modelIdentifier=about.identifier, needsExecutionTool=about.needs_tool,
        **CAPABILITIES, **derivatives,
    )  # fmt: skip
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
        add(element, _TYPES[variable.kind], start=variable.start, **limits(variable))
    structure = add(root, "ModelStructure")
    index = {v.reference: i for i, v in enumerate(table.variables, start=1)}
    for part, depends_on in (("Outputs", known.of_output), ("InitialUnknowns", known.at_start)):
        element = add(structure, part)
        for variable in table.of_role("output"):
            found = depends_on(variable)
            add(element, "Unknown", index=index[variable.reference], **dependencies(index[v.reference] for v in found))
    return finish(root)
