"""`tlismni list`: the scenarios and their parameters."""

from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import Debug, Json
from ..screen import number, print_json, print_table, stdout

EXAMPLES = "Examples:\n\n  tlismni list\n\n  tlismni list pendulum_stop\n\n  tlismni list --json"


@one_line_errors
def list_scenarios(
    name: Annotated[str | None, typer.Argument(metavar="[SCENARIO]", help="Only this one.")] = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """List the scenarios with their parameters, defaults and units."""
    from ...models import catalogue, load

    if name is not None:
        load(name)  # refuses an unknown name, and says what there is
    entries = [entry for entry in catalogue() if name in (None, entry.name)]
    if json:
        print_json({"scenarios": [_data(entry) for entry in entries]})
        return
    for entry in entries:
        rows = [
            (p.name, _shown(p.default), "" if p.unit == "-" else p.unit, _range(p), p.description)
            for p in entry.parameters
        ]
        stdout().print(f"[bold]{entry.name}[/bold]: {entry.description}")
        print_table("", ("parameter", "default", "unit", "range", "meaning"), rows, left=5)


def _data(entry: object) -> dict[str, object]:
    fields = ("name", "kind", "default", "unit", "minimum", "maximum", "choices", "description")
    return {
        "name": entry.name,  # type: ignore[attr-defined]
        "description": entry.description,  # type: ignore[attr-defined]
        "parameters": [{f: getattr(p, f) for f in fields} for p in entry.parameters],  # type: ignore[attr-defined]
    }


def _shown(value: object) -> str:
    if value is None:
        return "auto"
    return str(value).lower() if isinstance(value, bool) else number(value)


def _range(parameter: object) -> str:
    choices = parameter.choices  # type: ignore[attr-defined]
    return ", ".join(choices) if choices else parameter.range_text()  # type: ignore[attr-defined,no-any-return]
