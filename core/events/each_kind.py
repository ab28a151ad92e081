"""Contacts of the plane and of space at one instant of one model.

Where nothing connects contacts of the plane that have friction with such of space, the instant is decided once for
each kind, of which something is pending, with the functions of that kind: so each part does what it does in a model of
its own. What is connected is decided as in space; there the second tangent of a contact of the plane has no gradient,
so nothing moves it and its force is zero: a direction of sliding is a sign, and what is held along the first tangent
sticks.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec
from .decide import decide
from .records import SETTLED, TOUCHED, TOUCHED_IN_SPACE, whole


@internal
def decide_each_kind(ev: Any, dr: Any, ws: Any, ms: Any, lc: Any) -> int:
    """`decide` for the contacts of the plane, and then for those of space."""
    most, status, touched = ws.tangents, SETTLED, 0
    for tangents in range(1, most + 1):
        if status == SETTLED and _is_due(dr, ws, tangents):
            _take_parts(ev, ws, tangents)
            status = decide(ev, dr, ws, ms, lc)
            touched = max(touched, whole(ev)[TOUCHED])
            whole(ev)[TOUCHED_IN_SPACE] = whole(ev)[TOUCHED] if tangents == 2 else 0
    _take_parts(ev, ws, most)
    whole(ev)[TOUCHED] = touched
    return status


@internal
def _is_due(dr: Any, ws: Any, tangents: int) -> bool:
    """True if all contacts are decided with so many tangents, or one that is has an event."""
    kinds, pending, own, due = ivec(ws.contact_tangents, ws.n_contacts), ivec(dr.pending, ws.n_contacts), 0, False
    for k in range(ws.n_contacts):
        if kinds[k] == tangents:
            own += 1
            due = due or pending[k] != 0
    return own == ws.n_contacts or due


@internal
def _take_parts(ev: Any, ws: Any, tangents: int) -> None:
    """Instants are decided with so many tangents from now on."""
    if ws.tangents == tangents:
        return
    ws.tangents = tangents
    if tangents == 1:
        ev.open_touching, ev.strike, ev.begin_rest = ev.open_in_plane, ev.strike_in_plane, ev.begin_rest_in_plane
        ev.find_forces, ev.keep = ev.find_forces_in_plane, ev.keep_in_plane
    else:
        ev.open_touching, ev.strike, ev.begin_rest = ev.open_in_space, ev.strike_in_space, ev.begin_rest_in_space
        ev.find_forces, ev.keep = ev.find_forces_in_space, ev.keep_in_space
