"""The history of a step in frames that turn with the bodies (`stage/corotating.py`), and how far they may turn."""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..model.rotation3d import space_rate
from ..stage.corotating import ANCHOR, OMEGA, POINT, enter, four_of, plus_times, product, put_four, rotation_of
from ..state.method_records import CARRIES, CHOICE_SIZE, ESTIMATE, NEXT_K, RING_SIZE, call_step
from ..state.workspace_records import CONTROL_SIZE, EXACTNESS, NEWTON_TOLERANCE, OK, REANALYZE, SPIN_SIZE
from .history import history_row, history_time, row_index

LARGEST_TURN = 0.4
"""By which a body may turn in a step under error control, rad: a sixteenth of a turn. What is asked for between steps
is interpolated in p, to 1e-13 then."""
MOST_TURN = 1.0
"""Beyond which a body's attitude stays in the frame of space: the outer loop would not converge."""
FAST, FINER = 0.5, 1e-4
"""Part of LARGEST_TURN beyond which it is the turn that limits the step, and not the error; by how much finer the two
loops solve then. What they leave would be the largest error, and energy would drift with it. It costs nothing: the
frames predict such steps so well that the iterations begin there, or nearly."""


@internal
def _begin(ws: Any, ms: Any, t: float) -> None:
    """Choose how the frames turn until t, the end of the step, and put the history that is in them in its place."""
    n, row = ws.n_ext, history_row(ws, ms, 0)
    h = t - history_time(ms, 0)
    spins, spinning = mat(ws.spin, ws.n_spins, SPIN_SIZE), ivec(ws.spinning, ws.n_spins)
    for k in range(ws.n_spins):
        i = spinning[k]
        w = space_rate(four_of(row, i), four_of(row, n + i))
        within = 2.0 * h * np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) <= MOST_TURN
        for j in range(3):
            spins[k, OMEGA + j] = w[j] if within else 0.0
        spins[k, ANCHOR] = t
    rows, carries = mat(ws.turned, ms.capacity, ws.row_length), vec(ms.parameters, 8)[CARRIES] != 0.0
    for back in range(ivec(ms.ring, RING_SIZE)[1]):
        row, to = history_row(ws, ms, back), rows[row_index(ms, back)]
        for i in range(ws.row_length):
            to[i] = row[i]
        q, v, a, aux = to[:n], to[n : 2 * n], to[2 * n : 3 * n], to[3 * n : 4 * n]
        at = history_time(ms, back)
        for k in range(ws.n_spins):
            i = spinning[k]
            # what a formula carries turns as accelerations do
            carried = plus_times(four_of(aux, i), four_of(a, i), -1.0)
            enter(spins[k], at, q, v, a, i)
            if back == 0 and carries:
                own = product(rotation_of(spins[k], t - at), carried)
                put_four(aux, i, plus_times(four_of(a, i), own, 1.0))
    ms.history, ws.turned = ws.turned, ms.history


@internal
def _end(ws: Any, ms: Any, done: bool) -> None:
    """The history in space again, and, where the step is `done`, the workspace's point."""
    n = ws.n_ext
    ms.history, ws.turned = ws.turned, ms.history
    if not done:
        return
    q, v, a, aux = vec(ws.q, n), vec(ws.v, n), vec(ws.a, n), vec(ws.aux, n)
    for k in range(ws.n_spins):
        i, spin = ivec(ws.spinning, ws.n_spins)[k], mat(ws.spin, ws.n_spins, SPIN_SIZE)[k]
        if vec(ms.parameters, 8)[CARRIES] != 0.0:
            carried = plus_times(four_of(aux, i), four_of(a, i), -1.0)
            put_four(aux, i, plus_times(four_of(spin, POINT + 8), carried, 1.0))
        put_four(q, i, four_of(spin, POINT))
        put_four(v, i, four_of(spin, POINT + 4))
        put_four(a, i, four_of(spin, POINT + 8))


@internal
def turn_error(ws: Any, ms: Any, h: float, order: float) -> float:
    """Error norm of a formula of this order that lets a step turn the fastest body by LARGEST_TURN."""
    n, row, largest = ws.n_ext, history_row(ws, ms, 0), 0.0
    for k in range(ws.n_spins):
        i = ivec(ws.spinning, ws.n_spins)[k]
        w = space_rate(four_of(row, i), four_of(row, n + i))
        largest = max(largest, w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    return (2.0 * h * np.sqrt(largest) / LARGEST_TURN) ** (order + 1.0)


@internal
def step_at_rest(ws: Any, ms: Any, step: int, h: float) -> int:
    """The step of a Runge-Kutta formula at this address: in space. Its stages would have dependent coordinates of their
    own in turning frames, and cost it its order."""
    for k in range(ws.n_spins):
        for j in range(3):
            mat(ws.spin, ws.n_spins, SPIN_SIZE)[k, OMEGA + j] = 0.0
    return call_step(step, ws, ms, h)


@internal
def step_in_frames(ws: Any, ms: Any, step: int, h: float) -> int:
    """The step at this address from the newest row by h, with attitudes in turning frames where there are some."""
    if ws.n_spins == 0:
        return call_step(step, ws, ms, h)
    error, control = vec(ms.error, 2), vec(ws.control, CONTROL_SIZE)
    newton, exactness = control[NEWTON_TOLERANCE], control[EXACTNESS]
    fast = vec(ms.parameters, 8)[ESTIMATE] != 0.0 and turn_error(ws, ms, h, 0.0) > FAST
    finer = FINER if fast else 1.0
    while True:
        control[NEWTON_TOLERANCE], control[EXACTNESS] = finer * newton, finer * exactness
        _begin(ws, ms, history_time(ms, 0) + h)
        status = call_step(step, ws, ms, h)
        _end(ws, ms, status == OK)
        if status == OK or status == REANALYZE or finer == 1.0:
            break
        # rounding does not let the loops come so far: where a parameter passes zero its weight is small
        finer = 1.0
    control[NEWTON_TOLERANCE], control[EXACTNESS] = newton, exactness
    error[0] = max(error[0], turn_error(ws, ms, h, error[1]))
    return status


@internal
def select_in_frames(ws: Any, ms: Any, select: int, h: float) -> bool:
    """Whether the function at this address, which sees the same history as a step does, proposes other steps k."""
    if ws.n_spins > 0:
        _begin(ws, ms, history_time(ms, 0))
    status = call_step(select, ws, ms, h)
    if ws.n_spins > 0:
        _end(ws, ms, False)
    return bool(status == OK and vec(ms.choice, CHOICE_SIZE)[NEXT_K] > 0.0)
