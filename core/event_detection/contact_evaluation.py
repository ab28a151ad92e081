"""Looking at one contact at a point of the dense output of a step that is not accepted yet.

The motion is the polynomial of fifth degree in each coordinate through (q, v, a) of the newest row and of the
workspace's current point. Each contact has a batch of its own here, whose results go to arrays that nobody else reads:
looking changes nothing.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.evaluate import evaluate_residuals
from ..assembly.patterns import contacts_alone
from ..assembly.workspace import Workspace
from ..compiled.jit import internal
from ..compiled.kernels import BATCH, RESIDUAL, TANGENT, batch_at, call_kernel
from ..compiled.views import imat, ivec, mat, vec
from ..contacts.geometry_kinds import EQUATIONS, MAY_SLEEP, STOP
from ..contacts.stop3d import ACCOUNT
from ..methods.history import history_row, history_time
from ..state.run_records import clock_at

NEAR_SIZE = 3
NEAR_KIND, NEAR_KERNEL, SLEEPS = range(NEAR_SIZE)
"""Columns of `near`; SLEEPS: 1 for contacts that may fall asleep."""
BRACKET = 4
HAPPENS = 3
"""Columns of `brackets`: the place before an event, one beyond it and the deepest after it, in parts of the step; and
whether there is one."""
VIEW = 3
"""Gap (or sliding distance), rate and acceleration."""
BATCH_BYTES = BATCH.itemsize


def build_probes(workspace: Workspace) -> dict[str, NDArray[Any]]:
    """The arrays of the loop's record that `look` needs."""
    assembly, arrays = workspace.assembly, workspace.arrays
    n_ext, m_ext = len(arrays["q"]), len(arrays["phi"])
    own = {name: np.zeros(n_ext) for name in ("q", "v", "a", "r")}
    own |= {name: np.zeros(m_ext) for name in ("lam", "phi", "phid", "phidd")}
    own["monitor"] = np.zeros(len(arrays["monitor"]))
    count = max(len(assembly.contacts), 1)
    own["sleeping"] = np.zeros(count, dtype=np.int64)
    near, probes = np.zeros((count, NEAR_SIZE), dtype=np.int64), np.zeros(count, BATCH)
    near[:, NEAR_KIND] = EQUATIONS
    batches, tables = assembly.batches, [workspace.batch_table(number) for number in range(len(assembly.batches))]
    alone = contacts_alone(assembly)
    # a tangent of a contact alone: Phi_q goes to places of its own one after another, all else nowhere
    blocks = [(n * batches[x].coord.shape[1], batches[x].coord.shape[1], batches[x].row.shape[1])
              for x, _, n in alone if x is not None]  # fmt: skip
    gradients = max((wide * rows for wide, _, rows in blocks), default=0)
    all_of_it = max((wide * max(width, rows) for wide, width, rows in blocks), default=0)
    places, nowhere = np.arange(gradients), np.full(all_of_it, gradients, dtype=np.int64)
    own |= {"values": np.zeros(gradients + 1), "places": places, "nowhere": nowhere}
    common = {name: own[name].ctypes.data for name in own if name not in ("places", "nowhere")}
    common |= {"slot_j": places.ctypes.data, "slot_s": nowhere.ctypes.data, "slot_jt": nowhere.ctypes.data}
    common |= {"line": 0, "shown": 0, "n_values": gradients + 1}
    massless = assembly.massless_contacts
    for number, batch in enumerate(batches):
        here = np.array([(k, first, n) for k, (x, first, n) in enumerate(alone) if x == number], dtype=np.int64)
        if not len(here):
            continue
        of, first = here[:, 0], here[:, 1]
        probes[of] = tables[number]
        probes["count"][of] = here[:, 2]
        for name, table in (("par", batch.par), ("coord", batch.coord), ("row", batch.row), ("extra", batch.extra)):
            probes[name][of] = table.ctypes.data + table.strides[0] * first
        for name, address in common.items():
            probes[name][of] = address
        kinds = [assembly.contacts[k].kind for k in of.tolist()]
        near[of, NEAR_KIND], near[of, NEAR_KERNEL] = kinds, batch.address
        near[of, SLEEPS] = [kind in MAY_SLEEP and k not in massless for k, kind in zip(of.tolist(), kinds, strict=True)]
    return {
        "near": near, "probes": probes.view(np.int64).reshape(count, -1),
        **{f"probe_{name}": array for name, array in own.items()},
        "travel": np.zeros((2, n_ext)), "brackets": np.zeros((count, BRACKET)), "margin": np.zeros(count),
    }  # fmt: skip


