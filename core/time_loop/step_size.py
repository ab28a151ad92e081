"""How large the next step is: compiled rules for one-step formulas (`controllers.py`) and for multistep ones."""

from typing import Any

from ..compiled.jit import internal
from ..state.run_records import (
    clock_at,
)

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
        clock.previous_norm = 0.0
        return MAX_FACTOR
    exponent = 1.0 / (order + 1.0)
    factor = (SAFETY ** (order + 1.0) / error) ** (clock.b1 * exponent)
    if clock.previous_norm > 0.0:
        factor *= (SAFETY ** (order + 1.0) / clock.previous_norm) ** (clock.b2 * exponent)
        factor *= clock.previous_ratio**-clock.a2
    else:
        # without a past every controller is the elementary one
        factor = SAFETY * error**-exponent
    factor = min(MAX_FACTOR, max(MIN_FACTOR, factor))
    clock.previous_norm, clock.previous_ratio = error, factor
    return factor


@internal
def next_step(loop: Any, h: float, error: float, order: float, multistep: bool, hold: float) -> float:
    """Step to follow an accepted one of size h.

    A multistep formula grows only after `hold` equal steps, and only if it pays: growing at every step is not
    zero-stable for more than a few steps, growing by LARGEST_GROWTH between such runs of equal steps is (companion
    matrices of the variable-step formulas), and equal steps keep the coefficients.
    """
    clock = clock_at(loop.clock)
    if not multistep:
        clock.equal_steps = 0.0
        return h * _controlled(clock, error, order)
    factor = step_factor(error, order, clock.largest_growth)
    if factor >= 1.0 and ((factor < DEAD_BAND and factor < clock.largest_growth) or clock.equal_steps < hold):
        clock.equal_steps += 1.0
        return h
    clock.equal_steps = 0.0
    return h * factor
