"""A time at which a force or the rate of a driver jumps: the run goes on from there with a new history.

A driver's jump in rate is an impact of the driver: v jumps by M dv + Phi_q^T Lambda = 0, Phi_q dv = -phid, and the
change of kinetic energy is the driver's work. The surface of a belt that jumps in speed pulls by no more than friction:
contacts that stick to it are settled anew, and take no part in such an impact.
"""

from typing import Any

from ..assembly.evaluate import evaluate_energy, evaluate_residuals
from ..assembly.levels import rate_level
from ..assembly.projection import meet
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..methods.history import recall
from ..rounding import CONTINUOUS
from ..state.run_records import COUNTS_SIZE, EVENTS, GOALS_SIZE, JUMPS, PASSED, call_accelerations
from ..state.workspace_records import OK
from .moved_surfaces import find_moved, is_moved_row, release_sticking
from .records import NO_ACCELERATIONS, NOT_MET, SETTLED, call_part, clear
from .report import report, room_for


@internal
def pass_breakpoint(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Bring the current point to the breakpoint `PASSED` of the goals, just after the newest row, with accelerations
    that hold behind it, and find the contacts that are to be settled there, to `unsettled`: a status; with any but
    SETTLED only what an instant keeps has changed."""
    events = ivec(dr.counts, COUNTS_SIZE)[EVENTS]
    status = _pass(ev, dr, ws, ms, vec(dr.goals, GOALS_SIZE)[PASSED])
    if status != SETTLED:
        ivec(dr.counts, COUNTS_SIZE)[EVENTS] = events
    return status


@internal
def _pass(ev: Any, dr: Any, ws: Any, ms: Any, t: float) -> int:
    recall(ws, ms, 0)
    evaluate_residuals(ws)
    rates, before, active = vec(ws.phid, ws.m_ext), vec(ev.joint_rates, ws.m_act), ivec(ws.active, ws.m_act)
    for i in range(ws.m_act):
        before[i] = rates[active[i]]
    vec(ws.t, 1)[0] = t
    evaluate_residuals(ws)
    moved, status = ivec(ev.unsettled, ws.n_contacts), SETTLED
    clear(moved, ws.n_contacts)
    some = find_moved(ws, ms, moved)
    if _jumps(dr, ws, before, moved, t):
        if some:
            release_sticking(ws, moved)
            status = call_part(ev.use_modes, ev, dr, ws, ms)
            if status != SETTLED:
                return int(status)
        v, energy = vec(ws.v, ws.n_ext), vec(ws.energy, 3)
        evaluate_energy(ws)
        kinetic = energy[0]
        if not meet(ws, True):
            return NOT_MET
        evaluate_energy(ws)
        if dr.input_account >= 0:
            v[dr.input_account] += energy[0] - kinetic
    status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status != SETTLED:
        return int(status)
    return SETTLED if call_accelerations(dr.accelerations, ws) == OK else NO_ACCELERATIONS


@internal
def _jumps(dr: Any, ws: Any, before: Any, moved: Any, t: float) -> bool:
    """True if the rate of an active row has jumped, but for contacts whose surfaces have `moved`; drivers that strike
    are reported. (What a method without velocity constraints has violated before is no jump.)"""
    rates, scale, active = vec(ws.phid, ws.m_ext), vec(ws.row_scale, ws.m_ext), ivec(ws.active, ws.m_act)
    least, found = CONTINUOUS * rate_level(ws), False
    for i in range(ws.m_act):
        jumps = abs(rates[active[i]] - before[i]) > least * scale[active[i]]
        found = found or (jumps and not is_moved_row(ws, moved, active[i]))
    if found:
        for i in range(ws.m_act):
            row = active[i]
            if row < dr.joint_rows and abs(rates[row]) > least * scale[row] and room_for(dr, 1):
                report(dr, t, JUMPS, row, 0.0, 0.0, -rates[row], 0.0, 0.0, 0.0)
    return found
