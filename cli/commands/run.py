"""`tlismni run`: integrate, and say what happened."""

import typer

from ..errors import one_line_errors
from ..options import (
    ANIMATION_KINDS,
    RESULT_KINDS,
    AnimationFile,
    Atol,
    ChannelNames,
    Debug,
    EndTime,
    Every,
    Hold,
    InputValues,
    Json,
    MethodName,
    MethodOption,
    PlotFile,
    ResultFile,
    Rtol,
    Set,
    Source,
    Spline,
    Step,
    StepsFile,
    check_suffix,
)
from ..screen import compile_notice, print_json, progress_bar, say
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni run pendulum_stop --set restitution=0.5 --plot swing.png\n\n"
    "  tlismni run chain --set links=20 --method hht --option alpha=-0.1 --step 1e-3\n\n"
    "  tlismni run my_model.json --t-end 2 --output result.csv --json\n\n"
    "  tlismni run my_model.json --t-end 2 --input force.csv --channel rod.angle --every 0.01 --output out.csv\n\n"
    "  tlismni run hub_beam_stop --animate motion.html --output result.npz"
)

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""


@one_line_errors
def run(
    source: Source,
    sets: Set = None,
    t_end: EndTime = None,
    method: MethodName = None,
    rtol: Rtol = None,
    atol: Atol = None,
    step: Step = None,
    option: MethodOption = None,
    every: Every = None,
    inputs: InputValues = None,
    hold: Hold = False,
    spline: Spline = False,
    channels: ChannelNames = None,
    output: ResultFile = None,
    plot: PlotFile = None,
    steps: StepsFile = None,
    animate: AnimationFile = None,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Run a scenario or a model file, and print events, constraint residuals, energy balance and statistics."""
    check_suffix(output, RESULT_KINDS, "--output")
    check_suffix(animate, ANIMATION_KINDS, "--animate")
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    check_suffix(steps, (".csv",), "--steps")
    if hold and spline:
        raise typer.BadParameter("inputs are held or on a spline, not both", param_hint="--hold")
    for path in (output, plot, steps, animate):
        check_file(path)
    if channels and output is not None and output.suffix.lower() == ".npz":
        raise typer.BadParameter("a .npz holds the whole result: choose channels of a table", param_hint="--channel")

    from ...core import ModelError, simulate
    from ..input_files import read_inputs
    from ..recording import affordable_stride, record_bytes
    from ..source import read_source
    from ..summary import print_summary, summarise
    from ..times import times_of

    scenario = read_source(source, sets, t_end=t_end, method=method, rtol=rtol, atol=atol, step=step, options=option)
    times = None if every is None else times_of(scenario.t_end, every)
    stride = affordable_stride(scenario)
    if times is None and stride > 1:
        say(
            f"all steps would fill about {record_bytes(scenario) / 1e9:.2g} GB: recording every {stride}th "
            "(--every chooses times instead)"
        )
    wanted = [name.strip() for text in channels or () for name in text.split(",")]
    between = "hold" if hold else "spline" if spline else "linear"
    course = read_inputs(inputs or (), scenario.model, between, tuple(scenario.parameters))
    stopped = False
    with compile_notice(), progress_bar(scenario.name, scenario.t_end) as progress:
        try:
            result = simulate(
                scenario.model,
                scenario.t_end,
                scenario.method,
                scenario.rtol,
                scenario.atol,
                t_eval=times,
                record=stride,
                progress=progress,
                step_records=steps is not None,
                inputs=course,
                **scenario.options,
            )
        except KeyboardInterrupt as stop:
            kept = getattr(stop, "partial", None)
            if kept is None or len(kept) == 0:
                raise
            result, stopped = kept, True
    if stopped:
        say(f"stopped at t = {result.t[-1]:.6g} s of {scenario.t_end:.6g} s: what was reached is kept")
    missing = [name for name in wanted if name not in result.channels]
    if missing:
        raise ModelError(f"there are no channels {missing}; there are {list(result.channels)}")
    files = []
    if output is not None:
        from ..result_files import write_result

        files.append(write_result(result, output, wanted or None))
    if plot is not None:
        from ..plots import plot_result

        files.append(plot_result(result, scenario, plot, wanted or None))
    if steps is not None:
        from ..result_files import write_table

        files.append(write_table(steps, result.steps))
    if animate is not None:
        from ..animations import write_animation

        files.append(write_animation(result, scenario, animate))
    figures = {**summarise(scenario, result), "files": [str(path) for path in files]}
    if stopped:
        figures["stopped_at"] = float(result.t[-1])
    if json:
        print_json(figures)
    else:
        print_summary(figures)
        for path in files:
            say(f"wrote {path}")
    if stopped:
        raise typer.Exit(INTERRUPTED)
