"""Impacts on a patch: impulses along the tangents, and against the spin, as one friction.

With the impulse zeta = M/r beside both of the tangents, and z = r w_n beside the sliding velocity, friction on a patch
(`laws/friction/turning.py`) is P = (P_T, zeta) = -mu P_N w/|w| at the end of the blow, w = (v_T, z). So w falls as if
it were braked in proportion, P = -L w, with the L at which |P| is mu P_N: one root for each contact, and as large as
can be where it sticks. Several contacts: sweeps of that over all of them, those that do not spin too.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..cones.one_cone import one_cone
from ..linalg import lu_at, solve
from ..location.probe import probe_of
from ..model.rotation3d import times
from ..shapes.normal3d import SIZE, pair_of
from ..shapes.turning3d import FRICTION_RADIUS, turning_gradient
from .rates_in_space import masses, solve_cones_in_space
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

MOST_TURNS, MOST_TRIALS, ENOUGH, ROUGH = 5000, 100, 1e-14, 1e-8
"""Sweeps, trials for one contact; and in parts of the largest impulse how far these may be off, or at the end."""
SMALLER_AFTER, LEAST_STEP = 300, 0.125
STICKS = 1e-15
"""In parts of the inverse masses: what brakes a contact that sticks."""


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
            solve(lu_at(ws.kkt_query), ws.rhs)
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
def _braked(a: Any, b: Any, base: float, brake: float, p: Any) -> Any:
    """|P| of one contact with P = -brake w, and P_N; the impulses go to p (4,). (I + brake A_TT) w = b_T + a_TN P_N."""
    d_1, l_21, l_31 = 1.0 + brake * a[1, 1], brake * a[2, 1], brake * a[3, 1]
    l_21, l_31 = l_21 / d_1, l_31 / d_1
    d_2 = 1.0 + brake * a[2, 2] - l_21 * l_21 * d_1
    l_32 = (brake * a[3, 2] - l_31 * l_21 * d_1) / d_2
    d_3 = 1.0 + brake * a[3, 3] - l_31 * l_31 * d_1 - l_32 * l_32 * d_2
    free, pressed = (b[1], b[2], b[3]), (a[1, 0], a[2, 0], a[3, 0])
    w, more = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for turn in range(2):
        x, y, z = free if turn == 0 else pressed
        y -= l_21 * x
        z = (z - l_31 * x - l_32 * y) / d_3
        y = y / d_2 - l_32 * z
        x = x / d_1 - l_21 * y - l_31 * z
        w, more = ((x, y, z), more) if turn == 0 else (w, (x, y, z))
    grows = a[0, 0] - brake * (a[1, 0] * more[0] + a[2, 0] * more[1] + a[3, 0] * more[2])
    wanted = b[0] - brake * (a[1, 0] * w[0] + a[2, 0] * w[1] + a[3, 0] * w[2])
    p[0] = max(base, -wanted / grows) if grows > 0.0 else base
    total = 0.0
    for k in range(3):
        p[1 + k] = -brake * (w[k] + p[0] * more[k])
        total += p[1 + k] * p[1 + k]
    return math.sqrt(total), p[0]


@internal
def one_patch(a: Any, b: Any, mu: float, base: float, p: Any) -> None:
    """Impulses p (4,) of one contact: normal, both tangents, zeta; a (4, 4), b (4,): inverse masses, 1/kg, and the
    motion without them, m/s. None along what cannot move: a driven spin goes on, and is counted in w."""
    _solve_patch(a, b, mu, base, p)
    for k in range(1, 4):
        p[k] = p[k] if a[k, k] > 0.0 else 0.0


@internal
def _solve_patch(a: Any, b: Any, mu: float, base: float, p: Any) -> None:
    p[0], p[1], p[2], p[3] = max(base, -b[0] / a[0, 0]), 0.0, 0.0, 0.0
    size = a[1, 1] + a[2, 2] + a[3, 3]
    if mu == 0.0 or size == 0.0 or (base == 0.0 and b[0] >= 0.0):
        return
    friction, normal = _braked(a, b, base, 1.0 / (STICKS * size), p)
    if friction <= mu * normal:
        return
    # in parts of what is braked: 0 free, 1 sticks
    low, high, of_low, of_high, side = 0.0, 1.0, -mu * max(base, -b[0] / a[0, 0]), friction - mu * normal, 0
    for _ in range(MOST_TRIALS):
        x = low - of_low * (high - low) / (of_high - of_low)
        x = x if low < x < high else 0.5 * (low + high)
        friction, normal = _braked(a, b, base, x / ((1.0 - x) * size), p)
        off = friction - mu * normal
        if abs(off) <= ENOUGH * mu * normal or high - low <= ENOUGH * high:
            break
        # (Illinois: an end that stays counts for half)
        if off < 0.0:
            low, of_low, of_high = x, off, 0.5 * of_high if side < 0 else of_high
            side = -1
        else:
            high, of_high, of_low = x, off, 0.5 * of_low if side > 0 else of_low
            side = 1


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
def _visit(
    count: int, i: int, whole_a: Any, b: Any, p: Any, mu: float, base: float, a: Any, own: Any, one: Any
) -> None:
    """Impulses of contact i beside those of the others in p (4 count,), to one (4,)."""
    for k in range(4):
        row = k * count + i
        own[k] = b[row]
        for column in range(4 * count):
            own[k] += whole_a[row, column] * p[column]
        for l in range(4):
            a[k, l] = whole_a[row, l * count + i]
            own[k] -= a[k, l] * p[l * count + i]
    one_patch(a, own, mu, base, one)


@internal
def _sweep(count: int, whole_a: Any, b: Any, part: Any, friction: Any, contacts: Any, base: Any, p: Any) -> bool:
    """Impulses p (4 count,) of the contacts `part`; False if sweeps do not find them."""
    a, own, one, step, largest, change = np.empty((4, 4)), np.empty(4), np.empty(4), 1.0, 0.0, 0.0
    for turn in range(MOST_TURNS):
        change, largest = 0.0, 0.0
        # sweeps that go round in circles come to rest with smaller steps
        step = max(0.5 * step, LEAST_STEP) if turn > 0 and turn % SMALLER_AFTER == 0 else step
        for i in range(count):
            if part[i] == 0.0:
                continue
            _visit(count, i, whole_a, b, p, friction[contacts[i]], base[i], a, own, one)
            for k in range(4):
                more = one[k] - p[k * count + i]
                change = max(change, abs(more))
                p[k * count + i] += step * more
            largest = max(largest, p[i])
        if change <= 10.0 * ENOUGH * largest:
            return True
    return change <= ROUGH * largest


@internal
def solve_blow(ev: Any, dr: Any, ws: Any, part: Any, b: Any, p: Any) -> bool:
    """Impulses p (3 count,) of the contacts `part`, as `solve_cones_in_space` finds them, and ZETA of those that
    spin."""
    count, mu, zeta = whole(ev)[COUNT], col(ev, MU), col(ev, ZETA)
    contacts, friction = ivec(ev.contacts, ev.most), vec(dr.friction, ws.n_contacts)
    for i in range(count):
        mu[i], zeta[i] = friction[contacts[i]], 0.0
    if not any_spins(ev):
        return solve_cones_in_space(ev, masses(ev, count), count, part, b, mu, col(ev, BASE), col(ev, KNOWN), p)
    motion, found = np.empty(4 * count), np.zeros(4 * count)
    for i in range(count):
        motion[3 * count + i], found[i] = col(ev, SPIN)[i], col(ev, BASE)[i] * part[i]
        for block in range(3):
            motion[block * count + i] = b[block * count + i]
    if not _sweep(count, _inverse_masses(ev, ws), motion, part, friction, contacts, col(ev, BASE), found):
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
        return one_cone(own, (wanted, v[j], v[k]), full, 0.0)
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
