"""How channels follow from the columns of samples."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..state.modes import ACTIVE, CLOSED


@dataclass(frozen=True)
class Sum:
    """A channel that is a sum of columns, less other columns and a constant. It is added up one by one from the left,
    so that a single sample gives the same bits as a column of many."""

    columns: tuple[int, ...]
    less: tuple[int, ...] = ()
    factor: float = 1.0
    """Of all."""

    def __call__(self, samples: NDArray[np.float64]) -> NDArray[np.float64]:
        total = np.zeros(len(samples))
        for column in self.columns:
            total += self.factor * samples[:, column]
        for column in self.less:
            total -= self.factor * samples[:, column]
        return total


@dataclass(frozen=True)
class InContact:
    """A channel that is 1 while the mode in `column` says that the contact carries force."""

    column: int

    def __call__(self, samples: NDArray[np.float64]) -> NDArray[np.float64]:
        mode = samples[:, self.column]
        return ((mode == CLOSED) | (mode == ACTIVE)).astype(np.float64)


@dataclass(frozen=True)
class OneOf:
    """A derived channel: its number among all derived ones, and that of its rate."""

    number: int
    rate: int
