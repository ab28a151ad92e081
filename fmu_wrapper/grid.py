"""Check of a communication step against the slave's own time."""

import math

from .errors import FmuValueError

LARGEST_SLIP = 1e-9
"""How far a master's time may be from the slave's, relative to the time, besides plain rounding."""


def check_step(own: float, t: float, h: float, stop: float | None) -> float:
    """End of the step from `t` by `h` (s) for a slave at `own`, before `stop` if there is one.

    The end is `t + h` as the master rounds it: the slave's own sum of steps would drift away from a master that
    counts its steps (a million steps of 0.1 s by 1.3e-6 s).

    Raises
    ------
    FmuValueError : for a `t` that is not the slave's time within rounding, an `h` that is not positive, a step
        that ends after `stop`, and numbers that are not finite.
    """
    end = t + h
    # nearly all; the slip is less than the least that is allowed below
    if h > 0.0 and abs(t - own) <= 8e-16 * own and own < end < math.inf and (stop is None or end <= stop):
        return end
    if not (math.isfinite(t) and math.isfinite(h)):
        raise FmuValueError(f"communication point {t!r} s and step {h!r} s must be finite")
    if h <= 0.0:
        raise FmuValueError(f"the communication step is {h!r} s: a step greater than 0 is needed")
    scale = max(abs(own), abs(t), h)
    # never so much that a step done twice passes
    slack = max(8.0 * math.ulp(scale), min(LARGEST_SLIP * scale, 0.01 * h))
    if abs(t - own) > slack:
        raise FmuValueError(
            f"the communication point is {t!r} s, but this slave is at {own!r} s: step from there, "
            "or set a stored state first"
        )
    if end <= own:
        raise FmuValueError(f"the communication step {h!r} s is lost in rounding at {own!r} s: make it larger")
    if stop is not None and end > stop + slack:
        raise FmuValueError(
            f"the step from {t!r} s by {h!r} s ends after the stop time {stop!r} s of the experiment: "
            "make it shorter, or set up the experiment without a stop time"
        )
    return end
