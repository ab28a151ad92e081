"""`tlismni study contact` and `tlismni study stiffness`: impact laws against their absence, and against forces."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import Failure, one_line_errors
from ..options import Debug, Json, check_suffix
from ..screen import compile_notice, print_json, print_table, progress_bar, say, stdout

CONTACT_EXAMPLES = "Examples:\n\n  tlismni study contact --plot contact.png\n\n  tlismni study contact --json"
SUFFIXES = (".png", ".pdf", ".svg")
STIFFNESS_EXAMPLES = "Examples:\n\n  tlismni study stiffness\n\n  tlismni study stiffness --quick --json"
COLUMNS = ("method", "jump", "contacts", "restitution", "impulse", "energy", "release", "overlap", "velocity", "faults")
LEGEND = """\
impulse: relative error, until the first contact ends; energy: error right after it, relative to the kinetic energy
before; release: error of the time at which it ends, s; overlap: deepest penetration, m; velocity: largest violation of
joints and closed contacts, m/s. Faults: Impulse, Energy, Release, Penetration, Number of contacts"""


@one_line_errors
def contact(
    quick: Annotated[bool, typer.Option("--quick", help="The coarse steps only: a first look.")] = False,
    plot: Annotated[Path | None, typer.Option("--plot", help="Draw the figure: .png, .pdf or .svg.")] = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Impulse, release, energy and penetration at contact, with the velocity jump and without, against TLISMNI."""
    check_suffix(plot, SUFFIXES, "--plot")

    from ...validation.study import contact_study, fourth_claim

    with compile_notice(), progress_bar("contact", 1.0) as progress:
        rows = contact_study(quick=quick, progress=progress)
    files = []
    if plot is not None:
        from ...validation.study.contact_plots import plot_contact

        files.append(str(plot_contact(rows, plot)))
    claim = fourth_claim(rows)
    figures = {"rows": [row.to_dict() for row in rows], "claims": [claim.to_dict()], "quick": quick, "files": files}
    if json:
        print_json(figures)
        return
    _print(figures)
    for path in files:
        say(f"wrote {path}")


@one_line_errors
def stiffness(
    quick: Annotated[bool, typer.Option("--quick", help="Without the two largest stiffnesses.")] = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """How fast contact forces of growing stiffness K come to the impact of a constraint; exit code 1 if off theory."""
    from ...validation.study import STIFFNESS_CASES, stiffness_study

    with compile_notice(), progress_bar("stiffness", len(STIFFNESS_CASES)) as progress:
        rows = stiffness_study(quick=quick, progress=progress)
    figures: dict[str, Any] = {"rows": [row.to_dict() for row in rows], "quick": quick}
    if json:
        print_json(figures)
    else:
        table = [
            (
                row["label"], f"{row['theory']:.2f}", *(f"{rate:.4f}" for rate in row["observed"].values()),
                f"{row['stiffness'][-1]:.0e}", *(f"{values[-1]:+.0e}" for values in row["differences"].values()),
            )
            for row in figures["rows"]
        ]  # fmt: skip
        columns = ("case", "theory", "duration", "position", "impulse", "at K", "duration, s", "position", "impulse")
        print_table("Differences from the constraint's impact go as K to the power of", columns, table)
    off = [row.case.label for row in rows if not row.ok]
    if off:
        raise Failure(f"{len(off)} of {len(rows)} cases are off their theory: {'; '.join(off)}")


def _print(figures: dict[str, Any]) -> None:
    rows = figures["rows"]
    fine = min((row["step"] for row in rows if row["step"]), default=None)
    steps = [step for step in dict.fromkeys(row["step"] for row in rows) if step != fine or figures["quick"]]
    for problem in dict.fromkeys(row["problem"] for row in rows):
        for step in steps:
            here = [row for row in rows if (row["problem"], row["step"]) == (problem, step)]
            exact = here[0]["exact"]
            how = "error-controlled steps" if step is None else f"steps of {step:g} s"
            title = (
                f"{problem}, {how}\nright: {exact['contacts']} contacts, first impulse {exact['impulse']:.4g} N s, "
                f"restitution {exact['restitution']:.3g}"
            )
            print_table(title, COLUMNS, [_line(row) for row in here])
    stdout().print(LEGEND, markup=False)
    for claim in figures["claims"]:
        stdout().print(f"\n{claim['name']}: {claim['claim']}.\n  {claim['verdict'].upper()}", markup=False)
        for line in claim["observed"]:
            stdout().print(f"  - {line}", markup=False)


def _line(row: dict[str, Any]) -> tuple[Any, ...]:
    jump, found = "yes" if row["velocity_jump"] else "no", row["found"]
    if found is None:
        return (row["label"], jump, *[""] * 7, "no run")
    return (
        row["label"], jump, found["contacts"], f"{abs(found['restitution']):.3f}", f"{row['impulse_error']:+.0e}",
        f"{row['energy_error']:+.0e}", f"{row['release_error']:+.0e}", f"{found['penetration']:.0e}",
        f"{found['velocity']:.0e}", " ".join(fault[0].upper() for fault in row["faults"]) or "none",
    )  # fmt: skip
