"""Time functions as data, and their compiled evaluation with two derivatives.

Each signal of a model is a run of numbers in one pool: a kind and its parameters. `evaluate_signal` returns
f, f' and f'' (a driven constraint needs all three).
"""

import math
from functools import lru_cache
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ..compiled.jit import internal, interpreted
from ..errors import ModelError
from .base import Name, Positive, Record

CONSTANT, STEP, RAMP, SINE, POLYNOMIAL, TABLE, INPUT = range(7)

INPUT_SIZE = 4
"""Numbers of an input: value, first and second derivative, and the time (s) at which it has these."""
MOST_DERIVATIVES = INPUT_SIZE - 2
"""Order of the highest derivative that an input can go on with."""


class TimeFunction(Record):
    """Base of the time functions."""

    def longest_step(self) -> float:
        """Step beyond which error control could miss what the function does, s."""
        return math.inf

    def channels(self) -> tuple[str, ...]:
        """The input channels that it needs."""
        return ()

    def pool(self, inputs: dict[str, int]) -> list[float]:
        """Its kind and numbers, given the numbers of input channels."""
        raise NotImplementedError

    def breakpoints(self) -> list[float]:
        """Times at which it or its rate jumps, s."""
        raise NotImplementedError

    def __call__(self, t: Any) -> Any:
        """Its value at time `t`, s, for own equations; `t` may carry derivatives, as a complex number or a jet.

        Raises
        ------
        ModelError : for an input, whose value a run has.
        """
        if self.channels():
            raise ModelError(f"inputs {list(self.channels())} have values in the run of a Model alone, not here")
        if isinstance(t, float | int | np.number):
            now = float(t.real)
        else:
            now = t.real if isinstance(t, complex) else t.value
        f, df, ddf = interpreted(evaluate_signal)(_pool_of(self), _NO_INPUTS, 0, now)
        if isinstance(t, float):
            return float(f)
        ahead = t - now  # zero but for what t carries
        return f + ahead * (df + 0.5 * ahead * ddf)


class Constant(TimeFunction):
    """f(t) = value."""

    type: Literal["Constant"] = "Constant"
    value: float
    """In the unit of what it drives."""

    def pool(self, inputs: dict[str, int]) -> list[float]:
        return [CONSTANT, self.value]

    def breakpoints(self) -> list[float]:
        return []


class Step(TimeFunction):
    """f jumps from `before` to `after` at `time` (s). Not for drivers: a jump in position is no motion."""

    type: Literal["Step"] = "Step"
    time: float
    """When it jumps, s."""
    before: float = 0.0
    """Value before."""
    after: float = 1.0
    """Value after."""

    def pool(self, inputs: dict[str, int]) -> list[float]:
        return [STEP, self.time, self.before, self.after]

    def breakpoints(self) -> list[float]:
        return [self.time]


class Ramp(TimeFunction):
    """f goes linearly from `before` at `start` (s) to `after` at `start + duration`.

    As a driver's motion it jumps in velocity at both ends: that is an impact of the driver, which the run computes
    exactly and reports by a warning in the log, not as an `Event` (those are of contacts). A smooth start needs a
    Polynomial or a Table.
    """

    type: Literal["Ramp"] = "Ramp"
    start: float
    """When it begins, s."""
    duration: Positive
    """How long it takes, s."""
    before: float = 0.0
    """Value before."""
    after: float = 1.0
    """Value after."""

    def pool(self, inputs: dict[str, int]) -> list[float]:
        return [RAMP, self.start, self.duration, self.before, self.after]

    def breakpoints(self) -> list[float]:
        return [self.start, self.start + self.duration]


class Sine(TimeFunction):
    """f(t) = offset + amplitude sin(angular_frequency t + phase); angular_frequency in rad/s, phase in rad."""

    type: Literal["Sine"] = "Sine"
    amplitude: float
    """In the unit of what it drives."""
    angular_frequency: float
    """rad/s."""
    phase: float = 0.0
    """rad."""
    offset: float = 0.0
    """Mean value."""

    def longest_step(self) -> float:
        return 0.5 * math.pi / abs(self.angular_frequency) if self.angular_frequency else math.inf

    def pool(self, inputs: dict[str, int]) -> list[float]:
        return [SINE, self.amplitude, self.angular_frequency, self.phase, self.offset]

    def breakpoints(self) -> list[float]:
        return []


class Polynomial(TimeFunction):
    """f(t) = c0 + c1 t + c2 t^2 + ...; `coefficients` from the constant upwards."""

    type: Literal["Polynomial"] = "Polynomial"
    coefficients: Annotated[tuple[float, ...], Field(min_length=1)]
    """Constant first, of powers of t in s."""

    def pool(self, inputs: dict[str, int]) -> list[float]:
        return [POLYNOMIAL, len(self.coefficients), *self.coefficients]

    def breakpoints(self) -> list[float]:
        return []


