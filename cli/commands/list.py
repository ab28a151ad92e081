"""`tlismni list`: the scenarios and their parameters."""

from typing import Annotated, Any

import typer

from ..errors import one_line_errors
from ..options import Debug, Json
from ..screen import number, print_json, print_table, say, stdout

EXAMPLES = "Examples:\n\n  tlismni list\n\n  tlismni list pendulum_stop\n\n  tlismni list --json"


@one_line_errors
def list_scenarios(
    name: Annotated[str | None, typer.Argument(metavar="[SCENARIO]", help="Only this one.")] = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """List the scenarios; with a name, the parameters of that one with defaults and units."""
    from ...models import catalogue, load

    if name is not None:
        load(name)  # refuses an unknown name, and says what there is
    entries = [entry for entry in catalogue() if name in (None, entry.name)]
    if json:
        print_json({"scenarios": [_data(entry) for entry in entries]})
        return
    if name is None:
        print_table("", ("scenario", "what happens"), [(entry.name, entry.description) for entry in entries], left=2)
        say("Parameters of one: tlismni list SCENARIO. See it: tlismni run SCENARIO --animate FILE.html")
        return
    for entry in entries:
        rows = [
            (p.name, _shown(p.default), "" if p.unit == "-" else p.unit, _range(p), p.description)
            for p in entry.parameters
        ]
        stdout().print(f"[bold]{entry.name}[/bold]: {entry.description}")
        print_table("", ("parameter", "default", "unit", "range", "meaning"), rows, left=5)


def _data(entry: Any) -> dict[str, Any]:
    fields = ("name", "kind", "default", "unit", "minimum", "maximum", "choices", "description")
    return {
        "name": entry.name,
        "description": entry.description,
        "parameters": [{field: getattr(p, field) for field in fields} for p in entry.parameters],
    }


def _shown(value: Any) -> str:
    if value is None:
        return "auto"
    return str(value).lower() if isinstance(value, bool) else number(value)


def _range(parameter: Any) -> str:
    return ", ".join(parameter.choices) or str(parameter.range_text())
