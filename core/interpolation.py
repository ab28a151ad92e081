"""Values between recorded samples: where a wanted time lies among them, cubics and straight lines."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Between:
    """F times among N samples: after sample `k`, by the part `x` of the way to the next one.

    At an impact two samples have the same time. `at` takes the one after it; `merged` can take both.
    """

    t: Floats
    """(F,), s."""
    k: NDArray[np.intp]
    """(F,)."""
    x: Floats
    """(F,), from 0 to less than 1."""
    h: Floats
    """(F,) the time from sample k to the next, s; 0 at the last one."""

    @classmethod
    def at(cls, samples: Floats, wanted: Floats) -> "Between":
        """The times `wanted` (F,) among those of the samples (N,), which enclose them."""
        k = np.clip(np.searchsorted(samples, wanted, side="right") - 1, 0, len(samples) - 1)
        h = samples[np.minimum(k + 1, len(samples) - 1)] - samples[k]
        x = np.divide(wanted - samples[k], h, out=np.zeros(len(wanted)), where=h > 0.0)
        return cls(wanted, k, x, h)

    @classmethod
    def merged(cls, samples: Floats, rows: NDArray[np.intp], wanted: Floats) -> "Between":
        """The samples `rows` as they are, and the times `wanted` between them, in the order of time.

        A wanted time at which one of the samples is taken is left out.
        """
        other = cls.at(samples, np.setdiff1d(wanted, samples[rows]))
        k, x = np.concatenate([rows, other.k]), np.concatenate([np.zeros(len(rows)), other.x])
        order = np.lexsort((x, k))
        k, x = k[order], x[order]
        h = samples[np.minimum(k + 1, len(samples) - 1)] - samples[k]
        return cls(np.concatenate([samples[rows], other.t])[order], k, x, h)

    def cubic(self, y: Floats, rate: Floats) -> Floats:
        """Cubics through the samples y (N, ...) with the slopes `rate` (N, ...): (F, ...)."""
        x, h = self._like(self.x, y), self._like(self.h, y)
        a, b = y[self.k], y[self._next(y)]
        bent = h * (x * (1 - x) ** 2 * rate[self.k] - x**2 * (1 - x) * rate[self._next(y)])
        found: Floats = (1 + 2 * x) * (1 - x) ** 2 * a + x**2 * (3 - 2 * x) * b + bent
        return found

    def line(self, y: Floats) -> Floats:
        """Straight lines through the samples y (N, ...): (F, ...)."""
        x = self._like(self.x, y)
        found: Floats = (1 - x) * y[self.k] + x * y[self._next(y)]
        return found

    def held(self, y: Floats) -> Floats:
        """The newest sample of y (N, ...): (F, ...)."""
        found: Floats = y[self.k]
        return found

    def _next(self, y: Floats) -> NDArray[np.intp]:
        return np.minimum(self.k + 1, len(y) - 1)

    @staticmethod
    def _like(x: Floats, y: Floats) -> Floats:
        return x.reshape(-1, *(1,) * (y.ndim - 1))
