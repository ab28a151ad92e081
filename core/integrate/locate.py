"""Locating an event inside a step: a guess from the ends' gap, rate and acceleration, then the step is made again
with the size that ends at the event, by a safeguarded secant iteration down to rounding."""

from collections.abc import Callable

import numpy as np

MAX_TRIALS = 60
JUMP = 1e-6
"""A function that is this large, relative to its largest value, right beside its root jumps there."""


def quintic(h: float, start: tuple[float, float, float], end: tuple[float, float, float]) -> np.ndarray:
    """Coefficients (highest first, in s = t/h) of the quintic through (g, g', g'') at both ends of a step h."""
    g0, d0, c0 = start[0], h * start[1], h * h * start[2]
    g1, d1, c1 = end[0], h * end[1], h * h * end[2]
    return np.array(
        [
            6.0 * (g1 - g0) - 3.0 * (d0 + d1) - 0.5 * (c0 - c1),
            -15.0 * (g1 - g0) + 8.0 * d0 + 7.0 * d1 + 1.5 * c0 - c1,
            10.0 * (g1 - g0) - 6.0 * d0 - 4.0 * d1 - 1.5 * c0 + 0.5 * c1,
            0.5 * c0,
            d0,
            g0,
        ]
    )


def first_crossing(
    h: float, start: tuple[float, float, float], end: tuple[float, float, float], down: bool
) -> tuple[float, float, float]:
    """Bracket (low, high) of s in (0, 1] in which the gap's interpolant first crosses zero (downwards or upwards), and
    the place of its extremum beyond zero.

    The points where the interpolant turns are looked at too: a graze may dip below zero only there. A start on the
    contact itself that moves away (g = 0 to rounding, g' of the safe sign) is no crossing.
    """
    sign = 1.0 if down else -1.0
    if sign * start[0] <= 0.0:
        start = (0.0, start[1], start[2])
    coefficients = sign * quintic(h, start, end)
    turning = np.roots(np.polyder(coefficients))
    turning = turning[np.isreal(turning)].real
    turning = turning[(turning > 0.0) & (turning < 1.0)]
    s = np.unique(np.concatenate([2.0 ** np.arange(-44.0, 0.0), np.linspace(0.0, 1.0, 65)[1:], turning]))
    value = np.polyval(coefficients, s)
    below = np.flatnonzero(value < 0.0)
    if len(below) == 0:
        return 0.0, 1.0, 1.0
    first = int(below[0])
    return float(s[first - 1]) if first > 0 else 0.0, float(s[first]), float(s[np.argmin(value)])


def find_root(function: Callable[[float], float], low: float, high: float, guess: float, floor: float) -> float:
    """Root of `function` (positive at `low`, negative at `high`) to rounding; `floor` is its rounding noise.

    Secant steps (ITP-like safeguard: bisection when they do not halve the bracket in three trials).
    Returns the argument of the last evaluation, so that the caller's state belongs to it: on the safe side of the root,
    but behind a jump of the function, since what it asks for is seen only there.
    """
    x_low, x_high = low, high
    f_low: float | None = None
    f_high: float | None = None
    largest = 0.0
    x = guess
    last: tuple[float, float] | None = None
    widths = [high - low]
    for _ in range(MAX_TRIALS):
        f = function(x)
        if abs(f) <= floor:
            return x
        largest = max(largest, abs(f))
        if f > 0.0:
            x_low, f_low = x, f
        else:
            x_high, f_high = x, f
        width = x_high - x_low
        if width <= 2e-16 * abs(x_high):
            break
        widths.append(width)
        if last is not None and f != last[1]:
            proposal = x - f * (x - last[0]) / (f - last[1])
        elif f_low is not None and f_high is not None:
            proposal = x_low + width * f_low / (f_low - f_high)
        else:
            proposal = 0.5 * (x_low + x_high)
        slow = len(widths) > 3 and width > 0.5 * widths[-4]
        if slow or not x_low < proposal < x_high:
            proposal = 0.5 * (x_low + x_high)
        last = (x, f)
        x = proposal
    if f_low is not None and f_low > JUMP * largest and f_high is not None:
        function(x_high)
        return x_high
    # the side past the event would be found again as a crossing: end on the safe one
    if x_low > low:
        function(x_low)
        return x_low
    return x
