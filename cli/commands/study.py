"""`tlismni study`: observed orders of the methods, and the iterations that they need."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import Failure, one_line_errors
from ..options import Debug, Json, check_suffix
from ..screen import compile_notice, number, print_json, print_table, progress_bar, say, stdout
from .study_claims import CLAIMS_EXAMPLES, claims
from .study_contact import CONTACT_EXAMPLES, STIFFNESS_EXAMPLES, contact, stiffness
from .study_coupling import COUPLING_EXAMPLES, coupling
from .study_damping import DAMPING_EXAMPLES, damping
from .study_methods import METHODS_EXAMPLES
from .study_methods import methods as methods_command

ORDERS_EXAMPLES = (
    "Examples:\n\n  tlismni study orders --plot orders.png\n\n"
    "  tlismni study orders --method ebdf --method mebdf --json"
)
IMPACTS_EXAMPLES = "Examples:\n\n  tlismni study impacts\n\n  tlismni study impacts --method ebdf --method bdf --json"
ITERATIONS_EXAMPLES = (
    "Examples:\n\n  tlismni study iterations --plot iterations.png\n\n"
    "  tlismni study iterations --scenario chain --method hht --method ebdf --json"
)
SUFFIXES = (".png", ".pdf", ".svg")
SHOWN_TOLERANCE = 1e-6
"""The tolerance whose runs are printed in full (the nearest that ran); all are in the JSON."""

app = typer.Typer(
    help="The method study: orders on a smooth problem and through impacts, behaviour at contact, iterations.",
    no_args_is_help=True,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)

app.command("claims", epilog=CLAIMS_EXAMPLES)(claims)
app.command("methods", epilog=METHODS_EXAMPLES)(methods_command)
app.command("contact", epilog=CONTACT_EXAMPLES)(contact)
app.command("stiffness", epilog=STIFFNESS_EXAMPLES)(stiffness)
app.command("damping", epilog=DAMPING_EXAMPLES)(damping)
app.command("coupling", epilog=COUPLING_EXAMPLES)(coupling)

Methods = Annotated[
    list[str] | None, typer.Option("--method", "-m", help="Only this method; may be repeated (see `tlismni methods`).")
]
Quick = Annotated[bool, typer.Option("--quick", help="Fewer and coarser runs: a first look, not for quoting.")]
Plot = Annotated[Path | None, typer.Option("--plot", help="Draw the figures: .png, .pdf or .svg.")]


@app.command("orders", epilog=ORDERS_EXAMPLES)
@one_line_errors
def orders(
    method: Methods = None,
    quick: Quick = False,
    plot: Plot = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Observed orders of positions, velocities and multipliers; exit code 1 if one is off its theory."""
    check_suffix(plot, SUFFIXES, "--plot")

    from ...validation.study import order_cases, order_table

    with compile_notice(), progress_bar("orders", len(order_cases(method))) as progress:
        rows = order_table(method, quick=quick, progress=progress)
    files = []
    if plot is not None:
        from ...validation.study.plots import plot_orders

        files.append(str(plot_orders(rows, plot)))
    figures = {"rows": [row.to_dict() for row in rows], "quick": quick, "files": files}
    if json:
        print_json(figures)
    else:
        _print_orders(figures)
        for path in files:
            say(f"wrote {path}")
    off = [row.case.setting.label for row in rows if not row.ok]
    if off:
        raise Failure(f"{len(off)} of {len(rows)} orders are off their theory: {', '.join(off)}")


@app.command("impacts", epilog=IMPACTS_EXAMPLES)
@one_line_errors
def impacts(method: Methods = None, quick: Quick = False, json: Json = False, debug: Debug = False) -> None:
    """Orders of the times and impulses of six impacts in one run; exit code 1 if a method loses its order to them."""
    from ...validation.study import impact_orders, order_cases

    with compile_notice(), progress_bar("impacts", len(order_cases(method))) as progress:
        rows = impact_orders(method, quick=quick, progress=progress)
    figures: dict[str, Any] = {"rows": [row.to_dict() for row in rows], "quick": quick}
    if json:
        print_json(figures)
    else:
        table = [
            (
                row["label"],
                "?" if row["theory"] is None else row["theory"],
                *(f"{found:.2f}" for found in row["observed"].values()),
                f"{row['errors']['time'][-1]:.0e}" if row["steps"] else "",
                row["verdict"],
            )
            for row in figures["rows"]
        ]
        columns = ("method", "theory", "times", "impulses", "least error of the times, s", "verdict")
        print_table("Orders through six impacts: two rods and a wall, fixed steps", columns, table)
    lost = [row.case.setting.label for row in rows if row.verdict == "lost"]
    if lost:
        raise Failure(f"{len(lost)} of {len(rows)} methods lose their order to the impacts: {', '.join(lost)}")


