"""Shape functions of the gradient-deficient cubic ANCF cable element, and where its strains are integrated.

Over x in [0, 1] of an element of length L, with nodes r0, s0, r1, s1 (s = dr/ds):
  r = (1 - 3 x^2 + 2 x^3) r0 + L (x - 2 x^2 + x^3) s0 + (3 x^2 - 2 x^3) r1 + L (x^3 - x^2) s1.
With d = (r1 - r0)/L: r' = (6 x - 6 x^2) d + (1 - 4 x + 3 x^2) s0 + (3 x^2 - 2 x) s1, and L r'' by another derivative.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_POINTS = 5
POINTS = {"full": (5, 3), "reduced": (4, 2)}
"""Gauss points of the axial and of the bending strain (orders 9 and 5, 7 and 3)."""


def weights(x: float, length: float, derivative: int) -> NDArray[np.float64]:
    """Weights (4,) of r0, s0, r1, s1 in r (derivative 0), r' (1) or r'' (2) at x in [0, 1]."""
    if derivative == 0:
        w = [1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2]
    elif derivative == 1:
        w = [6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x]
    else:
        w = [12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2]
    return np.array(w) * np.array([1.0, length, 1.0, length]) / length**derivative


def _gauss() -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """For n Gauss points, n in 0...MOST_POINTS, over [0, 1]: weights (n, point), and those of d, s0, s1 in r' and L r''
    (n, point, 3)."""
    size = (MOST_POINTS + 1, MOST_POINTS)
    share, first, second = np.zeros(size), np.zeros((*size, 3)), np.zeros((*size, 3))
    for n in range(1, MOST_POINTS + 1):
        for k, (z, w) in enumerate(zip(*np.polynomial.legendre.leggauss(n), strict=True)):
            x = 0.5 * (1.0 + z)
            share[n, k] = 0.5 * w
            first[n, k] = (6 * x - 6 * x**2, 1 - 4 * x + 3 * x**2, 3 * x**2 - 2 * x)
            second[n, k] = (6 - 12 * x, 6 * x - 4, 6 * x - 2)
    return share, first, second


SHARE, FIRST, SECOND = _gauss()


def gauss_places(n: int) -> Any:
    """The n Gauss points over [0, 1]."""
    return 0.5 * (1.0 + np.polynomial.legendre.leggauss(n)[0])
