"""In which frame a body's attitude is integrated in a step: one that turns, or that of space.

A frame is a help where the motion is smoother in it: errors of a formula are those of the differences of its history.
So each step looks at its three newest rows in space, in a frame with the body's angular velocity, in one of regular
precession and in one that tumbles as the body would without torques, and takes a frame only if the accelerations there
differ much less. Else the body is integrated in space, as if there were no frames.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import batch_at
from ..compiled.views import imat, ivec, mat, vec
from ..model.rotation3d import body_rate, space_rate, times
from ..stage.corotating import enter, series_memory
from ..stage.frame_motion import INERTIA, SPEED, set_free, set_precession
from ..stage.free_rotation import free_acceleration, set_inertia
from ..stage.quaternions import four_of, put_four
from ..state.method_records import CHOICE_SIZE, K
from ..state.workspace_records import SPIN_SIZE, control_at
from .history import history_row, history_time
from .multistep import rows_available

MOST_TURN = 1.0
"""Beyond which a body's attitude stays in the frame of space: the outer loop would not converge."""
SMOOTHER = 0.1
"""Differences in a frame are at most this part of those in space: errors there have up to three times the frequency."""
NEGLIGIBLE, PART = 1e-10, 0.01
"""What a formula may err by in a step in space, rad, at most, to stay there, where rounding in a frame would be more
soon; and that as a part of the tolerance: what comes near to it holds the step."""
FREE, LONGEST = 0.1, 12.0
"""Part of the angular acceleration that torques may make for the motion without torques to be looked at, which takes
longer than others; and by how much the body may turn over the whole history, rad."""
SMOOTH = 1e-12
"""Differences in a frame that are this part of those in space, or less, are rounding: no other frame is looked at."""
UNIFORM, FREE_BODY, PRECESSION = 1, 2, 3
"""Motions of frames, in the order in which they are tried."""


@inlined
def _cross(a: Any, b: Any) -> Any:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def _dot(a: Any, b: Any) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def _acceleration(row: Any, n: int, i: int) -> Any:
    """Half the angular acceleration in space, of a row of the history."""
    return space_rate(four_of(row, i), four_of(row, 2 * n + i))


@internal
def _difference(method: Any, rows: int, second: Any) -> float:
    """Square of the divided difference of second derivatives at the newest rows, one in each row of `second`."""
    total = 0.0
    t, before = history_time(method, 0), history_time(method, 1) if rows > 1 else 0.0
    for j in range(4):
        found = second[0, j]
        if rows > 1:
            found = (found - second[1, j]) / (t - before)
        if rows > 2:
            oldest = history_time(method, 2)
            found = (found - (second[1, j] - second[2, j]) / (before - oldest)) / (t - oldest)
        total += found * found
    return total


@internal
def _roughness(workspace: Any, method: Any, spin: Any, i: int, rows: int) -> float:
    """How much accelerations differ in this frame; `_difference` of the newest rows there."""
    n, q, v = workspace.n_ext, vec(workspace.scratch, 4), vec(workspace.scratch + 4 * 8, 4)
    second = mat(workspace.scratch + 8 * 8, 3, 4)
    for back in range(rows):
        row = history_row(workspace, method, back)
        put_four(q, 0, four_of(row, i))
        put_four(v, 0, four_of(row, n + i))
        put_four(second[back], 0, four_of(row, 2 * n + i))
        enter(series_memory(workspace), spin, history_time(method, back), q, v, second[back], 0)
    return _difference(method, rows, second)


@internal
def _precession(workspace: Any, method: Any, i: int) -> Any:
    """Half the angular velocity of a regular precession: angular accelerations turn with it from row to row."""
    now = _acceleration(history_row(workspace, method, 0), workspace.n_ext, i)
    before = _acceleration(history_row(workspace, method, 1), workspace.n_ext, i)
    axis = _cross(before, now)
    size = np.sqrt(_dot(axis, axis))
    if size == 0.0:
        return 0.0, 0.0, 0.0
    part = 0.5 * np.arctan2(size, _dot(before, now)) / (size * (history_time(method, 0) - history_time(method, 1)))
    return part * axis[0], part * axis[1], part * axis[2]


