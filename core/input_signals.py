"""Courses of inputs over time, for runs: what a file or arrays say that inputs do."""

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ModelError

Floats = NDArray[np.float64]
Between = Literal["linear", "hold", "spline"]
Given = Mapping[str, Any]


class Courses:
    """Values of inputs at times; constant before the first and after the last.

    between : "linear", straight lines; "hold", each value until the next; "spline", straight lines, but a cubic spline
        for positions that lead motions. `input_schedule.py` has what motions do.

    Attributes
    ----------
    times : (k,), s, growing. values : (k,) by the name of the input.
    """

    def __init__(self, times: ArrayLike, values: Mapping[str, ArrayLike], between: Between = "linear") -> None:
        self.times = _numbers("time", times)
        self.values = {name: _numbers(name, x) for name, x in values.items()}
        if between not in ("linear", "hold", "spline"):
            raise ModelError(f"inputs go on between their times by 'linear', 'hold' or 'spline', not {between!r}")
        if len(self.times) == 0 or np.any(np.diff(self.times) <= 0.0):
            raise ModelError("the times of inputs must be at least one, and grow strictly")
        for name, x in self.values.items():
            if len(x) != len(self.times):
                raise ModelError(f"input '{name}' has {len(x)} values for {len(self.times)} times: give as many")
        self.between = between

    def check(self, names: Sequence[str]) -> None:
        """Raise ModelError for inputs that a model with the inputs `names` does not have."""
        unknown = sorted(set(self.values) - set(names))
        if unknown:
            raise ModelError(f"there is no input {unknown}; inputs are {list(names)}")

    def at(self, t: float) -> tuple[dict[str, float], dict[str, tuple[float]]]:
        """Values from `t` on, and their rates."""
        k = int(np.searchsorted(self.times, t, side="right")) - 1
        inside, last = 0 <= k < len(self.times) - 1, len(self.times) - 1
        values, rates = {}, {}
        for name, x in self.values.items():
            slope = 0.0
            if inside and self.between != "hold":
                slope = float((x[k + 1] - x[k]) / (self.times[k + 1] - self.times[k]))
            low = min(max(k, 0), last)
            values[name] = float(x[low] + (slope * (t - self.times[low]) if slope else 0.0))
            rates[name] = (slope,)
        return values, rates


def courses(given: "Given | Courses") -> Courses:
    """Inputs as `simulate` takes them: numbers that they keep, or (times, values), or Courses.

    Raises
    ------
    ModelError : for what is none of these.
    """
    if isinstance(given, Courses):
        return given
    if not isinstance(given, Mapping):
        raise ModelError(
            f"inputs must be a mapping such as {{'force': 2.0}} or {{'force': (times, values)}}, not {given!r}"
        )
    constant = {name: x for name, x in given.items() if isinstance(x, Real)}
    pairs = {name: x for name, x in given.items() if name not in constant}
    knots: dict[str, tuple[Floats, Floats]] = {}
    for name, pair in pairs.items():
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise ModelError(f"input '{name}': (times, values) are needed, not {pair!r}")
        t, x = (_numbers(name, part) for part in pair)
        if len(t) != len(x) or len(t) == 0 or np.any(np.diff(t) <= 0.0):
            raise ModelError(f"input '{name}': as many values as times are needed, and times that grow strictly")
        knots[name] = t, x
    times = np.unique(np.concatenate([t for t, _ in knots.values()])) if knots else np.zeros(1)
    values: dict[str, ArrayLike] = {name: np.interp(times, t, x) for name, (t, x) in knots.items()}
    values |= {name: np.full(len(times), float(x)) for name, x in constant.items()}
    return Courses(times, values)


def _numbers(name: str, values: Any) -> Floats:
    try:
        x = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise ModelError(f"'{name}': numbers are needed, not {values!r}") from None
    if x.ndim != 1 or not np.all(np.isfinite(x)):
        raise ModelError(f"'{name}': a list of finite numbers is needed, not {values!r}")
    return x
