"""Locating an event inside a step: the step is made again with the size that ends at the event, by a safeguarded
secant iteration down to rounding."""

from collections.abc import Callable

from ..rounding import RESOLVED_TIME

MAX_TRIALS = 60
JUMP = 1e-6
"""A function that is this large, relative to its largest value, right beside its root jumps there."""


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
        if width <= RESOLVED_TIME * abs(x_high):
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
