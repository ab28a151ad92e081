"""Impacts on a patch: impulses along the tangents, and against the spin, as one friction.

Beside the rows of the tangents stand those of z = r w_n, whose impulses are zeta = M/r;
`contact_solvers/patch_friction.py` has the problem. The same with several contacts, those that do not spin too.
"""

from typing import Any

import numpy as np

from ..assembly.compatibility import solve_equations
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contact_solvers.patch_friction import one_patch, sweep_patches
from ..contact_solvers.single_contact import solve_single_contact
from ..contacts.normal3d import SIZE, pair_of
from ..contacts.turning3d import FRICTION_RADIUS, turning_gradient
from ..event_detection.contact_evaluation import probe_of
from ..model.rotation3d import times
from .rates import masses, solve_cone_problem
from .records import (
    BASE,
    COUNT,
    KNOWN,
    MU,
    P_SPIN,
    RATE,
    SLIDE_RATE,
    SPIN,
    SWAY_RATE,
    ZETA,
    clear,
    col,
    whole,
)
from .turning_rows import axes_of_contact


@internal
def find_spins(ev: Any, ws: Any, lc: Any) -> None:
    """Gradients of z of the touching contacts that spin on a patch, behind those of the tangents, and the motions that
    unit impulses cause; z to SPIN, with the sign that the gradients have. Zeros of the others."""
    count, n, rhs, v = whole(ev)[COUNT], ws.n, vec(ws.rhs, ws.n + ws.m_act), vec(ws.v, ws.n_ext)
    directions, responses = mat(ev.directions, 4 * count, n), mat(ev.responses, 4 * count, n)
    for i in range(count):
        row, z = 3 * count + i, 0.0
        clear(directions[row], n)
        clear(responses[row], n)
        if col(ev, SPIN)[i] != 0.0:
            batch = probe_of(lc, ivec(ev.contacts, ev.most)[i])
            coord, radius = ivec(batch.coord, SIZE), vec(batch.par, FRICTION_RADIUS + 1)[FRICTION_RADIUS]
            _, _, normal = axes_of_contact(coord, directions[i], n)
            turning_gradient(vec(ws.q, ws.n_ext), coord, pair_of(batch, 0), times(radius, normal), n, directions[row])
            for j in range(n):
                rhs[j] = directions[row, j]
                z += directions[row, j] * v[j]
            for j in range(ws.m_act):
                rhs[n + j] = 0.0
            solve_equations(ws, ws.kkt_query)
            for j in range(n):
                responses[row, j] = rhs[j]
        col(ev, SPIN)[i] = z


@internal
def any_spins(ev: Any) -> bool:
    """True if a touching contact spins on a patch."""
    found = False
    for i in range(whole(ev)[COUNT]):
        found = found or col(ev, SPIN)[i] != 0.0
    return found


@internal
def _by_zeta(ev: Any, ws: Any, row: int, i: int) -> float:
    """How a unit of zeta of contact i moves a row."""
    count, product = whole(ev)[COUNT], 0.0
    directions, responses = mat(ev.directions, 4 * count, ws.n), mat(ev.responses, 4 * count, ws.n)
    for j in range(ws.n):
        product += directions[row, j] * responses[3 * count + i, j]
    return product


@internal
def push_spins(ev: Any, ws: Any) -> None:
    """Add the velocities that the impulses in ZETA cause; rates and spins follow."""
    count, v = whole(ev)[COUNT], vec(ws.v, ws.n_ext)
    directions, responses = mat(ev.directions, 4 * count, ws.n), mat(ev.responses, 4 * count, ws.n)
    for i in range(count):
        zeta = col(ev, ZETA)[i]
        if zeta == 0.0:
            continue
        col(ev, P_SPIN)[i] += zeta
        for j in range(ws.n):
            v[j] += zeta * responses[3 * count + i, j]
        for j in range(count):
            col(ev, RATE)[j] += zeta * _by_zeta(ev, ws, j, i)
            col(ev, SLIDE_RATE)[j] += zeta * _by_zeta(ev, ws, count + j, i)
            col(ev, SWAY_RATE)[j] += zeta * _by_zeta(ev, ws, 2 * count + j, i)
    for i in range(count):
        if col(ev, SPIN)[i] != 0.0:
            z = 0.0
            for j in range(ws.n):
                z += directions[3 * count + i, j] * v[j]
            col(ev, SPIN)[i] = z


