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
from ..compiled.views import ivec, vec
from ..methods.history import history_time
from ..rounding import RATE_ROUNDING
from ..state.impact_law_codes import AT_MASSLESS
from ..state.modes import CLOSED, OPEN, memories_at
from ..state.run_records import CLOSE, GRAZE, OPENS, call_accelerations
from ..state.workspace_records import OK
from .constraint_projection import meet_constraints
from .progress import GUARD_SIZE, RUN_BEGAN
from .records import NO_ACCELERATIONS, NOT_MET, SETTLED, call_part
from .report import report


@internal
def settle_massless(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Of the pending contacts at massless ends, closed ones whose force became zero open, and open ones that approach
    close."""
    law, pending, rows = (
        ivec(drive.law, workspace.n_contacts),
        ivec(drive.pending, workspace.n_contacts),
        ivec(workspace.contact_rows, workspace.n_contacts),
    )
    memory, rates = (
        memories_at(workspace.memory, workspace.n_contacts),
        vec(instant.massless_rates, workspace.n_contacts),
    )
    phid, phidd, modes = (
        vec(workspace.phid, workspace.m_ext),
        vec(workspace.phidd, workspace.m_ext),
        vec(instant.modes, workspace.n_contacts),
    )
    any_found = False
    for k in range(workspace.n_contacts):
        if law[k] != AT_MASSLESS or pending[k] == 0:
            continue
        any_found = True
        rate, rounding = phid[rows[k]], RATE_ROUNDING * rate_size(workspace, k)
        rates[k] = rate
        closes = rate < -rounding or (rate <= rounding and phidd[rows[k]] < 0.0)
        memory[k].mode = CLOSED if closes and modes[k] != CLOSED else OPEN
    if not any_found:
        return SETTLED
    status = call_part(instant.use_modes, instant, drive, workspace, method)
    if status != SETTLED:
        return status
    if not meet_constraints(workspace):
        return NOT_MET
    if call_accelerations(drive.accelerations, workspace) != OK:
        return NO_ACCELERATIONS
    t, started = history_time(method, 0), history_time(method, 0) > vec(drive.guard, GUARD_SIZE)[RUN_BEGAN]
    for k in range(workspace.n_contacts):
        if law[k] != AT_MASSLESS or pending[k] == 0:
            continue
        if memory[k].mode == CLOSED:
            speed = max(-rates[k], 0.0)
            memory[k].approach_speed = speed
            memory[k].largest_approach = max(memory[k].largest_approach, speed)
            report(drive, t, CLOSE, k, 0.0, 0.0, speed, 0.0, 0.0, 0.0)
        elif modes[k] == CLOSED:
            report(drive, t, OPENS, k, 0.0, 0.0, 0.0, max(phid[rows[k]], 0.0), 0.0, 0.0)
        elif started:
            report(drive, t, GRAZE, k, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return SETTLED
