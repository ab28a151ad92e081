"""`repair`, compiled, for systems without redundant rows: a new partition and new pivots at the newest row; and what
is left where that does not help.

Who drives a run without Python calls it; where something has to be built that is not there yet it says so.
"""

from typing import Any

from ..assembly.compatibility import analyze_equations
from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..compiled.jit import compiled
from ..compiled.views import vec
from ..events.records import DECLINED, SETTLED, SINGULAR_MATRIX, WANT_MEMORY, call_part, instant_at
from ..linalg.record import WANT_ROOM
from ..methods.history import recall
from ..state.run_records import CLOCK_SIZE, PUSH_STEP, STEP_SIZE
from ..state.workspace_records import CHOICE_CONDITION, CONDITION, FACTOR_CV, OK, RATE_SIZE
from ..time_loop.drive import loop_at, method_at, workspace_at


@compiled
def repair_now(dr: Any) -> int:
    """What `repair` does: a status of `events/records.py`; with any but SETTLED the run cannot go on."""
    ws, ms, ev = workspace_at(dr.workspace), method_at(dr.method), instant_at(dr.instant)
    rate = vec(ws.rate, RATE_SIZE)
    c_v, condition = rate[FACTOR_CV], rate[CONDITION]
    recall(ws, ms, 0)
    evaluate_residuals(ws)
    status = call_part(ev.use_modes, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    rate[CHOICE_CONDITION] = condition
    # pivots of the stages' matrix, which may be others than those of the mass matrix alone
    evaluate_tangent(ws, c_v * c_v, c_v)
    code = analyze_equations(ws, ws.kkt)
    if code != OK and code != WANT_ROOM:
        evaluate_tangent(ws, 0.0, 0.0)
        code = analyze_equations(ws, ws.kkt)
    if code == WANT_ROOM:
        return WANT_MEMORY
    return SETTLED if code == OK else SINGULAR_MATRIX


@compiled
def go_by_impulses(dr: Any) -> int:
    """Where no step can be made from the newest row: steps of impulses from there (`events/zeno.py`), if enough
    contacts touch; SETTLED, or DECLINED, and nothing has happened."""
    ws, ms, ev = workspace_at(dr.workspace), method_at(dr.method), instant_at(dr.instant)
    if ws.n_contacts == 0:
        return DECLINED
    recall(ws, ms, 0)
    evaluate_residuals(ws)
    status = int(call_part(ev.step_through, ev, dr, ws, ms))
    if status == SETTLED:
        # what failed has left it at nearly nothing
        clock = vec(loop_at(dr.loop).clock, CLOCK_SIZE)
        clock[STEP_SIZE] = clock[PUSH_STEP]
    return status
