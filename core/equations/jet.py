"""Jets: numbers that carry their gradient and Hessian (forward automatic differentiation, second order).

Rules: Griewank and Walther, Evaluating Derivatives, 2nd ed. (SIAM 2008), chapters 3 and 13.
"""

import math
from typing import Any

import numpy as np

from .elementary import UNARY_NAMES, power, power_derivatives, quotient, unary
from .jet_numpy import NumpyFunctions, pair, plain

_REMEDY = (
    "{what} of a Jet would lose its derivatives. Jets are the numbers with which a user's function is "
    "differentiated: use numpy's functions (numpy.sin instead of math.sin), no float() or int(), and make "
    "arrays that are filled later with numpy.zeros_like(q) instead of numpy.zeros(...)"
)


class Jet(NumpyFunctions):
    """A number with its derivatives with respect to k variables.

    Parameters
    ----------
    value : the number.
    gradient : (k,) first derivatives.
    hessian : (k, k) second derivatives, or None where only the first are needed.

    Comparisons and truth are those of the value, so that branches follow the plain evaluation. Division by
    zero, roots of negative numbers and the like give inf or nan as in numpy, never an exception.
    """

    __slots__ = ("gradient", "hessian", "value")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: float, gradient: Any, hessian: Any = None) -> None:
        self.value = float(value)
        self.gradient = gradient
        self.hessian = hessian

    # How gradients combine to a Hessian: the only place that knows that they are vectors.
    @staticmethod
    def _square(g: Any) -> Any:
        return g[:, None] * g

    @staticmethod
    def _symmetric(g: Any, h: Any) -> Any:
        product = g[:, None] * h
        return product + product.T

    def _constant(self, value: float) -> "Jet":
        hessian = None if self.hessian is None else 0.0 * self.hessian
        return type(self)(value, 0.0 * self.gradient, hessian)

    def _chain(self, f: float, f1: float, f2: float) -> "Jet":
        """f(self), from the value and the derivatives of f."""
        g = self.gradient
        hessian = None if self.hessian is None else f1 * self.hessian + f2 * self._square(g)
        return type(self)(f, f1 * g, hessian)

    def _chain2(self, other: "Jet", f: float, first: tuple, second: tuple) -> "Jet":
        """f(self, other), from f, (f_x, f_y) and (f_xx, f_xy, f_yy)."""
        (fx, fy), (fxx, fxy, fyy) = first, second
        g, h = self.gradient, other.gradient
        hessian = None
        if self.hessian is not None:
            hessian = (
                fx * self.hessian
                + fy * other.hessian
                + fxx * self._square(g)
                + fxy * self._symmetric(g, h)
                + fyy * self._square(h)
            )
        return type(self)(f, fx * g + fy * h, hessian)

    def __add__(self, other: Any) -> Any:
        if isinstance(other, Jet):
            hessian = None if self.hessian is None else self.hessian + other.hessian
            return type(self)(self.value + other.value, self.gradient + other.gradient, hessian)
        if isinstance(other, NUMBERS):
            return type(self)(self.value + float(other), self.gradient, self.hessian)
        return NotImplemented

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Jet):
            hessian = None if self.hessian is None else self.hessian - other.hessian
            return type(self)(self.value - other.value, self.gradient - other.gradient, hessian)
        if isinstance(other, NUMBERS):
            return type(self)(self.value - float(other), self.gradient, self.hessian)
        return NotImplemented

    def __rsub__(self, other: Any) -> Any:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Jet):
            x, y = self.value, other.value
            hessian = None
            if self.hessian is not None:
                mixed = self._symmetric(self.gradient, other.gradient)
                hessian = y * self.hessian + x * other.hessian + mixed
            return type(self)(x * y, y * self.gradient + x * other.gradient, hessian)
        if isinstance(other, NUMBERS):
            y = float(other)
            hessian = None if self.hessian is None else y * self.hessian
            return type(self)(self.value * y, y * self.gradient, hessian)
        return NotImplemented

    __rmul__ = __mul__

    def _reciprocal(self) -> "Jet":
        r = quotient(1.0, self.value)
        return self._chain(r, -r * r, 2.0 * r * r * r)

    def __truediv__(self, other: Any) -> Any:
        if isinstance(other, Jet):
            y = other.value
            if y == 0.0:
                return self * other._reciprocal()
            ratio = self.value / y
            gradient = (self.gradient - ratio * other.gradient) / y
            hessian = None
            if self.hessian is not None:
                mixed = self._symmetric(gradient, other.gradient)
                hessian = (self.hessian - ratio * other.hessian - mixed) / y
            return type(self)(ratio, gradient, hessian)
        if isinstance(other, NUMBERS):
            y = float(other)
            if y == 0.0:
                return self._chain(quotient(self.value, y), math.nan, math.nan)
            hessian = None if self.hessian is None else self.hessian / y
            return type(self)(self.value / y, self.gradient / y, hessian)
        return NotImplemented

    def __rtruediv__(self, other: Any) -> Any:
        if not isinstance(other, NUMBERS):
            return NotImplemented
        return self._constant(float(other)) / self

    def __pow__(self, other: Any) -> Any:
        x = self.value
        if isinstance(other, NUMBERS):
            return self * self if other == 2 else self._chain(*power_derivatives(x, float(other)))
        if not isinstance(other, Jet):
            return NotImplemented
        y = other.value
        f, fx, fxx = power_derivatives(x, y)
        if x > 0.0:
            log = math.log(x)
            second = (fxx, power(x, y - 1.0) * (1.0 + y * log), f * log * log)
            return self._chain2(other, f, (fx, f * log), second)
        if not np.any(other.gradient) and (other.hessian is None or not np.any(other.hessian)):
            return self._chain(f, fx, fxx)
        return self._chain2(other, f, (fx, math.nan), (fxx, math.nan, math.nan))

    def __rpow__(self, other: Any) -> Any:
        if not isinstance(other, NUMBERS):
            return NotImplemented
        return self._constant(float(other)) ** self

    def __mod__(self, other: Any) -> Any:
        if not isinstance(other, NUMBERS):
            return NotImplemented
        with np.errstate(all="ignore"):
            value = float(np.mod(self.value, float(other)))
        return type(self)(value, self.gradient, self.hessian)

    def __neg__(self) -> "Jet":
        return type(self)(-self.value, -self.gradient, None if self.hessian is None else -self.hessian)

    def __pos__(self) -> "Jet":
        return self

    def __abs__(self) -> "Jet":
        """|x|; the derivative at zero is taken as 0, as numpy.sign(0) is."""
        if self.value > 0.0:
            return self
        return -self if self.value < 0.0 else self._chain(abs(self.value), 0.0, 0.0)

    fabs = __abs__

    def arctan2(self, other: Any) -> "Jet":
        """Angle of the point (other, self), rad."""
        y, x = pair(self, other)
        r2 = x.value * x.value + y.value * y.value
        a, b = quotient(x.value, r2), quotient(y.value, r2)
        second = (-2.0 * a * b, (b - a) * (b + a), 2.0 * a * b)
        return y._chain2(x, math.atan2(y.value, x.value), (a, -b), second)

    def hypot(self, other: Any) -> "Jet":
        """Length of the vector (self, other)."""
        x, y = pair(self, other)
        r = math.hypot(x.value, y.value)
        a, b = quotient(x.value, r), quotient(y.value, r)
        return x._chain2(y, r, (a, b), (quotient(b * b, r), quotient(-a * b, r), quotient(a * a, r)))

    def conjugate(self) -> "Jet":
        """Jets are real."""
        return self

    def __lt__(self, other: Any) -> Any:
        return self.value < plain(other) if isinstance(other, REALS) else NotImplemented

    def __le__(self, other: Any) -> Any:
        return self.value <= plain(other) if isinstance(other, REALS) else NotImplemented

    def __gt__(self, other: Any) -> Any:
        return self.value > plain(other) if isinstance(other, REALS) else NotImplemented

    def __ge__(self, other: Any) -> Any:
        return self.value >= plain(other) if isinstance(other, REALS) else NotImplemented

    def __eq__(self, other: Any) -> Any:
        return self.value == plain(other) if isinstance(other, REALS) else NotImplemented

    def __ne__(self, other: Any) -> Any:
        return self.value != plain(other) if isinstance(other, REALS) else NotImplemented

    def __bool__(self) -> bool:
        return self.value != 0.0

    def __float__(self) -> float:
        raise TypeError(_REMEDY.format(what="conversion to a plain float"))

    def __int__(self) -> int:
        raise TypeError(_REMEDY.format(what="conversion to int"))

    def __complex__(self) -> complex:
        raise TypeError(_REMEDY.format(what="conversion to complex"))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.value!r}, gradient={self.gradient!r}, hessian={self.hessian!r})"


class LineJet(Jet):
    """A number with its first two derivatives along a curve: gradient and hessian are plain floats.

    The same rules as `Jet` with one variable, at a fraction of the cost of arrays of length one.
    """

    __slots__ = ()

    @staticmethod
    def _square(g: float) -> float:
        return g * g

    @staticmethod
    def _symmetric(g: float, h: float) -> float:
        return 2.0 * g * h


NUMBERS = (float, int, np.floating, np.integer, np.bool_)
REALS = (*NUMBERS, Jet)


def _unary_method(name: str) -> Any:
    def method(self: Jet) -> Jet:
        return self._chain(*unary(name, self.value))

    method.__name__ = name
    method.__doc__ = f"numpy.{name} of the jet."
    return method


for _name in UNARY_NAMES:
    setattr(Jet, _name, _unary_method(_name))
