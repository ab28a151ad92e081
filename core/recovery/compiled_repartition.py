"""`repair`, compiled, for systems without redundant rows: a new partition and new pivots at the newest row; and what
is left where that does not help. Where something has to be built that is not there yet it says so.
"""

from typing import Any

from ..assembly.condition_probe import set_probe
from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.redundant_reactions import analyze_equations
from ..compiled.jit import compiled, internal
from ..events.records import DECLINED, SETTLED, SINGULAR_MATRIX, WANT_MEMORY, WANTS_ROOM, call_part, instant_at
from ..linalg.record import WANT_ROOM
from ..methods.frame_partition import PREFERENCE, prefer_attitudes
from ..methods.history import recall
from ..state.run_records import clock_at
from ..state.workspace_records import (
    OK,
    convergence_at,
    counters_at,
)
from ..time_loop.drive import loop_at, method_at, workspace_at


@compiled
def repair_now(drive: Any) -> int:
    """What `repair` does: a status of `events/records.py`. With one that wants memory it is repeated."""
    workspace = workspace_at(drive.workspace)
    counters = counters_at(workspace.counters)
    partitions, analyses = counters.partitions, counters.analyses
    status = _repair(drive, workspace, method_at(drive.method), instant_at(drive.instant))
    if status == WANTS_ROOM or status == WANT_MEMORY:
        counters.partitions, counters.analyses = partitions, analyses
    return status


@internal
def _repair(drive: Any, workspace: Any, method: Any, instant: Any) -> int:
    rate = convergence_at(workspace.rate)
    c_v, condition = rate.factor_cv, rate.condition
    recall(workspace, method, 0)
    evaluate_residuals(workspace)
    prefer_attitudes(workspace, method, PREFERENCE)
    status = int(call_part(instant.use_modes, instant, drive, workspace, method))
    if prefer_attitudes(workspace, method, 1.0 / PREFERENCE):
        set_probe(workspace)
    if status != SETTLED:
        return status
    rate.choice_condition = condition
    # pivots of the stages' matrix, which may be others than those of the mass matrix alone
    evaluate_tangent(workspace, c_v * c_v, c_v)
    code = analyze_equations(workspace, workspace.kkt)
    if code != OK and code != WANT_ROOM:
        evaluate_tangent(workspace, 0.0, 0.0)
        code = analyze_equations(workspace, workspace.kkt)
    if code == WANT_ROOM:
        return WANT_MEMORY
    return SETTLED if code == OK else SINGULAR_MATRIX


@compiled
def go_by_impulses(drive: Any) -> int:
    """Where no step can be made from the newest row: steps of impulses from there (`events/zeno.py`), if enough
    contacts touch; SETTLED, or DECLINED, and nothing has happened."""
    workspace, method, instant = workspace_at(drive.workspace), method_at(drive.method), instant_at(drive.instant)
    if workspace.n_contacts == 0:
        return DECLINED
    recall(workspace, method, 0)
    evaluate_residuals(workspace)
    status = int(call_part(instant.step_through, instant, drive, workspace, method))
    if status == SETTLED:
        # what failed has left it at nearly nothing
        clock = clock_at(loop_at(drive.loop).clock)
        clock.step_size = clock.push_step
    return status
