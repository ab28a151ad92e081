"""`tlismni crosscheck`: the same scenario in exudyn, quantity by quantity."""

from typing import Any

from ..errors import Failure, one_line_errors
from ..options import (
    Atol,
    Debug,
    EndTime,
    ExudynStep,
    Json,
    MethodName,
    MethodOption,
    ReportFolder,
    Rtol,
    Set,
    Source,
)
from ..screen import compile_notice, number, print_json, print_table, say, status_line, stdout
from ..targets import check_folder

EXAMPLES = (
    "Examples:\n\n  tlismni crosscheck pendulum_stop --report out/check\n\n"
    "  tlismni crosscheck pendulum_stop --set law=hunt_crossley --json"
)


@one_line_errors
def crosscheck(
    source: Source,
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
