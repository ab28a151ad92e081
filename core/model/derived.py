"""Channels that are functions of coordinates, their rates and multipliers: of markers, attitudes, loads."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .channels import Channel

NOT_KNOWN = -1
"""The rate of a channel that is none of the others."""


@dataclass(frozen=True)
class Columns:
    """What N samples say: coordinates, velocities, accelerations (N, n), multipliers (N, m), work accounts."""

    q: NDArray[np.float64]
    v: NDArray[np.float64]
    a: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    work: Callable[[str], NDArray[np.float64]]
    """Values (N,) of the work account of this name."""

    def __len__(self) -> int:
        return len(self.q)


class Derived(Protocol):
    """Channels computed together. One sample alone gives the same bits as a row of many."""

    @property
    def channels(self) -> Sequence[Channel]: ...

    @property
    def rate_of(self) -> Sequence[int]:
        """Number of the channel that is the rate of each, or NOT_KNOWN."""
        ...

    def __call__(self, columns: Columns) -> NDArray[np.float64]:
        """All of them (N, channels)."""
        ...
