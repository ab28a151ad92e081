"""`tlismni linearise`: the matrices A, B, C, D from inputs to channels about rest."""

from pathlib import Path
from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import Debug, Json, PlotFile, Set, Source, check_suffix
from ..screen import compile_notice, number, print_json, print_table, say
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni linearise my_model.json --from force --to end.x --plot bode.png\n\n"
    "  tlismni linearise my_model.json --output linear.npz"
)

From = Annotated[list[str] | None, typer.Option("--from", metavar="INPUT", help="Input; may be repeated. All if none.")]
To = Annotated[list[str] | None, typer.Option("--to", metavar="CHANNEL", help="Output; may be repeated. All if none.")]
MatrixFile = Annotated[Path | None, typer.Option("--output", "-o", help="Write A, B, C, D and names, .npz.")]


@one_line_errors
def linearise(
    source: Source,
    sets: Set = None,
    inputs: From = None,
    outputs: To = None,
    output: MatrixFile = None,
    plot: PlotFile = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Linearise a scenario or a model file about its place of rest: x' = A x + B u, y = C x + D u."""
    check_suffix(output, (".npz",), "--output")
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    check_file(output)
    check_file(plot)

    import numpy as np

    from ...core.analysis import state_space
    from ..source import ANY_END, read_source

    scenario = read_source(source, sets, t_end=ANY_END)
    with compile_notice():
        found = state_space(scenario.model, inputs or None, outputs or None)
    if output is not None:
        from ...core.results.files import write_arrays
        from ..result_files import replace_whole

        matrices = {name: getattr(found, name) for name in "ABCD"}
        names = {name: np.array(getattr(found, name)) for name in ("states", "inputs", "outputs")}

        replace_whole(output, lambda path: write_arrays(Path(path), {**matrices, **names}))
    if plot is not None:
        from ..analysis_plots import plot_bode

        plot_bode(found, scenario.name, plot)
    poles = sorted(found.poles.tolist(), key=lambda pole: (abs(pole), pole.imag))
    if json:
        print_json(
            {
                "model": scenario.name,
                "states": found.states,
                "inputs": found.inputs,
                "outputs": found.outputs,
                **{name: getattr(found, name) for name in "ABCD"},
                "poles": [[pole.real, pole.imag] for pole in poles],
            }
        )
        return
    size = f"{len(found.states)} states, {len(found.inputs)} inputs, {len(found.outputs)} outputs"
    rows = [(number(pole.real), number(pole.imag)) for pole in poles]
    print_table(f"{scenario.name}: {size}; poles", ("real 1/s", "imaginary 1/s"), rows, left=0)
    for path in (output, plot):
        if path is not None:
            say(f"wrote {path}")
