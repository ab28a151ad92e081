"""`tlismni study coupling`: a mechanism in two halves that touch, against its whole."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import one_line_errors
from ..options import Debug, Json, check_suffix
from ..screen import compile_notice, number, print_json, print_table, progress_bar, say, stdout

COUPLING_EXAMPLES = (
    "Examples:\n\n  tlismni study coupling --plot coupling.png\n\n  tlismni study coupling --quick --json"
)


@one_line_errors
def coupling(
    quick: Annotated[bool, typer.Option("--quick", help="Fewer and longer steps: a first look.")] = False,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw the figures: .png, .pdf or .svg.")] = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Error, cost and stability of master algorithms for a mechanism in two halves that touch, against its whole."""
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")

    from ...validation.study.coupling import coupling_study, observations

    with compile_notice(), progress_bar("coupling", 1.0) as progress:
        study = coupling_study(quick=quick, progress=progress)
    files = []
    if plot is not None:
        from ...validation.study.coupling_plots import plot_coupling

        files.append(str(plot_coupling(study, plot)))
    figures = {**study.to_dict(), "observations": observations(study), "quick": quick, "files": files}
    if json:
        print_json(figures)
        return
    columns = ("coupling", "step, ms", "error", "energy added", "steps", "passes", "instance steps")
    print_table("A blow, equal communication steps", columns, [_line(row) for row in study.rows])
    columns = ("coupling", "step or tolerance", *columns[2:])
    print_table("A longer run, equal and controlled steps", columns, [_line(row) for row in study.controlled])
    stability = [
        (row.contender.label, f"{row.beyond} ".lstrip() + ("" if row.limit is None else number(1e3 * row.limit, 3)),
         "" if row.limit_angle is None else number(row.limit_angle, 3), row.fails)
        for row in study.stability
    ]  # fmt: skip
    print_table("A contact that stays", ("coupling", "longest stable step, ms", "times frequency", "beyond"), stability)
    for line in figures["observations"]:
        stdout().print(f"- {line}", markup=False)
    for path in files:
        say(f"wrote {path}")


def _line(row: Any) -> tuple[str, ...]:
    given = f"{1e3 * row.step:.4g}" if row.tolerance is None else f"{row.tolerance:g}, {row.estimate}"
    if row.failure:
        return row.contender.label, given, "no run", "", "", "", ""
    counts = (str(row.steps), str(row.passes), str(row.instance_steps))
    return row.contender.label, given, f"{row.error:.2e}", f"{row.energy:+.1e}", *counts
