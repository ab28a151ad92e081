"""`tlismni run`: integrate, and say what happened."""

from ..errors import one_line_errors
from ..options import (
    ANIMATION_KINDS,
    RESULT_KINDS,
    AnimationFile,
    Atol,
    Debug,
    EndTime,
    Every,
    Json,
    MethodName,
    MethodOption,
    PlotFile,
    ResultFile,
    Rtol,
    Set,
    Source,
    Step,
    StepsFile,
    check_samples,
    check_suffix,
)
from ..screen import compile_notice, print_json, progress_bar, say
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni run pendulum_stop --set restitution=0.5 --plot swing.png\n\n"
    "  tlismni run chain --set links=20 --method hht --option alpha=-0.1 --step 1e-3\n\n"
    "  tlismni run my_model.json --t-end 2 --output result.csv --json\n\n"
    "  tlismni run hub_beam_stop --animate motion.html --output result.npz"
)


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
    for path in (output, plot, steps, animate):
        check_file(path)

    from ...core import simulate
    from ..recording import affordable_stride, record_bytes
    from ..source import read_source
    from ..summary import print_summary, summarise

    scenario = read_source(source, sets, t_end=t_end, method=method, rtol=rtol, atol=atol, step=step, options=option)
    times = None if every is None else _times(scenario.t_end, every)
    stride = affordable_stride(scenario)
    if times is None and stride > 1:
        say(
            f"all steps would fill about {record_bytes(scenario) / 1e9:.2g} GB: recording every {stride}th "
            "(--every chooses times instead)"
        )
    with compile_notice(), progress_bar(scenario.name, scenario.t_end) as progress:
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
            **scenario.options,
        )
    files = []
    if output is not None:
        from ..result_files import write_result

        files.append(write_result(result, output))
    if plot is not None:
        from ..plots import plot_result

        files.append(plot_result(result, scenario, plot))
    if steps is not None:
        from ..result_files import write_table

        files.append(write_table(steps, result.steps))
    if animate is not None:
        from ..animations import write_animation

        files.append(write_animation(result, scenario, animate))
    figures = {**summarise(scenario, result), "files": [str(path) for path in files]}
    if json:
        print_json(figures)
    else:
        print_summary(figures)
        for path in files:
            say(f"wrote {path}")


def _times(t_end: float, every: float) -> list[float]:
    """0, every, 2 every ... and the end."""
    check_samples(t_end, every, "--every")
    count = int(t_end / every * (1.0 + 1e-12))
    times = [min(k * every, t_end) for k in range(count + 1)]
    return times if times[-1] >= t_end * (1.0 - 1e-12) else [*times, t_end]
