"""`tlismni study methods`: every method on every scenario, at equal error and at equal cost."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import Failure, one_line_errors
from ..options import Debug, Json, ReportFolder, check_suffix, positive
from ..screen import compile_notice, number, print_json, print_table, progress_bar, say, stdout
from ..targets import check_file, check_folder

METHODS_EXAMPLES = (
    "Examples:\n\n  tlismni study methods --records out/methods.jsonl --report out/methods\n\n"
    "  tlismni study methods -s pendulum_stop -s chain -m hht -m ebdf --json\n\n"
    "  tlismni study methods --quick --plot methods.png"
)
LEGEND = """\
f/r/l/s: scenarios without a figure, because the run failed, was refused, took too long, or missed the error at its
tightest tolerance. energy: drift over the largest kinetic energy; joints, impulses: errors of forces, at that error"""
SUFFIXES = (".png", ".pdf", ".svg")


@one_line_errors
def methods(
    scenario: Annotated[
        list[str] | None, typer.Option("--scenario", "-s", help="Only this scenario; may be repeated.")
    ] = None,
    method: Annotated[
        list[str] | None,
        typer.Option("--method", "-m", help="Only this method; may be repeated (see `tlismni methods`)."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Few tolerances, one level of error: a first look.")] = False,
    records: Annotated[
        Path | None,
        typer.Option("--records", metavar="FILE", help="Add each pair to this file (JSON lines) when it is done, and "
                     "go on from it; with --report DIR: DIR/records.jsonl."),
    ] = None,
    processes: Annotated[int | None, typer.Option("--processes", min=1, help="That work at once; default 2.")] = None,
    limit: Annotated[
        float | None, typer.Option("--limit", callback=positive, help="CPU time of a run, s; default 10, quick 1.5.")
    ] = None,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Every run as a line.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw the heat map: .png, .pdf or .svg.")] = None,
    cost: Annotated[
        str, typer.Option("--cost", help="Of the heat map: cpu_time, evaluations, outer_iterations, factorizations.")
    ] = "cpu_time",
    report: ReportFolder = None,
    json: Json = False,
    debug: Debug = False,
) -> None:  # fmt: skip
    """Every method on every scenario: cost at equal error, error at equal cost, and why a pair has no figure."""
    check_suffix(plot, SUFFIXES, "--plot")
    check_folder(report)
    for path in (records, csv, plot):
        check_file(path)

    from dataclasses import replace

    from ...validation.study.matrix import QUICK, Sweep, method_matrix
    from ...validation.study.matrix.equal import COSTS

    if cost not in COSTS:
        raise typer.BadParameter(f"'{cost}' is none of {', '.join(COSTS)}", param_hint="--cost")
    sweep = QUICK if quick else Sweep()
    if limit is not None:
        sweep = replace(sweep, limit=limit)
    if records is None and report is not None:
        records = report / "records.jsonl"
    with compile_notice(), progress_bar("methods", 1.0) as progress:
        matrix = method_matrix(
            scenario, method, sweep=sweep, processes=processes, records=records,
            tell=lambda what, share: progress(share),
        )  # fmt: skip
    files: list[Path] = []
    if report is not None:
        from ...validation.study.matrix.report import write_report

        files += write_report(matrix, report)
    if csv is not None:
        from ...validation.study.matrix.tables import write_csv

        files.append(write_csv(matrix, csv))
    if plot is not None:
        from ...validation.study.matrix.plots import plot_matrix

        plot.parent.mkdir(parents=True, exist_ok=True)
        files.append(plot_matrix(matrix, plot, cost))
    if json:
        print_json({**matrix.to_dict(), "files": [str(path) for path in files]})
    else:
        _print(matrix)
        for path in files:
            say(f"wrote {path}")
    lost = [reference.scenario for reference in matrix.references if not reference.ok]
    if lost:
        raise Failure(f"{len(lost)} of {len(matrix.references)} scenarios have no reference: {', '.join(lost)}")


def _print(matrix: Any) -> None:
    from ...validation.study.matrix.summary import BASE, reasons, summary_rows

    summary, first = summary_rows(matrix), matrix.sweep.levels[0]
    for level in matrix.sweep.levels:
        rows = []
        for row in summary:
            at = row["levels"][f"{level:.0e}"]
            without = f"{at['failed'] + at['broken']}/{at['refused']}/{at['limit']}/{at['short']}"
            figures = (at[name] for name in ("cpu_time", "evaluations", f"outer iterations over {BASE}", "energy_drift",
                                             "joint_force_error", "impulse_error"))  # fmt: skip
            rows.append((row["label"], at["reached"], without, *(_two(x) for x in figures)))
        columns = ("method", "reach it", "f/r/l/s", "CPU", "evaluations", f"iter./{BASE}", "energy", "joints",
                   "impulses")  # fmt: skip
        title = f"Error {level:.0e} of the motion, {len(matrix.scenarios)} scenarios: medians, costs over the least"
        print_table(title, columns, rows)
    print_table(
        "Largest residuals of all runs, and runs that failed with any tolerance",
        ("method", "position", "velocity", "acceleration", "failed", "runs"),
        [(row["label"], *(_two(x) for x in row["residuals"].values()), row["failed runs"], row["runs"])
         for row in summary],
    )  # fmt: skip
    stdout().print(LEGEND, markup=False)
    _print_budgets(matrix)
    why = reasons(matrix, first)
    if why:
        print_table(f"Without a figure at {first:.0e}", ("scenario", "method", "why"), why, left=3)
    stdout().print("All runs: --json, --csv or --report.", markup=False)


def _print_budgets(matrix: Any) -> None:
    """At equal cost: the error that each method has reached by then."""
    rows, found = [], [row for row in matrix.rows() if row["error at the budget"] is not None]
    for name in matrix.scenarios:
        here = [row for row in found if row["scenario"] == name]
        if not here:
            continue
        here.sort(key=lambda row: row["error at the budget"])
        best, worst = here[0], here[-1]
        rows.append((
            name, number(1e3 * best["budget"], 3), f"{best['label']} {best['error at the budget']:.0e}",
            f"{worst['label']} {worst['error at the budget']:.0e}", f"{len(here)} of {len(matrix.labels)}",
        ))  # fmt: skip
    columns = ("scenario", "budget, ms", "least error", "largest error", "methods within it")
    title = f"At equal CPU time (the median of what methods need for {matrix.sweep.levels[0]:.0e})"
    print_table(title, columns, rows, left=1)


def _two(value: Any) -> str:
    return "" if value is None else number(float(value), 2)
