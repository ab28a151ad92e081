"""`tlismni sensitivities`: how channels answer to small changes of parameters, through impacts too."""

from typing import Annotated, Any

import typer

from ..errors import one_line_errors
from ..options import Atol, Debug, EndTime, Every, Json, MethodName, PlotFile, Rtol, Set, Source, check_suffix
from ..screen import compile_notice, number, print_json, print_table, say
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni sensitivities bouncing_ball --parameter ball.mass --parameter floor.law.restitution "
    "--channel ball.y --every 0.01 --plot answers.png"
)

Parameters = Annotated[
    list[str] | None,
    typer.Option("--parameter", metavar="NAME", help="Parameter, or place of a number (ball.mass); may be repeated."),
]
Channels = Annotated[
    list[str] | None, typer.Option("--channel", metavar="NAME", help="Channel; may be repeated.")
]  # fmt: skip


@one_line_errors
def sensitivities(
    source: Source,
    sets: Set = None,
    parameters: Parameters = None,
    channels: Channels = None,
    t_end: EndTime = None,
    method: MethodName = None,
    rtol: Rtol = None,
    atol: Atol = None,
    every: Every = None,
    plot: PlotFile = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Derivatives of channels by parameters at the end of a run, or at intervals (--every), and how sure they are."""
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    check_file(plot)

    from ...core.analysis import parameter_sensitivities
    from ..source import read_source
    from ..times import times_of

    scenario = read_source(source, sets, t_end=t_end)
    names = parameters or [p.name for p in scenario.model.parameters]
    if not names:
        raise typer.BadParameter("the model declares no parameters: name places of numbers", param_hint="--parameter")
    wanted = channels or list(scenario.compare)
    given = (("method", method), ("rtol", rtol), ("atol", atol))
    settings: dict[str, Any] = {name: value for name, value in given if value is not None}
    with compile_notice():
        found = parameter_sensitivities(
            scenario.model, scenario.t_end, names, wanted,
            t_eval=None if every is None else times_of(scenario.t_end, every), **settings,
        )  # fmt: skip
    if plot is not None:
        from ..analysis_plots import plot_sensitivities

        plot_sensitivities(found, scenario.name, plot)
    if json:
        print_json(
            {
                "model": scenario.name, "parameters": dict(zip(found.parameters, found.values.tolist(), strict=True)),
                "channels": found.channels, "t": found.t, "derivatives": found.derivatives, "errors": found.errors,
            }
        )  # fmt: skip
        return
    rows = [
        (channel, name, number(float(found.derivatives[p, -1, c])), number(float(found.errors[p, -1, c]), 2),
         number(float(found.relative[p, -1, c])))
        for c, channel in enumerate(found.channels)
        for p, name in enumerate(found.parameters)
    ]  # fmt: skip
    title = f"{scenario.name}: at t = {found.t[-1]:g} s"
    print_table(title, ("channel", "parameter", "derivative", "unsure by", "for its own value"), rows, left=2)
    if plot is not None:
        say(f"wrote {plot}")
