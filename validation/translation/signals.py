"""Time functions as plain Python callables, for exudyn's user functions."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from scipy.interpolate import CubicSpline

from ...core.model.signals import Constant, InputSignal, Polynomial, Ramp, Signal, Sine, Step, Table
from ...core.multibody_model import Model
from ..errors import NotTranslatable


@dataclass(frozen=True)
class TimeFunction:
    """f(t) and f'(t); `constant` is the value if it never changes."""

    value: Callable[[float], float]
    rate: Callable[[float], float]
    constant: float | None = None


def turned(x: TimeFunction, y: TimeFunction, angle: float) -> tuple[TimeFunction, TimeFunction]:
    """The components of a vector (x, y) that is turned by `angle`."""
    return _mixed(x, y, math.cos(angle), -math.sin(angle)), _mixed(x, y, math.sin(angle), math.cos(angle))


def _mixed(x: TimeFunction, y: TimeFunction, a: float, b: float) -> TimeFunction:
    if x.constant is not None and y.constant is not None:
        return _constant(a * x.constant + b * y.constant)
    return TimeFunction(lambda t: a * x.value(t) + b * y.value(t), lambda t: a * x.rate(t) + b * y.rate(t))


def time_function(signal: Signal, model: Model) -> TimeFunction:
    """The time function that `signal` means. An input channel keeps its start value, a motion with a rate channel goes
    on with the start value of that.

    Raises
    ------
    NotTranslatable : for a kind of signal that is not known here.
    """
    if isinstance(signal, InputSignal):
        starts = {i.name: i.start for i in model.inputs}
        start, rate = signal.gain * starts[signal.channel], signal.gain * starts.get(signal.rate or "", 0.0)
        return TimeFunction(lambda t: start + rate * t, lambda t: rate) if rate else _constant(start)
    if isinstance(signal, Constant):
        return _constant(signal.value)
    if isinstance(signal, Sine):
        a, w, p, c = signal.amplitude, signal.angular_frequency, signal.phase, signal.offset
        return TimeFunction(lambda t: c + a * math.sin(w * t + p), lambda t: a * w * math.cos(w * t + p))
    if isinstance(signal, Polynomial):
        series = signal.coefficients
        return TimeFunction(
            lambda t: sum(x * t**k for k, x in enumerate(series)),
            lambda t: sum(k * x * t ** (k - 1) for k, x in enumerate(series) if k),
        )
    if isinstance(signal, Step):
        return TimeFunction(lambda t: signal.after if t >= signal.time else signal.before, lambda t: 0.0)
    if isinstance(signal, Ramp):
        return _ramp(signal)
    if isinstance(signal, Table):
        spline = CubicSpline(signal.times, signal.values)
        slope = spline.derivative()
        return TimeFunction(lambda t: float(spline(t)), lambda t: float(slope(t)))
    raise NotTranslatable(f"time function {type(signal).__name__} has no translation to exudyn")


def _constant(value: float) -> TimeFunction:
    return TimeFunction(lambda t: value, lambda t: 0.0, value)


def _ramp(signal: Ramp) -> TimeFunction:
    slope = (signal.after - signal.before) / signal.duration
    end = signal.start + signal.duration

    def value(t: float) -> float:
        return signal.before + slope * (min(max(t, signal.start), end) - signal.start)

    return TimeFunction(value, lambda t: slope if signal.start <= t < end else 0.0)
