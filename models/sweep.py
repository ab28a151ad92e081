"""Sweeps of a scenario of the catalogue: its own parameters, and all that a sweep of a model may vary."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.compiled_model import CompiledModel, compile_model
from ..core.errors import ModelError
from ..core.simulate_one import check_times
from ..core.simulation.simulation import Simulation
from ..core.sweeps.problem import (
    KEPT_MODELS,
    Outcomes,
    answer,
    begin_at,
    group_of,
    settings_of,
    settings_text,
    units_of,
)
from .registry import catalogue, load
from .scenario import Scenario


@dataclass(frozen=True)
class ScenarioProblem:
    """Runs of a scenario; where one of its parameters changes how it is solved or how long, that is followed.

    Attributes
    ----------
    name : of the scenario. fixed : its other parameters, as JSON text.
    t_end : s; None: as the scenario says. times, channels : as `ModelProblem`.
    method, rtol, atol : None: as the scenario says. options : of `Simulation`, as JSON text, beside the scenario's own.
    """

    name: str
    fixed: str = "{}"
    t_end: float | None = None
    times: tuple[float, ...] = ()
    channels: tuple[str, ...] = ()
    method: str | None = None
    rtol: float | None = None
    atol: float | None = None
    options: str = "{}"

    @classmethod
    def of(
        cls, name: str, fixed: Mapping[str, Any] | None = None, t_end: float | None = None, times: Any = None,
        channels: Any = None, method: str | None = None, rtol: float | None = None, atol: float | None = None,
        **options: Any,
    ) -> "ScenarioProblem":  # fmt: skip
        """The problem of a scenario. Raises ModelError for bad names, times, channels or settings."""
        base = load(name, **(fixed or {}))
        end = base.t_end if t_end is None else float(t_end)
        kept = () if times is None else tuple(check_times(times, 0.0, end).tolist())
        text = settings_text(options)
        found = cls(name, json.dumps(dict(fixed or {}), sort_keys=True), t_end, kept, (), method, rtol, atol, text)
        compiled = found._base()[1]
        wanted = () if channels is None else tuple(channels)
        unknown = [channel for channel in wanted if channel not in compiled.channels]
        if unknown:
            raise ModelError(f"there are no channels {unknown}; there are {list(compiled.channels)}")
        return cls(name, found.fixed, t_end, kept, wanted, method, rtol, atol, text)

    def identity(self) -> str:
        base = self._base()[0]
        return json.dumps([
            self.name, self.fixed, base.model.to_json(), self.t_end, self.times, self.channels, self.method, self.rtol,
            self.atol, self.options,
        ])  # fmt: skip

    def check(self, names: tuple[str, ...]) -> None:
        compiled, own = self._base()[1], self._own()
        for name in names:
            if name not in own:
                group_of(compiled, name)

    def units(self) -> dict[str, str]:
        return {**units_of(self._base()[1]), **{name: parameter.unit for name, parameter in self._own().items()}}

    def run(self, points: Mapping[str, NDArray[np.float64]], threads: int | None) -> Outcomes:
        (base, compiled), own = self._base(), self._own()
        groups = {name: group_of(compiled, name) for name in points if name not in own}

        def begin(row: int) -> tuple[Simulation, float]:
            values = {name: float(x[row]) for name, x in points.items()}
            mine = {name: _value(own[name], x) for name, x in values.items() if name in own}
            rest = {name: x for name, x in values.items() if name not in own}
            if not mine:
                return begin_at(compiled, rest, groups), self._end(base)
            scenario = load(self.name, **{**json.loads(self.fixed), **mine})
            if self._settings(scenario) == self._settings(base) and not rest:
                return compiled.run_of(scenario.model), self._end(scenario)
            return begin_at(self._compile(scenario), rest, groups), self._end(scenario)

        return answer(points, begin, compiled.channels, self.times, self.channels, threads)

    def _own(self) -> dict[str, Any]:
        (entry,) = (entry for entry in catalogue() if entry.name == self.name)
        return {p.name: p for p in entry.parameters if p.kind in ("number", "integer")}

    def _base(self) -> tuple[Scenario, CompiledModel]:
        return _base_of(self)

    def _end(self, scenario: Scenario) -> float:
        return scenario.t_end if self.t_end is None else self.t_end

    def _settings(self, scenario: Scenario) -> tuple[Any, ...]:
        method = self.method or scenario.method
        own = dict(scenario.options) if method == scenario.method else {}
        return (
            method, scenario.rtol if self.rtol is None else self.rtol,
            scenario.atol if self.atol is None else self.atol, {**own, **settings_of(self.options)},
        )  # fmt: skip

    def _compile(self, scenario: Scenario) -> CompiledModel:
        *arguments, options = self._settings(scenario)
        return compile_model(scenario.model, *arguments, **options)


@lru_cache(KEPT_MODELS)
def _base_of(problem: ScenarioProblem) -> tuple[Scenario, CompiledModel]:
    base = load(problem.name, **json.loads(problem.fixed))
    return base, problem._compile(base)


def _value(parameter: Any, x: float) -> float | int:
    """A whole number for a parameter that counts."""
    return int(x) if parameter.kind == "integer" and x == int(x) else x
