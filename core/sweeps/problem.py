"""What is run at each point of a sweep."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..batch_result import Runs
from ..compiled_model import CompiledModel, compile_model
from ..errors import ModelError, TlismniError
from ..multibody_model import Model
from ..simulate_one import check_end, check_times
from ..simulation.simulation import Simulation
from ..tolerances import OfScales
from ..worker_threads import in_threads, run_into

Columns = dict[str, NDArray[Any]]
START = "start."
"""Before the name of a channel: what it is at the start."""
KEPT_MODELS = 4
"""Compiled models that a process keeps: a worker has one sweep at a time."""


@dataclass(frozen=True)
class Outcomes:
    """Runs at some points: columns (runs x times,) with the number of the run among these points in "run"."""

    columns: Columns


class Problem(Protocol):
    """A question that a sweep asks at every point. It goes to other processes, so it is plain data.

    `identity` says all that the answers depend on but the points: a folder of answers belongs to one. `check` raises
    ModelError for names that mean nothing. It may have `units()`, by the names of columns.
    """

    def identity(self) -> str: ...

    def check(self, names: tuple[str, ...]) -> None: ...

    def run(self, points: Mapping[str, NDArray[np.float64]], threads: int | None) -> Outcomes: ...


@dataclass(frozen=True)
class ModelProblem:
    """Runs of one model with other parameters, places of numbers ("ball.mass"), inputs or start values
    ("start.ball.vy").

    Attributes
    ----------
    text : the model as JSON.
    t_end : s. times : at which channels are kept, s; empty: at the end.
    channels : names; empty: all.
    settings : of `Simulation`, as JSON text.
    """

    text: str
    t_end: float
    times: tuple[float, ...] = ()
    channels: tuple[str, ...] = ()
    settings: str = "{}"

    @classmethod
    def of(
        cls,
        model: Model,
        t_end: float,
        times: Any = None,
        channels: Any = None,
        settings: Mapping[str, Any] | None = None,
    ) -> "ModelProblem":
        """The problem of a model. Raises ModelError for bad times, channels or settings."""
        options = dict(settings or {})
        compiled = compile_model(model, **options)
        check_end(compiled.t0, t_end)
        kept = () if times is None else tuple(check_times(times, compiled.t0, float(t_end)).tolist())
        wanted = () if channels is None else tuple(channels)
        unknown = [name for name in wanted if name not in compiled.channels]
        if unknown:
            raise ModelError(f"there are no channels {unknown}; there are {list(compiled.channels)}")
        return cls(model.to_json(), float(t_end), kept, wanted, settings_text(options))

    def identity(self) -> str:
        return json.dumps([self.text, self.t_end, self.times, self.channels, self.settings])

    def check(self, names: tuple[str, ...]) -> None:
        compiled = _compiled(self.text, self.settings)
        for name in names:
            group_of(compiled, name)

    def units(self) -> dict[str, str]:
        return units_of(_compiled(self.text, self.settings))

    def run(self, points: Mapping[str, NDArray[np.float64]], threads: int | None) -> Outcomes:
        compiled = _compiled(self.text, self.settings)
        groups = {name: group_of(compiled, name) for name in points}

        def begin(row: int) -> tuple[Simulation, float]:
            return begin_at(compiled, {name: float(x[row]) for name, x in points.items()}, groups), self.t_end

        return answer(points, begin, compiled.channels, self.times, self.channels, threads)


def group_of(compiled: CompiledModel, name: str) -> str:
    """What a name means: "start" of a start value, a declared parameter before an input before a place.

    Raises
    ------
    ModelError : if it means nothing.
    """
    model: Any = compiled.system
    if name.startswith(START) and name.removeprefix(START) in compiled.start_names:
        return "start"
    if name in {p.name for p in model.parameters}:
        return "parameters"
    if name in {i.name for i in model.inputs}:
        return "inputs"
    if name in compiled.start_names:
        raise ModelError(f"'{name}' is a channel; to vary what it is at the start, write '{START}{name}'")
    if "." in name:
        model._place(name)
        return "parameters"
    raise ModelError(
        f"'{name}' is no parameter ({[p.name for p in model.parameters]}) or input ({[i.name for i in model.inputs]}) "
        f"of model '{model.name}'; there are also places of numbers such as 'body.mass' and start values such as "
        f"'{START}{compiled.start_names[0]}'"
    )


def units_of(compiled: CompiledModel) -> dict[str, str]:
    """Units of parameters, inputs, start values and channels, and of the columns that every sweep has."""
    model: Any = compiled.system
    channels = {channel.name: channel.unit for channel in compiled.channel_records}
    named = {each.name: each.unit for each in (*model.parameters, *model.inputs)}
    start = {f"{START}{name}": channels[name] for name in compiled.start_names if name in channels}
    return {"time": "s", "reached": "s", **channels, **start, **named}


def begin_at(compiled: CompiledModel, values: Mapping[str, float], groups: Mapping[str, str]) -> Simulation:
    """A run of a compiled model with these numbers."""
    numbers: dict[str, dict[str, float]] = {"parameters": {}, "inputs": {}, "start": {}}
    for name, x in values.items():
        numbers[groups[name]][name.removeprefix(START) if groups[name] == "start" else name] = x
    return compiled.simulation(**numbers)


def answer(
    points: Mapping[str, NDArray[np.float64]],
    begin: Callable[[int], tuple[Simulation, float]],
    every: tuple[str, ...],
    times: tuple[float, ...],
    channels: tuple[str, ...],
    threads: int | None,
) -> Outcomes:
    """The runs that `begin(row)` makes, with their end times, s; what it raises is the row's cause.

    every : names of all channels, in their order. channels : those that are kept; empty: all.
    """
    count, wanted = len(next(iter(points.values()))), channels or every
    at = np.array(times) if times else None
    found = Runs(dict(points), wanted, count, at)
    place = [every.index(name) for name in wanted]
    ends = np.full(count, np.nan)

    def one(row: int) -> None:
        try:
            sim, ends[row] = begin(row)
        except Exception as error:
            found.close(row, np.nan, None, error)
        else:
            run_into(found, row, place, lambda: sim, sim.t, float(ends[row]), at)

    in_threads(one, count, threads)
    each = len(times) or 1
    causes = np.array([_cause(found.failures.get(row)) for row in range(count)], dtype=object)
    columns: Columns = {
        "run": np.repeat(np.arange(count), each),
        **{name: np.repeat(x, each) for name, x in points.items()},
        "time": ends if at is None else np.tile(at, count),
        "reached": np.repeat(found.reached, each),
        "events": np.repeat(found.events, each),
        "steps": np.repeat(found.steps, each),
        "cause": np.repeat(causes, each),
        **{name: found.values[:, :, k].ravel() for k, name in enumerate(wanted)},
    }
    return Outcomes(columns)


def _cause(error: Exception | None) -> str:
    """Why a run failed; empty if it did not."""
    if error is None:
        return ""
    return str(error) if isinstance(error, TlismniError) else f"{type(error).__name__}: {error}"


@lru_cache(KEPT_MODELS)
def _compiled(text: str, settings: str) -> CompiledModel:
    return compile_model(Model.from_json(text), **settings_of(settings))


def settings_text(settings: Mapping[str, Any]) -> str:
    """Settings of `Simulation` as JSON text. Raises ModelError for what is no plain data."""
    try:
        return json.dumps(
            {name: {"OfScales": float(x)} if isinstance(x, OfScales) else x for name, x in settings.items()},
            sort_keys=True,
        )
    except TypeError as error:
        raise ModelError(f"settings go to other processes as plain data: {error}") from None


def settings_of(text: str) -> dict[str, Any]:
    """The settings in a text."""
    return {
        name: OfScales(x["OfScales"]) if isinstance(x, dict) and "OfScales" in x else x
        for name, x in json.loads(text).items()
    }
