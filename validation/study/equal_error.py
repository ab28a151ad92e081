"""Figures at equal achieved error: between the runs of a method, on straight lines in log-log scale."""

import math
from collections.abc import Sequence
from typing import Any, Protocol

LEVELS = tuple(10.0**-k for k in range(1, 10))
"""Errors at which methods are compared."""


class Finished(Protocol):
    """A run with a cost, an error (None or not finite: it has none), and whether it came to its end."""

    @property
    def ok(self) -> bool:
        """True if it came to its end."""

    @property
    def error(self) -> Any:
        """What it achieved."""


def at_error(runs: Sequence[Finished], level: float, quantity: str = "outer_iterations") -> float | None:
    """What `quantity` a method needs to come to the error `level`, from its runs from loose to tight tolerance.

    Between the last run that misses the level and the next; None if no run misses it, or none comes to it: nothing is
    extrapolated.
    """
    good = [run for run in runs if run.ok and run.error is not None and 0.0 < run.error < math.inf]
    missed = [k for k, run in enumerate(good) if run.error > level]
    if not missed or missed[-1] == len(good) - 1:
        return None
    a, b = good[missed[-1]], good[missed[-1] + 1]
    low, high = float(getattr(a, quantity)), float(getattr(b, quantity))
    share = math.log(a.error / level) / math.log(a.error / b.error)
    if low <= 0.0 or high <= 0.0:
        # explicit formulas have no outer iterations
        return low + (high - low) * share
    return low * (high / low) ** share
