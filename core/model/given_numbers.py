"""Numbers that a model file declares: parameters with a value, and formulas of parameters, put where they belong.

This happens before the records are validated, so every field holds a number and nothing else knows of formulas.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from .arithmetic import evaluate, names_in
from .base import Record
from .places import inside, replaced

RECORD_LISTS = ("bodies", "joints", "forces", "contacts", "groups")
GRAVITY = "gravity"
"""The model's own numbers have places too: "gravity.1"."""
STANDARD_GRAVITY = (0.0, -9.81, 0.0)
"""m/s^2."""
SIGN = "="
"""Before a formula that stands in a field's own place."""


def with_given_numbers(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """The data of a model with formulas in place collected under `formulas`, and all declared numbers in their places.

    Data of a wrong form is given back as it is: what is wrong with it, validation says.

    Raises
    ------
    ValueError : for a formula that has no value, a place that is not there, two numbers for one place.
    """
    parameters = data.get("parameters", ())
    if not _is_list(parameters) or not all(isinstance(p, Record | Mapping) for p in parameters):
        return data
    data, formulas = _collected(dict(data))
    if not all(isinstance(f, Record | Mapping) for f in formulas):
        return data
    set_here = [p for p in parameters if _get(p, "value") is not None]
    if not formulas and not set_here:
        return data
    named = {_get(p, "name") for p in parameters}
    numbers: dict[str, float] = {}
    settings: dict[str, tuple[str, float]] = {}
    for p in parameters:
        name, value, targets = str(_get(p, "name")), _get(p, "value"), _get(p, "targets") or ()
        if value is None:
            value = _at(data, str(targets[0])) if _is_list(targets) and targets else None
        elif _is_list(targets):
            for target in targets:
                _claim(settings, str(target), f"parameter '{name}'", value)
        if isinstance(value, int | float) and not isinstance(value, bool):
            numbers[name] = float(value)
    for f in formulas:
        target, text = _get(f, "target"), _get(f, "formula")
        if isinstance(target, str) and isinstance(text, str):
            try:
                for name in (n for n in names_in(text) if n not in numbers and n in named):
                    raise ValueError(
                        f"formula '{text}' asks for parameter '{name}', which has no value: give it `value`"
                    )
                _claim(settings, target, f"formula '{text}'", evaluate(text, numbers))
            except ValueError as error:
                raise ValueError(f"'{target}': {error}") from None
    for target, (_, number) in settings.items():
        data = _with(data, target, number)
    return data


def _claim(settings: dict[str, tuple[str, float]], target: str, who: str, value: float) -> None:
    if target in settings:
        raise ValueError(f"'{target}' is set twice, by {settings[target][0]} and by {who}: leave one out")
    settings[target] = (who, value)


def _collected(data: dict[str, Any]) -> tuple[dict[str, Any], list[Any]]:
    """Data without formulas in place, and all formulas."""
    given = data.get("formulas", ())
    formulas = list(given) if _is_list(given) else []
    for kind in RECORD_LISTS:
        if _is_list(data.get(kind)):
            for element in data[kind]:
                if isinstance(element, Mapping) and isinstance(element.get("name"), str):
                    found = _formulas_in(element, element["name"])
                    formulas += [{"target": place, "formula": text} for place, text in found]
    if formulas:
        data["formulas"] = formulas
    return data, formulas


def _formulas_in(here: Any, place: str) -> Iterator[tuple[str, str]]:
    if isinstance(here, str) and here.startswith(SIGN):
        yield place, here.removeprefix(SIGN).strip()
    elif isinstance(here, Mapping):
        for key, value in here.items():
            yield from _formulas_in(value, f"{place}.{key}")
    elif _is_list(here):
        for k, value in enumerate(here):
            yield from _formulas_in(value, f"{place}.{k}")


def _at(data: Mapping[str, Any], target: str) -> Any:
    """What stands at a place; None where there is nothing, or the element's default."""
    name, *parts = target.split(".")
    found: Any = data.get(GRAVITY, STANDARD_GRAVITY) if name == GRAVITY else None
    found = next((e for _, _, e in _elements(data) if _get(e, "name") == name), found)
    for part in parts:
        if found is None:
            return None
        found = inside(found, part, target)
    return found


def _with(data: Mapping[str, Any], target: str, value: float) -> Mapping[str, Any]:
    name, *parts = target.split(".")
    for kind, k, element in _elements(data):
        if _get(element, "name") == name and parts:
            elements = list(data[kind])
            elements[k] = replaced(element, parts, value, target)
            return {**data, kind: elements}
    field = data.get(GRAVITY, STANDARD_GRAVITY)
    if name == GRAVITY and parts and _is_list(field):
        return {**data, GRAVITY: replaced(field, parts, value, target)}
    raise ValueError(f"parameter target '{target}' must be 'element.field', with the name of an element")


def _elements(data: Mapping[str, Any]) -> Iterator[tuple[str, int, Any]]:
    for kind in RECORD_LISTS:
        if _is_list(data.get(kind)):
            for k, element in enumerate(data[kind]):
                yield kind, k, element


def _get(here: Any, name: str) -> Any:
    return here.get(name) if isinstance(here, Mapping) else getattr(here, name, None)


def _is_list(value: Any) -> bool:
    return isinstance(value, list | tuple)
