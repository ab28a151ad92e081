"""Parts of modelDescription.xml that FMI 2.0 and 3.0 share."""

from dataclasses import dataclass
from typing import Any

from .log import CATEGORIES
from .settings import Settings
from .units import parse_unit
from .variables import Variable, VariableTable


@dataclass(frozen=True)
class About:
    """What a description says of the FMU as a whole. `identifier` is the file name of the binary, `token` ties the
    description to the resources; `derivatives` says whether there are those with respect to all inputs."""

    identifier: str
    name: str
    token: str
    description: str
    generator: str
    derivatives: bool


def start(version: str, token_name: str, about: About, **more: str) -> Any:
    """The root element."""
    from lxml import etree  # only the export needs it, the exported FMU does not

    return etree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": about.name,
            token_name: about.token,
            "description": about.description,
            "generationTool": about.generator,
            "variableNamingConvention": "structured",
            **more,
        },
    )


def finish(root: Any) -> bytes:
    """The file's bytes."""
    from lxml import etree

    data: bytes = etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)
    return data


def add(parent: Any, tag: str, **attributes: Any) -> Any:
    """A new element in `parent`; attributes that are None are left out."""
    from lxml import etree

    return etree.SubElement(parent, tag, {k: text(v) for k, v in attributes.items() if v is not None})


def add_units(root: Any, table: VariableTable) -> None:
    """The units of all variables, with their base units."""
    units = add(root, "UnitDefinitions")
    for unit in sorted({v.unit for v in table.variables if v.unit is not None}):
        element, base = add(units, "Unit", name=unit), parse_unit(unit)
        if base is not None:
            factor = None if base.factor == 1.0 else base.factor
            add(element, "BaseUnit", **base.exponents, factor=factor)


def enumerations(table: VariableTable) -> dict[str, tuple[str, ...]]:
    """The enumeration types of all variables: name, and names of the values 0, 1, ..."""
    return {v.enumeration: v.items for v in table.variables if v.enumeration is not None}


def add_items(parent: Any, items: tuple[str, ...]) -> None:
    """The items of an enumeration."""
    for value, name in enumerate(items):
        add(parent, "Item", name=name, value=value)


def add_categories(root: Any) -> None:
    """The log categories."""
    categories = add(root, "LogCategories")
    for category, description in CATEGORIES.items():
        add(categories, "Category", name=category, description=description)


def add_experiment(root: Any, settings: Settings) -> None:
    """The default experiment."""
    add(
        root,
        "DefaultExperiment",
        startTime=0.0,
        stopTime=settings.t_end,
        tolerance=settings.rtol,
        stepSize=settings.communication_step,
    )


def attributes(variable: Variable) -> dict[str, Any]:
    """Attributes of a variable that do not depend on its type."""
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


def text(value: Any) -> str:
    """`value` as XML Schema writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
