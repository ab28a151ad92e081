"""How rows that repeat each other share the load: rows of compatibility.

Where closed contacts repeat each other (a block on four feet), the constraints of some of them are implied by those of
the others. The motion is the same with any multipliers lambda' = lambda + n, Phi_q^T n = 0. Forces of rigid contacts
are the limit of those of equally compliant ones, A + eps C with eps -> 0. Multiplied by a null vector n of Phi_q^T, of
which A is made, the equations (A + eps C) lambda + b = 0 leave n^T C lambda = 0 for any eps: of all multipliers that
give the motion these are the ones of least C-norm (Tikhonov 1963; for multibody systems Wojtyra and Fraczek 2013, who
compare such choices). So in place of the equation of each implied row the matrix has such a row, and sliding friction
follows the normal forces that it gives.

C is 1 for each normal and each tangent of a contact. Joints are rigid beside contacts: their compliance is 0.

The null vector of an implied row g is (-w, 1), Phi_q^T w = g^T. It is found by one solution with the transposed matrix
of the equations, whatever rows of compatibility this has: where G are the rows of Phi_q that are solved for, B those of
compatibility, and T_G, T_g the columns with which their multipliers act (friction included), the solution of
[S^T, G^T, 0; T_G^T, 0, B_G^T; T_g^T, 0, B_g^T] (x, w, u) = (g^T, 0, 0) is x = u = 0. So the rows that were valid
last serve to find the present ones.
"""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..compiled.views import imat, ivec, mat, vec
from ..linalg import factor, lu_at, solve
from ..linalg.analyze import call_analyze
from ..linalg.solve import solve_transposed
from ..rounding import COMPATIBLE, STILL_COMPATIBLE
from ..state.workspace_records import structure_at


@internal
def begin_sharing(st: Any) -> None:
    """Rows of compatibility of a structure that has just been built: each implied row carries nothing."""
    rows = mat(st.compatibility, st.n_implied, st.n_sharing)
    sharing = ivec(st.sharing, st.n_sharing)
    for p in range(st.n_implied):
        for j in range(st.n_sharing):
            rows[p, j] = 1.0 if sharing[j] == st.m_act + p else 0.0


@internal
def write_compatibility(ws: Any) -> None:
    """The rows of compatibility, to their slots in the matrix."""
    if ws.n_implied == 0:
        return
    st = structure_at(ws.structure)
    rows, slots = mat(st.compatibility, st.n_implied, st.n_sharing), imat(st.sharing_slot, st.n_implied, st.n_sharing)
    values = vec(ws.values, ws.n_values)
    for p in range(st.n_implied):
        for j in range(st.n_sharing):
            values[slots[p, j]] = rows[p, j]


@internal
def left_of_sharing(ws: Any) -> None:
    """What the multipliers leave of the rows of compatibility, its negative, to their places in `rhs`."""
    if ws.n_implied == 0:
        return
    st, lam = structure_at(ws.structure), vec(ws.lam, ws.m_ext)
    rows, sharing = mat(st.compatibility, st.n_implied, st.n_sharing), ivec(st.sharing, st.n_sharing)
    rhs, active = vec(ws.rhs, ws.n + ws.m_act + ws.n_implied), ivec(ws.active, ws.m_act + ws.n_implied)
    for p in range(st.n_implied):
        total = 0.0
        for j in range(st.n_sharing):
            total += rows[p, j] * lam[active[sharing[j]]]
        rhs[ws.n + ws.m_act + p] = -total


@internal
def solve_equations(ws: Any, lu_address: int) -> None:
    """rhs (n + m_act,) -> its solution with the matrix of the equations, where rows of compatibility leave nothing."""
    rhs = vec(ws.rhs, ws.n + ws.m_act + ws.n_implied)
    for p in range(ws.n_implied):
        rhs[ws.n + ws.m_act + p] = 0.0
    solve(lu_at(lu_address), ws.rhs)


