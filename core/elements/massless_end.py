"""The end of a flexible body whose node has no mass, while nothing touches it: Phi = x - x_neighbour - rest length.

Its equation of motion is a balance of forces: the force of its element is zero. That is a constraint, for which no
force is needed. When a contact closes there, the contact's row takes its place (`Assembly.replaced_rows`).
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec


@internal
def massless_end_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    coord, row = imat(b.coord, b.count, 2), imat(b.row, b.count, 1)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    for e in range(b.count):
        i, j, k = coord[e, 0], coord[e, 1], row[e, 0]
        if job == RESIDUAL:
            r, lam = vec(b.r, b.n_extended), vec(b.lam, b.m_extended)
            vec(b.phi, b.m_extended)[k] = q[i] - q[j] - mat(b.par, b.count, 1)[e, 0]
            vec(b.phid, b.m_extended)[k] = v[i] - v[j]
            vec(b.phidd, b.m_extended)[k] = a[i] - a[j]
            r[i] += lam[k]
            r[j] -= lam[k]
        else:
            values = vec(b.values, b.n_values)
            slot_j, slot_jt = imat(b.slot_j, b.count, 2), imat(b.slot_jt, b.count, 2)
            values[slot_j[e, 0]] += 1.0
            values[slot_j[e, 1]] -= 1.0
            values[slot_jt[e, 0]] += 1.0
            values[slot_jt[e, 1]] -= 1.0
