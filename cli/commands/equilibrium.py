"""`tlismni equilibrium`: where a model comes to rest, and what its joints and contacts then carry."""

from pathlib import Path
from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import Debug, Json, PlotFile, Set, Source, check_suffix
from ..screen import compile_notice, number, print_json, print_table, say, shortened
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni equilibrium cable_ground --plot rest.png\n\n"
    "  tlismni equilibrium my_model.json --output resting.json --json"
)

RestFile = Annotated[
    Path | None, typer.Option("--output", "-o", help="Write the model that starts at rest, .json.")
]  # fmt: skip


@one_line_errors
def equilibrium(
    source: Source,
    sets: Set = None,
    output: RestFile = None,
    plot: PlotFile = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Find the place of rest that a scenario or a model file creeps to from its start."""
    check_suffix(output, (".json",), "--output")
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    check_file(output)
    check_file(plot)

    from ...core.analysis import eigenmodes, static_equilibrium
    from ..source import ANY_END, read_source

    scenario = read_source(source, sets, t_end=ANY_END)
    with compile_notice():
        found = static_equilibrium(scenario.model)
        stable = eigenmodes(found).stable
    # rates are zero at rest, and accounts hold nothing of interest
    kinds = {c.name: c for c in found.sim.channels}
    wanted = [
        name
        for name, channel in kinds.items()
        if channel.unit in ("m", "rad", "N", "N.m", "1")
        and channel.kind == "real"
        and not name.startswith(("energy.", "residual."))
    ]
    figures = {
        "model": scenario.name,
        "stable": stable,
        "iterations": found.iterations,
        "unbalanced": found.unbalanced,
        "closed": list(found.closed),
        "channels": {name: found[name] for name in wanted},
    }
    if output is not None:
        found.model.save(output)
    if plot is not None:
        from ..analysis_plots import plot_equilibrium

        plot_equilibrium(found, scenario, plot)
    if json:
        print_json(figures)
    else:
        title = f"{scenario.name}: at rest, {'stable' if stable else 'not stable'}"
        rows = [(name, number(found[name]), kinds[name].unit) for name in wanted]
        print_table(title, ("channel", "value", "unit"), shortened(rows, 60))
    for path in (output, plot):
        if path is not None and not json:
            say(f"wrote {path}")
