"""numpy functions of jets: scalars directly, arrays element by element, plain numbers among them included."""

import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from .elementary import UNARY_NAMES


class NumpyFunctions:
    """What lets numpy's functions take jets, also together with plain numbers and arrays: `Jet` is one of these."""

    __slots__ = ()
    value: float

    def _constant(self, value: float) -> Any:
        """A jet with the same variables and no derivatives."""
        raise NotImplementedError

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        return apply_ufunc(ufunc, method, inputs, options)


def plain(x: Any) -> float:
    """The value of a jet or number."""
    return float(x.value) if isinstance(x, NumpyFunctions) else float(x)


def pair(x: Any, y: Any) -> tuple[Any, Any]:
    """Both as jets; one of them is."""
    if isinstance(x, NumpyFunctions):
        return x, y if isinstance(y, NumpyFunctions) else x._constant(float(y))
    return y._constant(float(x)), y


def _unary(name: str) -> Callable[[Any], Any]:
    ufunc = getattr(np, name)

    def apply(x: Any) -> Any:
        return getattr(x, name)() if isinstance(x, NumpyFunctions) else float(ufunc(x))

    return apply


def arctan2(y: Any, x: Any) -> Any:
    """numpy.arctan2 of numbers and jets."""
    if isinstance(x, NumpyFunctions) or isinstance(y, NumpyFunctions):
        first, second = pair(y, x)
        return first.arctan2(second)
    return math.atan2(y, x)


def hypot(x: Any, y: Any) -> Any:
    """numpy.hypot of numbers and jets."""
    if isinstance(x, NumpyFunctions) or isinstance(y, NumpyFunctions):
        first, second = pair(x, y)
        return first.hypot(second)
    return math.hypot(x, y)


def _maximum(x: Any, y: Any) -> Any:
    return x if plain(x) >= plain(y) or math.isnan(plain(x)) else y


def _minimum(x: Any, y: Any) -> Any:
    return x if plain(x) <= plain(y) or math.isnan(plain(x)) else y


def _of_value(ufunc: np.ufunc) -> Callable[[Any], Any]:
    """Functions that are constant almost everywhere, and tests."""
    return lambda x: ufunc(plain(x)).item()


# By ufunc: the function of scalars, jets and plain numbers mixed.
SCALAR: dict[Any, Callable[..., Any]] = {
    np.add: operator.add,
    np.subtract: operator.sub,
    np.multiply: operator.mul,
    np.true_divide: operator.truediv,
    np.power: operator.pow,
    np.float_power: operator.pow,
    np.remainder: operator.mod,
    np.negative: operator.neg,
    np.positive: operator.pos,
    np.absolute: abs,
    np.fabs: abs,
    np.conjugate: lambda x: x,
    np.square: lambda x: x * x,
    np.reciprocal: lambda x: 1.0 / x,
    np.arctan2: arctan2,
    np.hypot: hypot,
    np.maximum: _maximum,
    np.minimum: _minimum,
    np.fmax: _maximum,
    np.fmin: _minimum,
    np.less: operator.lt,
    np.less_equal: operator.le,
    np.greater: operator.gt,
    np.greater_equal: operator.ge,
    np.equal: operator.eq,
    np.not_equal: operator.ne,
    **{getattr(np, name): _unary(name) for name in UNARY_NAMES},
    **{f: _of_value(f) for f in (np.sign, np.floor, np.ceil, np.rint, np.trunc, np.isfinite, np.isnan, np.isinf)},
}

# Those that numpy's own object loop leaves to a method of the first element, which a plain number lacks.
_BY_METHOD = (*(getattr(np, name) for name in UNARY_NAMES), np.arctan2, np.hypot, np.fabs, np.conjugate)
_BY_VALUE = (np.sign, np.floor, np.ceil, np.rint, np.trunc, np.isfinite, np.isnan, np.isinf, np.float_power)
ELEMENTWISE = {f: np.frompyfunc(SCALAR[f], f.nin, 1) for f in (*_BY_METHOD, *_BY_VALUE)}


def object_array(x: Any) -> Any:
    """A jet as a 0-d object array, anything else unchanged."""
    if not isinstance(x, NumpyFunctions):
        return x
    array = np.empty((), dtype=object)
    array[()] = x
    return array


def apply_ufunc(ufunc: np.ufunc, method: str, inputs: tuple, options: dict[str, Any]) -> Any:
    """What numpy calls when a jet stands among the operands of a ufunc."""
    if method == "__call__" and not options:
        scalars = not any(isinstance(x, np.ndarray | list | tuple) for x in inputs)
        if scalars and ufunc in SCALAR:
            return SCALAR[ufunc](*(x.item() if isinstance(x, np.generic) else x for x in inputs))
        if ufunc in ELEMENTWISE:
            return ELEMENTWISE[ufunc](*map(object_array, inputs))
    return getattr(ufunc, method)(*map(object_array, inputs), **options)
