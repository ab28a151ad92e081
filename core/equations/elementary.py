"""Elementary functions of one number with their first two derivatives (standard calculus)."""

import math
from collections.abc import Callable

import numpy as np

LN2 = math.log(2.0)
LN10 = math.log(10.0)


def _sin(x: float) -> tuple[float, float, float]:
    s, c = math.sin(x), math.cos(x)
    return s, c, -s


def _cos(x: float) -> tuple[float, float, float]:
    s, c = math.sin(x), math.cos(x)
    return c, -s, -c


def _tan(x: float) -> tuple[float, float, float]:
    y = math.tan(x)
    return y, 1.0 + y * y, 2.0 * y * (1.0 + y * y)


def _exp(x: float) -> tuple[float, float, float]:
    y = math.exp(x)
    return y, y, y


def _expm1(x: float) -> tuple[float, float, float]:
    y = math.exp(x)
    return math.expm1(x), y, y


def _log(x: float) -> tuple[float, float, float]:
    return math.log(x), 1.0 / x, -1.0 / (x * x)


def _log1p(x: float) -> tuple[float, float, float]:
    z = 1.0 + x
    return math.log1p(x), 1.0 / z, -1.0 / (z * z)


def _log2(x: float) -> tuple[float, float, float]:
    return math.log2(x), 1.0 / (x * LN2), -1.0 / (x * x * LN2)


def _log10(x: float) -> tuple[float, float, float]:
    return math.log10(x), 1.0 / (x * LN10), -1.0 / (x * x * LN10)


def _sqrt(x: float) -> tuple[float, float, float]:
    y = math.sqrt(x)
    return y, 0.5 / y, -0.25 / (x * y)


def _cbrt(x: float) -> tuple[float, float, float]:
    y = math.cbrt(x)
    return y, 1.0 / (3.0 * y * y), -2.0 / (9.0 * x * y * y)


def _arcsin(x: float) -> tuple[float, float, float]:
    w = (1.0 - x) * (1.0 + x)
    d = 1.0 / math.sqrt(w)
    return math.asin(x), d, x * d / w


def _arccos(x: float) -> tuple[float, float, float]:
    w = (1.0 - x) * (1.0 + x)
    d = 1.0 / math.sqrt(w)
    return math.acos(x), -d, -x * d / w


def _arctan(x: float) -> tuple[float, float, float]:
    d = 1.0 / (1.0 + x * x)
    return math.atan(x), d, -2.0 * x * d * d


def _sinh(x: float) -> tuple[float, float, float]:
    s, c = math.sinh(x), math.cosh(x)
    return s, c, s


def _cosh(x: float) -> tuple[float, float, float]:
    s, c = math.sinh(x), math.cosh(x)
    return c, s, c


def _tanh(x: float) -> tuple[float, float, float]:
    y = math.tanh(x)
    d = 1.0 / math.cosh(x) ** 2 if abs(x) < 300.0 else 0.0
    return y, d, -2.0 * y * d


def _arcsinh(x: float) -> tuple[float, float, float]:
    d = 1.0 / math.hypot(1.0, x)
    return math.asinh(x), d, -x * d**3


def _arccosh(x: float) -> tuple[float, float, float]:
    d = 1.0 / math.sqrt((x - 1.0) * (x + 1.0))
    return math.acosh(x), d, -x * d**3


def _arctanh(x: float) -> tuple[float, float, float]:
    d = 1.0 / ((1.0 - x) * (1.0 + x))
    return math.atanh(x), d, 2.0 * x * d * d


def _radians(x: float) -> tuple[float, float, float]:
    return math.radians(x), math.pi / 180.0, 0.0


def _degrees(x: float) -> tuple[float, float, float]:
    return math.degrees(x), 180.0 / math.pi, 0.0


_FORMULAS: dict[str, Callable[[float], tuple[float, float, float]]] = {
    "sin": _sin,
    "cos": _cos,
    "tan": _tan,
    "exp": _exp,
    "expm1": _expm1,
    "log": _log,
    "log1p": _log1p,
    "log2": _log2,
    "log10": _log10,
    "sqrt": _sqrt,
    "cbrt": _cbrt,
    "arcsin": _arcsin,
    "arccos": _arccos,
    "arctan": _arctan,
    "sinh": _sinh,
    "cosh": _cosh,
    "tanh": _tanh,
    "arcsinh": _arcsinh,
    "arccosh": _arccosh,
    "arctanh": _arctanh,
    "radians": _radians,
    "degrees": _degrees,
    "deg2rad": _radians,
    "rad2deg": _degrees,
}

UNARY_NAMES = tuple(_FORMULAS)


def unary(name: str, x: float) -> tuple[float, float, float]:
    """Value, first and second derivative of numpy's function `name` at x.

    Where a derivative does not exist or overflows, the value is numpy's and both derivatives are nan.
    """
    try:
        return _FORMULAS[name](x)
    except (ValueError, ZeroDivisionError, OverflowError):
        with np.errstate(all="ignore"):
            return float(getattr(np, name)(x)), math.nan, math.nan


def power(x: float, p: float) -> float:
    """x**p as numpy gives it: nan for a root of a negative number, inf for 0**-1 and for overflow."""
    try:
        return math.pow(x, p)
    except (ValueError, OverflowError):
        with np.errstate(all="ignore"):
            return float(np.power(x, p))


def quotient(x: float, y: float) -> float:
    """x / y as numpy gives it: inf or nan for a division by zero."""
    if y != 0.0:
        return x / y
    return math.nan if x == 0.0 or math.isnan(x) else math.copysign(math.inf, x) * math.copysign(1.0, y)


def power_derivatives(x: float, p: float) -> tuple[float, float, float]:
    """x**p with its first two derivatives with respect to x (constant p)."""
    first = p * power(x, p - 1.0) if p != 0.0 else 0.0
    second = p * (p - 1.0) * power(x, p - 2.0) if p not in (0.0, 1.0) else 0.0
    return power(x, p), first, second
