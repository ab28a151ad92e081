"""Which times become frames: evenly spaced ones, and the solver's own steps, dense where much happens."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ..core.interpolation import Between

EVEN = 400
"""Frames at equal intervals."""
MOST_SAMPLES = 1200
"""Samples of the result that become frames too."""


def choose_frames(
    samples: NDArray[np.float64], events: Iterable[float], even: int = EVEN, most: int = MOST_SAMPLES
) -> Between:
    """Frames of a result with samples at these times (N,), s, and events; at most about `even` + `most`.

    Both samples of an impact are kept, so that jumps stay jumps. Of more than `most` samples those are kept that
    divide them evenly by number and not by time: short contacts keep their shape.
    """
    count = len(samples)
    if count == 0:
        raise ValueError("a result without samples has nothing to show")
    twice = np.flatnonzero(np.diff(samples) <= 0.0)
    near = np.searchsorted(samples, np.fromiter(events, dtype=float))
    important = np.concatenate([[0, count - 1], twice, twice + 1, np.clip(near, 0, count - 1)]).astype(np.intp)
    if len(important) > most:
        important = important[np.linspace(0, len(important) - 1, most).astype(np.intp)]
    spread = np.linspace(0, count - 1, min(count, most)).astype(np.intp)
    rows = np.unique(np.concatenate([important, spread]))
    return Between.merged(samples, rows, np.linspace(samples[0], samples[-1], even + 1))