@internal
def _still_null(ws: Any, st: Any, p: int, weights: Any, total: Any) -> bool:
    """True if row p of compatibility, `weights` (n_sharing,), still is a null vector of the gradients evaluated last,
    as finely as it was found. `total` (n,): room. Where joints take part in it, whose multipliers are none of its
    entries, it is not known to be one."""
    values, scale, n, m_act, size = vec(ws.values, ws.n_values), vec(ws.scale, ws.n), ws.n, ws.m_act, 0.0
    count, sharing, starts = ws.n_values, ivec(st.sharing, st.n_sharing), ivec(ws.gradient_start, ws.m_ext)
    columns, slots = ivec(ws.gradient_col, count), ivec(ws.gradient_slot, count)
    own_start, own = ivec(st.jacobian_start, m_act + 1), st.n_jacobian
    own_col, own_slot = ivec(st.jacobian_col, own), ivec(st.jacobian_slot, own)
    row = ivec(ws.active, m_act + ws.n_implied)[m_act + p]
    for i in range(n):
        total[i] = 0.0
    for e in range(starts[row], starts[row + 1]):
        total[columns[e]] += values[slots[e]]
        size = max(size, scale[columns[e]] * abs(values[slots[e]]))
    for j in range(st.n_sharing):
        if sharing[j] < m_act and weights[j] != 0.0:
            for e in range(own_start[sharing[j]], own_start[sharing[j] + 1]):
                total[own_col[e]] += weights[j] * values[own_slot[e]]
    for i in range(n):
        if scale[i] * abs(total[i]) > STILL_COMPATIBLE * size:
            return False
    return True


@internal
def _renewed(ws: Any, lu_address: int) -> bool:
    """Rows of compatibility for the gradients evaluated last, from the factors of the equations with those that were
    valid before; False if these are still valid."""
    st, changed = structure_at(ws.structure), False
    n, m_act = ws.n, ws.m_act
    size = n + m_act + ws.n_implied
    rows, sharing = mat(st.compatibility, st.n_implied, st.n_sharing), ivec(st.sharing, st.n_sharing)
    rhs, active, values = vec(ws.rhs, size), ivec(ws.active, m_act + ws.n_implied), vec(ws.values, ws.n_values)
    starts, count = ivec(ws.gradient_start, ws.m_ext), ws.n_values
    columns, slots = ivec(ws.gradient_col, count), ivec(ws.gradient_slot, count)
    total = np.empty(n)
    for p in range(ws.n_implied):
        # (most of a structure's rows are of bodies that do not move against each other)
        if _still_null(ws, st, p, rows[p], total):
            continue
        row = active[m_act + p]
        for i in range(size):
            rhs[i] = 0.0
        for e in range(starts[row], starts[row + 1]):
            rhs[columns[e]] += values[slots[e]]
        solve_transposed(lu_at(lu_address), ws.rhs)
        for j in range(st.n_sharing):
            at = sharing[j]
            new = -rhs[n + at] if at < m_act else (1.0 if at == m_act + p else 0.0)
            if abs(new - rows[p, j]) > COMPATIBLE:
                changed = True
                rows[p, j] = new
    return changed


@internal
def factor_equations(ws: Any, lu_address: int) -> int:
    """Factor the matrix of the equations evaluated last, with rows of compatibility of its gradients: as `factor`."""
    status = factor(lu_at(lu_address), ws.values)
    if status != 0 or ws.n_implied == 0 or not _renewed(ws, lu_address):
        return int(status)
    write_compatibility(ws)
    return int(factor(lu_at(lu_address), ws.values))


@internal
def analyze_equations(ws: Any, lu_address: int) -> int:
    """Pivots for the matrix of the equations evaluated last, with rows of compatibility of its gradients: as
    `linalg.analyze`."""
    status = call_analyze(ws.analyze, lu_at(lu_address), ws.values)
    if status != 0 or ws.n_implied == 0 or factor(lu_at(lu_address), ws.values) != 0 or not _renewed(ws, lu_address):
        return int(status)
    write_compatibility(ws)
    return int(call_analyze(ws.analyze, lu_at(lu_address), ws.values))


@compiled
def share_load(ws: Any) -> bool:
    """Pivots for the stages' matrix as it was evaluated last, which has some, with rows of compatibility of its
    gradients; False where there is no memory for them, or there are none."""
    return bool(analyze_equations(ws, ws.kkt) == 0)
