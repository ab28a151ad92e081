"""What is looked at after each step while contacts slide: has it gone over a place where friction jams?

Compiled half of `run/painleve.py`, which says what that means.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..linalg import factor, lu_at, solve
from ..state.modes import CLOSED, MEMORY_SIZE, MODE, RATIO, SLIDE
from ..state.workspace_records import OK
from ..tables.evaluate import evaluate_residuals, evaluate_tangent


@internal
def slides(ws: Any, k: int) -> bool:
    """True if the friction of closed contact k is in proportion to its normal force because it slides."""
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    return memory[MODE] == CLOSED and abs(memory[SLIDE]) == 1.0 and memory[RATIO] != 0.0


@internal
def any_slides(ws: Any) -> bool:
    """True if a closed contact slides."""
    found = False
    for k in range(ws.n_contacts):
        found = found or slides(ws, k)
    return found


@internal
def may_have_jammed(ws: Any) -> bool:
    """True if, at the current point, the force of a sliding contact may pull its gap's acceleration down, so that
    Python must look at it."""
    evaluate_residuals(ws)
    evaluate_tangent(ws, 0.0, 0.0)
    if factor(lu_at(ws.kkt_query), ws.values) != OK:
        return True
    size = ws.n + ws.m_act
    rhs, active, rows = vec(ws.rhs, size), ivec(ws.active, ws.m_act), ivec(ws.contact_rows, ws.n_contacts)
    for k in range(ws.n_contacts):
        if not slides(ws, k):
            continue
        row = 0
        for i in range(ws.m_act):
            if active[i] == rows[k]:
                row = ws.n + i
        for i in range(size):
            rhs[i] = 0.0
        rhs[row] = 1.0
        # multiplier that gives the gap a unit acceleration
        solve(lu_at(ws.kkt_query), ws.rhs)
        if not rhs[row] < 0.0:
            return True
    return False
