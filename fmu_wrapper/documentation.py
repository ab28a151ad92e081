"""documentation/index.html of an FMU: what the model is made of, its variables, how it is solved."""

from collections.abc import Iterable, Sequence
from typing import Any

from ..core.elements import Element
from ..core.model.markers import GROUND
from ..core.multibody_model import Model
from ..viewer.drawing import add_surroundings, draw, to_svg
from .dependencies import bodies_of
from .description_parts import About
from .settings import Settings
from .terminals import terminals
from .variables import Variable, VariableTable

PARTS = {"bodies": "body", "joints": "joint", "forces": "force", "contacts": "contact"}
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 68em; margin: 2em auto; padding: 0 1em; color: #1c2430 }
h1 { margin-bottom: 0.2em } h2 { margin-top: 1.8em; font-size: 1.15em }
figure { margin: 1.5em 0 } figure svg { max-width: 100%; max-height: 75vh; height: auto }
figcaption { color: #6b7280; font-size: 0.9em }
.wide { overflow-x: auto }
table { border-collapse: collapse; margin-bottom: 1em; font-size: 0.93em }
td, th { text-align: left; padding: 0.2em 1.1em 0.2em 0; border-bottom: 1px solid #e3e6ea; vertical-align: top }
th { font-weight: 600; border-bottom-color: #9aa3ad } td:first-child { font-family: ui-monospace, monospace }
"""
ROLES = {"parameter": "Parameters", "input": "Inputs", "output": "Outputs", "constant": "Constants"}
ABOUT_ROLES = {
    "parameter": "They are fixed once the FMU is initialized: masses and geometry decide the consistent start, from "
                 "which everything follows.",
    "input": "An input set at a communication point holds from there on.",
    "output": "Values at the present time, events at it included.",
}  # fmt: skip
COLUMNS = ("name", "type", "unit", "start", "min", "max", "nominal", "meaning")


def documentation(
    model: Model, table: VariableTable, settings: Settings, about: About, drawn: bool = True, parts: bool = True
) -> bytes:
    """The page's bytes; a page of its own, without anything from elsewhere. `drawn`: with the drawing, the solver's
    settings and the flanges; `parts`: with the model's parts."""
    from lxml import etree

    root = etree.Element("html", lang="en")
    head, body = _add(root, "head"), _add(root, "body")
    _add(head, "meta", charset="utf-8")
    _add(head, "meta", name="viewport", content="width=device-width, initial-scale=1")
    _add(head, "title", about.name)
    _add(head, "style", STYLE)
    _add(body, "h1", about.name)
    _add(body, "p", about.description)
    if drawn:
        _draw(body, model, about)
    _add(body, "p", f"Co-simulation FMU made by {about.generator}. It solves the equations of motion itself, impacts "
         "inside a communication step included.")  # fmt: skip
    if parts:
        _add(body, "h2", "Model")
        rows = [(part.name, type(part).__name__, kind, _attached(part))
                for group, kind in PARTS.items() for part in getattr(model, group)]  # fmt: skip
        _table(body, ("name", "type", "kind", "at"), rows)
        _add(body, "p", f"Gravity: ({', '.join(f'{g:g}' for g in model.gravity)}) m/s².")
    if drawn:
        _add(body, "h2", "Solver")
        given = {k: v for k, v in settings.as_arguments().items() if v is not None}
        _table(body, ("setting", "value"), given.items())
    flanges = terminals(model, table) if drawn else []
    if flanges:
        _add(body, "h2", "Flanges")
        members = [(f.name, f.description, ", ".join(f"{m} = {v}" for m, v in f.members.items())) for f in flanges]
        _table(body, ("terminal", "meaning", "members"), members)
    for role, title in ROLES.items():
        variables = [v for v in table.variables if v.role == role]
        if variables:
            _add(body, "h2", title)
            if role in ABOUT_ROLES:
                _add(body, "p", ABOUT_ROLES[role])
            used = [k for k in range(len(COLUMNS)) if any(_row(v)[k] != "" for v in variables)]
            _table(body, [COLUMNS[k] for k in used], ([_row(v)[k] for k in used] for v in variables))
    page: bytes = etree.tostring(root, method="html", encoding="utf-8", doctype="<!DOCTYPE html>", pretty_print=True)
    return page


def _draw(body: Any, model: Model, about: About) -> None:
    figure = _add(body, "figure")
    drawing = draw(model)
    add_surroundings(drawing, model)
    figure.append(to_svg(drawing, title=f"{about.name} at its start"))
    _add(figure, "figcaption", "The model at its start. Joints, springs, loads and contacts are where the model has "
         "them; outlines of bodies are made up of the points that these take hold of.")  # fmt: skip


def _attached(part: Element) -> str:
    """The bodies that an element takes hold of."""
    names = sorted(bodies_of(part) - {part.name})
    ground = GROUND in [marker.body for marker in part.markers()]
    return ", ".join([*names, *([GROUND] if ground else [])])


def _row(variable: Variable) -> tuple[Any, ...]:
    start = variable.start
    if start is not None and variable.items:
        start = variable.item(start)
    listed = variable.items and variable.role != "constant"
    numbers = (variable.minimum, variable.maximum, variable.nominal)
    return (
        variable.name,
        variable.enumeration or variable.kind,
        variable.unit or "",
        "" if start is None else _number(start),
        *("" if x is None else _number(x) for x in numbers),
        f"{variable.description}: {', '.join(variable.items)}" if listed else variable.description,
    )


def _number(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _add(parent: Any, tag: str, text: str = "", **attributes: str) -> Any:
    from lxml import etree

    element = etree.SubElement(parent, tag, attributes)
    element.text = text or None
    return element


def _table(parent: Any, columns: Sequence[str], rows: Iterable[Iterable[Any]]) -> None:
    table = _add(_add(parent, "div", **{"class": "wide"}), "table")
    line = _add(table, "tr")
    for column in columns:
        _add(line, "th", column)
    for row in rows:
        line = _add(table, "tr")
        for value in row:
            _add(line, "td", str(value))