@internal
def _inverse_masses(ev: Any, ws: Any) -> Any:
    """Of normals, tangents and spins (4 count, 4 count)."""
    count, a = whole(ev)[COUNT], masses(ev, whole(ev)[COUNT])
    found = np.empty((4 * count, 4 * count))
    for i in range(3 * count):
        for j in range(3 * count):
            found[i, j] = a[i, j]
    for i in range(count):
        for row in range(4 * count):
            found[row, 3 * count + i] = found[3 * count + i, row] = _by_zeta(ev, ws, row, i)
        for block in range(1, 3):
            row = block * count + i
            if a[row, row] == 0.0:  # a tangent without friction, or that joints hold
                for other in range(count):
                    found[row, 3 * count + other] = found[3 * count + other, row] = 0.0
    return found


@internal
def solve_blow(ev: Any, dr: Any, ws: Any, part: Any, b: Any, p: Any) -> bool:
    """Impulses p (3 count,) of the contacts `part`, as `solve_cone_problem` finds them, and ZETA of those that
    spin."""
    count, mu, zeta = whole(ev)[COUNT], col(ev, MU), col(ev, ZETA)
    contacts, friction = ivec(ev.contacts, ev.most), vec(dr.friction, ws.n_contacts)
    for i in range(count):
        mu[i], zeta[i] = friction[contacts[i]], 0.0
    if not any_spins(ev):
        return solve_cone_problem(ev, masses(ev, count), count, part, b, mu, col(ev, BASE), col(ev, KNOWN), p)
    motion, found = np.empty(4 * count), np.zeros(4 * count)
    for i in range(count):
        motion[3 * count + i], found[i] = col(ev, SPIN)[i], col(ev, BASE)[i] * part[i]
        for block in range(3):
            motion[block * count + i] = b[block * count + i]
    if not sweep_patches(count, _inverse_masses(ev, ws), motion, part, mu, col(ev, BASE), found):
        return False
    for i in range(count):
        zeta[i] = found[3 * count + i]
        for block in range(3):
            p[block * count + i] = found[block * count + i]
    return True


@internal
def strike_spinning(ev: Any, dr: Any, ws: Any, i: int, v: Any, wanted: float) -> Any:
    """(found, P_N, P_1, P_2) of one blow on contact i, the rates being v (3 count,) and that of the gap `wanted`; ZETA
    of it is added to, v and SPIN follow it."""
    count, j, k = whole(ev)[COUNT], whole(ev)[COUNT] + i, 2 * whole(ev)[COUNT] + i
    a, full = masses(ev, count), vec(dr.friction, ws.n_contacts)[ivec(ev.contacts, ev.most)[i]]
    if col(ev, SPIN)[i] == 0.0 or full == 0.0:
        own = (a[i, i], a[i, j], a[i, k], a[j, j], a[j, k], a[k, k])
        return solve_single_contact(own, (wanted, v[j], v[k]), full, 0.0)
    every, rates, p = _inverse_masses(ev, ws), np.empty(4), np.empty(4)
    square = np.empty((4, 4))
    rows = (i, j, k, 3 * count + i)
    rates[0], rates[1], rates[2], rates[3] = wanted, v[j], v[k], col(ev, SPIN)[i]
    for m in range(4):
        for l in range(4):
            square[m, l] = every[rows[m], rows[l]]
    one_patch(square, rates, full, 0.0, p)
    col(ev, ZETA)[i] += p[3]
    for row in range(3 * count):
        v[row] += p[3] * every[row, 3 * count + i]
    for other in range(count):
        for m in range(4):
            col(ev, SPIN)[other] += p[m] * every[3 * count + other, rows[m]]
    return True, p[0], p[1], p[2]
