"""Spinning on a patch at an instant: what it leaves of a contact's friction along its tangents.

Friction on a patch (`laws/friction/turning.py`) is Coulomb's with a coefficient that the motion says: mu |v_T|/s of
what slides or spins, s^2 = |v_T|^2 + z^2; of what is at rest what the torque at its present part leaves on the
ellipsoid (`shapes/patch3d.py`). In an impact the sliding velocity at its end says it, with the spin as it was: the
coefficient m is the root of m - mu |v_T|/s, which grows with m.
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..cones.one_cone import one_cone
from ..shapes.patch3d import CREEPS
from .rates_in_space import masses, solve_cones_in_space
from .reading import slow_sliding
from .records import (
    BASE,
    COUNT,
    HELD_SPIN,
    KINETIC,
    KNOWN,
    MU,
    SLIDE_RATE,
    SPIN,
    STATIC,
    SWAY_RATE,
    col,
    whole,
)

MOST_TURNS, MOST_TRIALS, ENOUGH = 40, 100, 1e-13
"""Rounds over contacts that spin, trials for one, and how far its coefficient may be off, in parts of the full one."""


@internal
def read_spins(ev: Any, dr: Any, ws: Any) -> None:
    """Spins of the touching contacts, which are open and whose residuals have been evaluated last, and their
    coefficients of friction as if they were at rest."""
    contacts, slides = ivec(ev.contacts, ev.most), ivec(ws.contact_slide_rows, ws.n_contacts)
    monitor, friction = vec(ws.monitor, 3 * ws.n_contacts), vec(dr.friction, ws.n_contacts)
    static = vec(ws.contact_sticking, ws.n_contacts)
    for i in range(whole(ev)[COUNT]):
        k = contacts[i]
        z = monitor[2 * ws.n_contacts + k] if slides[k] >= 0 and static[k] > 0.0 else 0.0
        slow = CREEPS * slow_sliding(ws, k)
        size = math.hypot(z, slow)
        left = slow / size if z != 0.0 else 1.0
        col(ev, SPIN)[i], col(ev, HELD_SPIN)[i] = z, z / size if z != 0.0 else 0.0
        col(ev, KINETIC)[i], col(ev, STATIC)[i] = left * friction[k], left * static[k]


@internal
def brake_by_spins(ev: Any, dr: Any, ws: Any) -> None:
    """Coefficients of those that are known to slide or to spin."""
    contacts, friction = ivec(ev.contacts, ev.most), vec(dr.friction, ws.n_contacts)
    for i in range(whole(ev)[COUNT]):
        z, speed = col(ev, SPIN)[i], math.hypot(col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i])
        if col(ev, KNOWN)[i] != 0.0 and z != 0.0:
            col(ev, KINETIC)[i] = friction[contacts[i]] * speed / math.hypot(speed, z)


@internal
def _next(low: float, of_low: float, high: float, of_high: float) -> float:
    """Where the secant comes to zero, within the bracket."""
    x = low - of_low * (high - low) / (of_high - of_low)
    return x if low < x < high else 0.5 * (low + high)


@internal
def _over(coefficient: float, full: float, x: float, y: float, z: float) -> float:
    """m - mu |v_T|/s at the end of a blow."""
    speed = math.hypot(x, y)
    return coefficient - full * speed / math.hypot(speed, z)


@internal
def _solve(ev: Any, count: int, part: Any, b: Any, p: Any, i: int, full: float) -> Any:
    """(found, m - mu |v_T|/s of contact i) with the coefficients in MU."""
    a, x, y = masses(ev, count), b[count + i], b[2 * count + i]
    if not solve_cones_in_space(ev, a, count, part, b, col(ev, MU), col(ev, BASE), col(ev, KNOWN), p):
        return False, 0.0
    for j in range(3 * count):
        x += a[count + i, j] * p[j]
        y += a[2 * count + i, j] * p[j]
    return True, _over(col(ev, MU)[i], full, x, y, col(ev, SPIN)[i])


@internal
def solve_blow(ev: Any, dr: Any, ws: Any, part: Any, b: Any, p: Any) -> bool:
    """Impulses p (3 count,) of the contacts `part`, as `solve_cones_in_space` finds them, with what spins leave of
    their friction."""
    count, mu, spinning = whole(ev)[COUNT], col(ev, MU), 0
    contacts, friction = ivec(ev.contacts, ev.most), vec(dr.friction, ws.n_contacts)
    for i in range(count):
        mu[i] = friction[contacts[i]]
        spinning += 1 if part[i] != 0.0 and col(ev, SPIN)[i] != 0.0 and mu[i] > 0.0 else 0
    if spinning == 0:
        return solve_cones_in_space(ev, masses(ev, count), count, part, b, mu, col(ev, BASE), col(ev, KNOWN), p)
    for _ in range(MOST_TURNS):
        changed = 0.0
        for i in range(count):
            full, before = friction[contacts[i]], mu[i]
            if part[i] == 0.0 or col(ev, SPIN)[i] == 0.0 or full == 0.0:
                continue
            low, high, mu[i] = 0.0, full, 0.0
            found, of_low = _solve(ev, count, part, b, p, i, full)
            mu[i] = full
            good, of_high = _solve(ev, count, part, b, p, i, full)
            side = 0
            if not (found and good):
                return False
            for _ in range(MOST_TRIALS):
                if of_low >= 0.0 or of_high <= 0.0:
                    mu[i] = low if of_low >= 0.0 else high
                else:
                    mu[i] = _next(low, of_low, high, of_high)
                found, off = _solve(ev, count, part, b, p, i, full)
                if not found:
                    return False
                if abs(off) <= ENOUGH * full or high - low <= ENOUGH * full or of_low >= 0.0 or of_high <= 0.0:
                    break
                # (Illinois: an end that stays counts for half)
                if off < 0.0:
                    low, of_low, of_high = mu[i], off, 0.5 * of_high if side < 0 else of_high
                    side = -1
                else:
                    high, of_high, of_low = mu[i], off, 0.5 * of_low if side > 0 else of_low
                    side = 1
            changed = max(changed, abs(mu[i] - before) / full)
        if spinning == 1 or changed <= 10.0 * ENOUGH:
            return True
    return True


@internal
def one_blow(own: Any, b: Any, full: float, z: float) -> Any:
    """As `one_cone`, of a contact that spins with z."""
    found, p, first, second = one_cone(own, b, full, 0.0)
    if z == 0.0 or not found or full == 0.0:
        return found, p, first, second
    low, high = 0.0, full
    for _ in range(MOST_TRIALS):
        # (by halves: blows one after another are of few contacts)
        m = 0.5 * (low + high)
        found, p, first, second = one_cone(own, b, m, 0.0)
        if not found or high - low <= ENOUGH * full:
            break
        x = b[1] + own[1] * p + own[3] * first + own[4] * second
        y = b[2] + own[2] * p + own[4] * first + own[5] * second
        if _over(m, full, x, y, z) < 0.0:
            low = m
        else:
            high = m
    return found, p, first, second
