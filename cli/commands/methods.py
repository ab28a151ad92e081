"""`tlismni methods`: the integration methods and their options."""

from typing import Any

from ..errors import one_line_errors
from ..options import Debug, Json
from ..screen import number, print_json, print_table, stdout

EXAMPLES = "Examples:\n\n  tlismni methods\n\n  tlismni run chain --method ebdf --option k=3"


@one_line_errors
def methods(json: Json = False, debug: Debug = False) -> None:
    """List the integration methods with their options."""
    from ...core.methods.automatic import METHOD_NAMES, described
    from ..source import RUN_OPTIONS

    known = [described(name) for name in METHOD_NAMES]
    if json:
        of_runs = [{"name": n, "default": d, "description": text} for n, (d, text) in RUN_OPTIONS.items()]
        print_json({"methods": [_data(method) for method in known], "run_options": of_runs})
        return
    for method in known:
        stdout().print(f"[bold]{method.name}[/bold]: {method.description}")
        rows = [(name, _shown(_value(o, o.default)), _range(o), o.description) for name, o in method.options.items()]
        if rows:
            print_table("", ("option", "default", "range", "meaning"), rows, left=4)
    stdout().print()
    shared = [(name, default, meaning) for name, (default, meaning) in RUN_OPTIONS.items()]
    print_table("options of every run", ("option", "default", "meaning"), shared, left=3)


def _value(option: Any, value: float | str) -> float | int | str:
    if isinstance(value, str):
        return value
    return int(value) if option.integer else float(value)


def _shown(value: float | int | str) -> str:
    return value if isinstance(value, str) else number(value)


def _range(option: Any) -> str:
    numbers = [f"[{number(option.minimum, 3)}, {number(option.maximum, 3)}]"] if option.numeric else []
    return " or ".join([*numbers, *option.choices])


def _data(method: Any) -> dict[str, Any]:
    return {
        "name": method.name,
        "description": method.description,
        "family": method.family,
        "options": [
            {"name": name, "default": o.default, "choices": list(o.choices), "description": o.description}
            if o.choices
            else {
                "name": name,
                "default": _value(o, o.default),
                "minimum": _value(o, o.minimum) if o.numeric else None,
                "maximum": _value(o, o.maximum) if o.numeric else None,
                "choices": list(o.choices),
                "description": o.description,
            }
            for name, o in method.options.items()
        ],
    }
