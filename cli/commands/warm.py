"""`tlismni warm`: compile now what would be compiled at the first use."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import Debug, Json, MethodName, MethodOption, Set
from ..screen import compile_notice, print_json, print_table, status_line

EXAMPLES = (
    "Examples:\n\n  tlismni warm\n\n  tlismni warm pendulum_stop --method irk\n\n  tlismni warm my_model.json\n\n"
    "  tlismni warm pendulum.fmu --json"
)

Target = Annotated[
    str | None,
    typer.Argument(
        metavar="SCENARIO_OR_MODEL_OR_FMU",
        help="Name of a scenario, a model file, or an FMU made by tlismni; all scenarios if left out.",
    ),
]


@one_line_errors
def warm(
    target: Target = None,
    sets: Set = None,
    method: MethodName = None,
    option: MethodOption = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Compile what a model, an FMU or the catalogue needs on this machine, so that the first run does not wait."""
    if target is None and sets:
        raise typer.BadParameter("parameters belong to a scenario or a model: name it", param_hint="--set")
    is_fmu = target is not None and target.lower().endswith(".fmu")
    if is_fmu and (sets or method or option):
        raise typer.BadParameter(
            f"'{target}' has its own model and solver: give neither --set nor --method nor --option"
        )

    from ...models import names
    from ..source import read_source
    from ..warming import warm_fmu, warm_scenario

    done = []
    with compile_notice():
        if is_fmu:
            done.append(warm_fmu(Path(str(target))))
        else:
            with status_line("looking at what is compiled already") as tell:
                for name in [target] if target is not None else names():
                    tell(f"compiling what {name} needs")
                    # how long a model runs is nothing to compile
                    source = read_source(name, sets, t_end=1.0, method=method, options=option)
                    done.append(warm_scenario(source))
    functions, seconds = sum(one.functions for one in done), sum(one.seconds for one in done)
    if json:
        print_json({"targets": [asdict(one) for one in done], "functions": functions, "seconds": seconds})
        return
    rows = [(one.name, one.functions, f"{one.seconds:.1f}") for one in done]
    if len(rows) > 1:
        rows.append(("all", functions, f"{seconds:.1f}"))
    print_table("", ("for", "functions compiled", "seconds"), rows)
    for folder in dict.fromkeys(one.folder for one in done):
        typer.echo(f"kept in {folder}" if folder else "not kept: there is no folder for it", err=True)
