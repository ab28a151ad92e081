"""Impacts on a patch: what the spin leaves of the friction along the tangents, and the impulse against the spin.

With the impulse zeta = M/r beside both of the tangents, and z = r w_n beside the sliding velocity, friction on a patch
(`laws/friction/turning.py`) is (P_T, zeta) = -mu P_N (v_T, z)/s at the end of the blow. So each contact that spins has
Coulomb's friction with the coefficient m that is the root of m - mu |v_T|/s, which grows with m; and z the one root of
z + S mu P_N z/s = z without zeta, S being the inverse mass of the spin. Both in turn, until nothing changes: what spins
changes little by what slides.
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

MOST_TURNS, MOST_TRIALS, ENOUGH = 60, 100, 1e-13
"""Rounds, trials for one coefficient, and how far it may be off, in parts of the full one."""


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
def _left(full: float, x: float, y: float, z: float) -> float:
    """mu |v_T|/s; where nothing moves all of mu."""
    speed = math.hypot(x, y)
    size = math.hypot(speed, z)
    return full * speed / size if size > 0.0 else full


@internal
def _braked(z: float, speed: float, most: float) -> float:
    """The root of x + most x/|(speed, x)| = z."""
    low, high, x = 0.0, abs(z), abs(z)
    for _ in range(MOST_TRIALS):
        over = x + most * x / max(math.hypot(speed, x), 1e-300) - abs(z)
        if over > 0.0:
            high = x
        else:
            low = x
        x = 0.5 * (low + high)
        if high - low <= 1e-16 * abs(z):
            break
    return math.copysign(x, z)


@internal
def _solve(ev: Any, part: Any, b: Any, p: Any, i: int, full: float, z: float) -> Any:
    """(found, m - mu |v_T|/s of contact i, |v_T|) with the coefficients in MU and the spin z at the end."""
    count, a = whole(ev)[COUNT], masses(ev, whole(ev)[COUNT])
    x, y = b[count + i], b[2 * count + i]
    if not solve_cones_in_space(ev, a, count, part, b, col(ev, MU), col(ev, BASE), col(ev, KNOWN), p):
        return False, 0.0, 0.0
    for j in range(3 * count):
        x += a[count + i, j] * p[j]
        y += a[2 * count + i, j] * p[j]
    return True, col(ev, MU)[i] - _left(full, x, y, z), math.hypot(x, y)


@internal
def _find_coefficient(ev: Any, part: Any, b: Any, p: Any, i: int, full: float, z: float) -> Any:
    """(found, |v_T|): the coefficient of contact i to MU, with the impulses p."""
    mu, side = col(ev, MU), 0
    low, high, mu[i] = 0.0, full, full
    found, of_high, speed = _solve(ev, part, b, p, i, full, z)
    if not found or of_high <= 0.0:
        return found, speed
    mu[i] = 0.0
    found, of_low, speed = _solve(ev, part, b, p, i, full, z)
    for _ in range(MOST_TRIALS):
        if not found or of_low >= 0.0 or high - low <= ENOUGH * full:
            break
        x = low - of_low * (high - low) / (of_high - of_low)
        mu[i] = x if low < x < high else 0.5 * (low + high)
        found, off, speed = _solve(ev, part, b, p, i, full, z)
        if abs(off) <= ENOUGH * full:
            break
        # (Illinois: an end that stays counts for half)
        if off < 0.0:
            low, of_low, of_high = mu[i], off, 0.5 * of_high if side < 0 else of_high
            side = -1
        else:
            high, of_high, of_low = mu[i], off, 0.5 * of_low if side > 0 else of_low
            side = 1
    return found, speed


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
    motion, now = np.empty(3 * count), np.empty(count)
    for i in range(count):
        now[i] = col(ev, SPIN)[i]
    directions, responses = mat(ev.directions, 4 * count, ws.n), mat(ev.responses, 4 * count, ws.n)
    for _ in range(MOST_TURNS):
        changed = 0.0
        for i in range(count):
            full = friction[contacts[i]]
            if part[i] == 0.0 or col(ev, SPIN)[i] == 0.0 or full == 0.0:
                continue
            for row in range(3 * count):
                motion[row] = b[row]
                for k in range(count):
                    if zeta[k] != 0.0:
                        motion[row] += zeta[k] * _by_zeta(ev, ws, row, k)
            before, spun = mu[i], now[i]
            found, speed = _find_coefficient(ev, part, motion, p, i, full, now[i])
            if not found:
                return False
            # z without zeta, and with it
            z = col(ev, SPIN)[i]
            for row in range(3 * count):
                if p[row] != 0.0:
                    for j in range(ws.n):
                        z += p[row] * directions[3 * count + i, j] * responses[row, j]
            for k in range(count):
                if k != i and zeta[k] != 0.0:
                    z += zeta[k] * _by_zeta(ev, ws, 3 * count + i, k)
            own, most = _by_zeta(ev, ws, 3 * count + i, i), full * max(p[i], 0.0)
            now[i] = _braked(z, speed, own * most)
            zeta[i] = (now[i] - z) / own if own > 0.0 else 0.0
            moved = abs(now[i] - spun) / max(abs(z), 1e-300)
            changed = max(changed, abs(mu[i] - before) / full, moved)
        if changed <= 10.0 * ENOUGH:
            break
    return True


@internal
def strike_spinning(ev: Any, dr: Any, ws: Any, i: int, v: Any, wanted: float) -> Any:
    """(found, P_N, P_1, P_2) of one blow on contact i, the rates being v (3 count,) and that of the gap `wanted`; ZETA
    of it is added to, v and SPIN follow it."""
    count, j, k, full = whole(ev)[COUNT], whole(ev)[COUNT] + i, 2 * whole(ev)[COUNT] + i, 0.0
    a, zeta = masses(ev, count), 0.0
    full = vec(dr.friction, ws.n_contacts)[ivec(ev.contacts, ev.most)[i]]
    own = (a[i, i], a[i, j], a[i, k], a[j, j], a[j, k], a[k, k])
    z = col(ev, SPIN)[i]
    if z == 0.0 or full == 0.0:
        return one_cone(own, (wanted, v[j], v[k]), full, 0.0)
    by_n, by_1, by_2 = _by_zeta(ev, ws, i, i), _by_zeta(ev, ws, j, i), _by_zeta(ev, ws, k, i)
    inverse, now = _by_zeta(ev, ws, 3 * count + i, i), z
    found, p, first, second = False, 0.0, 0.0, 0.0
    for _ in range(MOST_TURNS):
        b, low, high, x, y = (wanted + zeta * by_n, v[j] + zeta * by_1, v[k] + zeta * by_2), 0.0, full, 0.0, 0.0
        for trial in range(MOST_TRIALS):
            m = full if trial == 0 else 0.5 * (low + high)
            found, p, first, second = one_cone(own, b, m, 0.0)
            x = b[1] + own[1] * p + own[3] * first + own[4] * second
            y = b[2] + own[2] * p + own[4] * first + own[5] * second
            off = m - _left(full, x, y, now)
            low, high = (m, high) if off < 0.0 else (low, m)
            if not found or (trial == 0 and off <= 0.0) or high - low <= ENOUGH * full:
                break
        if not found:
            break
        without = z + by_n * p + by_1 * first + by_2 * second
        spun, now = now, _braked(without, math.hypot(x, y), inverse * full * p)
        zeta = (now - without) / inverse
        if abs(now - spun) <= ENOUGH * abs(z):
            break
    col(ev, ZETA)[i] += zeta
    for row in range(3 * count):
        v[row] += zeta * _by_zeta(ev, ws, row, i)
    for other in range(count):
        if col(ev, SPIN)[other] != 0.0:
            of_p = p * _by_zeta(ev, ws, i, other) + first * _by_zeta(ev, ws, j, other)
            of_p += second * _by_zeta(ev, ws, k, other)
            col(ev, SPIN)[other] += of_p + zeta * _by_zeta(ev, ws, 3 * count + other, i)
    return found, p, first, second
