"""Whether two models have the same structure: the same but for numbers, so that they have the same variables."""

from typing import Any

from ..core.multibody_model import Model

MISSING = "nothing"


def difference(one: Model, other: Model) -> str:
    """The first place where the structure of two models differs, in words; empty if it does not.

    Numbers that are no whole ones may differ, but for the start values of inputs, which variables have themselves.
    """
    first, second = _structure(one), _structure(other)
    return _compare("", first, second)


def _structure(model: Model) -> dict[str, Any]:
    data = model.model_dump(mode="json")
    own = {key: value for key, value in data.items() if key not in ("name", "description", "inputs")}
    return {"inputs": [{**i, "start": repr(i["start"])} for i in data["inputs"]], **own}


def _compare(path: str, one: Any, other: Any) -> str:
    if isinstance(one, float) and isinstance(other, float):
        return ""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in dict.fromkeys((*one, *other)):
            where = f"{path}.{key}" if path else key
            if found := _compare(where, one.get(key, MISSING), other.get(key, MISSING)):
                return found
        return ""
    if isinstance(one, list) and isinstance(other, list):
        if len(one) != len(other):
            return f"{path}: {len(other)} instead of {len(one)}"
        for index, (left, right) in enumerate(zip(one, other, strict=True)):
            named = isinstance(left, dict) and "name" in left
            if found := _compare(f"{path}.{left['name']}" if named else f"{path}[{index}]", left, right):
                return found
        return ""
    if type(one) is type(other) and one == other:
        return ""
    return f"{path}: {_word(other)} instead of {_word(one)}"


def _word(value: Any) -> str:
    return "other parts" if isinstance(value, dict | list) else str(value)
