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
from .records import scalars, touching


@internal
def read_spins(instant: Any, drive: Any, workspace: Any) -> None:
    """Spins of the touching contacts, which are open and whose residuals have been evaluated last, and their
    coefficients of friction as if they were at rest."""
    contact = touching(instant)
    contacts = ivec(instant.contacts, instant.most)
    monitor, friction = vec(workspace.monitor, 3 * workspace.n_contacts), vec(drive.friction, workspace.n_contacts)
    static = vec(workspace.contact_sticking, workspace.n_contacts)
    for i in range(scalars(instant).count):
        k = contacts[i]
        z = monitor[2 * workspace.n_contacts + k] if in_space(workspace, k) and static[k] > 0.0 else 0.0
        slow = CREEPS * slow_sliding(workspace, k)
        size = math.hypot(z, slow)
        left = slow / size if z != 0.0 else 1.0
        contact[i].spin_rate, contact[i].spin_share = z, z / size if z != 0.0 else 0.0
        contact[i].kinetic_friction, contact[i].static_friction = left * friction[k], left * static[k]


@internal
def brake_by_spins(instant: Any, drive: Any, workspace: Any) -> None:
    """Coefficients of those that are known to slide or to spin."""
    contact = touching(instant)
    contacts, friction = ivec(instant.contacts, instant.most), vec(drive.friction, workspace.n_contacts)
    for i in range(scalars(instant).count):
        z, speed = contact[i].spin_rate, math.hypot(contact[i].sliding_rate, contact[i].sliding_rate2)
        if vec(instant.known_direction, instant.most)[i] != 0.0 and z != 0.0:
            contact[i].kinetic_friction = friction[contacts[i]] * speed / math.hypot(speed, z)
