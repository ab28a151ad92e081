"""`tlismni methods`: the integration methods and their options."""

from typing import Any

from ..errors import one_line_errors
from ..options import Debug, Json
from ..screen import number, print_json, print_table, stdout

EXAMPLES = "Examples:\n\n  tlismni methods\n\n  tlismni run chain --method ebdf --option k=3"


@one_line_errors
def methods(json: Json = False, debug: Debug = False) -> None:
    """List the integration methods with their options."""
    from ...core import METHODS

    if json:
        print_json({"methods": [_data(method) for method in METHODS.values()]})
        return
    for method in METHODS.values():
        stdout().print(f"[bold]{method.name}[/bold]: {method.description}")
        rows = [(name, _shown(o), _range(o), o.description) for name, o in method.options.items()]
        if rows:
            print_table("", ("option", "default", "range", "meaning"), rows, left=4)


def _shown(option: Any) -> str:
    return str(option.default) if option.choices else number(_value(option, option.default))


def _range(option: Any) -> str:
    if option.choices:
        return ", ".join(option.choices)
    return f"[{number(option.minimum, 3)}, {number(option.maximum, 3)}]"


def _value(option: Any, value: float) -> float | int:
    return int(value) if option.integer else float(value)


def _data(method: Any) -> dict[str, Any]:
    return {
        "name": method.name,
        "description": method.description,
        "options": [
            {"name": name, "default": o.default, "choices": list(o.choices), "description": o.description}
            if o.choices
            else {
                "name": name,
                "default": _value(o, o.default),
                "minimum": _value(o, o.minimum),
                "maximum": _value(o, o.maximum),
                "description": o.description,
            }
            for name, o in method.options.items()
        ],
    }
