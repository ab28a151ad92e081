"""`tlismni modes`: frequencies and damping of small vibrations about rest."""

from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import Debug, Json, PlotFile, Set, Source, check_suffix
from ..screen import compile_notice, number, print_json, print_table, say
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni modes cantilever --count 5 --plot modes.png\n\n  tlismni modes my_model.json --start --json"
)

Count = Annotated[int, typer.Option("--count", min=1, help="How many modes, from the lowest.")]
AtStart = Annotated[
    bool, typer.Option("--start", help="About the start, which must be a place of rest; else that is found first.")
]


@one_line_errors
def modes(
    source: Source,
    sets: Set = None,
    count: Count = 10,
    start: AtStart = False,
    plot: PlotFile = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Frequencies, damping ratios and shapes of a scenario's or a model file's vibrations about its place of rest."""
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    check_file(plot)

    from ...core.analysis import eigenmodes
    from ..source import ANY_END, read_source

    scenario = read_source(source, sets, t_end=ANY_END)
    with compile_notice():
        found = eigenmodes(scenario.model, settle=not start, count=count)
    figures = {
        "model": scenario.name,
        "stable": found.stable,
        "coordinates": list(found.coordinates),
        "modes": [
            {
                "eigenvalue": [value.real, value.imag],
                "frequency": frequency,
                "damping_ratio": ratio,
                "shape": {"real": shape.real.tolist(), "imaginary": shape.imag.tolist()},
            }
            for value, frequency, ratio, shape in zip(
                found.eigenvalues.tolist(),
                found.frequencies.tolist(),
                found.damping_ratios.tolist(),
                found.shapes,
                strict=True,
            )
        ],
    }
    if plot is not None:
        from ..analysis_plots import plot_modes

        plot_modes(found, scenario.name, plot)
    if json:
        print_json(figures)
        return
    rows = []
    for k, (value, frequency, ratio) in enumerate(
        zip(found.eigenvalues, found.frequencies, found.damping_ratios, strict=True)
    ):
        largest = int(abs(found.shapes[k]).argmax())
        rows.append((k + 1, float(frequency), number(float(ratio), 3), number(float(value.real), 4),
                     found.coordinates[largest]))  # fmt: skip
    title = f"{scenario.name}: modes about rest, {'stable' if found.stable else 'not stable'}"
    print_table(title, ("mode", "frequency Hz", "damping ratio", "growth 1/s", "moves most"), rows)
    if plot is not None:
        say(f"wrote {plot}")
