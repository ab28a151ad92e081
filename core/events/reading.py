"""What is known of the touching contacts before an instant is settled: modes, and which events they have."""

from typing import Any

import numpy as np

from ..assembly.levels import force_level, position_level, rate_size
from ..assembly.sticking_force import held_friction, in_space, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import BRAKED, FORCE_ROUNDING, NEAR_ZERO, PERHAPS_REST, RATE_ROUNDING, REACHES_LIMIT, UNRESOLVED
from ..state.modes import CLOSED, IDLE, memories_at
from ..state.workspace_records import control_at
from .records import scalars, touching


@internal
def largest_acceleration(workspace: Any) -> float:
    """Of all coordinates, in parts of their scales, 1/s^2."""
    a, scale, largest = vec(workspace.a, workspace.n_ext), vec(workspace.scale, workspace.n), 0.0
    for i in range(workspace.n):
        largest = max(largest, abs(a[i]) / scale[i])
    return largest


@internal
def slow_sliding(workspace: Any, k: int) -> float:
    """Sliding speed of contact k in space whose direction error control does not resolve, m/s."""
    return float(control_at(workspace.control).rtol * rate_size(workspace, k))


@internal
def unresolved_speed(workspace: Any, k: int, falls: float) -> float:
    """Speed of separation below which a gap with the acceleration -falls (m/s^2) cannot be seen to open, m/s."""
    scale = vec(workspace.row_scale, workspace.m_ext)[ivec(workspace.contact_rows, workspace.n_contacts)[k]]
    return np.sqrt(2.0 * UNRESOLVED * position_level(workspace) * scale * max(falls, 0.0))


@internal
def comes_back(workspace: Any, k: int, jerk: float, motion: float) -> bool:
    """True if a gap at rest with this acceleration (m/s^2) and its rate (m/s^3) does not open, or by less than could be
    told from zero before it closes again. g = b t^2/2 + j t^3/6, j < 0, is highest at t = -2 b/j."""
    scale = vec(workspace.row_scale, workspace.m_ext)[ivec(workspace.contact_rows, workspace.n_contacts)[k]]
    height = 2.0 * max(motion, 0.0) ** 3 / (3.0 * jerk * jerk) if jerk < 0.0 else np.inf
    return height <= UNRESOLVED * position_level(workspace) * scale


@internal
def read_before(instant: Any, drive: Any, workspace: Any) -> None:
    """What the touching contacts were, and which events those that are pending have, at the current point."""
    contact = touching(instant)
    contacts, pending = ivec(instant.contacts, instant.most), ivec(drive.pending, workspace.n_contacts)
    memory, lam = memories_at(workspace.memory, workspace.n_contacts), vec(workspace.lam, workspace.m_ext)
    phid, phidd = vec(workspace.phid, workspace.m_ext), vec(workspace.phidd, workspace.m_ext)
    rows, slides = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    scale, static = vec(workspace.row_scale, workspace.m_ext), vec(workspace.contact_sticking, workspace.n_contacts)
    was, slid, leaves, slips, stops = (
        contact.mode_before,
        contact.slide_mode_before,
        contact.opens,
        contact.slips,
        contact.stops,
    )
    forces, braked = force_level(workspace), BRAKED * largest_acceleration(workspace)
    scalars(instant).struck, pulled = 0, False
    for i in range(scalars(instant).count):
        # the forces of others behind a jump, where a constraint that has ended still pulls, are none
        k = contacts[i]
        pulled = pulled or (memory[k].mode == CLOSED and lam[rows[k]] * scale[rows[k]] > NEAR_ZERO * forces)
    for i in range(scalars(instant).count):
        k = contacts[i]
        row, slide = rows[k], slides[k]
        was[i], slid[i], contact[i].ratio_before = memory[k].mode, memory[k].slide_mode, memory[k].friction_ratio
        leaves[i] = slips[i] = stops[i] = 0.0
        fastest = rate_size(workspace, k)
        rounding = RATE_ROUNDING * fastest
        contact[i].rate_rounding, contact[i].closing_acceleration = rounding, -phidd[row]
        if was[i] != CLOSED:
            continue
        if slide >= 0 and abs(slid[i]) == 1.0:
            # what moves with another that stops does so at the same time
            stops[i] = abs(phid[slide]) <= rounding and slid[i] * phidd[slide] < -braked * scale[slide]
        if pending[k] == 0:
            continue
        force, strongest = -lam[row], forces / scale[row]
        # a method that does not meet the constraints at all levels may end a little before its force is zero
        if slide < 0 or slid[i] == IDLE or force <= FORCE_ROUNDING * strongest:
            leaves[i] = 1.0
            continue
        # a force is found less finely than a velocity: the event is of what is nearer to zero
        part = force / strongest
        if is_held(workspace, k):
            friction = held_friction(workspace, k, lam) if in_space(workspace, k) else -lam[slide]
            if not pulled and abs(friction) >= static[k] * force * (1.0 - REACHES_LIMIT):
                slips[i] = -np.sign(friction)
            else:
                leaves[i] = part <= NEAR_ZERO
        elif abs(slid[i]) == 1.0:
            leaves[i] = part <= NEAR_ZERO and part < abs(phid[slide]) / fastest
            if leaves[i] == 0.0 and abs(phid[slide]) <= PERHAPS_REST * fastest:
                stops[i] = 1.0
