"""Has the force of a closed contact, or its margin of friction, changed its sign within a step and back?

Forces are no geometry: nothing bounds them but their own course. That is taken as a parabola through the ends of the
step and the row before; where the parabola, bent twice as much, comes to zero, the augmented system is solved at the
middle, and so on with halves. With a driver, no part is longer than what its time function says that steps may be.
"""

from typing import Any

import numpy as np

from ..assembly.sticking_force import friction_limit, held_friction, is_held
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_row, history_time
from ..methods.multistep import rows_available
from ..rounding import AS_LONG, SLIP_EXCESS
from ..state.modes import CLOSED, IDLE, memories_at
from ..state.run_records import WATCH, call_accelerations, clock_at
from ..state.workspace_records import OK
from .contact_evaluation import BRACKET, HAPPENS, VIEW, between, look
from .root_bounds import SHORTEST_PART

SAFETY = 2.0
"""How much more than its parabola a force may bend."""
DEPTH = 24
MOST_SOLUTIONS = 200
"""In one step."""
WANT = 2
"""Margins of a contact: its normal force, and what is left of its friction."""


@internal
def _least(m0: float, m1: float, bend: float) -> float:
    """The lowest value of the line from m0 to m1 less a parabola that is `bend` deep at the middle."""
    if not bend > 0.0:
        return min(m0, m1)
    s = 0.5 - (m1 - m0) / (8.0 * bend)
    return m0 - 4.0 * bend * s * s if 0.0 < s < 1.0 else min(m0, m1)


@internal
def _margins(workspace: Any, k: int, lam: Any) -> Any:
    """(normal force, sticking friction that is left) of closed contact k, N; infinite where there is none."""
    force, left = -lam[ivec(workspace.contact_rows, workspace.n_contacts)[k]], np.inf
    most = vec(workspace.contact_sticking, workspace.n_contacts)[k]
    if most > 0.0 and is_held(workspace, k):
        left = (1.0 + SLIP_EXCESS) * friction_limit(workspace, k, force) - held_friction(workspace, k, lam)
    return force, left


@internal
def _starting(workspace: Any, k: int, lam: Any) -> Any:
    """The margins at the newest row; infinite those that are not positive there: a contact that is held closed though
    it pulls a little, for it would come back at once (`_returns_at_once`), is looked at from the end of the step on."""
    force, left = _margins(workspace, k, lam)
    return force if force > 0.0 else np.inf, left if left > 0.0 else np.inf


@internal
def _bend(m0: float, m1: float, before: float, ratio: float) -> float:
    """Depth at the middle of the step, below the line through its ends, of the parabola through these and the value
    `before`, a step of `ratio` times this one's size earlier."""
    return SAFETY * 0.25 * abs((m1 - m0) - (m0 - before) / ratio) / (1.0 + ratio)


@internal
def _solve_at(workspace: Any, method: Any, loop: Any, h: float, s: float, margins: Any) -> bool:
    """The margins (n_contacts, WANT) at s h in the dense output of the step; the workspace is put back."""
    n, m = workspace.n_ext, workspace.m_ext
    q, v, a, r = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.r, n)
    lam, phi, phid, phidd = (
        vec(workspace.lam, m),
        vec(workspace.phi, m),
        vec(workspace.phid, m),
        vec(workspace.phidd, m),
    )
    monitor, t = vec(workspace.monitor, 3 * workspace.n_contacts), vec(workspace.t, 1)
    states, levels, forces, now = np.empty((4, n)), np.empty((4, m)), monitor.copy(), t[0]
    states[0], states[1], states[2], states[3] = q, v, a, r
    levels[0], levels[1], levels[2], levels[3] = lam, phi, phid, phidd
    start = history_row(workspace, method, 0)
    for i in range(workspace.n):
        q[i], v[i], a[i] = between(start[i], start[n + i], start[2 * n + i], q[i], v[i], a[i], h, s)
    for i in range(m):
        lam[i] += (1.0 - s) * (start[4 * n + i] - lam[i])
    t[0] = history_time(method, 0) + s * h
    solved = call_accelerations(loop.accelerations, workspace) == OK
    for k in range(workspace.n_contacts):
        margins[k, 0], margins[k, 1] = _margins(workspace, k, lam)
    q[:] = states[0]
    v[:] = states[1]
    a[:] = states[2]
    r[:] = states[3]
    lam[:] = levels[0]
    phi[:] = levels[1]
    phid[:] = levels[2]
    phidd[:] = levels[3]
    monitor[:] = forces
    t[0] = now
    return solved


