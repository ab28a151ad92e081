"""What a sweep's command line means."""

from collections.abc import Callable, Iterable
from typing import Any

import typer

from ..core.sweeps import ModelProblem
from ..models.sweep import ScenarioProblem
from .options import pairs
from .source import is_file, read_source

MOST_VALUES = 1_000_000


def axis_of(text: str) -> list[float]:
    """The values of first:last:count, or of a list with commas. Raises BadParameter for anything else."""
    import numpy as np

    try:
        if ":" not in text:
            return [float(x) for x in text.split(",")]
        first, last, count = text.split(":")
        if not 1 <= int(count) <= MOST_VALUES:
            raise ValueError
        return [float(x) for x in np.linspace(float(first), float(last), int(count))]
    except ValueError:
        raise typer.BadParameter(
            f"'{text}' must read first:last:count (0:1:101) or be a list (1,2,5); ranges low:high need --samples",
            param_hint="--vary",
        ) from None


def range_of(text: str) -> tuple[float, float]:
    """The ends of low:high. Raises BadParameter for anything else."""
    try:
        low, high = (float(x) for x in text.split(":"))
    except ValueError:
        raise typer.BadParameter(f"'{text}' must read low:high, as --samples is given", param_hint="--vary") from None
    return low, high


def problem_of(
    source: str,
    sets: Iterable[str] | None,
    *,
    t_end: float | None,
    method: str | None,
    rtol: float | None,
    atol: float | None,
    step: float | None,
    options: Iterable[str] | None,
    channels: Iterable[str] | None,
    times: Callable[[float], list[float]] | None,
) -> tuple[Any, float]:
    """The problem of a scenario or a model file, and its end time, s. Raises as `read_source` and the problems."""
    scenario = read_source(source, sets, t_end=t_end, method=method, rtol=rtol, atol=atol, step=step, options=options)
    at = None if times is None else times(scenario.t_end)
    if is_file(source):
        settings = {
            "method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options,
        }  # fmt: skip
        return ModelProblem.of(scenario.model, scenario.t_end, at, channels, settings), scenario.t_end
    given = pairs(sets or (), "--set")
    fixed = {name: scenario.given[name] for name in given}
    own = dict(scenario.options) if options or step or method else {}
    problem = ScenarioProblem.of(
        source, fixed, t_end, at, channels, method=method, rtol=rtol, atol=atol, **own
    )  # fmt: skip
    return problem, scenario.t_end
