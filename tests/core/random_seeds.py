"""Checks at random seeds: what hypothesis does with integers, without its cost, which is a multiple of the checks'."""

from collections.abc import Callable
from functools import wraps

import numpy as np
from hypothesis.errors import UnsatisfiedAssumption

COUNT = 4
"""Seeds at which a check must hold."""


def assume(condition: bool) -> None:
    """Leaves out a seed that does not meet the condition; in tests of hypothesis, too."""
    if not condition:
        raise UnsatisfiedAssumption


def at_seeds(check: Callable[[int], None]) -> Callable[[], None]:
    """The check at COUNT seeds, always the same; for one that does not meet what is assumed another is taken."""

    @wraps(check)
    def checked() -> None:
        done = 0
        for seed in np.random.default_rng(COUNT).integers(0, 10**6, 10 * COUNT):
            try:
                check(int(seed))
            except UnsatisfiedAssumption:
                continue
            done += 1
            if done == COUNT:
                return
        assert done > 0, "no seed meets what is assumed"

    return checked