@internal
def probe_of(loop: Any, k: int) -> Any:
    """The batch of contact k alone."""
    return batch_at(loop.probes + BATCH_BYTES * k)


@internal
def between(q0: float, v0: float, a0: float, q1: float, v1: float, a1: float, h: float, s: float) -> Any:
    """(q, v, a) at s h of the polynomial through those at 0 and h."""
    d, v0, v1, a0, a1 = q1 - q0, h * v0, h * v1, h * h * a0, h * h * a1
    c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1
    c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1
    c5 = 6.0 * d - 3.0 * (v0 + v1) - 0.5 * (a0 - a1)
    q = q0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))))
    v = v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + 5.0 * s * c5)))
    a = a0 + s * (6.0 * c3 + s * (12.0 * c4 + 20.0 * s * c5))
    return q, v / h, a / (h * h)


@internal
def _look_at_system(workspace: Any, method: Any, loop: Any, row: int, h: float, s: float, view: Any) -> None:
    """`look` for a contact that can be evaluated with the whole system only; the workspace is put back."""
    n, m = workspace.n_ext, workspace.m_ext
    kept, levels, t = np.empty((4, n)), np.empty((3, m)), vec(workspace.t, 1)
    monitor = vec(workspace.monitor, 3 * max(workspace.n_contacts, 1)).copy()
    start, now = history_row(workspace, method, 0), t[0]
    q, v, a, r = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.r, n)
    phi, phid, phidd = vec(workspace.phi, m), vec(workspace.phid, m), vec(workspace.phidd, m)
    kept[0], kept[1], kept[2], kept[3] = q, v, a, r
    levels[0], levels[1], levels[2] = phi, phid, phidd
    for i in range(workspace.n):
        q[i], v[i], a[i] = between(start[i], start[n + i], start[2 * n + i], q[i], v[i], a[i], h, s)
    t[0] = history_time(method, 0) + s * h
    evaluate_residuals(workspace)
    view[0], view[1], view[2] = phi[row], phid[row], phidd[row]
    q[:] = kept[0]
    v[:] = kept[1]
    a[:] = kept[2]
    r[:] = kept[3]
    phi[:] = levels[0]
    phid[:] = levels[1]
    phidd[:] = levels[2]
    t[0] = now
    vec(workspace.monitor, len(monitor))[:] = monitor


@internal
def look(workspace: Any, method: Any, loop: Any, k: int, row: int, h: float, s: float, view: Any) -> None:
    """Value, rate and acceleration (3,) of row `row` of contact k at time s h of the step of size h."""
    kind = imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KIND]
    if kind == EQUATIONS:
        _look_at_system(workspace, method, loop, row, h, s, view)
        return
    batch, n = probe_of(loop, k), workspace.n_ext
    coord = ivec(batch.coord, batch.count * batch.ncoord)
    start = history_row(workspace, method, 0)
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    to_q, to_v, to_a = vec(loop.probe_q, n), vec(loop.probe_v, n), vec(loop.probe_a, n)
    for i in coord:
        to_q[i], to_v[i], to_a[i] = between(start[i], start[n + i], start[2 * n + i], q[i], v[i], a[i], h, s)
    if kind == STOP:
        # its turns so far, which say of which turn the angle is
        i = imat(batch.extra, batch.count, batch.nextra)[0, ACCOUNT]
        to_v[i] = start[n + i] + s * (v[i] - start[n + i])
    call_kernel(
        imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KERNEL],
        RESIDUAL,
        history_time(method, 0) + s * h,
        batch,
    )
    view[0], view[1], view[2] = (
        vec(loop.probe_phi, workspace.m_ext)[row],
        vec(loop.probe_phid, workspace.m_ext)[row],
        vec(loop.probe_phidd, workspace.m_ext)[row],
    )


