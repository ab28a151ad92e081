"""Trials: a step is made again with another size, and tells what is positive before an event of one of its contacts."""

from typing import Any

from ..assembly.levels import force_level, rate_size
from ..assembly.sticking_force import friction_limit, held_friction, implied_margin, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_row
from ..rounding import SLIP_EXCESS
from ..state.modes import CLOSED, IDLE, MEMORY_SIZE, MODE, SLIDE
from ..state.run_records import WATCH, call_trial
from ..state.workspace_records import FACTOR_AGE, OK, OUTER_RATE, RATE_SIZE
from .crossings import friction_margin, no_sliding

# what is searched for a root
GAP, FORCE, OVERLAP, CLOSING = range(4)


@internal
def make_trial(dr: Any, ws: Any, ms: Any, lc: Any, step: float, full: float) -> int:
    """Make the step again with another size. Small fractions of it are made by the one-step starter: the multistep
    coefficients of a grid with a very small last step lose digits."""
    last = vec(dr.last_trial, 1)
    if last[0] == step:
        return OK
    starter, rows = lc.starter, lc.rows
    if step < 0.1 * full or rows == 1:
        lc.starter = lc.fine_starter
        if rows > 1:
            lc.rows = 1_000_000_000
    # with old matrices the same step would come out a little different each time it is made
    rate = vec(ws.rate, RATE_SIZE)
    rate[FACTOR_AGE], rate[OUTER_RATE] = -1.0, 1.0
    status = call_trial(dr.trial, ws, ms, lc, step)
    lc.starter, lc.rows = starter, rows
    last[0] = step if status == OK else -1.0
    return status


@internal
def _no_margin(ws: Any, ms: Any, lc: Any, k: int) -> float:
    """What counts as none of the margin of friction of closed contact k, which has begun the step with no more than
    that: blocks that ride on one another at exactly the limit, or slide with no speed. 0 of any other contact, whose
    margin has a root."""
    if not is_held(ws, k):
        none, start = no_sliding(ws, k), mat(lc.watch, ws.n_contacts, WATCH)[k, 3]
        return none if mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, SLIDE] * start <= none else 0.0
    lam = history_row(ws, ms, 0)[4 * ws.n_ext :]
    limit = friction_limit(ws, k, -lam[ivec(ws.contact_rows, ws.n_contacts)[k]])
    held = limit - held_friction(ws, k, lam) <= SLIP_EXCESS * limit
    return SLIP_EXCESS * friction_limit(ws, k, vec(ws.monitor, ws.n_contacts)[k]) if held else 0.0


@internal
def trial_value(
    dr: Any, ws: Any, ms: Any, lc: Any, k: int, what: int, sign: float, slack: float, step: float, full: float
) -> Any:
    """(status, value) at the end of a step of this size of what is positive before the event."""
    status = make_trial(dr, ws, ms, lc, step, full)
    if status != OK:
        return status, 0.0
    row = ivec(ws.contact_rows, ws.n_contacts)[k]
    if what == GAP or what == OVERLAP:
        return OK, sign * vec(ws.phi, ws.m_ext)[row] + slack
    if what == CLOSING:
        return OK, vec(ws.phidd, ws.m_ext)[row] + slack
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    force, strongest = sign * vec(ws.monitor, ws.n_contacts)[k], force_level(ws) / vec(ws.row_scale, ws.m_ext)[row]
    if memory[MODE] == CLOSED and vec(ws.contact_sticking, ws.n_contacts)[k] > 0.0 and memory[SLIDE] != IDLE:
        left, fastest = friction_margin(ws, k) + _no_margin(ws, ms, lc, k), rate_size(ws, k)
        if not is_held(ws, k) and fastest > 0.0:
            # speeds beside forces, each in parts of its scale: what is small does not depend on the units
            left *= strongest / fastest
        force = min(force, left)
    before = mat(lc.watch, ws.n_contacts, WATCH)[k, 2]
    margin = implied_margin(ws, k, before) if ms.exact != 0 else 1.0
    if margin < 1.0:
        force = min(force, strongest * margin)
    return OK, force
