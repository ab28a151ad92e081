"""The options that commands share, as types, and how their values are read."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from . import completion


def positive(value: float | None) -> float | None:
    """Refuse what is not a positive finite number (a wrong usage, exit code 2)."""
    if value is not None and not (math.isfinite(value) and value > 0.0):
        raise typer.BadParameter(f"{value!r} is not a positive number")
    return value


MOST_SAMPLES = 10_000_000
"""Points in time beyond this number are a slip of the pen: they would fill the memory."""


def check_samples(t_end: float, interval: float, option: str) -> None:
    """Refuse an interval (s) that would divide the run into more than MOST_SAMPLES parts."""
    if t_end / interval > MOST_SAMPLES:
        raise typer.BadParameter(
            f"{interval:g} s would give {t_end / interval:.3g} points up to t_end = {t_end:g} s, more than "
            f"{MOST_SAMPLES:.0e}: use at least {t_end / MOST_SAMPLES:.3g} s, or a smaller --t-end",
            param_hint=option,
        )


def pairs(given: Iterable[str], option: str) -> dict[str, str]:
    """`name=value` texts as a dict. Raises BadParameter for a text without `=` or a name given twice."""
    found: dict[str, str] = {}
    for text in given:
        name, separator, value = (part.strip() for part in text.partition("="))
        if not (name and separator):
            raise typer.BadParameter(f"'{text}' must read name=value", param_hint=option)
        if name in found:
            raise typer.BadParameter(f"'{name}' is given twice", param_hint=option)
        found[name] = value
    return found


def value_of(text: str) -> Any:
    """The number, switch or word that a text means."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return {"true": True, "false": False}.get(text.lower(), text)


def check_suffix(path: Path | None, suffixes: tuple[str, ...], option: str) -> None:
    """Refuse a file whose kind is unknown, before any work is done."""
    if path is not None and path.suffix.lower() not in suffixes:
        raise typer.BadParameter(f"'{path}' must end in {' or '.join(suffixes)}", param_hint=option)


RESULT_KINDS = (".npz", ".csv", ".json", ".parquet", ".nc", ".h5")
"""Of files of results: the first one holds everything, `tlismni play` and `load_result` read it."""
ANIMATION_KINDS = (".html", ".gif", ".mp4", ".glb")

_SOLVER, _OUTPUT = "Solver", "Output"

