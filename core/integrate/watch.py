"""The watch over contacts: has the step just computed crossed an event?"""

from typing import Any

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, mat, vec
from ..contact.modes import (
    ACTIVE,
    CLOSED,
    IDLE,
    MEMORY_SIZE,
    MODE,
    OPEN,
    RELEASED,
    SLIDE,
    STICKS,
)
from ..rounding import FORCE_ROUNDING, GAP_ROUNDING, RATE_ROUNDING, SLIP_EXCESS
from ..system.levels import force_level, position_level, rate_level


@compiled
def remember(ws: Any, lc: Any) -> None:
    """Store gap, rate and acceleration of the current point as those of the newest row."""
    watch = mat(lc.watch, max(ws.n_contacts, 1), 3)
    rows = ivec(ws.contact_rows, ws.n_contacts)
    for k in range(ws.n_contacts):
        watch[k, 0] = vec(ws.phi, ws.m_ext)[rows[k]]
        watch[k, 1] = vec(ws.phid, ws.m_ext)[rows[k]]
        watch[k, 2] = vec(ws.phidd, ws.m_ext)[rows[k]]


@internal
def lowest_inside(g0: float, d0: float, g1: float, d1: float, h: float) -> Any:
    """Minimum of the cubic through (g, g') at both ends, and its place in (0, 1); g' must change from - to +."""
    low, high = 0.0, 1.0
    for _ in range(60):
        s = 0.5 * (low + high)
        slope = (6.0 * s * s - 6.0 * s) * (g0 - g1) + h * (
            (3.0 * s * s - 4.0 * s + 1.0) * d0 + (3.0 * s * s - 2.0 * s) * d1
        )
        if slope < 0.0:
            low = s
        else:
            high = s
    s = 0.5 * (low + high)
    value = (
        (2.0 * s**3 - 3.0 * s * s + 1.0) * g0
        + (3.0 * s * s - 2.0 * s**3) * g1
        + h * ((s**3 - 2.0 * s * s + s) * d0 + (s**3 - s * s) * d1)
    )
    return value, s


@compiled
def friction_margin(ws: Any, k: int) -> float:
    """How far closed contact k with Coulomb friction is from its next change, negative beyond it: mu_s F_N - |F_T|
    while it sticks (N); its sliding velocity in the direction of sliding while it slides (m/s)."""
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    row = ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    if memory[SLIDE] == STICKS:
        friction = abs(vec(ws.lam, ws.m_ext)[row])
        return vec(ws.contact_sticking, ws.n_contacts)[k] * vec(ws.monitor, ws.n_contacts)[k] - friction
    if memory[SLIDE] == IDLE:
        return 0.0
    return memory[SLIDE] * vec(ws.phid, ws.m_ext)[row]


@compiled
def crossed(ws: Any, lc: Any, k: int, h: float) -> bool:
    """True if contact k has an event within the step of size h that ends at the current point."""
    mode = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE]
    row = ivec(ws.contact_rows, ws.n_contacts)[k]
    g, rate = vec(ws.phi, ws.m_ext)[row], vec(ws.phid, ws.m_ext)[row]
    force = vec(ws.monitor, ws.n_contacts)[k]
    release = ivec(ws.contact_release, ws.n_contacts)[k]
    watch = mat(lc.watch, ws.n_contacts, 3)
    size = vec(ws.row_scale, ws.m_ext)[row]
    if mode == OPEN:
        if g < 0.0:
            # shapes that touch and neither part nor press drift by rounding only; those that a method without position
            # constraints has let overlap before they opened may come apart
            if rate < -RATE_ROUNDING * rate_level(ws) * size:
                return True
            overlap = GAP_ROUNDING * position_level(ws) * size
            return g < -overlap and watch[k, 0] >= -overlap
        if watch[k, 1] < 0.0 < rate and watch[k, 0] > 0.0:
            # shapes that touch without a force turn round by rounding only
            still = RATE_ROUNDING * rate_level(ws) * size
            if watch[k, 1] >= -still or rate <= still:
                return False
            lowest, _ = lowest_inside(watch[k, 0], watch[k, 1], g, rate, h)
            return lowest < 0.0
        return False
    if mode == CLOSED:
        no_force = FORCE_ROUNDING * force_level(ws) / size
        if force < -no_force:
            return True
        if vec(ws.contact_sticking, ws.n_contacts)[k] == 0.0:
            return False
        sticks = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, SLIDE] == STICKS
        if sticks:
            limit = vec(ws.contact_sticking, ws.n_contacts)[k] * force
            return friction_margin(ws, k) < -max(no_force, SLIP_EXCESS * limit)
        along = vec(ws.row_scale, ws.m_ext)[ivec(ws.contact_slide_rows, ws.n_contacts)[k]]
        none = RATE_ROUNDING * rate_level(ws) * along
        return friction_margin(ws, k) < -none
    if mode == ACTIVE:
        return g > 0.0 or (release == 2 and force < 0.0)
    if mode == RELEASED:
        return g > 0.0 or force > 0.0
    return False


@internal
def any_crossed(ws: Any, lc: Any, h: float) -> bool:
    """True if any contact has an event within the step."""
    for k in range(ws.n_contacts):
        if crossed(ws, lc, k, h):
            return True
    return False
