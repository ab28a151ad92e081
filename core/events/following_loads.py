"""Loads that follow the forces of joints (`contacts/joint_friction_contact.py`), at an instant whose forces are sought.

Inverse masses are those at fixed loads. So the loads that the forces found bring about by the joints' multipliers are
put in their place, until they are the same. The iteration contracts by the part of a friction that comes back as a
load of its own. Where that is 1 or more the joint locks itself, and nothing is found.
"""

from typing import Any

from ..assembly.redundant_reactions import solve_equations
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, call_kernel
from ..compiled.views import imat, ivec, mat, vec
from ..contacts.geometry_kinds import JOINT
from ..contacts.joint_friction_contact import OWN_ROWS, SLIDE_GAIN
from ..event_detection.contact_evaluation import NEAR_KERNEL, NEAR_KIND, NEAR_SIZE, probe_of
from ..rounding import LOADS_SETTLED
from .rates import solve_cone_problem
from .records import scalars

MOST_ROUNDS = 100


@internal
def own_rows(workspace: Any, k: int) -> int:
    """Rows of the friction of a joint: of its gap and of its tangents. Those of the joint stand behind."""
    return OWN_ROWS + 1 if in_space(workspace, k) else OWN_ROWS


@internal
def _follows(instant: Any, workspace: Any, loop: Any, i: int) -> bool:
    """True if the load of touching contact i follows the force of a joint."""
    k = ivec(instant.contacts, instant.most)[i]
    return imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KIND] == JOINT and probe_of(
        loop, k
    ).nrow > own_rows(workspace, k)


@internal
def _load_of(workspace: Any, loop: Any, k: int, change: Any) -> float:
    """Acceleration that the load of contact k gives its gap, downwards, where the multipliers of the active rows change
    by the second part of `change` (n + m_act,), m/s^2. The coordinate that it presses has unit mass."""
    batch, lam, own = probe_of(loop, k), vec(workspace.lam, workspace.m_ext), vec(loop.probe_lam, workspace.m_ext)
    n = workspace.n_ext
    active, rows, coord = (
        ivec(workspace.active, workspace.m_act),
        ivec(batch.row, batch.nrow),
        ivec(batch.coord, batch.ncoord),
    )
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    to_q, to_v, to_a, r = vec(loop.probe_q, n), vec(loop.probe_v, n), vec(loop.probe_a, n), vec(loop.probe_r, n)
    for i in coord:
        to_q[i], to_v[i], to_a[i], r[i] = q[i], v[i], a[i], 0.0
    for j in range(own_rows(workspace, k), batch.nrow):
        own[rows[j]] = lam[rows[j]]
        for i in range(workspace.m_act):
            if active[i] == rows[j]:
                own[rows[j]] += change[workspace.n + i]
    call_kernel(
        imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KERNEL], RESIDUAL, vec(workspace.t, 1)[0], batch
    )
    for j in range(own_rows(workspace, k), batch.nrow):
        own[rows[j]] = 0.0
    stop = coord[batch.ncoord - 1 if in_space(workspace, k) else 0]
    return float(vec(batch.par, batch.npar)[SLIDE_GAIN] * r[stop])


@internal
def solve_with_loads(
    instant: Any, workspace: Any, loop: Any, a: Any, part: Any, b: Any, mu: Any, base: Any, known: Any, p: Any
) -> bool:
    """`solve_cone_problem` of all touching contacts, whose loads in b follow the forces p that are found."""
    count, n, follows = scalars(instant).count, workspace.n, False
    if not solve_cone_problem(instant, a, count, part, b, mu, base, known, p):
        return False
    for i in range(count):
        follows = follows or _follows(instant, workspace, loop, i)
    if not follows:
        return True
    directions, contacts = mat(instant.directions, 3 * count, n), ivec(instant.contacts, instant.most)
    change = vec(workspace.rhs, n + workspace.m_act)
    for _ in range(MOST_ROUNDS):
        change[:] = 0.0
        for i in range(3 * count):
            if p[i] != 0.0:
                for j in range(n):
                    change[j] += p[i] * directions[i, j]
        solve_equations(workspace, workspace.kkt_query)
        settled = True
        for i in range(count):
            if _follows(instant, workspace, loop, i):
                load = _load_of(workspace, loop, contacts[i], change)
                settled = settled and abs(load + b[i]) <= LOADS_SETTLED * abs(load)
                b[i] = -load
        if settled:
            return True
        if not solve_cone_problem(instant, a, count, part, b, mu, base, known, p):
            return False
    return False
