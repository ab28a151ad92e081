"""Sizes of steps over a singular position, and numbers of their stages that keep clear of it."""

import numpy as np

from .collocation import gauss

STAGES = (4, 6, 8, 10)
"""Of the long step. Even numbers leave the widest gap between stages in the middle of the step."""
ALL_STAGES = tuple(range(3, 11))
CLEARANCE = 0.2
"""Least distance of a stage from the position, in units of the step over the number of stages."""
LENGTHS = (1.0, 1.5, 2.2, 3.3, 5.0)
"""Longer steps, with the position not in the middle, where rounding asks for them."""
SHORTER = (0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)
"""Of what remains to a stop, where it leaves no room for the steps above: some of these have stages that keep clear."""


def step_plans(near: float, natural: float, remaining: float) -> list[tuple[float, tuple[int, ...]]]:
    """Sizes of steps, s, in the order in which to try them, each with the numbers of stages to try."""
    plans: list[tuple[float, tuple[int, ...]]] = []
    if 0.25 * natural <= near <= 0.5 * remaining:
        plans.append((2.0 * near, STAGES))
    least = 2.0 * max(abs(near), natural)
    lengths = [min(length * least, remaining) for length in LENGTHS]
    plans += _clear_plans(sorted(set(lengths)), near)
    return plans or _clear_plans([length * remaining for length in SHORTER], near)


def _clear_plans(sizes: list[float], near: float) -> list[tuple[float, tuple[int, ...]]]:
    """Those sizes of steps for which there are numbers of stages that can be compared."""
    return [(h, clear) for h in sizes if len(clear := clear_stages(h, near)) > 1]


def clear_stages(h: float, near: float) -> tuple[int, ...]:
    """Numbers of stages that keep clear of the position, `near` s from the start, in a step of size h."""
    return tuple(s for s in ALL_STAGES if np.min(np.abs(gauss(s).c * h - near)) >= CLEARANCE * h / s)
