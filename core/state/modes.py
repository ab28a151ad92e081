"""Contact modes and the memory of a contact (one record of floats for each contact, part of the state)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled import types
from ..compiled.jit import records_view

OPEN = 0.0
CLOSED = 1.0  # CCM: the gap is a constraint
ACTIVE = 2.0  # CCFM: the force law acts
RELEASED = 3.0  # CCFM: the force has reached zero while the shapes still overlap
UNWATCHED = -1.0  # CCM, within a step of impulses: open, and nobody looks for its events

MODE_NAMES: dict[float, str] = {OPEN: "open", CLOSED: "closed", ACTIVE: "active", RELEASED: "released"}

# when a contact that acts as a force ends (`contact_release`)
NO_FORCE_LAW = 0  # it is a constraint contact
AT_ZERO_GAP = 1
AT_ZERO_FORCE = 2
AT_ZERO_GAP_OR_FORCE = 3  # the latter where others draw the shapes apart faster than they rebound from each other

# how a closed contact with friction moves along its tangent; +1 and -1: it slides in that direction
STICKS = 0.0  # its sliding distance is a constraint
IDLE = 2.0  # it cannot slide because others hold it, and carries a share of its normal force (`friction_ratio`)
# in space: others hold it, with its friction at its limit along the second tangent, `friction_ratio` F_N; along the
# first one, across that friction, its sliding is zero, and that row's multiplier turns the direction a little
AT_LIMIT = 3.0

OF_NORMAL, OF_FIRST, OF_SECOND = 1, 2, 4
STEP_FORCES = 6
"""Of a step of impulses: normal force, forces along two tangents, torques about two axes of rolling and of spinning."""

CONTACT_MEMORY = np.dtype(
    [
        ("mode", np.float64),
        ("approach_speed", np.float64),  # at the last first touch, m/s
        ("largest_approach", np.float64),  # since the start, m/s
        ("impulse_jump", np.float64),  # sum of impact impulses, N s
        ("loss_jump", np.float64),  # sum of energy lost at impacts and releases, J
        ("slide_mode", np.float64),  # STICKS, IDLE, AT_LIMIT, +1 or -1 (in space +1: along `tangent_angle`)
        ("slide_start", np.float64),  # in the plane: sliding distance at which the contact began to stick, m
        ("friction_ratio", np.float64),  # F_T/F_N of a closed contact that does not stick: +-mu while it slides
        ("closed_gap", np.float64),  # gap at which a contact constraint holds, next to nothing, m
        ("begun_impulse", np.float64),  # impulse of a contact force when it began to act, N s
        ("begun_loss", np.float64),  # its dissipation then, J
        # of a constraint contact in the last step of impulses: mean forces, N, and torques, N m
        ("step_force", np.float64, (STEP_FORCES,)),
        # of a closed contact, which of its rows are implied by others: a sum of OF_NORMAL, OF_FIRST, OF_SECOND
        ("implied_rows", np.float64),
        ("laid_mass", np.float64),  # effective mass of shapes that met by force without an approach, kg; else 0
        # of constraint contacts with friction in space (`contacts/frame3d.py`)
        ("tangent_angle", np.float64),  # of the first tangent, rad
        ("tangent_axis", np.float64),  # axis of the first marker that angles are counted from: 1, 2, 3; 0: not chosen
        ("sliding_lean", np.float64),  # angle of the direction of sliding and spinning out of the tangent plane, rad
        ("slow_sliding", np.float64),  # sliding speed whose direction error control does not resolve, m/s
    ]
)
MEMORY_SIZE = CONTACT_MEMORY.itemsize // 8
memories_at = records_view(types.from_dtype(CONTACT_MEMORY))
"""memories_at(address, n): n records of CONTACT_MEMORY."""


def contact_memories(rows: NDArray[np.float64]) -> Any:
    """The memories (contacts, MEMORY_SIZE) as records, (contacts,) CONTACT_MEMORY, of the same memory."""
    return rows.view(CONTACT_MEMORY)[:, 0].view(np.recarray)
