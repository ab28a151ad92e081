"""The history of a step in frames that turn with the bodies (`stage/corotating.py`), and how far these may turn."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..stage.corotating import enter, recall_point, series_memory
from ..stage.frame_motion import SPEED
from ..stage.quaternions import four_of, plus_times, put_four
from ..state.method_records import CARRIES, CHOICE_SIZE, ESTIMATE, NEXT_K, NEXT_NORM, PREDICTS, RING_SIZE, call_step
from ..state.workspace_records import (
    OK,
    REANALYZE,
    SPIN_SIZE,
    control_at,
    convergence_at,
)
from .frame_choice import choose_frames
from .frame_partition import partition_ends
from .history import history_row, history_time, row_index
from .multistep import rows_available
from .newmark import ALPHA

LARGEST_TURN = 0.4
"""By which a frame may turn in a step under error control, rad: a sixteenth of a turn. What is asked for between steps
is interpolated in p, to 1e-13 then, and to 1e-10 where a body tumbles or its history begins."""
FAST, FINER, COARSER = 0.5, 1e-4, 100.0
"""Part of LARGEST_TURN beyond which it is the turn that limits the step, and not the error; by how much finer the outer
loop solves then, and by how much less fine if it fails. What it leaves would be the largest error, and energy would
drift with it. It costs nothing: the frames predict such steps so well that the iterations begin there, or nearly."""
NOT_COUNTED = 1e30
"""Error weight of positions and velocities that are not counted."""


@internal
def _share_weights(workspace: Any, i: int, predicts: bool) -> None:
    """Error weights of a body's Euler parameters in a frame: those of their mean, as each is in turn. Positions that
    follow from the attitude swing where that does not: differences from what the history `predicts` are no errors."""
    n, dependent = workspace.n_ext, ivec(workspace.dependent, workspace.m_act)
    weight_q, weight_v = vec(workspace.weight_q, n), vec(workspace.weight_v, n)
    for weights in (weight_q, weight_v):
        mean = 0.25 * (weights[i] + weights[i + 1] + weights[i + 2] + weights[i + 3])
        put_four(weights, i, (mean, mean, mean, mean))
    for d in range(workspace.m_act if predicts else 0):
        l = dependent[d]
        if i - 3 <= l < i:
            weight_v[l] = NOT_COUNTED
            if d < workspace.m_held:
                weight_q[l] = NOT_COUNTED


@internal
def _carry(method: Any, a: Any, before: Any, aux: Any, i: int) -> None:
    """What Newmark's formula carries beside accelerations a, into aux[i] and the three behind it. It is a difference
    of accelerations in one frame, which those in another frame do not give: it is found anew there."""
    put_four(aux, i, plus_times(a, plus_times(a, before, -1.0), vec(method.parameters, 8)[ALPHA]))


@internal
def _begin(workspace: Any, method: Any, t: float, predicts: bool) -> None:
    """Choose the frames until t, the end of the step, and put the history that is in them in its place, if there are
    some."""
    n, count = workspace.n_ext, choose_frames(workspace, method, t)
    workspace.n_spins = count
    if count == 0:
        return
    spins, spinning = mat(workspace.spin, count, SPIN_SIZE), ivec(workspace.spinning, count)
    for k in range(count):
        _share_weights(workspace, spinning[k], predicts)
    rows = mat(workspace.turned, method.capacity, workspace.row_length)
    for back in range(ivec(method.ring, RING_SIZE)[1]):
        row, to = history_row(workspace, method, back), rows[row_index(method, back)]
        for i in range(workspace.row_length):
            to[i] = row[i]
        q, v, a = to[:n], to[n : 2 * n], to[2 * n : 3 * n]
        at = history_time(method, back)
        for k in range(count):
            enter(series_memory(workspace), spins[k], at, q, v, a, spinning[k])
    if vec(method.parameters, 8)[CARRIES] != 0.0:
        row, newest = history_row(workspace, method, 0), rows[row_index(method, 0)]
        for k in range(count):
            i = spinning[k]
            smooth = rows_available(method) > 1 and four_of(row, 3 * n + i) != four_of(row, 2 * n + i)
            before = rows[row_index(method, 1)] if smooth else newest
            _carry(method, four_of(newest, 2 * n + i), four_of(before, 2 * n + i), newest, 3 * n + i)
    method.history, workspace.turned = workspace.turned, method.history


@internal
def _end(workspace: Any, method: Any, done: bool) -> None:
    """The history in space again, and, where the step is `done`, the workspace's point."""
    n, count = workspace.n_ext, workspace.n_spins
    if count == 0:
        return
    method.history, workspace.turned = workspace.turned, method.history
    if done:
        recall_point(workspace)
        row = history_row(workspace, method, 0)
        for k in range(count if vec(method.parameters, 8)[CARRIES] != 0.0 else 0):
            i = ivec(workspace.spinning, count)[k]
            _carry(method, four_of(vec(workspace.a, n), i), four_of(row, 2 * n + i), vec(workspace.aux, n), i)
    workspace.n_spins = 0


@internal
def _fastest(workspace: Any) -> float:
    """Rate of the frame that turns fastest, rad/s."""
    rate = 0.0
    for k in range(workspace.n_spins):
        rate = max(rate, mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k, SPEED])
    return rate


@internal
def _turn_error(h: float, rate: float, order: float) -> float:
    """Error norm of a formula of this order that lets a frame of this rate turn by LARGEST_TURN in a step."""
    return (h * rate / LARGEST_TURN) ** (order + 1.0)


@internal
def step_in_frames(workspace: Any, method: Any, step: int, h: float) -> int:
    """The step at this address from the newest row by h, with attitudes in turning frames where these are a help.

    Fixed steps have none: frames come and go with the motion and the size of the steps, and errors would not fall with
    these as they do for one formula.
    """
    if workspace.n_attitudes == 0 or vec(method.parameters, 8)[ESTIMATE] == 0.0:
        return call_step(step, workspace, method, h)
    error, control = vec(method.error, 2), control_at(workspace.control)
    newton, exactness = control.newton_tolerance, control.exactness
    finer = FINER
    while True:
        _begin(workspace, method, history_time(method, 0) + h, vec(method.parameters, 8)[PREDICTS] != 0.0)
        fastest = _fastest(workspace)
        if h * fastest <= FAST * LARGEST_TURN:
            finer = 1.0
        control.newton_tolerance, control.exactness = finer * newton, finer * exactness
        status = call_step(step, workspace, method, h)
        if status == OK and partition_ends(workspace, h):
            convergence_at(workspace.rate).sensitivity = np.inf
        _end(workspace, method, status == OK)
        if status == OK or status == REANALYZE or finer == 1.0:
            break
        # rounding does not let the loops come so far: a dependent parameter passes zero
        finer = min(1.0, COARSER * finer)
    control.newton_tolerance, control.exactness = newton, exactness
    error[0] = max(error[0], _turn_error(h, fastest, error[1]))
    return status


@internal
def select_in_frames(workspace: Any, method: Any, select: int, h: float) -> bool:
    """Whether the function at this address proposes other steps k after a step of size h. It sees the same history as
    a step does."""
    choice = vec(method.choice, CHOICE_SIZE)
    _begin(workspace, method, history_time(method, 0), True)
    fastest = _fastest(workspace)
    status = call_step(select, workspace, method, h)
    _end(workspace, method, False)
    if status != OK or choice[NEXT_K] == 0.0:
        return False
    choice[NEXT_NORM] = max(choice[NEXT_NORM], _turn_error(h, fastest, choice[NEXT_K]))
    return True
