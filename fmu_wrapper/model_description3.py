"""modelDescription.xml for FMI 3.0 co-simulation."""

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
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "providesPerElementDependencies": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "maxOutputDerivativeOrder": str(HIGHEST_ORDER),
    "providesIntermediateUpdate": "true",
    "mightReturnEarlyFromDoStep": "true",
    "canReturnEarlyAfterIntermediateUpdate": "true",
    "hasEventMode": "true",
    "providesEvaluateDiscreteStates": "false",
}

_TYPES = {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "string": "String"}


def fmi3_description(table: VariableTable, settings: Settings, about: About, known: Dependencies) -> bytes:
    """The file's bytes."""
    root = start("3.0", "instantiationToken", about)
    derivatives = dict.fromkeys(("providesDirectionalDerivatives", "providesAdjointDerivatives"), about.derivatives)
    add(
        root, "CoSimulation", modelIdentifier=about.identifier, needsExecutionTool=about.needs_tool,
        **CAPABILITIES, **derivatives,
    )  # fmt: skip
    add_units(root, table)
    if types := enumerations(table):
        definitions = add(root, "TypeDefinitions")
        for name, items in types.items():
            add_items(add(definitions, "EnumerationType", name=name), items)
    add_categories(root)
    add_experiment(root, settings)
    variables = add(root, "ModelVariables")
    for variable in table.variables:
        own = attributes(variable)
        if variable.role in ("input", "output"):
            own["intermediateUpdate"] = True
        if variable.kind == "string":
            element = add(variables, "String", **own)
            if variable.start is not None:
                add(element, "Start", value=variable.start)
        elif variable.enumeration is not None:
            add(variables, "Enumeration", **own, declaredType=variable.enumeration, start=variable.start)
        else:
            add(variables, _TYPES[variable.kind], **own, **limits(variable), start=variable.start)
    arrays = table.arrays if about.arrays else ()
    for array in arrays:
        first = array.elements[0]
        what = f"{array.name} as an array: " + ", ".join(e.name.rpartition(".")[2] for e in array.elements)
        element = add(
            variables,
            "Float64",
            name=array.name,
            valueReference=array.reference,
            description=what,
            causality="output",
            variability="continuous",
            initial="calculated",
            intermediateUpdate=True,
            **{k: v for k, v in limits(first).items() if k != "nominal"},
        )
        add(element, "Dimension", start=len(array.elements))
    structure = add(root, "ModelStructure")
    for part, depends_on in (("Output", known.of_output), ("InitialUnknown", known.at_start)):
        for variable in table.of_role("output"):
            found = dependencies(v.reference for v in depends_on(variable))
            add(structure, part, valueReference=variable.reference, **found)
        for array in arrays:
            felt = {v.reference for element in array.elements for v in depends_on(element)}
            add(structure, part, valueReference=array.reference, **dependencies(sorted(felt)))
    return finish(root)