@internal
def _set_free(workspace: Any, method: Any, spin: Any, k: int, t: float) -> bool:
    """Whether the frame in which body k would turn without torques is worth a look; it is in `spin` then."""
    i = ivec(workspace.attitudes, workspace.n_attitudes)[k]
    place = imat(workspace.attitude_bodies, workspace.n_attitudes, 2)[k]
    if place[0] < 0:
        return False
    batch = batch_at(ivec(workspace.batches, workspace.n_kernels)[place[0]])
    # behind the mass
    inertia = mat(batch.par, batch.count, batch.npar)[place[1], 1:7]
    n, row, at = workspace.n_ext, history_row(workspace, method, 0), history_time(method, 0)
    p = four_of(row, i)
    w, change = times(2.0, body_rate(p, four_of(row, n + i))), times(2.0, body_rate(p, four_of(row, 2 * n + i)))
    set_inertia(spin, INERTIA, inertia)
    free = free_acceleration(spin, INERTIA, w)
    off = (change[0] - free[0], change[1] - free[1], change[2] - free[2])
    longest = LONGEST / max(at - history_time(method, rows_available(method) - 1), abs(t - at))
    if not (_dot(off, off) < FREE * FREE * _dot(change, change) and _dot(w, w) < longest * longest):
        return False
    set_free(series_memory(workspace), spin, inertia, p, w, at, t)
    return True


@internal
def _set_frame(workspace: Any, method: Any, spin: Any, k: int, kind: int, axis: Any, w: Any, t: float) -> bool:
    """Whether there is a frame of this kind for body k, in `spin` then; half the body's angular velocity is w, `axis`
    that of its precession, in space."""
    if kind == FREE_BODY:
        return _set_free(workspace, method, spin, k, t)
    i, none = ivec(workspace.attitudes, workspace.n_attitudes)[k], (0.0, 0.0, 0.0)
    p = four_of(history_row(workspace, method, 0), i)
    if kind == UNIFORM:
        set_precession(spin, w, none, p, t)
    else:
        set_precession(spin, axis, (w[0] - axis[0], w[1] - axis[1], w[2] - axis[2]), p, t)
    return True


@internal
def _choose_frame(workspace: Any, method: Any, spin: Any, k: int, i: int, t: float) -> bool:
    """Whether a frame makes the motion of body k until t smoother, and which: it is in `spin` then."""
    n, row, at = workspace.n_ext, history_row(workspace, method, 0), history_time(method, 0)
    # of the newest step while it is looked at which formula is to follow
    h = t - at if t > at else at - history_time(method, 1)
    w = space_rate(four_of(row, i), four_of(row, n + i))
    size = h * np.sqrt(_dot(w, w))
    order = max(vec(method.choice, CHOICE_SIZE)[K], 2.0)
    negligible = min(NEGLIGIBLE, PART * control_at(workspace.control).rtol)
    if 2.0 * size > MOST_TURN or size ** (order + 1.0) < negligible:
        return False
    rows = min(rows_available(method), 3)
    second = mat(workspace.scratch, 3, 4)
    for back in range(rows):
        put_four(second[back], 0, four_of(history_row(workspace, method, back), 2 * n + i))
    in_space, none = _difference(method, rows, second), (0.0, 0.0, 0.0)
    least, best, last, axis = SMOOTHER * SMOOTHER * in_space, 0, 0, none
    for kind in (UNIFORM, FREE_BODY, PRECESSION):
        if kind == PRECESSION:
            if rows == 1:
                continue
            axis = _precession(workspace, method, i)
        if not _set_frame(workspace, method, spin, k, kind, axis, w, t):
            continue
        last = kind
        # only a precession turns faster than the body
        if kind == PRECESSION and not h * spin[SPEED] <= MOST_TURN:
            continue
        found = _roughness(workspace, method, spin, i, rows)
        if found < least:
            least, best = found, kind
        if found < SMOOTH * SMOOTH * in_space:
            break
    return best > 0 and (best == last or _set_frame(workspace, method, spin, k, best, axis, w, t))


@internal
def choose_frames(workspace: Any, method: Any, t: float) -> int:
    """The frames until t, the end of the step, and the bodies that are in them, to `spin` and `spinning`; their
    number. With t the time of the newest row it is the frames of another step like the last one."""
    count, spins = 0, mat(workspace.spin, workspace.n_attitudes, SPIN_SIZE)
    for k in range(workspace.n_attitudes):
        i = ivec(workspace.attitudes, workspace.n_attitudes)[k]
        if _choose_frame(workspace, method, spins[count], k, i, t):
            ivec(workspace.spinning, workspace.n_attitudes)[count] = i
            count += 1
    return count
