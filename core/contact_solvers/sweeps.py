"""Sweeps over many contacts, one after another (nonlinear Gauss-Seidel, Jean and Moreau 1992; Jean 1999)."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..rounding import SWEEP_ROUNDING


@internal
def one_contact(a: float, b: float, c: float, w_n: float, w_t: float, mu: float, direction: float, least: float) -> Any:
    """(N, T) of one contact whose motion without forces of its own is (w_n, w_t); N >= least. NaN if there are none."""
    if mu == 0.0:
        return max(least, -w_n / a), 0.0
    if direction != 0.0:
        pressing = a - mu * direction * b
        if pressing <= 0.0 and w_n + pressing * least < 0.0:
            return np.nan, np.nan
        normal = max(least, -w_n / pressing) if pressing > 0.0 else least
        return normal, -mu * direction * normal
    # no more than what it has in any case
    friction = -(w_t + b * least) / c if c > 0.0 else 0.0
    friction = min(max(friction, -mu * least), mu * least)
    if w_n + a * least + b * friction >= 0.0:
        return least, friction
    determinant = a * c - b * b
    if determinant > SWEEP_ROUNDING * a * c:
        normal, friction = (b * w_t - c * w_n) / determinant, (b * w_n - a * w_t) / determinant
        if normal >= least and abs(friction) <= mu * normal:
            return normal, friction
    elif c == 0.0:
        return -w_n / a, 0.0
    # the way in which the friction of a stuck contact gives way
    side = 1.0 if w_t - b / a * w_n > 0.0 else -1.0
    for _ in range(2):
        pressing = a - mu * side * b
        if pressing > 0.0:
            normal = max(-w_n / pressing, least)
            if side * (w_t + (b - mu * side * c) * normal) >= -SWEEP_ROUNDING * (abs(w_t) + (abs(b) + mu * c) * normal):
                return normal, -mu * side * normal
        side = -side
    return np.nan, np.nan


@internal
def sweep(cn: Any, mu: Any, normal: Any, friction: Any, eps: float, count: int) -> bool:
    """`count` sweeps over the contacts of the record `cn` (`planar_contacts.py`) with the coefficients of friction mu
    (n,), from (`normal`, `friction`), which are overwritten; each gives way by the part `eps` of its own inverse mass.
    False if a contact has no solution of its own."""
    n = cn.n
    nn, nt, tt = mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    b_n, b_t, direction, base = vec(cn.b_n, n), vec(cn.b_t, n), vec(cn.direction, n), vec(cn.base, n)
    for _ in range(count):
        for i in range(n):
            w_n, w_t = b_n[i], b_t[i]
            for j in range(n):
                if j != i:
                    w_n += nn[i, j] * normal[j] + nt[i, j] * friction[j]
                    w_t += nt[j, i] * normal[j] + tt[i, j] * friction[j]
            a, c = nn[i, i] + eps * nn[i, i], tt[i, i] + eps * tt[i, i]
            alone = one_contact(a, nt[i, i], c, w_n, w_t, mu[i], direction[i], base[i])
            if not np.isfinite(alone[0]):
                return False
            normal[i], friction[i] = alone
    return True