@internal
def tell_gradients(workspace: Any, loop: Any, k: int) -> None:
    """Evaluate the gradients of contact k at the current point, in the mode that it has, for `gradient_alone`."""
    batch, n, coef = probe_of(loop, k), workspace.n_ext, vec(workspace.coef, 2)
    coord = ivec(batch.coord, batch.count * batch.ncoord)
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    to_q, to_v, to_a = vec(loop.probe_q, n), vec(loop.probe_v, n), vec(loop.probe_a, n)
    for i in coord:
        to_q[i], to_v[i], to_a[i] = q[i], v[i], a[i]
    values = vec(loop.probe_values, batch.n_values)
    for e in range(batch.count * batch.nrow * batch.ncoord):
        values[e] = 0.0
    coef[0] = coef[1] = 0.0
    call_kernel(
        imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KERNEL], TANGENT, vec(workspace.t, 1)[0], batch
    )


@internal
def gradient_alone(workspace: Any, loop: Any, k: int, row: int, out: Any) -> None:
    """Gradient (n,) of row `row`, one of contact k, of which `tell_gradients` has told."""
    batch = probe_of(loop, k)
    coord, rows = imat(batch.coord, batch.count, batch.ncoord), imat(batch.row, batch.count, batch.nrow)
    values = vec(loop.probe_values, batch.n_values)
    for i in range(workspace.n):
        out[i] = 0.0
    for e in range(batch.count):
        for j in range(batch.nrow):
            if rows[e, j] != row:
                continue
            begin = (e * batch.nrow + j) * batch.ncoord
            for i in range(batch.ncoord):
                if coord[e, i] < workspace.n:
                    out[coord[e, i]] += values[begin + i]


@internal
def add_gradient(
    workspace: Any, loop: Any, k: int, row: int, out: Any, mark: int, some: Any, marks: Any, count: int
) -> int:  # fmt: skip
    """Add the gradient of row `row`, one of contact k, to out (n,). Its coordinates that do not bear the mark get it in
    marks (n,), and go to `some`, of which there are `count`: how many there are then. Before, `tell_gradients` for what
    can be evaluated alone, `evaluate_tangent` for what cannot."""
    if can_look(loop, k):
        batch = probe_of(loop, k)
        coord, rows = imat(batch.coord, batch.count, batch.ncoord), imat(batch.row, batch.count, batch.nrow)
        values = vec(loop.probe_values, batch.n_values)
        for e in range(batch.count):
            for j in range(batch.nrow):
                if rows[e, j] != row:
                    continue
                begin = (e * batch.nrow + j) * batch.ncoord
                for i in range(batch.ncoord):
                    count = _add(coord[e, i], values[begin + i], workspace.n, out, mark, some, marks, count)
        return count
    start, values = ivec(workspace.gradient_start, workspace.m_ext), vec(workspace.values, workspace.n_values)
    columns, slots = ivec(workspace.gradient_col, start[row + 1]), ivec(workspace.gradient_slot, start[row + 1])
    for e in range(start[row], start[row + 1]):
        count = _add(columns[e], values[slots[e]], workspace.n, out, mark, some, marks, count)
    return count


@internal
def _add(i: int, value: float, n: int, out: Any, mark: int, some: Any, marks: Any, count: int) -> int:
    """Add a value to the coordinate i of out, and list this."""
    if i >= n or value == 0.0:
        return count
    out[i] += value
    if marks[i] == mark:
        return count
    marks[i], some[count] = mark, i
    return count + 1