class Table(TimeFunction):
    """Not-a-knot cubic spline through (times, values); outside, the first or last cubic goes on."""

    type: Literal["Table"] = "Table"
    times: Annotated[tuple[float, ...], Field(min_length=4)]
    """Growing, s."""
    values: Annotated[tuple[float, ...], Field(min_length=4)]
    """Values at these times, at least four; a cubic spline joins them."""

    @model_validator(mode="after")
    def _check(self) -> "Table":
        if len(self.times) != len(self.values):
            raise ValueError(f"times has {len(self.times)} entries, values has {len(self.values)}: give as many")
        if any(b <= a for a, b in zip(self.times, self.times[1:], strict=False)):
            raise ValueError("times must grow strictly")
        return self

    def longest_step(self) -> float:
        return min(b - a for a, b in zip(self.times, self.times[1:], strict=False))

    def pool(self, inputs: dict[str, int]) -> list[float]:
        # importing scipy costs more than most runs: only who needs a spline pays
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(self.times, self.values)
        return [TABLE, len(self.times), *self.times, *np.asarray(spline.c).T.ravel()]

    def breakpoints(self) -> list[float]:
        return []


class InputSignal(TimeFunction):
    """The model's input channel `channel`: the value that was set last, going on with the derivatives that it was given
    (none unless set), times `gain`. As a motion it may have its velocity in another channel, `rate`, see `motion.py`;
    forces have no use for that."""

    type: Literal["Input"] = "Input"
    channel: Name
    """Name of the input whose value it is."""
    rate: Name | None = None
    """Input channel with the velocity of a motion, in the position's unit per s."""
    gain: float = 1.0
    """What its value, and that of `rate`, is multiplied by: the constant of a motor, a valve, another unit."""

    def channels(self) -> tuple[str, ...]:
        return (self.channel,) if self.rate is None else (self.channel, self.rate)

    def pool(self, inputs: dict[str, int]) -> list[float]:
        return [INPUT, inputs[self.channel], self.gain]

    def breakpoints(self) -> list[float]:
        return []


Signal = Annotated[Constant | Step | Ramp | Sine | Polynomial | Table | InputSignal, Field(discriminator="type")]
"""Any time function."""

_NO_INPUTS = np.zeros(0)


@lru_cache(maxsize=64)
def _pool_of(signal: TimeFunction) -> NDArray[np.float64]:
    return np.array(signal.pool({}), dtype=np.float64)


@internal
def evaluate_signal(pool: Any, inputs: Any, offset: int, t: float) -> Any:
    """(f, f', f'') at time `t` of the signal that starts at `pool[offset]`."""
    kind = int(pool[offset])
    if kind == CONSTANT:
        return pool[offset + 1], 0.0, 0.0
    if kind == INPUT:
        k = INPUT_SIZE * int(pool[offset + 1])
        rate, curvature, x, gain = inputs[k + 1], inputs[k + 2], t - inputs[k + 3], pool[offset + 2]
        return (
            gain * (inputs[k] + x * (rate + 0.5 * x * curvature)), gain * (rate + x * curvature), gain * curvature,
        )  # fmt: skip
    if kind == SINE:
        amplitude, w = pool[offset + 1], pool[offset + 2]
        s = math.sin(w * t + pool[offset + 3])
        c = math.cos(w * t + pool[offset + 3])
        return pool[offset + 4] + amplitude * s, amplitude * w * c, -amplitude * w * w * s
    if kind == POLYNOMIAL:
        f, df, ddf = 0.0, 0.0, 0.0
        for k in range(int(pool[offset + 1]) - 1, -1, -1):
            ddf = ddf * t + 2.0 * df
            df = df * t + f
            f = f * t + pool[offset + 2 + k]
        return f, df, ddf
    if kind == STEP:
        return (pool[offset + 3] if t >= pool[offset + 1] else pool[offset + 2]), 0.0, 0.0
    if kind == RAMP:
        start, duration, before, after = pool[offset + 1], pool[offset + 2], pool[offset + 3], pool[offset + 4]
        if t < start:
            return before, 0.0, 0.0
        if t >= start + duration:
            return after, 0.0, 0.0
        rate = (after - before) / duration
        return before + rate * (t - start), rate, 0.0
    # TABLE: knots, then the four coefficients of each interval, highest power first
    n = int(pool[offset + 1])
    knots = pool[offset + 2 : offset + 2 + n]
    i = min(max(int(np.searchsorted(knots, t, side="right")) - 1, 0), n - 2)
    c = offset + 2 + n + 4 * i
    x = t - knots[i]
    f = ((pool[c] * x + pool[c + 1]) * x + pool[c + 2]) * x + pool[c + 3]
    df = (3.0 * pool[c] * x + 2.0 * pool[c + 1]) * x + pool[c + 2]
    return f, df, 6.0 * pool[c] * x + 2.0 * pool[c + 1]
