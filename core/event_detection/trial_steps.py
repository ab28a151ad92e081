"""Trials: a step is made again with another size, and tells what is positive before an event of one of its contacts."""

from typing import Any

from ..assembly.levels import force_level, rate_size
from ..assembly.sticking_force import friction_limit, held_friction, implied_margin, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_row
from ..rounding import SLIP_EXCESS
from ..state.modes import CLOSED, IDLE, memories_at
from ..state.run_records import WATCH, call_trial
from ..state.workspace_records import OK, convergence_at
from .crossings import friction_margin, no_sliding

# what is searched for a root
GAP_ROOT, FORCE_ROOT, OVERLAP_ROOT, CLOSING_ROOT = range(4)


@internal
def make_trial(drive: Any, workspace: Any, method: Any, loop: Any, step: float, full: float) -> int:
    """Make the step again with another size. Small fractions of it are made by the one-step starter: the multistep
    coefficients of a grid with a very small last step lose digits."""
    last = vec(drive.last_trial, 1)
    if last[0] == step:
        return OK
    starter, rows = loop.starter, loop.rows
    if step < 0.1 * full or rows == 1:
        loop.starter = loop.fine_starter
        if rows > 1:
            loop.rows = 1_000_000_000
    # with old matrices the same step would come out a little different each time it is made
    rate = convergence_at(workspace.rate)
    rate.factor_age, rate.outer_rate = -1.0, 1.0
    status = call_trial(drive.trial, workspace, method, loop, step)
    loop.starter, loop.rows = starter, rows
    last[0] = step if status == OK else -1.0
    return status


@internal
def _no_margin(workspace: Any, method: Any, loop: Any, k: int) -> float:
    """What counts as none of the margin of friction of closed contact k, which has begun the step with no more than
    that: blocks that ride on one another at exactly the limit, or slide with no speed. 0 of any other contact, whose
    margin has a root."""
    if not is_held(workspace, k):
        none, start = no_sliding(workspace, k), mat(loop.watch, workspace.n_contacts, WATCH)[k, 3]
        return none if memories_at(workspace.memory, workspace.n_contacts)[k].slide_mode * start <= none else 0.0
    lam = history_row(workspace, method, 0)[4 * workspace.n_ext :]
    limit = friction_limit(workspace, k, -lam[ivec(workspace.contact_rows, workspace.n_contacts)[k]])
    held = limit - held_friction(workspace, k, lam) <= SLIP_EXCESS * limit
    return SLIP_EXCESS * friction_limit(workspace, k, vec(workspace.monitor, workspace.n_contacts)[k]) if held else 0.0


@internal
def trial_value(
    drive: Any,
    workspace: Any,
    method: Any,
    loop: Any,
    k: int,
    what: int,
    sign: float,
    slack: float,
    step: float,
    full: float,
) -> Any:
    """(status, value) at the end of a step of this size of what is positive before the event."""
    status = make_trial(drive, workspace, method, loop, step, full)
    if status != OK:
        return status, 0.0
    row = ivec(workspace.contact_rows, workspace.n_contacts)[k]
    if what == GAP_ROOT or what == OVERLAP_ROOT:
        return OK, sign * vec(workspace.phi, workspace.m_ext)[row] + slack
    if what == CLOSING_ROOT:
        return OK, vec(workspace.phidd, workspace.m_ext)[row] + slack
    memory = memories_at(workspace.memory, workspace.n_contacts)[k]
    force, strongest = (
        sign * vec(workspace.monitor, workspace.n_contacts)[k],
        force_level(workspace) / vec(workspace.row_scale, workspace.m_ext)[row],
    )
    if (
        memory.mode == CLOSED
        and vec(workspace.contact_sticking, workspace.n_contacts)[k] > 0.0
        and memory.slide_mode != IDLE
    ):
        left, fastest = friction_margin(workspace, k) + _no_margin(workspace, method, loop, k), rate_size(workspace, k)
        if not is_held(workspace, k) and fastest > 0.0:
            # speeds beside forces, each in parts of its scale: what is small does not depend on the units
            left *= strongest / fastest
        force = min(force, left)
    before = mat(loop.watch, workspace.n_contacts, WATCH)[k, 2]
    margin = implied_margin(workspace, k, before) if method.exact != 0 else 1.0
    if margin < 1.0:
        force = min(force, strongest * margin)
    return OK, force
