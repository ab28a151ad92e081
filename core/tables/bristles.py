"""Bristles of LuGre's friction in space stand straight while their contact does not act.

As in the plane (`events/force_contact.py`) what they hold when the contact ends is lost, to the contact's dissipation.
The figure of the event itself, which is made before, leaves it out.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import internal
from ..compiled.views import imat, mat, vec
from ..laws.friction import LuGreFriction
from ..state.modes import ACTIVE, LOSS_JUMP, MEMORY_SIZE, MODE
from .assembly import ContactInfo

FIRST, COUNT = 0, 1
"""Of a contact's components in v: where they begin, and how many they are."""


def bristle_places(contacts: Sequence[ContactInfo]) -> NDArray[np.int64]:
    """Where the components of each contact are, (contacts, 2)."""
    found = [(c.bristles[0][0], len(c.bristles)) if c.bristles else (0, 0) for c in contacts]
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def bristle_stiffness(contacts: Sequence[ContactInfo]) -> NDArray[np.float64]:
    """N/m, (contacts,); 0 where there are none."""
    laws = [contact.friction for contact in contacts]
    return np.array([law.bristle_stiffness if isinstance(law, LuGreFriction) else 0.0 for law in laws])


@internal
def let_go(ws: Any, k: int) -> None:
    """The bristles of contact k stand straight; what they held is lost."""
    places, v = imat(ws.contact_bristles, ws.n_contacts, 2), vec(ws.v, ws.n_ext)
    held = 0.5 * vec(ws.bristle_stiffness, ws.n_contacts)[k]
    for i in range(places[k, FIRST], places[k, FIRST] + places[k, COUNT]):
        mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, LOSS_JUMP] += held * v[i] ** 2
        v[i] = 0.0


@internal
def let_idle_ones_go(ws: Any) -> None:
    """The same for all contacts that do not act."""
    for k in range(ws.n_contacts):
        if mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE] != ACTIVE:
            let_go(ws, k)
