"""Coefficients of multistep formulas on the actual, unequal grid.

Nodes are s_j = (t_j - t_new)/h < 0, newest first. For equal steps they are the classical ones.
"""

from typing import Any

from ..compiled.jit import compiled


@compiled
def bdf_coefficients(s: Any, k: int, out: Any) -> None:
    """y(0) = sum_j out_j y_j + out_k h y'(0): derivative at 0 of the interpolant through 0 and s_0 ... s_{k-1}."""
    own = 0.0
    for j in range(k):
        own -= 1.0 / s[j]
    for j in range(k):
        slope = 1.0 / s[j]
        for l in range(k):
            if l != j:
                slope *= -s[l] / (s[j] - s[l])
        out[j] = -slope / own
    out[k] = 1.0 / own


@compiled
def extrapolation_weights(s: Any, k: int, out: Any) -> None:
    """y(0) = sum_j out_j y_j, the polynomial through s_0 ... s_{k-1} (Lagrange)."""
    for j in range(k):
        weight = 1.0
        for l in range(k):
            if l != j:
                weight *= -s[l] / (s[j] - s[l])
        out[j] = weight


@compiled
def ebdf_coefficients(s: Any, k: int, out: Any, matrix: Any) -> None:
    """y(0) = sum_j out_j y_j + h out_k y'(0) + h out_{k+1} y'(1), exact for degree k + 1 (Cash 1980).

    Exactness for 1, s, ..., s^(k+1) on the actual nodes; `matrix` is ((k+2), (k+3)) scratch.
    """
    size = k + 2
    for p in range(size):
        for j in range(k):
            matrix[p, j] = s[j] ** p
        matrix[p, k] = 1.0 if p == 1 else 0.0
        matrix[p, k + 1] = float(p)
        matrix[p, size] = 1.0 if p == 0 else 0.0
    for c in range(size):
        pivot = c
        for i in range(c + 1, size):
            if abs(matrix[i, c]) > abs(matrix[pivot, c]):
                pivot = i
        if pivot != c:
            for j in range(c, size + 1):
                matrix[c, j], matrix[pivot, j] = matrix[pivot, j], matrix[c, j]
        for i in range(c + 1, size):
            factor = matrix[i, c] / matrix[c, c]
            if factor != 0.0:
                for j in range(c, size + 1):
                    matrix[i, j] -= factor * matrix[c, j]
    for c in range(size - 1, -1, -1):
        total = matrix[c, size]
        for j in range(c + 1, size):
            total -= matrix[c, j] * out[j]
        out[c] = total / matrix[c, c]