@app.command("iterations", epilog=ITERATIONS_EXAMPLES)
@one_line_errors
def iterations(
    scenario: Annotated[
        list[str] | None, typer.Option("--scenario", "-s", help="Only this scenario; may be repeated.")
    ] = None,
    method: Methods = None,
    quick: Quick = False,
    plot: Plot = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Iterations at equal tolerance and at equal achieved error, and what they say about the papers' claims."""
    check_suffix(plot, SUFFIXES, "--plot")

    from ...validation.study import iteration_study

    with compile_notice(), progress_bar("iterations", 1.0) as progress:
        study = iteration_study(scenario, method, quick=quick, tell=lambda what, share: progress(share))
    files = []
    if plot is not None:
        from ...validation.study.plots import plot_iterations

        files.append(str(plot_iterations(study, plot)))
    figures = {**study.to_dict(), "quick": quick, "files": files}
    if json:
        print_json(figures)
        return
    _print_iterations(figures)
    for path in files:
        say(f"wrote {path}")


def _print_orders(figures: dict[str, Any]) -> None:
    rows = []
    for row in figures["rows"]:
        theory, observed = row["theory"], row["observed"]
        window = row["window"]["position"]["errors"]
        span = f"{window[0]:.0e} … {window[-1]:.0e}" if window else ""
        rows.append(
            (
                row["label"],
                "?" if theory["position"] is None else theory["position"],
                *(f"{observed[name]:.2f}" for name in observed),
                span,
                row["verdict"],
            )
        )
    columns = ("method", "theory", "position", "velocity", "multipliers", "position errors, m", "verdict")
    print_table("Observed orders: a point on a circle, fixed steps", columns, rows)


def _print_iterations(figures: dict[str, Any]) -> None:
    for problem in figures["problems"]:
        for loop in dict.fromkeys(run["outer"] for run in figures["runs"]):
            here = [run for run in figures["runs"] if (run["problem"], run["outer"]) == (problem["label"], loop)]
            _print_runs(f"{problem['label']}, {problem['t_end']:g} s, outer loop {loop}", here)
            at = [row for row in figures["equal_error"] if (row["problem"], row["outer"]) == (problem["label"], loop)]
            _print_equal_error(at)
        stdout().print(f"accuracy of the reference: {problem['reference_accuracy']:.1e}\n", markup=False)
    for claim in figures["claims"]:
        stdout().print(f"{claim['name']}: {claim['claim']}.\n  {claim['verdict'].upper()}", markup=False)
        for line in claim["observed"]:
            stdout().print(f"  - {line}", markup=False)


def _print_runs(title: str, runs: list[dict[str, Any]]) -> None:
    tolerance = min((run["tolerance"] for run in runs), key=lambda t: abs(t - SHOWN_TOLERANCE))
    rows = [
        (
            run["label"], run["steps"], run["outer_iterations"], f"{run['per_step']:.2f}", run["evaluations"],
            run["factorizations"], number(1e3 * run["wall_time"], 3), f"{run['error']:.1e}",
        )
        if run["ok"]
        else (run["label"], "no run", *[""] * 6)
        for run in runs
        if run["tolerance"] == tolerance
    ]  # fmt: skip
    columns = ("method", "steps", "outer iterations", "a step", "evaluations", "factorisations", "time, ms", "error")
    print_table(f"{title}: rtol {tolerance:.0e}", columns, rows)
    for run in runs:
        if not run["ok"]:
            stdout().print(f"no run of {run['label']} with rtol {run['tolerance']:.0e}: {run['failure']}", markup=False)


def _print_equal_error(table: list[dict[str, Any]]) -> None:
    levels = sorted({row["error"] for row in table}, reverse=True)
    if not levels:
        return
    found = {(row["label"], row["error"]): row["outer_iterations"] for row in table}
    rows = [
        (label, *(f"{found[label, level]:.0f}" if (label, level) in found else "" for level in levels))
        for label in dict.fromkeys(row["label"] for row in table)
    ]
    print_table("outer iterations for an error of", ("method", *(f"{level:.0e}" for level in levels)), rows)
