"""`tlismni study damping`: how HHT damps the oscillation that an impact excites."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import one_line_errors
from ..options import Debug, Json, check_suffix
from ..screen import compile_notice, print_json, print_table, progress_bar, say, stdout

DAMPING_EXAMPLES = "Examples:\n\n  tlismni study damping --plot damping.png\n\n  tlismni study damping --quick --json"
CLAIM = "C5: HHT's damping inside TLISMNI and on GGL damps the oscillation that an impact excites differently"


@one_line_errors
def damping(
    quick: Annotated[bool, typer.Option("--quick", help="Without the alphas in between: a first look.")] = False,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw the spectra: .png, .pdf or .svg.")] = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Oscillation of the contact's multiplier about its trend: HHT inside TLISMNI and on GGL, alpha from 0 to -0.3."""
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")

    from ...validation.study import damping_study, fifth_claim

    with compile_notice(), progress_bar("damping", 1.0) as progress:
        rows = damping_study(quick=quick, progress=progress)
    files = []
    if plot is not None:
        from ...validation.study.damping_plots import plot_damping

        files.append(str(plot_damping(rows, plot)))
    verdict, observed = fifth_claim(rows)
    claim = {"name": "C5", "claim": CLAIM, "verdict": verdict, "observed": observed}
    figures = {"rows": [row.to_dict() for row in rows], "claims": [claim], "quick": quick, "files": files}
    if json:
        print_json(figures)
        return
    columns = ("method", "alpha", "mean force, N", "rms", "rms later", "peak")
    for label in dict.fromkeys(row.problem.label for row in rows):
        here = [row for row in rows if row.problem.label == label]
        print_table(f"{label}: oscillation of the multiplier, parts of its mean", columns, [_line(row) for row in here])
    stdout().print(f"{CLAIM}.\n  {verdict.upper()}", markup=False)
    for line in observed:
        stdout().print(f"  - {line}", markup=False)
    for path in files:
        say(f"wrote {path}")


def _line(row: Any) -> tuple[str, ...]:
    if row.failure:
        return row.method, f"{row.alpha:g}", "no run", "", "", ""
    sizes = (f"{row.rms:.4f}", f"{row.late:.4f}", f"{row.peak:.3f}")
    return row.method, f"{row.alpha:g}", f"{row.mean:.5g}", *sizes
