"""Spinning on a patch at an instant: what it leaves of a contact's friction along its tangents.

Friction on a patch (`laws/friction/turning.py`) is Coulomb's with a coefficient that the motion says: mu |v_T|/s of
what slides or spins, s^2 = |v_T|^2 + z^2; of what is at rest what the torque at its present part leaves on the
ellipsoid (`contacts/patch3d.py`). Of impacts `spin_impulses.py` says it.
"""

import math
from typing import Any

from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..contacts.patch3d import CREEPS
from .reading import slow_sliding
from .records import (
    COUNT,
    HELD_SPIN,
    KINETIC,
    KNOWN,
    SLIDE_RATE,
    SPIN,
    STATIC,
    SWAY_RATE,
    col,
    whole,
)


@internal
def read_spins(ev: Any, dr: Any, ws: Any) -> None:
    """Spins of the touching contacts, which are open and whose residuals have been evaluated last, and their
    coefficients of friction as if they were at rest."""
    contacts = ivec(ev.contacts, ev.most)
    monitor, friction = vec(ws.monitor, 3 * ws.n_contacts), vec(dr.friction, ws.n_contacts)
    static = vec(ws.contact_sticking, ws.n_contacts)
    for i in range(whole(ev)[COUNT]):
        k = contacts[i]
        z = monitor[2 * ws.n_contacts + k] if in_space(ws, k) and static[k] > 0.0 else 0.0
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