@internal
def can_look(loop: Any, k: int) -> bool:
    """True if contact k can be evaluated alone."""
    return bool(ivec(loop.near, NEAR_SIZE * (k + 1))[NEAR_SIZE * k + NEAR_KERNEL] != 0)


@internal
def pull_alone(workspace: Any, loop: Any, k: int, row: int, out: Any) -> None:
    """What a unit normal force of contact k, whose row this is, does to the equations of motion at the current point:
    the generalized forces (n,), with all that comes with the normal force."""
    batch, n = probe_of(loop, k), workspace.n_ext
    coord = ivec(batch.coord, batch.count * batch.ncoord)
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    to_q, to_v, to_a, r = vec(loop.probe_q, n), vec(loop.probe_v, n), vec(loop.probe_a, n), vec(loop.probe_r, n)
    lam = vec(loop.probe_lam, workspace.m_ext)
    for j in range(workspace.n):
        out[j] = 0.0
    for j in range(batch.count * batch.ncoord):
        i = coord[j]
        to_q[i], to_v[i], to_a[i], r[i] = q[i], v[i], a[i], 0.0
    # all that a contact adds to the residual goes with its multipliers
    lam[row] = -1.0
    call_kernel(
        imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KERNEL], RESIDUAL, vec(workspace.t, 1)[0], batch
    )
    lam[row] = 0.0
    for j in range(batch.count * batch.ncoord):
        if coord[j] < workspace.n:
            out[coord[j]] = -r[coord[j]]


@internal
def state_of_pair(workspace: Any, method: Any, loop: Any, k: int, width: int, h: float, s: float, state: Any) -> None:
    """The `width` coordinates, velocities and accelerations of the first body of contact k and of the second, one after
    the other, at s h."""
    batch, n = probe_of(loop, k), workspace.n_ext
    coord, start = ivec(batch.coord, batch.ncoord), history_row(workspace, method, 0)
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    for j in range(2 * width):
        i = coord[j]
        at = j if j < width else j + 2 * width
        state[at], state[at + width], state[at + 2 * width] = between(
            start[i], start[n + i], start[2 * n + i], q[i], v[i], a[i], h, s
        )


@internal
def rate_alone(workspace: Any, loop: Any, k: int, row: int, t: float, i: int) -> float:
    """Rate of row `row` of contact k where it was looked at last, if coordinate i alone moved, with speed 1."""
    batch = probe_of(loop, k)
    coord, v = ivec(batch.coord, batch.count * batch.ncoord), vec(loop.probe_v, workspace.n_ext)
    for j in coord:
        v[j] = 0.0
    v[i] = 1.0
    call_kernel(imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KERNEL], RESIDUAL, t, batch)
    v[i] = 0.0
    return float(vec(loop.probe_phid, workspace.m_ext)[row])


@internal
def acceleration_at(workspace: Any, loop: Any) -> int:
    """Where a row of the history has the accelerations with which smooth motion goes on from it: behind a step of
    impulses those of the row are of the contacts' mean forces."""
    pushes = loop.only_impulses != 0 or clock_at(loop.clock).push_step != 0.0
    return int((3 if pushes else 2) * workspace.n_ext)


@internal
def set_travel(workspace: Any, method: Any, loop: Any, h: float) -> None:
    """Upper bounds of the way that each coordinate goes within the step of size h, and of h times its greatest speed:
    those of its polynomial's control points."""
    n, start, begins = workspace.n_ext, history_row(workspace, method, 0), acceleration_at(workspace, loop)
    q, v, a, travel = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), mat(loop.travel, 2, n)
    for i in range(workspace.n):
        first, last = 0.2 * h * start[n + i], 0.2 * h * v[i]
        second, fourth = first + 0.05 * h * h * start[begins + i], last - 0.05 * h * h * a[i]
        middle = q[i] - start[i] - first - second - fourth - last
        travel[0, i] = abs(first) + abs(second) + abs(middle) + abs(fourth) + abs(last)
        travel[1, i] = 5.0 * max(abs(first), abs(second), abs(middle), abs(fourth), abs(last))
