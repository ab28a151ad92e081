"""How large the next step is: compiled rules for one-step formulas (`controllers.py`) and for multistep ones."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..state.run_records import A2, B1, B2, CLOCK_SIZE, EQUAL_STEPS, LARGEST_GROWTH, PREVIOUS_NORM, PREVIOUS_RATIO

SAFETY = 0.9
MIN_FACTOR = 0.2
MAX_FACTOR = 5.0  # of one-step formulas; multistep ones have their own
DEAD_BAND = 1.2  # a multistep formula keeps its step unless it may grow by more


@internal
def step_factor(error: float, order: float, growth: float) -> float:
    """By how much the step may change."""
    if error <= 0.0:
        return growth
    return min(growth, max(MIN_FACTOR, SAFETY * error ** (-1.0 / (order + 1.0))))


@internal
def _controlled(clock: Any, error: float, order: float) -> float:
    """By how much a one-step formula's step changes, by the controller's coefficients."""
    if error <= 0.0:
        clock[PREVIOUS_NORM] = 0.0
        return MAX_FACTOR
    exponent = 1.0 / (order + 1.0)
    factor = (SAFETY ** (order + 1.0) / error) ** (clock[B1] * exponent)
    if clock[PREVIOUS_NORM] > 0.0:
        factor *= (SAFETY ** (order + 1.0) / clock[PREVIOUS_NORM]) ** (clock[B2] * exponent)
        factor *= clock[PREVIOUS_RATIO] ** -clock[A2]
    else:
        # without a past every controller is the elementary one
        factor = SAFETY * error**-exponent
    factor = min(MAX_FACTOR, max(MIN_FACTOR, factor))
    clock[PREVIOUS_NORM], clock[PREVIOUS_RATIO] = error, factor
    return factor


@internal
def next_step(loop: Any, h: float, error: float, order: float, multistep: bool, hold: float) -> float:
    """Step to follow an accepted one of size h.

    A multistep formula grows only after `hold` equal steps, and only if it pays: growing at every step is not
    zero-stable for more than a few steps, growing by LARGEST_GROWTH between such runs of equal steps is (companion
    matrices of the variable-step formulas), and equal steps keep the coefficients.
    """
    clock = vec(loop.clock, CLOCK_SIZE)
    if not multistep:
        clock[EQUAL_STEPS] = 0.0
        return h * _controlled(clock, error, order)
    factor = step_factor(error, order, clock[LARGEST_GROWTH])
    if factor >= 1.0 and ((factor < DEAD_BAND and factor < clock[LARGEST_GROWTH]) or clock[EQUAL_STEPS] < hold):
        clock[EQUAL_STEPS] += 1.0
        return h
    clock[EQUAL_STEPS] = 0.0
    return h * factor
