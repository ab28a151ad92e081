"""`tlismni info`: what an FMU is, says of itself, and needs."""

from typing import Any

from ..errors import one_line_errors
from ..fmu_file import read_fmu
from ..options import Debug, ExistingFmu, Json
from ..screen import print_json, print_table, stdout

EXAMPLES = "Examples:\n\n  tlismni info pendulum.fmu\n\n  tlismni info pendulum.fmu --json"

_FACTS = {
    "generator": "generator",
    "token": "token",
    "stop time, s": "t_end",
    "communication step, s": "communication_step",
    "tolerance": "tolerance",
}
_CAUSALITIES = {"parameter": "parameters", "input": "inputs", "output": "outputs", "local": "constants"}


@one_line_errors
def info(fmu: ExistingFmu, json: Json = False, debug: Debug = False) -> None:
    """Show what an FMU is: version, experiment, capabilities, terminals, variables, and what it needs to run."""
    found = read_fmu(fmu)
    if json:
        print_json(found)
        return
    out = stdout()
    out.print(f"{found['model']} (FMI {found['fmi']}): {found['description']}", markup=False)
    rows: list[tuple[Any, ...]] = [(title, found[key]) for title, key in _FACTS.items()]
    rows += [("binaries for", ", ".join(found["binaries"]))]
    rows += [("it can do", ", ".join(found["capabilities"])), *_runs_with(found)]
    print_table("", ("", ""), [(key, "-" if value is None else value) for key, value in rows], left=2)
    if found["terminals"]:
        columns = ("terminal", "members", "meaning")
        members = [", ".join(f"{m} = {v}" for m, v in t["members"].items()) for t in found["terminals"]]
        rows = [(t["name"], m, t["description"]) for t, m in zip(found["terminals"], members, strict=True)]
        print_table("terminals", columns, rows, left=3)
    headings = ("variable", "start", "unit", "range", "meaning")
    for causality, title in _CAUSALITIES.items():
        of_kind = [v for v in found["variables"] if v["causality"] == causality]
        if of_kind:
            shown = [_row(v) for v in of_kind]
            used = [k for k in range(len(headings)) if any(row[k] for row in shown)]
            print_table(title, [headings[k] for k in used], [[row[k] for k in used] for row in shown], left=len(used))


def _runs_with(found: dict[str, Any]) -> list[tuple[str, Any]]:
    """What an FMU of ours says of its Python, package and solver."""
    python = found["python"]
    if found["native"]:
        return [("runs with", "nothing but the C library: it needs no Python")]
    if not python:
        return []
    carried = f"tlismni {python.get('tlismni')}" + (" (inside the FMU)" if found["bundle"] else "")
    return [
        ("exported with", f"Python {python.get('version')} in {python.get('prefix')}"),
        ("runs with", ", ".join([carried, *found["requires"]])),
        ("solver", ", ".join(f"{k}={v}" for k, v in found["solver"].items())),
    ]


def _row(variable: dict[str, Any]) -> tuple[str, str, str, str, str]:
    low, high = variable["min"], variable["max"]
    limits = "" if low is None and high is None else f"{'' if low is None else f'{low:g}'} .. "
    limits += "" if high is None else f"{high:g}"
    shown = ", ".join(variable.get("choices", ())) if variable["causality"] == "parameter" else limits
    return (
        variable["name"], variable["start"] or "", variable["unit"] or "", shown or limits,
        variable["description"] or "",
    )  # fmt: skip
