"""Impacts on a patch: impulses along the tangents, and against the spin, as one friction.

Beside the rows of the tangents stand those of z = r w_n, whose impulses are zeta = M/r;
`contact_solvers/patch_friction.py` has the problem. The same with several contacts, those that do not spin too.
"""

from typing import Any

import numpy as np

from ..assembly.redundant_reactions import solve_equations
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contact_solvers.patch_friction import one_patch, sweep_patches
from ..contact_solvers.single_contact import solve_single_contact
from ..contacts.normal3d import PAIR_SIZE, pair_of
from ..contacts.turning3d import FRICTION_RADIUS, turning_gradient
from ..event_detection.contact_evaluation import probe_of
from ..model.rotation3d import times
from .rates import masses, solve_cone_problem
from .records import clear, scalars, touching
from .turning_rows import axes_of_contact


@internal
def find_spins(instant: Any, workspace: Any, loop: Any) -> None:
    """Gradients of z of the touching contacts that spin on a patch, behind those of the tangents, and the motions that
    unit impulses cause; z to SPIN, with the sign that the gradients have. Zeros of the others."""
    count, n, rhs, v = (
        scalars(instant).count,
        workspace.n,
        vec(workspace.rhs, workspace.n + workspace.m_act),
        vec(workspace.v, workspace.n_ext),
    )
    directions, responses = mat(instant.directions, 4 * count, n), mat(instant.responses, 4 * count, n)
    for i in range(count):
        row, z = 3 * count + i, 0.0
        clear(directions[row], n)
        clear(responses[row], n)
        if touching(instant)[i].spin_rate != 0.0:
            batch = probe_of(loop, ivec(instant.contacts, instant.most)[i])
            coord, radius = ivec(batch.coord, PAIR_SIZE), vec(batch.par, FRICTION_RADIUS + 1)[FRICTION_RADIUS]
            _, _, normal = axes_of_contact(coord, directions[i], n)
            turning_gradient(
                vec(workspace.q, workspace.n_ext), coord, pair_of(batch, 0), times(radius, normal), n, directions[row]
            )
            for j in range(n):
                rhs[j] = directions[row, j]
                z += directions[row, j] * v[j]
            for j in range(workspace.m_act):
                rhs[n + j] = 0.0
            solve_equations(workspace, workspace.kkt_query)
            for j in range(n):
                responses[row, j] = rhs[j]
        touching(instant)[i].spin_rate = z


@internal
def any_spins(instant: Any) -> bool:
    """True if a touching contact spins on a patch."""
    found = False
    for i in range(scalars(instant).count):
        found = found or touching(instant)[i].spin_rate != 0.0
    return found


@internal
def _by_zeta(instant: Any, workspace: Any, row: int, i: int) -> float:
    """How a unit of zeta of contact i moves a row."""
    count, product = scalars(instant).count, 0.0
    directions, responses = (
        mat(instant.directions, 4 * count, workspace.n),
        mat(instant.responses, 4 * count, workspace.n),
    )
    for j in range(workspace.n):
        product += directions[row, j] * responses[3 * count + i, j]
    return product


@internal
def push_spins(instant: Any, workspace: Any) -> None:
    """Add the velocities that the impulses in ZETA cause; rates and spins follow."""
    contact = touching(instant)
    count, v = scalars(instant).count, vec(workspace.v, workspace.n_ext)
    directions, responses = (
        mat(instant.directions, 4 * count, workspace.n),
        mat(instant.responses, 4 * count, workspace.n),
    )
    for i in range(count):
        zeta = contact[i].problem_spin_impulse
        if zeta == 0.0:
            continue
        contact[i].spin_impulse += zeta
        for j in range(workspace.n):
            v[j] += zeta * responses[3 * count + i, j]
        for j in range(count):
            contact[j].gap_rate += zeta * _by_zeta(instant, workspace, j, i)
            contact[j].sliding_rate += zeta * _by_zeta(instant, workspace, count + j, i)
            contact[j].sliding_rate2 += zeta * _by_zeta(instant, workspace, 2 * count + j, i)
    for i in range(count):
        if contact[i].spin_rate != 0.0:
            z = 0.0
            for j in range(workspace.n):
                z += directions[3 * count + i, j] * v[j]
            contact[i].spin_rate = z


