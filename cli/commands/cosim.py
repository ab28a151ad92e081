"""`tlismni cosim`: the FMU under fmpy against the same slave in process, bit for bit; or a coupled system."""

import tempfile
from pathlib import Path
from typing import Any

import typer

from ..errors import Failure, one_line_errors
from ..options import (
    Algorithm,
    Atol,
    CommunicationStep,
    Debug,
    EndTime,
    FmiVersion,
    FmuFolder,
    Irregular,
    Json,
    MethodName,
    MethodOption,
    PlotFile,
    Rtol,
    Set,
    Step,
    SystemOrSource,
    check_samples,
    check_suffix,
)
from ..screen import compile_notice, number, print_json, print_table, say, status_line, stdout
from ..targets import check_file, check_folder, is_system_file

EXAMPLES = (
    "Examples:\n\n  tlismni cosim pendulum_stop -o out/demo\n\n"
    "  tlismni cosim pendulum_stop --irregular --communication-step 0.03 --json\n\n"
    "  tlismni cosim system.toml -o result.csv --plot result.png"
)

STEP = 0.01
"""Communication step of the comparison, s."""


@one_line_errors
def cosim(
    source: SystemOrSource,
    communication_step: CommunicationStep = None,
    irregular: Irregular = False,
    fmi: FmiVersion = "2.0",
    folder: FmuFolder = None,
    sets: Set = None,
    t_end: EndTime = None,
    method: MethodName = None,
    rtol: Rtol = None,
    atol: Atol = None,
    step: Step = None,
    option: MethodOption = None,
    algorithm: Algorithm = None,
    plot: PlotFile = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Export the FMU, drive it with fmpy, and compare it with the same slave in process.

    At every communication point all outputs must be the same bit for bit; if not, the exit code is 1. For
    information, the run is compared with one that has no communication points too.

    With a system file (SYSTEM.toml): run the coupled FMUs that it describes.
    """
    if is_system_file(source):
        other = {
            "--irregular": irregular, "--fmi": fmi != "2.0", "--set": sets, "--method": method, "--rtol": rtol,
            "--atol": atol, "--step": step, "--option": option,
        }  # fmt: skip
        _system(Path(source), folder, plot, json, other, step=communication_step, t_end=t_end, algorithm=algorithm)
        return
    for name, value in (("--algorithm", algorithm), ("--plot", plot)):
        if value is not None:
            raise typer.BadParameter("it is for a system file (SYSTEM.toml)", param_hint=name)
    communication_step = communication_step or STEP
    check_folder(folder)

    from ...fmu_wrapper import export_fmu
    from ..cosimulation import communication_points, compare
    from ..source import read_source

    scenario = read_source(source, sets, t_end=t_end, method=method, rtol=rtol, atol=atol, step=step, options=option)
    check_samples(scenario.t_end, communication_step, "--communication-step")
    times = communication_points(scenario.t_end, communication_step, irregular)
    with tempfile.TemporaryDirectory(prefix="tlismni_", ignore_cleanup_errors=True) as temporary:
        place = Path(temporary) if folder is None else folder
        place.mkdir(parents=True, exist_ok=True)
        with compile_notice(), status_line("exporting the FMU") as tell:
            fmu = export_fmu(scenario, place / f"{scenario.name}.fmu", fmi, communication_step=communication_step)
            found = compare(scenario, fmu, Path(temporary) / "unzipped", times, tell)
        files = [] if folder is None else [fmu, *_write(folder, scenario, found)]
    figures = {**_figures(scenario, found, irregular), "files": [str(path) for path in files]}
    if json:
        print_json(figures)
    else:
        _print(figures)
        for path in files:
            say(f"wrote {path}")
    if found.first is not None:
        t, name = found.first
        raise Failure(
            f"FMU and slave differ in {len(found.different)} of {len(found.fmu)} outputs, first in '{name}' "
            f"at t = {number(t, 9)} s"
        )


def _system(
    path: Path, output: Path | None, plot: Path | None, json: bool, other: dict[str, Any], **changes: Any
) -> None:
    """Run a system file; `other` are options that mean nothing to it."""
    given = [name for name, value in other.items() if value]
    if given:
        raise typer.BadParameter(
            f"'{path}' describes its instances and their solvers itself: change them there", param_hint=given[0]
        )
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    if output is not None and output.suffix == "":
        check_folder(output)
        output, plot = output / f"{path.stem}.csv", plot or output / f"{path.stem}.png"
    check_suffix(output, (".csv", ".json", ".npz"), "--output")
    for file in (output, plot):
        check_file(file)

    from ..system import run_system

    run_system(path, changes, output, plot, json)


def _figures(scenario: Any, found: Any, irregular: bool) -> dict[str, Any]:
    import numpy as np

    from ..source import solver_settings

    steps = np.diff(found.times)
    return {
        "scenario": scenario.name,
        "parameters": dict(scenario.parameters),
        "t_end": scenario.t_end,
        "solver": solver_settings(scenario),
        "irregular": irregular,
        "communication_steps": len(steps),
        "shortest_step": float(steps.min()),
        "longest_step": float(steps.max()),
        "outputs": len(found.fmu),
        "values": found.values,
        "identical": found.identical,
        "different": list(found.different),
        "events": int(found.fmu["solver.events"][-1]),
        "uninterrupted": {
            name: {
                "largest_difference": float(np.max(np.abs(found.fmu[name] - values))),
                "largest_value": float(np.max(np.abs(values))),
            }
            for name, values in found.uninterrupted.items()
        },
    }


def _print(figures: dict[str, Any]) -> None:
    verdict = "identical bit for bit" if figures["identical"] else f"different: {', '.join(figures['different'])}"
    kind = "irregular" if figures["irregular"] else "regular"
    rows: list[tuple[str, Any]] = [
        ("communication steps", f"{figures['communication_steps']}, {kind}"),
        ("their size", f"{number(figures['shortest_step'])} to {number(figures['longest_step'])} s"),
        ("contact events", figures["events"]),
        ("outputs", figures["outputs"]),
        ("values compared", figures["values"]),
        ("FMU and slave", verdict),
    ]
    stdout().print(
        f"{figures['scenario']}: 0 to {number(figures['t_end'])} s with {figures['solver']['method']}", markup=False
    )
    print_table("", ("FMU under fmpy against the slave in process", ""), rows)
    away = [
        (name, number(pair["largest_difference"], 3), number(pair["largest_value"]))
        for name, pair in figures["uninterrupted"].items()
    ]
    print_table("co-simulation against one uninterrupted run", ("output", "largest difference", "largest value"), away)


def _write(folder: Path, scenario: Any, found: Any) -> list[Path]:
    from ..plots import plot_cosimulation
    from ..result_files import write_table

    return [
        write_table(folder / f"{scenario.name}_fmu.csv", {"time": found.times, **found.fmu}),
        write_table(folder / f"{scenario.name}_slave.csv", {"time": found.times, **found.slave}),
        plot_cosimulation(scenario, found, folder / f"{scenario.name}_cosim.png"),
    ]
