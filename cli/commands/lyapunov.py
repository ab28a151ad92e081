"""`tlismni lyapunov`: exponents of a system with impacts, how they converged, and the identity of their sum."""

from typing import Annotated, Any

import typer

from ..errors import one_line_errors
from ..options import (
    Atol,
    Debug,
    EndTime,
    Json,
    MethodName,
    MethodOption,
    PlotFile,
    Rtol,
    Set,
    Source,
    Step,
    check_suffix,
    positive,
)
from ..screen import compile_notice, number, print_json, print_table, progress_bar, say, stdout
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni lyapunov impact_oscillator --periods 500 --plot exponents.png\n\n"
    "  tlismni lyapunov impact_oscillator --set damping_ratio=0.02 --set frequency=2 --periods 200 --json\n\n"
    "  tlismni lyapunov my_model.json --t-end 100 --transient 20 --count 2"
)
METHOD, RTOL = "irk", 1e-7
TRANSIENT = 0.1
"""Of the run, if nothing is said."""

Periods = Annotated[
    float | None,
    typer.Option("--periods", callback=positive, help="End after this many periods of the force, instead of --t-end."),
]
Transient = Annotated[
    float | None, typer.Option("--transient", help="Time in s from which on the growth counts; a tenth if left out.")
]
Count = Annotated[int | None, typer.Option("--count", help="How many exponents, from the largest; all if left out.")]


@one_line_errors
def lyapunov(
    source: Source,
    sets: Set = None,
    t_end: EndTime = None,
    periods: Periods = None,
    transient: Transient = None,
    count: Count = None,
    method: MethodName = None,
    rtol: Rtol = None,
    atol: Atol = None,
    step: Step = None,
    option: MethodOption = None,
    plot: PlotFile = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Lyapunov exponents of a scenario or a model file whose contacts are constraints (law newton)."""
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    check_file(plot)
    if periods is not None and t_end is not None:
        raise typer.BadParameter("give --periods or --t-end, not both", param_hint="--periods")

    from ...core.analysis import lyapunov_exponents
    from ...core.tolerances import DEFAULT_ATOL
    from ..source import read_source, solver_settings

    scenario = read_source(
        source, sets, t_end=1.0 if periods is not None else t_end, method=method or METHOD, rtol=rtol or RTOL,
        atol=atol or DEFAULT_ATOL, step=step, options=option,
    )  # fmt: skip
    period = _period(scenario.model)
    end = scenario.t_end
    if periods is not None:
        if period is None:
            raise typer.BadParameter(
                f"'{scenario.name}' has no Sine, or several frequencies: give --t-end", param_hint="--periods"
            )
        end = periods * period
    start = TRANSIENT * end if transient is None else transient
    with compile_notice(), progress_bar(scenario.name, end) as progress:
        result = lyapunov_exponents(
            scenario.model, end, scenario.method, scenario.rtol, scenario.atol, transient=start, count=count,
            progress=progress, **scenario.options,
        )  # fmt: skip
    files = []
    if plot is not None:
        from ..lyapunov_plot import plot_lyapunov

        files.append(plot_lyapunov(result, scenario.name, period, plot))
    figures: dict[str, Any] = {
        "scenario": scenario.name,
        "parameters": dict(scenario.parameters),
        "solver": solver_settings(scenario),
        "period": period,
        **result.to_dict(),
        "files": [str(path) for path in files],
    }
    if json:
        print_json(figures)
        return
    _print(figures)
    for path in files:
        say(f"wrote {path}")


def _period(model: Any) -> float | None:
    """Period of the model's time functions, s, if they have one frequency."""
    import math

    from ...core import Sine

    signals = [s for element in model.elements() for s in element.signals() if isinstance(s, Sine)]
    frequencies = {abs(s.angular_frequency) for s in signals if s.angular_frequency}
    return 2.0 * math.pi / frequencies.pop() if len(frequencies) == 1 else None


def _print(figures: dict[str, Any]) -> None:
    solver = figures["solver"]
    duration = figures["end"] - figures["start"]
    stdout().print(
        f"{figures['scenario']}: {number(figures['start'])} to {number(figures['end'])} s with {solver['method']}, "
        f"{figures['impacts']} impacts\n",
        markup=False,
    )
    rows = [(str(k + 1), x, e) for k, (x, e) in enumerate(zip(figures["exponents"], figures["errors"], strict=True))]
    print_table("Lyapunov exponents", ("", "1/s", "standard error"), rows)
    per_period = figures["impacts"] / duration * figures["period"] if figures["period"] else None
    totals: list[tuple[str, Any]] = [
        ("sum of the exponents, 1/s", sum(figures["exponents"])),
        ("divergence and 2 ln e of impacts, 1/s", figures["volume_rate"]),
        ("difference", number(figures["sum_residual"], 2)),
        ("Kaplan-Yorke dimension", figures["kaplan_yorke_dimension"]),
        *([("impacts a period", per_period)] if per_period is not None else []),
        ("steps", int(figures["stats"]["steps"])),
    ]
    print_table("", ("what", "figure"), totals)
