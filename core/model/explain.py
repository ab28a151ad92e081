"""What is wrong with a record, in words: which element, which field, what was needed, what was given."""

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError

from .words import an

LONGEST = 60
"""Characters of a value that are shown."""
A_LIST = "must be a list: write a single one in brackets, [...]"
NEEDED = {
    "missing": "it is missing: give it",
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "int_parsing": "must be a whole number",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "string_type": "must be a text",
    "string_too_long": "must have at most {max_length} characters",
    "tuple_type": A_LIST,
    "list_type": A_LIST,
    "too_short": "needs at least {min_length} entries, there are {actual_length}",
    "too_long": "takes at most {max_length} entries, there are {actual_length}",
    "literal_error": "must be {expected}",
    "model_type": "must be a {class_name}",
    "model_attributes_type": "must be a record of this library, or its data with a `type`",
    "union_tag_not_found": "its `type` is missing",
    "union_tag_invalid": "type '{tag}' is none of {expected_tags}",
}
"""By pydantic's type of problem; what is not here keeps pydantic's words."""
NAME_PATTERN = "must be made of letters, digits and underscores, and not begin with a digit"


def explain(error: ValidationError, record: type[BaseModel], data: Mapping[str, Any]) -> str:
    """One clause a problem. `data` is what the record was to be made of."""
    return "; ".join(clause for clause, _ in problems_of(error, record, data))


def problems_of(
    error: ValidationError, record: type[BaseModel], data: Mapping[str, Any]
) -> tuple[tuple[str, tuple[Any, ...]], ...]:
    """Each problem in words, and the place in `data` where it is."""
    found: list[tuple[str, tuple[Any, ...]]] = []
    for problem in error.errors():
        words, loc = _clause(problem, record, data), tuple(problem["loc"])
        within = getattr(problem.get("ctx", {}).get("error"), "problems", ())  # of a record inside, which has said so
        if words == "; ".join(clause for clause, _ in within):
            found += [(clause, (*loc, *place)) for clause, place in within]
        else:
            found.append((words, (*loc, *within[0][1]) if within else loc))
    return tuple(found)


def _clause(problem: Any, record: type[BaseModel], data: Mapping[str, Any]) -> str:
    kind, given = problem["type"], problem.get("input")
    # a problem of a whole value is one of the field that holds it; what a record itself says is that record's
    owner, name, field = _place(problem["loc"], record, data, to_the_end=kind == "value_error")
    if kind == "value_error":
        words = problem["msg"].removeprefix("Value error, ")
        # what concerns more than one field names its element itself, and a model its elements
        named = name is None if owner.startswith("Model") else f"'{name}'" in words
        return words if named and not field else f"{owner}: " + (f"{field}: " if field else "") + words
    if kind == "extra_forbidden":
        words, given = _no_such_field(field.rpartition(".")[2], owner.split(" ")[0], record), ...
    elif kind == "string_pattern_mismatch":
        words = _wanted(problem["ctx"]["pattern"])
    else:
        words = NEEDED[kind].format(**problem.get("ctx", {})) if kind in NEEDED else problem["msg"]
    what = "" if given is ... or kind == "missing" else f" (given: {shown(given)})"
    return f"{owner}: {field}: {words}{what}" if field else f"{owner}: {words}{what}"


def _wanted(pattern: str) -> str:
    """What a text must be that has to match a pattern: one of several words, or a name."""
    words = re.fullmatch(r"\^\(([a-z|]+)\)\$", pattern)
    return f"must be one of {', '.join(words[1].split('|'))}" if words else NAME_PATTERN


def _place(loc: Sequence[Any], record: type[BaseModel], data: Any, to_the_end: bool) -> tuple[str, str | None, str]:
    """(the element as it is called, its name, the field in it) of a place in `data`."""
    name = _get(data, "name")
    owner, field, here = _called(record.__name__, name), [], data
    for k, part in enumerate(loc):
        inside = _get(here, part)
        if inside is None and part == _get(here, "type"):
            continue  # which of several records it is to be, not a field
        field.append(str(part))
        here = inside
        kind, of_it = _get(here, "type"), _get(here, "name")
        if isinstance(kind, str) and isinstance(of_it, str) and (to_the_end or k < len(loc) - 1):
            owner, name, field = _called(kind, of_it), of_it, []
    return owner, name, ".".join(field)


def _get(here: Any, part: Any) -> Any:
    """What is at `part` of data or of a record; None if nothing is."""
    if isinstance(here, Mapping):
        return here.get(part)
    if isinstance(here, BaseModel):
        return getattr(here, part) if part in type(here).model_fields else None
    if isinstance(here, list | tuple) and isinstance(part, int) and part < len(here):
        return here[part]
    return None


def _called(kind: str, name: Any) -> str:
    return f"{kind} '{name}'" if isinstance(name, str) else kind


def shown(given: Any) -> str:
    if isinstance(given, BaseModel):
        return an(_called(type(given).__name__, _get(given, "name")))
    text = repr(given)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def _no_such_field(field: str, kind: str, record: type[BaseModel]) -> str:
    """That there is no such field, and which there are."""
    found = next((r for r in _all_records(BaseModel) if r.__name__ == kind), record)
    known = list(found.model_fields)
    near = get_close_matches(field, known, 1)
    return "there is no such field; " + (f"did you mean '{near[0]}'?" if near else f"there are {known}")


def _all_records(base: type[BaseModel]) -> Any:
    for record in base.__subclasses__():
        yield record
        yield from _all_records(record)
