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
from ..state.run_records import JUMPS, call_accelerations, counts_at, goals_at
from ..state.workspace_records import OK
from .moved_surfaces import find_moved, is_moved_row, release_sticking
from .records import NO_ACCELERATIONS, NOT_MET, SETTLED, call_part, clear
from .report import report, room_for


@internal
def pass_breakpoint(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Bring the current point to the breakpoint `passed` of the goals, just after the newest row, with accelerations
    that hold behind it, and find the contacts that are to be settled there, to `unsettled`: a status; with any but
    SETTLED only what an instant keeps has changed."""
    events = counts_at(drive.counts).events
    status = _pass(instant, drive, workspace, method, goals_at(drive.goals).passed)
    if status != SETTLED:
        counts_at(drive.counts).events = events
    return status


@internal
def _pass(instant: Any, drive: Any, workspace: Any, method: Any, t: float) -> int:
    recall(workspace, method, 0)
    evaluate_residuals(workspace)
    rates, before, active = (
        vec(workspace.phid, workspace.m_ext),
        vec(instant.joint_rates, workspace.m_act),
        ivec(workspace.active, workspace.m_act),
    )
    for i in range(workspace.m_act):
        before[i] = rates[active[i]]
    vec(workspace.t, 1)[0] = t
    evaluate_residuals(workspace)
    moved, status = ivec(instant.unsettled, workspace.n_contacts), SETTLED
    clear(moved, workspace.n_contacts)
    some = find_moved(workspace, method, moved)
    if _jumps(drive, workspace, before, moved, t):
        if some:
            release_sticking(workspace, moved)
            status = call_part(instant.use_modes, instant, drive, workspace, method)
            if status != SETTLED:
                return int(status)
        v, energy = vec(workspace.v, workspace.n_ext), vec(workspace.energy, 3)
        evaluate_energy(workspace)
        kinetic = energy[0]
        if not meet(workspace, True):
            return NOT_MET
        evaluate_energy(workspace)
        if drive.input_account >= 0:
            v[drive.input_account] += energy[0] - kinetic
    status = call_part(instant.use_modes, instant, drive, workspace, method)
    if status != SETTLED:
        return int(status)
    return SETTLED if call_accelerations(drive.accelerations, workspace) == OK else NO_ACCELERATIONS


@internal
def _jumps(drive: Any, workspace: Any, before: Any, moved: Any, t: float) -> bool:
    """True if the rate of an active row has jumped, but for contacts whose surfaces have `moved`; drivers that strike
    are reported. (What a method without velocity constraints has violated before is no jump.)"""
    rates, scale, active = (
        vec(workspace.phid, workspace.m_ext),
        vec(workspace.row_scale, workspace.m_ext),
        ivec(workspace.active, workspace.m_act),
    )
    least, found = CONTINUOUS * rate_level(workspace), False
    for i in range(workspace.m_act):
        jumps = abs(rates[active[i]] - before[i]) > least * scale[active[i]]
        found = found or (jumps and not is_moved_row(workspace, moved, active[i]))
    if found:
        for i in range(workspace.m_act):
            row = active[i]
            if row < drive.joint_rows and abs(rates[row]) > least * scale[row] and room_for(drive, 1):
                report(drive, t, JUMPS, row, 0.0, 0.0, -rates[row], 0.0, 0.0, 0.0)
    return found
