"""documentation/index.html of an FMU: what the model is made of, its variables, how it is solved."""

from collections.abc import Iterable, Sequence
from typing import Any

from ..core.description import Model
from .description_parts import About
from .settings import Settings
from .variables import Variable, VariableTable

PARTS = ("bodies", "joints", "forces", "contacts")
STYLE = (
    "body { font: 15px/1.5 sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em }"
    " table { border-collapse: collapse; margin-bottom: 1.5em } td, th { text-align: left; padding: 0.15em 1em 0.15em 0"
    "; border-bottom: 1px solid #ddd; vertical-align: top }"
)
ROLES = {"parameter": "Parameters", "input": "Inputs", "output": "Outputs"}


def documentation(model: Model, table: VariableTable, settings: Settings, about: About) -> bytes:
    """The page's bytes; a page of its own, without anything from elsewhere."""
    from lxml import etree

    root = etree.Element("html", lang="en")
    head, body = _add(root, "head"), _add(root, "body")
    _add(head, "meta", charset="utf-8")
    _add(head, "title", about.name)
    _add(head, "style", STYLE)
    _add(body, "h1", about.name)
    _add(body, "p", about.description)
    _add(body, "p", f"Co-simulation FMU made by {about.generator}. It solves the equations of motion itself, impacts "
         "inside a communication step included.")  # fmt: skip
    _add(body, "h2", "Model")
    parts = [(part.name, type(part).__name__, kind[:-1] if kind != "bodies" else "body")
             for kind in PARTS for part in getattr(model, kind, ())]  # fmt: skip
    _table(body, ("name", "type", "kind"), parts)
    _add(body, "h2", "Solver")
    given = {k: v for k, v in settings.as_arguments().items() if v is not None}
    _table(body, ("setting", "value"), given.items())
    for role, title in ROLES.items():
        variables = [v for v in table.variables if v.role == role]
        if variables:
            _add(body, "h2", title)
            _table(body, ("name", "type", "unit", "start", "meaning"), (_row(v) for v in variables))
    page: bytes = etree.tostring(root, method="html", encoding="utf-8", doctype="<!DOCTYPE html>", pretty_print=True)
    return page


def _row(variable: Variable) -> tuple[Any, ...]:
    start = "" if variable.start is None else variable.start
    kind = variable.enumeration or variable.kind
    return variable.name, kind, variable.unit or "", start, variable.description


def _add(parent: Any, tag: str, text: str = "", **attributes: str) -> Any:
    from lxml import etree

    element = etree.SubElement(parent, tag, attributes)
    element.text = text or None
    return element


def _table(parent: Any, columns: Sequence[str], rows: Iterable[Iterable[Any]]) -> None:
    table = _add(parent, "table")
    line = _add(table, "tr")
    for column in columns:
        _add(line, "th", column)
    for row in rows:
        line = _add(table, "tr")
        for value in row:
            _add(line, "td", str(value))