@internal
def _inverse_masses(instant: Any, workspace: Any) -> Any:
    """Of normals, tangents and spins (4 count, 4 count)."""
    count, a = scalars(instant).count, masses(instant, scalars(instant).count)
    found = np.empty((4 * count, 4 * count))
    for i in range(3 * count):
        for j in range(3 * count):
            found[i, j] = a[i, j]
    for i in range(count):
        for row in range(4 * count):
            found[row, 3 * count + i] = found[3 * count + i, row] = _by_zeta(instant, workspace, row, i)
        for block in range(1, 3):
            row = block * count + i
            if a[row, row] == 0.0:  # a tangent without friction, or that joints hold
                for other in range(count):
                    found[row, 3 * count + other] = found[3 * count + other, row] = 0.0
    return found


@internal
def solve_blow(instant: Any, drive: Any, workspace: Any, part: Any, b: Any, p: Any) -> bool:
    """Impulses p (3 count,) of the contacts `part`, as `solve_cone_problem` finds them, and ZETA of those that
    spin."""
    count, mu, zeta = scalars(instant).count, vec(instant.mu, instant.most), touching(instant).problem_spin_impulse
    contacts, friction = ivec(instant.contacts, instant.most), vec(drive.friction, workspace.n_contacts)
    for i in range(count):
        mu[i], zeta[i] = friction[contacts[i]], 0.0
    if not any_spins(instant):
        return solve_cone_problem(
            instant,
            masses(instant, count),
            count,
            part,
            b,
            mu,
            vec(instant.base, instant.most),
            vec(instant.known_direction, instant.most),
            p,
        )
    motion, found = np.empty(4 * count), np.zeros(4 * count)
    for i in range(count):
        motion[3 * count + i], found[i] = touching(instant)[i].spin_rate, vec(instant.base, instant.most)[i] * part[i]
        for block in range(3):
            motion[block * count + i] = b[block * count + i]
    if not sweep_patches(
        count, _inverse_masses(instant, workspace), motion, part, mu, vec(instant.base, instant.most), found
    ):
        return False
    for i in range(count):
        zeta[i] = found[3 * count + i]
        for block in range(3):
            p[block * count + i] = found[block * count + i]
    return True


@internal
def strike_spinning(instant: Any, drive: Any, workspace: Any, i: int, v: Any, wanted: float) -> Any:
    """(found, P_N, P_1, P_2) of one blow on contact i, the rates being v (3 count,) and that of the gap `wanted`;
    `problem_spin_impulse`
    of it is added to, v and SPIN follow it."""
    contact = touching(instant)
    count, j, k = scalars(instant).count, scalars(instant).count + i, 2 * scalars(instant).count + i
    a, full = masses(instant, count), vec(drive.friction, workspace.n_contacts)[ivec(instant.contacts, instant.most)[i]]
    if contact[i].spin_rate == 0.0 or full == 0.0:
        own = (a[i, i], a[i, j], a[i, k], a[j, j], a[j, k], a[k, k])
        return solve_single_contact(own, (wanted, v[j], v[k]), full, 0.0)
    every, rates, p = _inverse_masses(instant, workspace), np.empty(4), np.empty(4)
    square = np.empty((4, 4))
    rows = (i, j, k, 3 * count + i)
    rates[0], rates[1], rates[2], rates[3] = wanted, v[j], v[k], contact[i].spin_rate
    for m in range(4):
        for l in range(4):
            square[m, l] = every[rows[m], rows[l]]
    one_patch(square, rates, full, 0.0, p)
    contact[i].problem_spin_impulse += p[3]
    for row in range(3 * count):
        v[row] += p[3] * every[row, 3 * count + i]
    for other in range(count):
        for m in range(4):
            contact[other].spin_rate += p[m] * every[3 * count + other, rows[m]]
    return True, p[0], p[1], p[2]
