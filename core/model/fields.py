"""What each field of a record is: unit, default, range, words. The one source are the docstrings below the fields; the
JSON schema, `help()`, the command `tlismni fields` and the page of the docs show them.

A unit is a part of the docstring by itself ("Length of the rod, m."); a field without one has none.
"""

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel

from .docstrings import field_docstrings
from .units import parse_unit

_POWER = re.compile(r"\^(\d+)")
_OPEN_POWER = re.compile(r"^N( s)?/m\^(n|\(\d/\d\))$")
"""Units of contact laws whose exponent is a parameter, or broken."""
SYMBOLS = ("A", "C", "J", "K", "W")
"""Of quantities in docstrings, though units are called so too."""


@dataclass(frozen=True)
class FieldText:
    """A field in words. `default` is as it stands in a file, empty if there is none and it must be given."""

    name: str
    kind: str
    unit: str
    default: str
    description: str


def unit_in(text: str) -> str:
    """The unit that a docstring names, as it is written there; "" if it names none, "1" for dimensionless numbers."""
    for part in re.split(r"[,;:(]\s|\.(?:\s|$)", text):
        words = part.strip()
        if words == "dimensionless":
            return "1"
        if _OPEN_POWER.match(words):
            return words
        if (
            words
            and not words.isdecimal()
            and words not in SYMBOLS
            and parse_unit(_POWER.sub(r"\1", words)) is not None
        ):
            return words
    return ""


@cache
def fields_of(record: type[BaseModel]) -> tuple[FieldText, ...]:
    """The fields of a record, without the `type` that tells it apart, in their order."""
    texts = field_docstrings(record)
    found = []
    for name, field in record.model_fields.items():
        if name == "type":
            continue
        text = " ".join(texts.get(name, "").split())
        default = "" if field.is_required() else _written(field.get_default(call_default_factory=True))
        found.append(FieldText(name, _kind(field.annotation, field.metadata), unit_in(text), default, text))
    return tuple(found)


def _written(value: Any) -> str:
    """A default as it would stand in a file."""
    if isinstance(value, BaseModel):
        return json.dumps(value.model_dump(mode="json", exclude_defaults=True))
    if isinstance(value, tuple) and any(isinstance(each, BaseModel) for each in value):
        return "[...]"
    return "none" if value is None else json.dumps(value)


def _kind(annotation: Any, metadata: Iterable[Any]) -> str:
    """A type in a few words."""
    options = [option for option in get_args(annotation) if option is not NoneType]
    if get_origin(annotation) in (Union, UnionType) and len(options) == 1 and get_origin(options[0]) is Annotated:
        annotation, *metadata = get_args(options[0])
    plain = isinstance(annotation, type) and not get_args(annotation)
    text = re.sub(r"[A-Za-z_]\w*\.", "", annotation.__name__ if plain else str(annotation))
    words = {"float": "number", "int": "whole number", "bool": "true or false", "str": "text"}
    if not plain:
        inner = re.findall(r"\b(float|int|bool|str|Literal)\b", text)
        records = [
            w for w in re.findall(r"\b([A-Z][A-Za-z]*[23]D|[A-Z][a-z]+(?:[A-Z][a-z]+)*)\b", text) if w not in _PLAIN
        ]
        if "Literal" in inner:
            return "one of " + ", ".join(re.findall(r"'([^']+)'", text))
        either = ["number"] if records and float in options else []
        what = " or ".join(dict.fromkeys([*either, *records[:3]] or [words[w] for w in inner]))
        if "tuple[" in text:
            return f"list of {what}{'' if records else 's'}" if what else "list"
        return what
    metadata = [part for given in metadata for part in getattr(given, "metadata", [given])]
    bounds = [f"> {m.gt:g}" for m in metadata if getattr(m, "gt", None) is not None]
    bounds += [f">= {m.ge:g}" for m in metadata if getattr(m, "ge", None) is not None]
    bounds += [f"<= {m.le:g}" for m in metadata if getattr(m, "le", None) is not None]
    return " ".join([words.get(text, text), *bounds])


_PLAIN = {
    "Literal",
    "Annotated",
    "Field",
    "Info",
    "None",
    "Type",
    "Union",
    "Optional",
    "NoneType",
    "FieldInfo",
    "True",
    "False",
    "OpenUnion",
    "Gt",
    "Ge",
    "Le",
}


def records(root: type[BaseModel]) -> dict[str, type[BaseModel]]:
    """All records of this library that data of `root` (a `Model`) may hold, by the name of their type; `root` first.

    Types of one name are told apart by their classes: a `Step` is a signal, and `StepFriction` a law of friction.
    """
    home = __name__.rpartition(".model.")[0]

    def below(base: type[BaseModel]) -> Iterable[type[BaseModel]]:
        for record in base.__subclasses__():
            yield record
            yield from below(record)

    names = root.model_json_schema()["$defs"]  # which imports all that it names
    classes = {record.__name__: record for record in below(BaseModel) if record.__module__.startswith(home)}
    found = {root.__name__: root}
    for name in names:
        kind = classes[name].model_fields.get("type")
        found[name if kind is None or kind.default in found else str(kind.default)] = classes[name]
    return found


def described(record: type[BaseModel]) -> str:
    """The fields of a record as a text for `help()`."""
    rows = []
    for field in fields_of(record):
        head = f"{field.name} : {field.kind}" + (f", default {field.default}" if field.default else "")
        rows += [head, *([f"    {field.description}"] if field.description else [])]
    return "\n".join(["Fields", "------", *rows]) if rows else ""
