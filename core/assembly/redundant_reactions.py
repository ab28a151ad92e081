"""How rows that repeat each other share the load: rows of compatibility.

Where closed contacts repeat each other (a block on four feet), or joints do (a door on two hinges), the constraints of
some of them are implied by those of the others. The motion is the same with any multipliers lambda' = lambda + n,
Phi_q^T n = 0. Forces of rigid contacts are the limit of those of compliant ones, A + eps C with eps -> 0.
Multiplied by a null vector n of Phi_q^T, of which A is made, the equations (A + eps C) lambda + b = 0 leave
n^T C lambda = 0 for any eps: of all multipliers that give the motion these are the ones of least C-norm (Tikhonov 1963;
for multibody systems Wojtyra and Fraczek 2013, who compare such choices). So in place of the equation of each implied
row the matrix has such a row, and sliding friction follows the normal forces that it gives.

C is the relative compliance of a contact, for its normal and its tangents alike: 1 unless the model gives another.
Joints are rigid beside contacts, and share among themselves what contacts leave to them, with compliances of their own
(`joint_compliance.py`). So the row of an implied contact has entries for contacts only, and that of an implied joint,
whose null vector is of joints only, entries for joints.

The null vector of an implied row g is (-w, 1), Phi_q^T w = g^T. It is found by one solution with the transposed matrix
of the equations, whatever rows of compatibility this has: where G are the rows of Phi_q that are solved for, B those of
compatibility, and T_G, T_g the columns with which their multipliers act (friction included), the solution of
[S^T, G^T, 0; T_G^T, 0, B_G^T; T_g^T, 0, B_g^T] (x, w, u) = (g^T, 0, 0) is x = u = 0. So the rows that were valid
last serve to find the present ones.
"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..linalg import factor, lu_at, solve
from ..linalg.analyze import call_analyze
from ..linalg.solve import solve_transposed
from ..rounding import COMPATIBLE, STILL_COMPATIBLE
from ..state.workspace_records import OK, building_at, structure_at
from .structure_switch import HELD, STRUCTURE_KINDS


@internal
def list_sharing(
    workspace: Any,
    b: Any,
    m_act: int,
    n_implied: int,
    active: Any,
    matrix_col: Any,
    start: Any,
    sharing: Any,
    write: bool,
) -> int:
    """Which multipliers share the load with each of the implied rows, by their places among those of the matrix, where
    each row of compatibility begins, and how many numbers these rows have; `write`: to `start` and `sharing`."""
    codes, compliance, mechanism = (
        ivec(workspace.wanted, b.n_contacts),
        vec(b.compliance, b.m_ext),
        ivec(b.mechanism, b.m_ext),
    )
    rows, slides = ivec(b.contact_rows, b.n_contacts), ivec(b.contact_slide_rows, b.n_contacts)
    count = 0
    for p in range(n_implied):
        own = active[m_act + p]
        if write:
            start[p] = count
        for i in range(b.m_joints if own < b.m_joints else 0):
            shares = mechanism[i] == mechanism[own] and (compliance[i] > 0.0 or i == own)
            if matrix_col[i] >= 0 and shares:
                if write:
                    sharing[count] = matrix_col[i] - b.n
                count += 1
        for k in range(b.n_contacts if own >= b.m_joints else 0):
            for of in range(3):
                if codes[k] % STRUCTURE_KINDS >= HELD + of:
                    if write:
                        sharing[count] = matrix_col[rows[k] if of == 0 else slides[k] + of - 1] - b.n
                    count += 1
    if write:
        start[n_implied] = count
    return count


@internal
def begin_sharing(workspace: Any, structure: Any) -> None:
    """Rows of compatibility of a structure that has just been built: each implied row carries nothing. Null vectors of
    different mechanisms have nothing in common, so one solution finds one of each of them."""
    b, start, sharing = (
        building_at(workspace.building),
        ivec(structure.sharing_start, structure.n_implied + 1),
        ivec(structure.sharing, structure.n_sharing),
    )
    rows, color = vec(structure.compatibility, structure.n_sharing), ivec(structure.sharing_color, structure.n_implied)
    active, mechanism = ivec(structure.active, structure.m_act + structure.n_implied), ivec(b.mechanism, b.m_ext)
    colors = 0
    for p in range(structure.n_implied):
        for e in range(start[p], start[p + 1]):
            rows[e] = 1.0 if sharing[e] == structure.m_act + p else 0.0
        own, color[p] = active[structure.m_act + p], colors
        if own < b.m_joints:
            color[p] = 0
            for other in range(p):
                color[p] += 1 if mechanism[active[structure.m_act + other]] == mechanism[own] else 0
        colors = max(colors, color[p] + 1)


@internal
def _first_shared(workspace: Any, joints: bool) -> int:
    """From which of the implied rows on the load is shared: `joints`, if they are asked for, stand before contacts."""
    first, active, b = 0, ivec(workspace.active, workspace.m_act + workspace.n_implied), building_at(workspace.building)
    if not joints and b.loads_felt == 0:
        while first < workspace.n_implied and active[workspace.m_act + first] < b.m_joints:
            first += 1
    return first


@internal
def write_compatibility(workspace: Any, joints: bool) -> None:
    """The rows of compatibility, to their slots in the matrix. Those of joints only if it is asked what these carry, or
    forces depend on it; else the implied ones carry nothing."""
    if workspace.n_implied == 0:
        return
    structure, first = structure_at(workspace.structure), _first_shared(workspace, joints)
    start, sharing = (
        ivec(structure.sharing_start, structure.n_implied + 1),
        ivec(structure.sharing, structure.n_sharing),
    )
    rows, slots = vec(structure.compatibility, structure.n_sharing), ivec(structure.sharing_slot, structure.n_sharing)
    values = vec(workspace.values, workspace.n_values)
    for p in range(structure.n_implied):
        for e in range(start[p], start[p + 1]):
            alone = 1.0 if sharing[e] == structure.m_act + p else 0.0
            values[slots[e]] = rows[e] if p >= first else alone


@internal
def left_of_sharing(workspace: Any, joints: bool) -> None:
    """What the multipliers leave of the rows of compatibility as `write_compatibility` has written them, its negative,
    to their places in `rhs`."""
    if workspace.n_implied == 0:
        return
    structure, lam, first = (
        structure_at(workspace.structure),
        vec(workspace.lam, workspace.m_ext),
        _first_shared(workspace, joints),
    )
    start, sharing = (
        ivec(structure.sharing_start, structure.n_implied + 1),
        ivec(structure.sharing, structure.n_sharing),
    )
    rows = vec(structure.compatibility, structure.n_sharing)
    rhs, active = (
        vec(workspace.rhs, workspace.n + workspace.m_act + workspace.n_implied),
        ivec(workspace.active, workspace.m_act + workspace.n_implied),
    )
    for p in range(workspace.n_implied):
        total = 0.0
        for e in range(start[p], start[p + 1]):
            total += rows[e] * lam[active[sharing[e]]]
        rhs[workspace.n + workspace.m_act + p] = -total if p >= first else -lam[active[workspace.m_act + p]]


@internal
def solve_equations(workspace: Any, lu_address: int) -> None:
    """rhs (n + m_act,) -> its solution with the matrix of the equations, where rows of compatibility leave nothing."""
    rhs = vec(workspace.rhs, workspace.n + workspace.m_act + workspace.n_implied)
    for p in range(workspace.n_implied):
        rhs[workspace.n + workspace.m_act + p] = 0.0
    solve(lu_at(lu_address), workspace.rhs)


@internal
def _load_gradients(workspace: Any, structure: Any, color: int, first: int) -> None:
    """Sum of the gradients of implied rows of this color, from `first` on, to `rhs`."""
    rhs, count = vec(workspace.rhs, workspace.n + workspace.m_act + workspace.n_implied), workspace.n_values
    columns, slots, values = (
        ivec(workspace.gradient_col, count),
        ivec(workspace.gradient_slot, count),
        vec(workspace.values, count),
    )
    starts, active = (
        ivec(workspace.gradient_start, workspace.m_ext),
        ivec(workspace.active, workspace.m_act + workspace.n_implied),
    )
    colors = ivec(structure.sharing_color, structure.n_implied)
    rhs[:] = 0.0
    for p in range(first, workspace.n_implied):
        if colors[p] == color:
            row = active[workspace.m_act + p]
            for e in range(starts[row], starts[row + 1]):
                rhs[columns[e]] += values[slots[e]]


@internal
def _still_null(workspace: Any, structure: Any, p: int) -> bool:
    """True if row p of compatibility, that of the contact whose gradient is in `rhs`, still is a null vector of the
    gradients evaluated last, as finely as it was found; else `rhs` becomes what it leaves of them. Where joints take
    part in it, whose multipliers are none of its entries, it is not known to be one."""
    n, m_act, size = workspace.n, workspace.m_act, 0.0
    rhs, scale, values = vec(workspace.rhs, n), vec(workspace.scale, n), vec(workspace.values, workspace.n_values)
    start, sharing = (
        ivec(structure.sharing_start, structure.n_implied + 1),
        ivec(structure.sharing, structure.n_sharing),
    )
    rows, own = vec(structure.compatibility, structure.n_sharing), structure.n_jacobian
    compliance, active = (
        vec(building_at(workspace.building).compliance, workspace.m_ext),
        ivec(workspace.active, m_act + workspace.n_implied),
    )
    own_compliance = compliance[active[m_act + p]]
    own_start, own_col = ivec(structure.jacobian_start, m_act + 1), ivec(structure.jacobian_col, own)
    own_slot = ivec(structure.jacobian_slot, own)
    for i in range(n):
        size = max(size, scale[i] * abs(rhs[i]))
    for j in range(start[p], start[p + 1]):
        if sharing[j] < m_act and rows[j] != 0.0:
            part = rows[j] * own_compliance / compliance[active[sharing[j]]]
            for e in range(own_start[sharing[j]], own_start[sharing[j] + 1]):
                rhs[own_col[e]] += part * values[own_slot[e]]
    for i in range(n):
        if scale[i] * abs(rhs[i]) > STILL_COMPATIBLE * size:
            return False
    return True


@internal
def _renewed(workspace: Any, lu_address: int, joints: bool) -> bool:
    """Rows of compatibility for the gradients evaluated last, from the factors of the equations with those that were
    valid before; False if these are still valid."""
    structure, b = structure_at(workspace.structure), building_at(workspace.building)
    n, m_act, changed = workspace.n, workspace.m_act, False
    start, sharing = (
        ivec(structure.sharing_start, structure.n_implied + 1),
        ivec(structure.sharing, structure.n_sharing),
    )
    rows, colors = vec(structure.compatibility, structure.n_sharing), ivec(structure.sharing_color, structure.n_implied)
    compliance, units = vec(b.compliance, b.m_ext), vec(b.units, n + b.m_ext)
    rhs, active = (
        vec(workspace.rhs, n + m_act + workspace.n_implied),
        ivec(workspace.active, m_act + workspace.n_implied),
    )
    first = _first_shared(workspace, joints)
    color = colors[first] if first < workspace.n_implied else 0
    while first < workspace.n_implied:
        _load_gradients(workspace, structure, color, first)
        left, contact = False, -1
        for p in range(first, workspace.n_implied):
            left = left or colors[p] > color
            if colors[p] == color and active[m_act + p] >= b.m_joints:
                contact = p
        # (most rows of contacts are of bodies that do not move against each other)
        still = contact >= 0 and _still_null(workspace, structure, contact)
        if not still:
            solve_transposed(lu_at(lu_address), workspace.rhs)
        for p in range(first, workspace.n_implied):
            row = active[m_act + p]
            own, unit = compliance[row] if compliance[row] > 0.0 else 1.0, units[n + row]
            for e in range(start[p], start[p + 1] if colors[p] == color and not still else start[p]):
                at = sharing[e]
                new = -rhs[n + at] if at < m_act else (1.0 if at == m_act + p else 0.0)
                new *= compliance[active[at]] / own
                if contact >= 0 and at < m_act:
                    # what is solved for is what the row left
                    new += rows[e]
                if abs(new - rows[e]) * units[n + active[at]] > COMPATIBLE * unit:
                    changed = True
                    rows[e] = new
        if not left:
            break
        color += 1
    return changed


@internal
def factor_equations(workspace: Any, lu_address: int) -> int:
    """Factor the matrix of the equations evaluated last, with rows of compatibility of its gradients: as `factor`."""
    status = factor(lu_at(lu_address), workspace.values)
    if status != 0 or workspace.n_implied == 0 or not _renewed(workspace, lu_address, False):
        return int(status)
    write_compatibility(workspace, False)
    return int(factor(lu_at(lu_address), workspace.values))


@internal
def analyze_equations(workspace: Any, lu_address: int) -> int:
    """Pivots for the matrix of the equations evaluated last, with rows of compatibility of its gradients: as
    `linalg.analyze`."""
    status = call_analyze(workspace.analyze, lu_at(lu_address), workspace.values)
    if status != 0 or workspace.n_implied == 0 or factor(lu_at(lu_address), workspace.values) != 0:
        return int(status)
    if not _renewed(workspace, lu_address, False):
        return OK
    write_compatibility(workspace, False)
    return int(call_analyze(workspace.analyze, lu_at(lu_address), workspace.values))


@internal
def factor_shared(workspace: Any, lu_address: int) -> int:
    """The same as `factor_equations` where it is asked what joints carry."""
    status = factor(lu_at(lu_address), workspace.values)
    if status != 0:
        return int(status)
    _renewed(workspace, lu_address, True)
    write_compatibility(workspace, True)
    return int(factor(lu_at(lu_address), workspace.values))


@internal
def keep_sharing(workspace: Any, back: bool) -> None:
    """Keep the rows of compatibility while a point is asked for, or put them `back`: to ask changes nothing."""
    structure = structure_at(workspace.structure)
    rows, kept = vec(structure.compatibility, structure.n_sharing), vec(structure.sharing_kept, structure.n_sharing)
    for e in range(structure.n_sharing):
        if back:
            rows[e] = kept[e]
        else:
            kept[e] = rows[e]


@compiled
def share_load(workspace: Any) -> bool:
    """Pivots for the stages' matrix as it was evaluated last, which has some, with rows of compatibility of its
    gradients; False where there is no memory for them, or there are none."""
    return bool(analyze_equations(workspace, workspace.kkt) == 0)
