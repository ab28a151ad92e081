"""Contacts at massless ends of flexible bodies: they close and open without impulse.

While such a contact is open, the balance of forces at the end's node, "its element carries no force", is a constraint
with multiplier zero; while it is closed the gap is the constraint instead, and the element's force is the contact's.
Closing and opening exchange the two rows. Positions meet both at that moment (gap zero and force zero); the node's
velocity jumps, which takes no impulse and no energy, since nothing but the massless node moves in the M-norm's least
correction.
"""

from typing import Any

from ..assembly.levels import rate_size
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_time
from ..rounding import RATE_ROUNDING
from ..state.modes import APPROACH_SPEED, CLOSED, LARGEST_APPROACH, MEMORY_SIZE, MODE, OPEN
from ..state.run_records import CLOSE, GRAZE, OPENS, call_accelerations
from ..state.workspace_records import OK
from .constraint_projection import meet_constraints
from .laws import MASSLESS
from .progress import GUARD_SIZE, START
from .records import NO_ACCELERATIONS, NOT_MET, SETTLED, call_part
from .report import report


@internal
def settle_massless(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Of the pending contacts at massless ends, closed ones whose force became zero open, and open ones that approach
    close."""
    law, pending, rows = (
        ivec(dr.law, ws.n_contacts),
        ivec(dr.pending, ws.n_contacts),
        ivec(ws.contact_rows, ws.n_contacts),
    )
    memory, rates = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), vec(ev.massless_rates, ws.n_contacts)
    phid, phidd, modes = vec(ws.phid, ws.m_ext), vec(ws.phidd, ws.m_ext), vec(ev.modes, ws.n_contacts)
    any_found = False
    for k in range(ws.n_contacts):
        if law[k] != MASSLESS or pending[k] == 0:
            continue
        any_found = True
        rate, rounding = phid[rows[k]], RATE_ROUNDING * rate_size(ws, k)
        rates[k] = rate
        closes = rate < -rounding or (rate <= rounding and phidd[rows[k]] < 0.0)
        memory[k, MODE] = CLOSED if closes and modes[k] != CLOSED else OPEN
    if not any_found:
        return SETTLED
    status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    if not meet_constraints(ws):
        return NOT_MET
    if call_accelerations(dr.accelerations, ws) != OK:
        return NO_ACCELERATIONS
    t, started = history_time(ms, 0), history_time(ms, 0) > vec(dr.guard, GUARD_SIZE)[START]
    for k in range(ws.n_contacts):
        if law[k] != MASSLESS or pending[k] == 0:
            continue
        if memory[k, MODE] == CLOSED:
            speed = max(-rates[k], 0.0)
            memory[k, APPROACH_SPEED] = speed
            memory[k, LARGEST_APPROACH] = max(memory[k, LARGEST_APPROACH], speed)
            report(dr, t, CLOSE, k, 0.0, 0.0, speed, 0.0, 0.0, 0.0)
        elif modes[k] == CLOSED:
            report(dr, t, OPENS, k, 0.0, 0.0, 0.0, max(phid[rows[k]], 0.0), 0.0, 0.0)
        elif started:
            report(dr, t, GRAZE, k, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return SETTLED