Source = Annotated[
    str,
    typer.Argument(
        metavar="SCENARIO_OR_MODEL",
        help="Name of a scenario (see `tlismni list`), or a model file.",
        autocompletion=completion.sources,
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Parameter of the scenario or model; may be repeated."),
]
EndTime = Annotated[
    float | None,
    typer.Option("--t-end", callback=positive, help="End time in s; a model file needs it."),
]
MethodName = Annotated[
    str | None,
    typer.Option(
        "--method",
        "-m",
        help="Integration method (see `tlismni methods`).",
        rich_help_panel=_SOLVER,
        autocompletion=completion.methods,
    ),
]
Rtol = Annotated[
    float | None, typer.Option("--rtol", callback=positive, help="Relative tolerance.", rich_help_panel=_SOLVER)
]
Atol = Annotated[
    float | None, typer.Option("--atol", callback=positive, help="Absolute tolerance.", rich_help_panel=_SOLVER)
]
Step = Annotated[
    float | None,
    typer.Option("--step", callback=positive, help="Fixed step in s, no error control.", rich_help_panel=_SOLVER),
]
MethodOption = Annotated[
    list[str] | None,
    typer.Option(
        "--option", metavar="NAME=VALUE", help="Option of the method; may be repeated.", rich_help_panel=_SOLVER
    ),
]
CommunicationStep = Annotated[
    float | None,
    typer.Option("--communication-step", "-c", callback=positive, help="Communication step in s."),
]
SystemOrSource = Annotated[
    str,
    typer.Argument(
        metavar="SCENARIO_OR_MODEL_OR_SYSTEM",
        help="Name of a scenario (see `tlismni list`), a model file, or a system file (.toml).",
    ),
]
Algorithm = Annotated[
    str | None,
    typer.Option("--algorithm", help="Of a system file: jacobi, gauss-seidel, iterated or newton in place of its own."),
]
Irregular = Annotated[bool, typer.Option("--irregular", help="Steps of 0.2 to 1.8 times that, the same in every run.")]
ExudynStep = Annotated[
    float | None, typer.Option("--exudyn-step", callback=positive, help="exudyn's step in s; chosen if left out.")
]
FmiVersion = Annotated[str, typer.Option("--fmi", help="Version of the FMI standard: 2 or 3.")]
FmuFile = Annotated[Path, typer.Option("--output", "-o", help="The FMU to write, .fmu.")]
Bundle = Annotated[
    bool,
    typer.Option("--bundle", help="Carry tlismni along; the machine then needs only numpy, scipy, numba, pydantic."),
]
Native = Annotated[
    bool,
    typer.Option("--native", help="An FMU that needs no Python where it runs; not every model can be one."),
]
Outputs = Annotated[
    list[str] | None,
    typer.Option(
        "--outputs",
        metavar="NAME[,NAME]",
        help="Only these channels become outputs (pendulum.*,stop.gap). All if none.",
    ),
]
Protect = Annotated[
    bool,
    typer.Option("--protect", help="With --native: show no parameters, laws and settings of the model."),
]
Sources = Annotated[
    bool, typer.Option("--sources", help="With --native: put the model's text into it, and its parts on the page.")
]
Arrays = Annotated[
    bool, typer.Option("--arrays", help="FMI 3: describe vectors as arrays too; not every master reads such FMUs.")
]
Platforms = Annotated[
    list[str] | None,
    typer.Option(
        "--platform", metavar="NAME",
        help="Add the binary for another platform, e.g. x86_64-windows, or all; may be repeated. Needs ziglang.",
    ),
]  # fmt: skip
Author = Annotated[str | None, typer.Option("--author", help="Who made the model; your login name if left out.")]
ModelVersion = Annotated[
    str | None, typer.Option("--model-version", help="Version of the model; a digest of its content if left out.")
]
ExecutionTool = Annotated[
    bool,
    typer.Option(
        "--execution-tool/--no-execution-tool",
        help="What the FMU says of itself: that it needs a tool (a Python) on the machine. Some masters refuse that.",
    ),
]
ExistingFmu = Annotated[
    Path, typer.Argument(metavar="FMU", exists=True, dir_okay=False, help="An FMU, .fmu; of any origin.")
]
FmuFolder = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="DIR",
        help="Leave FMU, CSV files and figure here; of a system, also a file .csv, .json or .npz.",
    ),
]
ReportFolder = Annotated[
    Path | None, typer.Option("--report", metavar="DIR", help="Write the report, its figures and numbers here.")
]
Every = Annotated[
    float | None,
    typer.Option(
        "--every", callback=positive, help="Record at intervals of this many s, not at every step.",
        rich_help_panel=_OUTPUT,
    ),
]  # fmt: skip
InputValues = Annotated[
    list[str] | None,
    typer.Option(
        "--input",
        metavar="FILE.csv|NAME=VALUE",
        help="Inputs: a CSV file with a column `time` and one for each input, or a number; may be repeated.",
    ),
]
Hold = Annotated[bool, typer.Option("--hold", help="Inputs of a file keep their values until the next, without slope.")]
Spline = Annotated[
    bool, typer.Option("--spline", help="Positions of a file that lead motions go along a cubic spline, not lines.")
]
ChannelNames = Annotated[
    list[str] | None,
    typer.Option(
        "--channel",
        metavar="NAME[,NAME]",
        help="Channels of tables and plots; may be repeated. All if none.",
        rich_help_panel=_OUTPUT,
    ),
]
ResultFile = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        rich_help_panel=_OUTPUT,
        help="Write the result, .npz (see `tlismni play`), or all channels: .csv, .json, .parquet, .nc or .h5.",
    ),
]
StepsFile = Annotated[
    Path | None,
    typer.Option("--steps", help="Write size, error and iterations of every step: .csv.", rich_help_panel=_OUTPUT),
]
AnimationFile = Annotated[
    Path | None,
    typer.Option("--animate", help="Write the motion: .html to play, or .gif, .mp4.", rich_help_panel=_OUTPUT),
]
PageFile = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Write it here and open nothing.", rich_help_panel=_OUTPUT),
]
StoredResult = Annotated[
    Path,
    typer.Argument(metavar="RESULT", exists=True, dir_okay=False, help="A result, .npz, of `tlismni run --output`."),
]
PlotFile = Annotated[
    Path | None,
    typer.Option("--plot", help="Draw the main channels: .png, .pdf or .svg.", rich_help_panel=_OUTPUT),
]
Json = Annotated[bool, typer.Option("--json", help="One JSON object on stdout.", rich_help_panel=_OUTPUT)]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of a failure.", rich_help_panel=_OUTPUT)]
