"""Coefficients of multistep formulas on the actual, unequal grid.

Nodes are s_j = (t_j - t_new)/h < 0, newest first. For equal steps they are the classical ones.
"""

from typing import Any

from ..compiled.jit import internal


@internal
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


@internal
def extrapolation_weights(s: Any, k: int, out: Any) -> None:
    """y(0) = sum_j out_j y_j, the polynomial through s_0 ... s_{k-1} (Lagrange)."""
    for j in range(k):
        weight = 1.0
        for l in range(k):
            if l != j:
                weight *= -s[l] / (s[j] - s[l])
        out[j] = weight


@internal
def ebdf_coefficients(s: Any, k: int, out: Any) -> None:
    """y(0) = sum_j out_j y_j + h out_k y'(0) + h out_{k+1} y'(1), exact for degree k + 1 (Cash 1980).

    Exactness for w = prod (s - s_j) and s w gives the two derivative weights, exactness for the Lagrange
    polynomials of the nodes the others: closed forms, no ill-conditioned Vandermonde matrix.
    """
    w0, w1, sum0, sum1 = 1.0, 1.0, 0.0, 0.0
    for j in range(k):
        w0 *= -s[j]
        w1 *= 1.0 - s[j]
        sum0 -= 1.0 / s[j]
        sum1 += 1.0 / (1.0 - s[j])
    # w(0) = B w'(0) + B1 w'(1),  0 = B w(0) + B1 (w(1) + w'(1)),  w' = w sum
    ahead = 1.0 / (sum1 * w1 / w0 - (1.0 + sum1) * sum0 * w1 / w0)
    own = -ahead * (1.0 + sum1) * w1 / w0
    out[k], out[k + 1] = own, ahead
    for j in range(k):
        at0, at1, slope0, slope1 = 1.0, 1.0, 0.0, 0.0
        for l in range(k):
            if l != j:
                at0 *= -s[l] / (s[j] - s[l])
                at1 *= (1.0 - s[l]) / (s[j] - s[l])
                slope0 -= 1.0 / s[l]
                slope1 += 1.0 / (1.0 - s[l])
        out[j] = at0 - own * at0 * slope0 - ahead * at1 * slope1