@internal
def forces_may_vanish(workspace: Any, method: Any, loop: Any, h: float) -> bool:
    """True if a force or a margin of friction of a closed contact might be zero between the ends of the step."""
    start, lam = history_row(workspace, method, 0)[4 * workspace.n_ext :], vec(workspace.lam, workspace.m_ext)
    memory, longest = memories_at(workspace.memory, workspace.n_contacts), clock_at(loop.clock).max_step
    known = rows_available(method) > 1
    ratio = (history_time(method, 0) - history_time(method, 1)) / h if known else 1.0
    before = history_row(workspace, method, 1)[4 * workspace.n_ext :] if known else start
    looked = ivec(workspace.looked, workspace.n_contacts + 1)
    for p in range(looked[0]):
        k = looked[p + 1]
        if memory[k].mode != CLOSED:
            continue
        if not known or h > longest * (1.0 + AS_LONG):
            return True
        force, left = _starting(workspace, k, start)
        force_end, left_end = _margins(workspace, k, lam)
        force_before, left_before = _margins(workspace, k, before)
        if force < np.inf and _least(force, force_end, _bend(force, force_end, force_before, ratio)) < 0.0:
            return True
        if left < np.inf and _least(left, left_end, _bend(left, left_end, left_before, ratio)) < 0.0:
            return True
    return False


@internal
def forces_vanish(workspace: Any, method: Any, loop: Any, h: float, none: float) -> bool:
    """True if one does, falling below zero by more than rounding, and comes back; then the lines of `brackets` say
    where the first does.

    none : the work of a force, along the scale of its contact's row, below which it is none, J.
    """
    n = workspace.n_contacts
    rows, row_scale = ivec(workspace.contact_rows, n), vec(workspace.row_scale, workspace.m_ext)
    memory, brackets = memories_at(workspace.memory, n), mat(loop.brackets, n, BRACKET)
    places, values = np.empty(DEPTH + 1), np.empty((DEPTH + 2, n, WANT))
    bends, left = np.full((DEPTH + 1, n, WANT), np.inf), values[DEPTH + 1]
    longest, known = clock_at(loop.clock).max_step, rows_available(method) > 1
    ratio = (history_time(method, 0) - history_time(method, 1)) / h if known else 1.0
    start, lam = history_row(workspace, method, 0)[4 * workspace.n_ext :], vec(workspace.lam, workspace.m_ext)
    watched = np.empty((n, WANT), dtype=np.bool_)
    for k in range(n):
        left[k, 0], left[k, 1] = _starting(workspace, k, start)
        for j in range(WANT):
            watched[k, j] = memory[k].mode == CLOSED and left[k, j] < np.inf
        values[0, k, 0], values[0, k, 1] = _margins(workspace, k, lam)
        if known:
            before, friction_before = _margins(workspace, k, history_row(workspace, method, 1)[4 * workspace.n_ext :])
            bends[0, k, 0] = _bend(left[k, 0], values[0, k, 0], before, ratio)
            if left[k, 1] < np.inf:
                bends[0, k, 1] = _bend(left[k, 1], values[0, k, 1], friction_before, ratio)
    places[0], place, depth, solutions = 1.0, 0.0, 1, 0
    while depth > 0:
        right, long = values[depth - 1], places[depth - 1] - place
        doubtful, below = long * h > longest * (1.0 + AS_LONG), False
        for k in range(n):
            least_force = -none / row_scale[rows[k]]
            for j in range(WANT):
                if not watched[k, j]:
                    continue
                below = below or right[k, j] < least_force
                doubtful = doubtful or _least(left[k, j], right[k, j], bends[depth - 1, k, j]) < least_force
        if below:
            for k in range(n):
                least_force = -none / row_scale[rows[k]]
                if (watched[k, 0] and right[k, 0] < least_force) or (watched[k, 1] and right[k, 1] < least_force):
                    brackets[k, 0], brackets[k, 1], brackets[k, 2] = place, places[depth - 1], places[depth - 1]
                    brackets[k, HAPPENS] = 1.0
            return True
        if not doubtful or depth > DEPTH or solutions == MOST_SOLUTIONS:
            place = places[depth - 1]
            left[:] = right
            depth -= 1
            continue
        if depth == DEPTH + 1 or not _solve_at(workspace, method, loop, h, place + 0.5 * long, values[depth]):
            return False
        places[depth] = place + 0.5 * long
        solutions += 1
        for k in range(n):
            for j in range(WANT):
                if not watched[k, j]:
                    continue
                off = abs(values[depth, k, j] - 0.5 * (left[k, j] + right[k, j]))
                least = bends[depth - 1, k, j] / 16.0
                bend = SAFETY * 0.25 * off + (least if least < np.inf else 0.25 * abs(right[k, j] - left[k, j]))
                bends[depth - 1, k, j] = bends[depth, k, j] = bend
        depth += 1
    return False


