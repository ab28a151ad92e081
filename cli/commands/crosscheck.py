"""`tlismni crosscheck`: the same scenario in exudyn, quantity by quantity."""

import os
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import Failure, one_line_errors
from ..options import Atol, Debug, EndTime, ExudynStep, Json, MethodName, MethodOption, ReportFolder, Rtol, Set
from ..screen import compile_notice, number, print_json, print_table, say, status_line, stdout
from ..targets import check_folder

SourceOrNone = Annotated[
    str | None,
    typer.Argument(metavar="[SCENARIO_OR_MODEL]", help="Name of a scenario (see `tlismni list`), or a model file."),
]
EXAMPLES = (
    "Examples:\n\n  tlismni crosscheck pendulum_stop --report out/check\n\n"
    "  tlismni crosscheck pendulum_stop --set law=hunt_crossley --json\n\n"
    "  tlismni crosscheck --all --report out/all"
)


@one_line_errors
def crosscheck(
    source: SourceOrNone = None,
    everything: Annotated[bool, typer.Option("--all", help="Every scenario, with an overview.")] = False,
    coarse: Annotated[bool, typer.Option("--coarse", help="With --all: the short form that the tests take.")] = False,
    workers: Annotated[
        int | None, typer.Option(min=1, help="With --all: cases at once; left out: as many as there are cores.")
    ] = None,
    report: ReportFolder = None,
    exudyn_step: ExudynStep = None,
    sets: Set = None,
    t_end: EndTime = None,
    method: MethodName = None,
    rtol: Rtol = None,
    atol: Atol = None,
    option: MethodOption = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Run a scenario or a model file here and in exudyn, and compare; exit code 1 if a quantity differs."""
    check_folder(report)
    if everything:
        if source is not None:
            raise typer.BadParameter("--all takes no scenario: give one or the other")
        return _everything(report, coarse, json, workers or os.cpu_count() or 1)
    if source is None:
        raise typer.BadParameter("name a scenario or a model file, or say --all")

    from ...validation import crosscheck as check
    from ..source import read_source

    scenario = read_source(source, sets, t_end=t_end, method=method, rtol=rtol, atol=atol, options=option)
    with compile_notice(), status_line(f"cross-checking {scenario.name}") as tell:
        found = check(scenario, report, tell, step=exudyn_step)
    figures = found.to_dict()
    if json:
        print_json(figures)
    else:
        _print(figures)
        for path in (found.report, *found.figures):
            if path is not None:
                say(f"wrote {path}")
    if not found.ok:
        differing = [row.quantity for row in found.rows if row.required and row.verdict == "differ"]
        raise Failure(f"{len(differing)} of {len(found.rows)} quantities differ: {', '.join(differing)}")


def _everything(report: Path | None, coarse: bool, json: bool, workers: int) -> None:
    from ...validation import crosscheck_all

    with compile_notice(), status_line("cross-checking the catalogue") as tell:
        found = crosscheck_all(report, tell, coarse=coarse, workers=workers)
    if json:
        print_json([outcome.to_dict() for outcome in found.outcomes])
    else:
        rows = [
            (o.case.scenario, " ".join(f"{k}={v}" for k, v in o.case.parameters.items()), o.verdict,
             number(o.seconds, 3), o.remark)
            for o in found.outcomes
        ]  # fmt: skip
        print_table("", ("scenario", "with", "verdict", "s", "why"), rows, left=2)
        say(f"{found.seconds:.0f} s, {found.cpu_seconds:.0f} s of the processor, {found.workers} at once")
        if found.report is not None:
            say(f"wrote {found.report}")
    if not found.ok:
        wrong = [o.case.name for o in found.outcomes if o.verdict in ("differ", "failed")]
        raise Failure(f"{len(wrong)} of {len(found.outcomes)} cases differ or fail: {', '.join(wrong)}")


def _print(figures: dict[str, Any]) -> None:
    rows = [
        (
            row["quantity"],
            row["unit"],
            row["ours"],
            row["exudyn"],
            number(row["difference"], 3),
            number(row["relative"], 3),
            f"{number(row['tolerance'], 3)} {row['tolerance_kind']}",
            row["verdict"],
        )
        for row in figures["rows"]
    ]
    columns = ("quantity", "unit", "tlismni", "exudyn", "difference", "relative", "tolerance", "verdict")
    stdout().print(f"{figures['scenario']}: {figures['kind']}, exudyn {figures['exudyn']['version']}", markup=False)
    print_table("", columns, rows, left=2)
    for note in figures["notes"]:
        stdout().print(f"- {note}", markup=False)
    verdict = "agreement in all required quantities" if figures["ok"] else "NOT in agreement"
    stdout().print(verdict, markup=False)
