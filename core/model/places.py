"""Places in a model: "rod.inertia", "stop.law.restitution", "rod.position.0"; reading and setting what stands there."""

from collections.abc import Mapping, Sequence
from typing import Any

from .base import Record


def inside(here: Any, part: str, place: str) -> Any:
    """What is at `part` of a record, of its data, or of a sequence; `place` is the whole, for the message.

    Raises
    ------
    ValueError : if there is nothing, and what there is.
    """
    if isinstance(here, Record):
        if part in type(here).model_fields:
            return getattr(here, part)
        raise ValueError(f"parameter target '{place}': there is no field '{part}' in {type(here).__name__}")
    if isinstance(here, Mapping):
        return here.get(part)  # a field with its default may be left out
    if isinstance(here, Sequence) and not isinstance(here, str):
        if part.isdecimal() and int(part) < len(here):
            return here[int(part)]
        raise ValueError(
            f"parameter target '{place}': '{part}' is no place in a list of {len(here)}: count from 0 to "
            f"{len(here) - 1}"
        )
    raise ValueError(f"parameter target '{place}': there is no field '{part}' in {here!r}")


def replaced(here: Any, parts: Sequence[str], value: Any, place: str) -> Any:
    """`here` with `value` at the place that `parts` lead to. Raises ValueError if there is no such place."""
    if not parts:
        return value
    part, rest = parts[0], parts[1:]
    old = inside(here, part, place)
    if old is None and isinstance(here, Mapping) and rest:
        raise ValueError(f"parameter target '{place}': '{part}' must stand in the file before a number in it is set")
    new = replaced(old, rest, value, place)
    if isinstance(here, Record):
        kept = {name: getattr(here, name) for name in here.model_fields_set}
        return type(here)(**{**kept, part: new})
    if isinstance(here, Mapping):
        return {**here, part: new}
    return type(here)([*here[: int(part)], new, *here[int(part) + 1 :]]) if isinstance(here, list | tuple) else new
