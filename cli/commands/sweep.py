"""`tlismni sweep`: a scenario or a model at many points of its parameters, kept in a folder, as one table."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import one_line_errors
from ..options import Atol, Debug, EndTime, Every, Json, MethodName, MethodOption, Rtol, Set, Source, Step, check_suffix
from ..screen import compile_notice, number, print_json, print_table, progress_bar, say, shortened
from ..targets import check_file, check_folder

EXAMPLES = (
    "Examples:\n\n  tlismni sweep bouncing_ball --vary restitution=0:1:101 --out bounces --plot ball.y\n\n"
    "  tlismni sweep impact_oscillator --vary start.mass.x=-2:0:50 --vary start.mass.vx=-2:2:50 --out basin\n\n"
    "  tlismni sweep my_model.json --t-end 2 --vary ball.mass=1:3 --samples 1000 --out study --cluster tcp://host:8786"
)

Vary = Annotated[
    list[str],
    typer.Option(
        "--vary",
        metavar="NAME=VALUES",
        help="first:last:count, a list 1,2,5, or with --samples a range low:high; may be repeated. Names: parameters, "
        "inputs, places of numbers (ball.mass), start values (start.ball.vy).",
    ),
]
Out = Annotated[
    Path, typer.Option("--out", metavar="DIR", help="Folder of the answers; the same call again goes on there.")
]
Samples = Annotated[int | None, typer.Option("--samples", min=1, help="So many points within ranges, not a grid.")]
SamplingName = Annotated[str, typer.Option("--sampling", help="latin (hypercube), random or sobol.")]
Seed = Annotated[int, typer.Option("--seed", help="Of the samples.")]
Channels = Annotated[
    list[str] | None, typer.Option("--channel", metavar="NAME", help="Channel to keep; may be repeated. All if none.")
]
Cluster = Annotated[str | None, typer.Option("--cluster", help="Address of a Dask scheduler, tcp://host:8786.")]
Threads = Annotated[int | None, typer.Option("--threads", min=1, help="Without a cluster; all cores if left out.")]
Part = Annotated[int, typer.Option("--part", min=1, help="Runs that are kept together.")]
Plot = Annotated[
    str | None, typer.Option("--plot", metavar="COLUMN", help="Draw this column over the first name: DIR/COLUMN.png.")
]
Over = Annotated[str | None, typer.Option("--over", metavar="COLUMN", help="Draw it over this column.")]
Colour = Annotated[str | None, typer.Option("--colour", metavar="COLUMN", help="And colour it by this one.")]

MOST_COLUMNS = 8
"""Parameters and channels up to which a sweep is shown on the screen."""


@one_line_errors
def sweep(
    source: Source,
    vary: Vary,
    out: Out,
    sets: Set = None,
    samples: Samples = None,
    sampling: SamplingName = "latin",
    seed: Seed = 0,
    channels: Channels = None,
    t_end: EndTime = None,
    every: Every = None,
    method: MethodName = None,
    rtol: Rtol = None,
    atol: Atol = None,
    step: Step = None,
    option: MethodOption = None,
    cluster: Cluster = None,
    threads: Threads = None,
    part: Part = 100,
    plot: Plot = None,
    over: Over = None,
    colour: Colour = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Run a scenario or a model file at many points; resumable, failures kept with their cause, one table (Parquet)."""
    check_folder(out)

    from ...core.sweeps import sweep as run_sweep
    from ..options import pairs
    from ..sweeping import axis_of, problem_of, range_of
    from ..times import times_of

    wanted = pairs(vary, "--vary")
    axes: dict[str, Any] = {
        name: (axis_of(text) if samples is None else range_of(text)) for name, text in wanted.items()
    }  # fmt: skip
    with compile_notice():
        problem, end = problem_of(
            source, sets, t_end=t_end, method=method, rtol=rtol, atol=atol, step=step, options=option,
            channels=channels, times=None if every is None else (lambda end: times_of(end, every)),
        )  # fmt: skip
        with progress_bar("sweep", 1.0) as progress:
            found = run_sweep(
                problem, axes, out=out, samples=samples, sampling=sampling, seed=seed, cluster=cluster,
                threads=threads, part=part, progress=lambda done, count: progress(done / count),
            )  # fmt: skip
    files = [str(out / "table.parquet")]
    if plot is not None:
        target = out / f"{plot}.png"
        check_suffix(target, (".png",), "--plot")
        check_file(target)
        found.plot(plot, over, colour, target)
        files.append(str(target))
    causes: dict[str, int] = {}
    for cause in found.failures.values():
        causes[cause] = causes.get(cause, 0) + 1
    if json:
        print_json(
            {
                "source": source, "t_end": end, "runs": len(found), "names": found.names, "columns": found.columns,
                "failed": {str(row): cause for row, cause in found.failures.items()}, "files": files,
            }
        )  # fmt: skip
        return
    if channels and len(shown := [*found.names, *(name for name in found.columns if name in channels)]) <= MOST_COLUMNS:
        print_table("", shown, shortened(list(zip(*(found[name].tolist() for name in shown), strict=True))))
    print_table("", ("what", "count"), [("runs", len(found)), ("failed", len(found.failures))])
    if causes:
        rows = sorted(((number(count), cause) for cause, count in causes.items()), key=lambda row: -int(row[0]))
        print_table("causes", ("runs", "cause"), shortened(rows, 10), left=2)
    for path in files:
        say(f"wrote {path}")