@internal
def sliding_turns(workspace: Any, method: Any, loop: Any, k: int, h: float, none: float) -> bool:
    """True if the sliding velocity of closed contact k changes its sign within the step and back."""
    slide = memories_at(workspace.memory, workspace.n_contacts)[k].slide_mode
    row = ivec(workspace.contact_slide_rows, workspace.n_contacts)[k]
    if is_held(workspace, k) or slide == IDLE or row < 0:
        return False
    start = mat(loop.watch, workspace.n_contacts, WATCH)[k]
    stack, rests, left = np.empty((DEPTH + 1, VIEW)), np.empty(DEPTH + 1), np.empty(VIEW)
    view = np.empty(VIEW)
    left[0], left[1], left[2] = 0.0, slide * start[3], slide * start[4]
    stack[0, 0] = 1.0
    stack[0, 1] = slide * vec(workspace.phid, workspace.m_ext)[row]
    stack[0, 2] = slide * vec(workspace.phidd, workspace.m_ext)[row]
    rests[0], depth = 0.0, 1
    while depth > 0:
        right, long = stack[depth - 1], (stack[depth - 1, 0] - left[0]) * h
        c1, c2 = left[1] + long * left[2] / 3.0, right[1] - long * right[2] / 3.0
        lowered = min(c1, c2) - rests[depth - 1]
        if right[1] < -none and right[0] < 1.0:
            bracket = mat(loop.brackets, workspace.n_contacts, BRACKET)[k]
            bracket[0], bracket[1], bracket[2], bracket[HAPPENS] = left[0], right[0], right[0], 1.0
            return True
        if lowered >= -none or depth > DEPTH or long <= SHORTEST_PART * h:
            left[:] = right
            depth -= 1
            continue
        middle = left[0] + 0.5 * (right[0] - left[0])
        look(workspace, method, loop, k, row, h, middle, view)
        stack[depth, 0], stack[depth, 1], stack[depth, 2] = middle, slide * view[1], slide * view[2]
        off = abs(stack[depth, 1] - 0.125 * (left[1] + 3.0 * (c1 + c2) + right[1]))
        rests[depth - 1], rests[depth] = 0.7 * off, 0.7 * off
        depth += 1
    return False
