"""How channels answer to small changes of a model's parameters, along a run with its events.

Central differences of runs at tight tolerances, at two sizes of the change: their extrapolation to zero is the answer,
their difference says how sure it is. An event that a change brings about or takes away (a contact that just touches)
shows as a large uncertainty: there is no derivative across it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled_model import CompiledModel, compile_model
from ..errors import ModelError, SimulationError
from ..methods.default import DEFAULT_METHOD
from ..simulate_batch import simulate_many

Floats = NDArray[np.float64]

CHANGE = 1e-3
"""Relative change of a parameter: the error of the extrapolated formula is of its fourth power."""
TIGHT = 1e-11
"""Relative tolerance of the runs: their errors are divided by the change."""


@dataclass(frozen=True)
class ParameterSensitivities:
    """Derivatives of channels by parameters.

    Attributes
    ----------
    parameters, values : names and values of the parameters (p,).
    channels : names. t : (times,), s.
    base : the channels of the run itself, (times, channels).
    derivatives, errors : (p, times, channels): d channel / d parameter, and how unsure that is.
    """

    parameters: tuple[str, ...]
    values: Floats
    channels: tuple[str, ...]
    t: Floats
    base: Floats
    derivatives: Floats
    errors: Floats

    def of(self, channel: str, parameter: str) -> Floats:
        """One derivative (times,). Raises KeyError for unknown names."""
        for name, there in ((channel, self.channels), (parameter, self.parameters)):
            if name not in there:
                raise KeyError(f"'{name}' is not among {list(there)}")
        found: Floats = self.derivatives[self.parameters.index(parameter), :, self.channels.index(channel)]
        return found

    @property
    def relative(self) -> Floats:
        """(p, times, channels): change of a channel, in its own units, when a parameter changes by its own value."""
        return self.derivatives * self.values[:, None, None]


def parameter_sensitivities(
    model: Any,
    t_end: float,
    parameters: Iterable[str],
    channels: Iterable[str],
    *,
    t_eval: ArrayLike | None = None,
    change: float = CHANGE,
    threads: int | None = None,
    method: str = DEFAULT_METHOD,
    rtol: float = TIGHT,
    **settings: Any,
) -> ParameterSensitivities:
    """Derivatives of `channels` by `parameters` at the times `t_eval` (left out: at t_end).

    Parameters
    ----------
    parameters : names of the model's parameters, or places of numbers ("ball.mass").
    change : relative change of each parameter; of one that is 0, the change itself.
    threads, settings : as `simulate_many`.

    Raises
    ------
    ModelError : for unknown names; SimulationError : if one of the runs fails: says for which parameter.
    """
    names, wanted = tuple(parameters), tuple(channels)
    if not names or not wanted:
        raise ModelError("name at least one parameter and one channel")
    if not 0.0 < change < 0.1:
        raise ModelError(f"change = {change!r} must be a small part, between 0 and 0.1")
    settings.setdefault("atol", TIGHT)
    compiled = compile_model(model, method, rtol, settings.pop("atol"), **settings)
    values = np.array([_value(compiled, name) for name in names])
    steps = change * np.where(values != 0.0, np.abs(values), 1.0)
    table = np.tile(values, (1 + 4 * len(names), 1))
    for k, step in enumerate(steps):
        for row, part in enumerate((-1.0, -0.5, 0.5, 1.0)):
            table[1 + 4 * k + row, k] += part * step
    times = [float(t_end)] if t_eval is None else np.asarray(t_eval, dtype=float)
    runs = simulate_many(
        compiled, {name: table[:, k] for k, name in enumerate(names)}, t_end, channels=wanted, t_eval=times,
        threads=threads,
    )  # fmt: skip
    for row, error in runs.failures.items():
        k = (row - 1) // 4
        where = "as it is" if row == 0 else f"with {names[k]} = {float(table[row, k])!r}"
        raise SimulationError(f"the run {where} failed: {error}", t=float(runs.reached[row]), loop="outer") from error
    shape = (len(names), len(times), len(wanted))
    derivatives, errors = np.zeros(shape), np.zeros(shape)
    for k, step in enumerate(steps):
        low, near_low, near_high, high = runs.values[1 + 4 * k : 5 + 4 * k]
        wide, narrow = (high - low) / (2.0 * step), (near_high - near_low) / step
        derivatives[k] = (4.0 * narrow - wide) / 3.0
        errors[k] = np.abs(narrow - wide)
    return ParameterSensitivities(
        names, values, wanted, np.asarray(times, dtype=float), runs.values[0], derivatives, errors
    )


def _value(compiled: CompiledModel, name: str) -> float:
    system: Any = compiled.system
    if not hasattr(system, "parameter_value"):
        raise ModelError("own equations have no parameters: build them with other numbers, or describe a Model")
    if "." not in name:
        return float(system.parameter_value(name))
    try:
        value: float = system._value_at(name)
    except ValueError as error:
        raise ModelError(str(error)) from None
    return float(value)


def ordered(found: ParameterSensitivities, channel: str) -> Sequence[tuple[str, float]]:
    """Parameters by how much a channel answers to them at the last time: (name, change for the parameter's value)."""
    column = found.relative[:, -1, found.channels.index(channel)]
    order = np.argsort(-np.abs(column), kind="stable")
    return [(found.parameters[k], float(column[k])) for k in order]
