"""Contacts whose friction has one tangent, where a few sweeps and Newton's method find no forces: pivoting.

With one tangent a friction cone is a polyhedron, and the problem one of linear complementarity, which Lemke's method
solves with a limit to the normal forces (`contact_solvers/pivoting.py`).
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import mat, vec
from ..contact_solvers.planar_contacts import NONE, call_cones
from .independent_directions import cones_at


@internal
def has_one_tangent(n: int, a: Any) -> bool:
    """True if nothing moves the second tangents of n contacts with the inverse masses a (3 n, 3 n)."""
    for i in range(2 * n, 3 * n):
        if a[i, i] != 0.0:
            return False
    return True


@internal
def pivot_in_plane(instant: Any, n: int, a: Any, b: Any, mu: Any, base: Any, known: Any, way: Any, p: Any) -> bool:
    """Forces p (3 n,), as of `friction_cones.solve_friction_cones`, of contacts with one tangent; False: none found."""
    cn = cones_at(instant.cones)
    cn.n = n
    nn, nt, tt = mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    for i in range(n):
        for j in range(n):
            nn[i, j], nt[i, j], tt[i, j] = a[i, j], a[i, n + j], a[n + i, n + j]
        vec(cn.b_n, n)[i], vec(cn.b_t, n)[i], vec(cn.base, n)[i], vec(cn.mu, n)[i] = b[i], b[n + i], base[i], mu[i]
        vec(cn.direction, n)[i] = math.copysign(1.0, way[0, i]) if known[i] != 0.0 else 0.0
    if call_cones(instant.solve_cones, cn) == NONE:
        return False
    for i in range(n):
        p[i], p[n + i], p[2 * n + i] = vec(cn.normal, n)[i], vec(cn.tangential, n)[i], 0.0
    return True
