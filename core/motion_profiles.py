"""Positions over time that lead motions: position, rate, acceleration and jerk of one piecewise polynomial."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Derivatives = tuple[float, float, float, float]
"""Value and its first, second and third time derivative."""


@dataclass(frozen=True)
class Way:
    """A piecewise cubic: `coefficients` (4, k - 1), highest power first, of the time since the knot (k,) before.

    Constant before the first knot, with the value `first`, and from the last knot on, with the value `last`.
    """

    knots: Floats
    coefficients: Floats
    first: float
    last: float

    def at(self, t: float) -> Derivatives:
        """What holds from time `t` (s) on."""
        k = int(np.searchsorted(self.knots, t, side="right")) - 1
        if k < 0:
            return self.first, 0.0, 0.0, 0.0
        if k >= len(self.knots) - 1:
            return self.last, 0.0, 0.0, 0.0
        c3, c2, c1, c0 = (float(c) for c in self.coefficients[:, k])
        s = t - float(self.knots[k])
        return (
            c0 + s * (c1 + s * (c2 + s * c3)), c1 + s * (2.0 * c2 + 3.0 * s * c3), 2.0 * c2 + 6.0 * s * c3, 6.0 * c3,
        )  # fmt: skip


def straight(times: Floats, values: Floats) -> Way:
    """Straight lines through the values (k,)."""
    slopes = np.diff(values) / np.diff(times)
    zero = np.zeros(len(slopes))
    return _way(times, values, np.array([zero, zero, slopes, values[:-1]]))


def spline(times: Floats, values: Floats) -> Way:
    """The not-a-knot cubic spline through the values (k,); a parabola or a line where there are three or two."""
    if len(times) < 2:
        return straight(times, values)
    # importing scipy costs more than most runs: only who needs a spline pays
    from scipy.interpolate import CubicSpline

    return _way(times, values, np.asarray(CubicSpline(times, values).c))


def hermite(times: Floats, values: Floats, rates: Floats) -> Way:
    """The cubics through the values (k,) with these rates (k,) at the times."""
    h, chord = np.diff(times), np.diff(values) / np.diff(times)
    before, after = rates[:-1], rates[1:]
    cubic, square = (before + after - 2.0 * chord) / h**2, (3.0 * chord - 2.0 * before - after) / h
    return _way(times, values, np.array([cubic, square, before, values[:-1]]))


def _way(times: Floats, values: Floats, coefficients: Floats) -> Way:
    return Way(times, coefficients, float(values[0]), float(values[-1]))
