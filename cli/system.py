"""`tlismni cosim` of a coupled system: run it, say what was coupled and what it took, write results and a figure."""

from pathlib import Path
from typing import Any

import numpy as np

from ..core.results.plots import panels
from ..fmu_wrapper.master import Connection, SystemDescription, SystemResult, read_system, simulate_system
from ..models import load
from .plots import save
from .result_files import write_result
from .screen import compile_notice, number, print_json, print_table, progress_bar, say, stdout

MOST_PANELS = 10
MOST_UNCONNECTED = 12
"""Unconnected inputs that are named."""


def run_system(path: Path, changes: dict[str, Any], output: Path | None, plot: Path | None, as_json: bool) -> None:
    """Run the system in a file, with `changes` to its [master] settings."""
    description = read_system(path)
    changes = {name: value for name, value in changes.items() if value is not None}
    if changes:
        settings = {**description.master.model_dump(), **changes}
        description = description.model_copy(update={"master": type(description.master)(**settings)})
    with compile_notice(), progress_bar(description.name, description.master.t_end) as progress:
        result = simulate_system(description, path.parent, load_scenario=load, progress=progress)
    files = []
    if output is not None:
        files.append(write_result(result, output))
    if plot is not None:
        files.append(plot_system(description, result, plot))
    figures = _figures(description, result, files)
    if as_json:
        print_json(figures)
        return
    _print(description, figures)
    for file in files:
        say(f"wrote {file}")


def _figures(description: SystemDescription, result: SystemResult, files: list[Path]) -> dict[str, Any]:
    steps = np.diff(result.t)
    return {
        "system": description.name,
        "algorithm": description.master.algorithm,
        "t_end": description.master.t_end,
        "instances": list(description.instances),
        "connections": [{"from": c.source, "to": c.target} for c in description.connections],
        "unconnected": list(result.unconnected),
        "loops": list(result.loops),
        "shortest_step": float(steps.min()),
        "longest_step": float(steps.max()),
        "statistics": dict(result.stats),
        "final": {name: float(result[name][-1]) for name in drawn(description, result)},
        "files": [str(file) for file in files],
    }


def _print(description: SystemDescription, figures: dict[str, Any]) -> None:
    stdout().print(f"{figures['system']}: 0 to {number(figures['t_end'])} s with {figures['algorithm']}", markup=False)
    print_table("", ("input", "fed by"), [(c.target, _fed(c)) for c in description.connections], left=2)
    rows: list[tuple[str, Any]] = [
        ("size of communication steps", f"{number(figures['shortest_step'])} to {number(figures['longest_step'])} s"),
        *((name.replace("_", " "), value) for name, value in figures["statistics"].items()),
        *(("algebraic loop", loop) for loop in figures["loops"]),
    ]
    if figures["unconnected"]:
        names = figures["unconnected"]
        more = f" and {len(names) - MOST_UNCONNECTED} more" if len(names) > MOST_UNCONNECTED else ""
        rows.append(("inputs that nothing feeds", ", ".join(names[:MOST_UNCONNECTED]) + more))
    print_table("", ("coupling", ""), rows)
    print_table("", ("at the end", ""), list(figures["final"].items()))


def _fed(connection: Connection) -> str:
    if connection.factor == 1.0:
        return connection.source
    unit = "" if connection.unit == "1" else f" {connection.unit}"
    return f"{number(connection.factor)}{unit} × {connection.source}"


def drawn(description: SystemDescription, result: SystemResult) -> list[str]:
    """What is drawn: the system's choice, else what is coupled, else the first columns."""
    ends = [
        name for c in description.connections for name in ((c.source, c.target) if c.factor != 1.0 else (c.source,))
    ]
    wanted = description.plot or tuple(dict.fromkeys(ends))[:MOST_PANELS]
    found = [name for name in wanted if name in result.columns]
    missing = [name for name in description.plot if name not in result.columns]
    if missing:
        result[missing[0]]  # raises, and names what there is
    return found or list(result.channels[:4])


def plot_system(description: SystemDescription, result: SystemResult, path: Path) -> Path:
    """The chosen columns over time, and the communication step if it is controlled."""
    names = drawn(description, result)
    units = {channel.name: channel.unit for channel in result.channel_records}
    controlled = description.master.control is not None
    figure, axes = panels(len(names) + controlled)
    for axis, name in zip(axes, names, strict=False):
        axis.plot(result.t, result[name], lw=1.0)
        axis.set_ylabel(f"{name}\n{units[name]}")
    if controlled:
        axes[-1].semilogy(result.t[1:], np.diff(result.t), ".", ms=3.0)
        axes[-1].set_ylabel("communication\nstep, s")
    figure.suptitle(f"{description.name}, {description.master.algorithm}", fontsize=10)
    return save(figure, path)
