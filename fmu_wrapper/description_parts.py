"""Parts of modelDescription.xml that FMI 2.0 and 3.0 share."""

import inspect
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from ..core.laws import LAWS
from ..core.methods.automatic import METHOD_NAMES, described
from ..core.model.units import parse_unit
from .log import CATEGORIES
from .settings import Settings
from .variables import Variable, VariableTable

ROLES: dict[str, tuple[str, str, str | None]] = {
    "independent": ("independent", "continuous", None),
    "parameter": ("parameter", "fixed", "exact"),
    "input": ("input", "continuous", None),
    "output": ("output", "continuous", "calculated"),
    "constant": ("local", "constant", "exact"),
}
"""Causality, variability and `initial` by role."""

DISPLAY_UNITS = {
    "rad": (("deg", 180.0 / math.pi),),
    "rad/s": (("deg/s", 180.0 / math.pi), ("rev/min", 30.0 / math.pi)),
    "rad/s2": (("deg/s2", 180.0 / math.pi),),
    "m": (("mm", 1e3),),
    "s": (("ms", 1e3),),
    "N": (("kN", 1e-3),),
}
"""Names and factors of what a host may show instead of a unit."""

DISPLAYED = {"rad": "deg", "rad/s": "deg/s", "rad/s2": "deg/s2"}
"""What is shown by default."""


@dataclass(frozen=True)
class About:
    """What a description says of the FMU as a whole. `identifier` is the file name of the binary, `token` ties the
    description to the resources; `derivatives` says whether there are those with respect to all inputs, `arrays`
    whether the vectors stand in it as arrays too (FMI 3.0). `version` is the model's, `date` that of the export, as FMI
    writes it; `needs_tool` says whether running it takes more than the FMU, which a Python is; `native` whether it runs
    without one, and so can less (`WITHOUT_PYTHON` of the descriptions)."""

    identifier: str
    name: str
    token: str
    description: str
    generator: str
    derivatives: bool
    arrays: bool = False
    author: str | None = None
    version: str | None = None
    date: str | None = None
    needs_tool: bool = True
    native: bool = False


def start(version: str, token_name: str, about: About, **more: str) -> Any:
    """The root element."""
    from lxml import etree  # only the export needs it, the exported FMU does not

    known = {"author": about.author, "version": about.version, "generationDateAndTime": about.date}
    return etree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": about.name,
            token_name: about.token,
            "description": about.description,
            **{name: value for name, value in known.items() if value is not None},
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
        for name, factor in DISPLAY_UNITS.get(unit, ()):
            add(element, "DisplayUnit", name=name, factor=factor)


def enumerations(table: VariableTable) -> dict[str, tuple[str, ...]]:
    """The enumeration types of all variables: name, and names of the values 0, 1, ..."""
    return {v.enumeration: v.items for v in table.variables if v.enumeration is not None}


def add_items(parent: Any, items: tuple[str, ...]) -> None:
    """The items of an enumeration; methods and laws with their descriptions."""
    laws = {name: inspect.getdoc(law) or "" for name, law in LAWS.items()}
    for value, name in enumerate(items):
        text = described(name).description if name in METHOD_NAMES else laws.get(name, "").split("\n\n")[0]
        add(parent, "Item", name=name, value=value, description=" ".join(text.split()) or None)


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
    causality, variability, initial = ROLES[variable.role]
    if variability == "continuous" and variable.kind != "real":
        variability = "discrete"
    return {
        "name": variable.name,
        "valueReference": variable.reference,
        "description": variable.description or None,
        "causality": causality,
        "variability": variability,
        "initial": initial,
    }


def limits(variable: Variable) -> dict[str, Any]:
    """Unit, least, largest and nominal value; whole numbers have no units and no nominal value."""
    cast = int if variable.kind == "integer" else float
    own = {"min": variable.minimum, "max": variable.maximum}
    found: dict[str, Any] = {key: None if value is None else cast(value) for key, value in own.items()}
    if variable.kind == "real":
        found |= {"unit": variable.unit, "nominal": variable.nominal, "displayUnit": DISPLAYED.get(variable.unit or "")}
    return found


def dependencies(knowns: Iterable[int]) -> dict[str, str]:
    """The attributes that list what an unknown depends on. The factor is one of the state, so the kind is the general
    one; an empty list says that it depends on nothing."""
    found = [str(known) for known in knowns]
    kinds = {"dependenciesKind": " ".join(["dependent"] * len(found))} if found else {}
    return {"dependencies": " ".join(found), **kinds}


def text(value: Any) -> str:
    """`value` as XML Schema writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
