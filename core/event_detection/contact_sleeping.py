"""Contacts that are far from touching are not evaluated.

An open contact adds nothing to the motion; all that is asked of it is whether its gap closes. Once that is large
against how far it can go in a step, the contact falls asleep with a margin: its gap, less an upper bound of its way in
every step from then on. It wakes before a step is accepted in which the margin would be used up. So whether a contact
sleeps changes no bit of the motion, and nothing of it is part of the state: whoever leaves the compiled run wakes all.
"""

from typing import Any

import numpy as np

from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, batch_at, call_kernel
from ..compiled.views import imat, ivec, mat, vec
from ..methods.history import history_row, history_time
from ..state.impact_law_codes import BY_FORCE
from ..state.modes import OPEN, memories_at
from ..state.run_records import WATCH
from ..state.workspace_records import call_evaluate
from .balls import MARKS, VALID
from .contact_evaluation import NEAR_KERNEL, NEAR_SIZE, SLEEPS, probe_of
from .root_bounds import way_of_gap

AWAKE, ASLEEP, DEEPLY = 0, 1, 2
"""A contact is evaluated; its margin is looked at; it is one of a pair that the broad phase looks after."""
FAR = 8.0
"""A contact falls asleep with a gap of this many ways that it can go in a step like the last one."""
TOGETHER = 16
"""Where more than one in so many contacts sleeps, all are woken together."""
PLAINLY = 1e-6
"""Of its row's scale: a smaller gap is never far. What an instant moves to meet the constraints is much less."""


@internal
def _evaluate_alone(workspace: Any, loop: Any, k: int, t: float, q: Any, v: Any, a: Any) -> None:
    """The rows of contact k at (q, v, a), to the probes' arrays."""
    batch = probe_of(loop, k)
    coord = ivec(batch.coord, batch.count * batch.ncoord)
    to_q, to_v, to_a = (
        vec(loop.probe_q, workspace.n_ext),
        vec(loop.probe_v, workspace.n_ext),
        vec(loop.probe_a, workspace.n_ext),
    )
    for j in range(batch.count * batch.ncoord):
        i = coord[j]
        to_q[i], to_v[i], to_a[i] = q[i], v[i], a[i]
    call_kernel(imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KERNEL], RESIDUAL, t, batch)


@internal
def look_now(workspace: Any, loop: Any, k: int) -> None:
    """The rows of contact k at the current point."""
    row, slide = (
        ivec(workspace.contact_rows, workspace.n_contacts)[k],
        ivec(workspace.contact_slide_rows, workspace.n_contacts)[k],
    )
    _evaluate_alone(
        workspace,
        loop,
        k,
        vec(workspace.t, 1)[0],
        vec(workspace.q, workspace.n_ext),
        vec(workspace.v, workspace.n_ext),
        vec(workspace.a, workspace.n_ext),
    )
    for to, come_from in (
        (workspace.phi, loop.probe_phi),
        (workspace.phid, loop.probe_phid),
        (workspace.phidd, loop.probe_phidd),
    ):
        values, looked = vec(to, workspace.m_ext), vec(come_from, workspace.m_ext)
        values[row] = looked[row]
        if slide >= 0:
            values[slide] = looked[slide]
            if in_space(workspace, k):
                values[slide + 1] = looked[slide + 1]


@internal
def wake(workspace: Any, method: Any, loop: Any, k: int) -> None:
    """Contact k is looked at again, from the newest row on."""
    ivec(workspace.sleeping, workspace.n_contacts)[k] = AWAKE
    row, slide = (
        ivec(workspace.contact_rows, workspace.n_contacts)[k],
        ivec(workspace.contact_slide_rows, workspace.n_contacts)[k],
    )
    start, n = history_row(workspace, method, 0), workspace.n_ext
    _evaluate_alone(workspace, loop, k, history_time(method, 0), start, start[n:], start[2 * n :])
    watch = mat(loop.watch, workspace.n_contacts, WATCH)
    rates, accelerations = vec(loop.probe_phid, workspace.m_ext), vec(loop.probe_phidd, workspace.m_ext)
    watch[k, 0], watch[k, 1], watch[k, 2] = vec(loop.probe_phi, workspace.m_ext)[row], rates[row], accelerations[row]
    if slide >= 0:
        watch[k, 3], watch[k, 4] = rates[slide], accelerations[slide]
    look_now(workspace, loop, k)


@internal
def show_elements(workspace: Any) -> None:
    """Let kernels go through the elements of those contacts alone that do not sleep deeply."""
    _show(workspace, 0, 0)


@internal
def show_pending(workspace: Any, pending: int, law: int) -> None:
    """Of these only those that are pending, closed, or forces, until `show_elements`: rows of open contacts are of no
    account while a step without events is solved for, nor while others are pushed apart. Addresses of (n_contacts,)
    int64."""
    _show(workspace, pending, law)


@internal
def _show(workspace: Any, pending: int, law: int) -> None:
    n, memory = workspace.n_contacts, memories_at(workspace.memory, workspace.n_contacts)
    sleeping, batches = ivec(workspace.sleeping, n), ivec(workspace.batches, workspace.n_kernels)
    for x in range(workspace.n_kernels):
        batch = batch_at(batches[x])
        if batch.shown == 0:
            continue
        shown, extra, count = ivec(batch.shown, batch.count + 1), imat(batch.extra, batch.count, batch.nextra), 0
        for e in range(batch.count):
            k = extra[e, 0]
            if sleeping[k] == DEEPLY:
                continue
            if pending == 0 or ivec(pending, n)[k] != 0 or memory[k].mode != OPEN or ivec(law, n)[k] == BY_FORCE:
                count += 1
                shown[count] = e
        shown[0] = count


@internal
def wake_all(workspace: Any, method: Any, loop: Any) -> None:
    """No contact sleeps any more, and the broad phase begins again."""
    n = workspace.n_contacts
    sleeping, looked, asleep = ivec(workspace.sleeping, n), ivec(workspace.looked, n + 1), 0
    for k in range(n):
        looked[k + 1] = k
        asleep += 1 if sleeping[k] != AWAKE else 0
    looked[0], ivec(loop.broad, MARKS)[VALID] = n, 0
    if TOGETHER * asleep > n:
        _wake_together(workspace, method, loop)
        return
    for k in range(n):
        if sleeping[k] != AWAKE:
            wake(workspace, method, loop, k)
    show_elements(workspace)


@internal
def _wake_together(workspace: Any, method: Any, loop: Any) -> None:
    """`wake` for all that sleep, by evaluations of the system at the newest row and at the current point."""
    n, m, count = workspace.n_ext, workspace.m_ext, workspace.n_contacts
    t, now, start = vec(workspace.t, 1), vec(workspace.t, 1)[0], history_row(workspace, method, 0)
    q, v, a, r = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.r, n)
    phi, phid, phidd = vec(workspace.phi, m), vec(workspace.phid, m), vec(workspace.phidd, m)
    monitor, sleeping = vec(workspace.monitor, 3 * count), ivec(workspace.sleeping, count)
    kept, levels, monitored, slept = np.empty((4, n)), np.empty((3, m)), monitor.copy(), sleeping.copy()
    kept[0], kept[1], kept[2], kept[3] = q, v, a, r
    levels[0], levels[1], levels[2] = phi, phid, phidd
    for k in range(count):
        sleeping[k] = AWAKE
    show_elements(workspace)
    for j in range(n):
        q[j], v[j], a[j] = start[j], start[n + j], start[2 * n + j]
    t[0] = history_time(method, 0)
    call_evaluate(workspace.evaluate_function, workspace, RESIDUAL)
    watch, rows = mat(loop.watch, count, WATCH), ivec(workspace.contact_rows, count)
    slides = ivec(workspace.contact_slide_rows, count)
    for k in range(count):
        if slept[k] == AWAKE:
            continue
        watch[k, 0], watch[k, 1], watch[k, 2] = phi[rows[k]], phid[rows[k]], phidd[rows[k]]
        if slides[k] >= 0:
            watch[k, 3], watch[k, 4] = phid[slides[k]], phidd[slides[k]]
    t[0] = now
    for j in range(n):
        q[j], v[j], a[j] = kept[0, j], kept[1, j], kept[2, j]
    call_evaluate(workspace.evaluate_function, workspace, RESIDUAL)
    for j in range(n):
        r[j] = kept[3, j]
    for k in range(count):
        if slept[k] == AWAKE:
            continue
        for row in (rows[k], slides[k], slides[k] + 1 if in_space(workspace, k) else -1):
            if row >= 0:
                levels[0, row], levels[1, row], levels[2, row] = phi[row], phid[row], phidd[row]
    for i in range(m):
        phi[i], phid[i], phidd[i] = levels[0, i], levels[1, i], levels[2, i]
    for i in range(3 * count):
        monitor[i] = monitored[i]


@internal
def look_at_all(workspace: Any, loop: Any) -> None:
    """The rows of sleeping contacts at the current point, for those who record them."""
    sleeping = ivec(workspace.sleeping, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        if sleeping[k] != AWAKE:
            look_now(workspace, loop, k)


@internal
def sleeps_on(workspace: Any, method: Any, loop: Any, k: int) -> bool:
    """True if contact k sleeps and its gap cannot close within the step that ends at the current point, for which
    `set_travel` and `broad_phase.keep_watch` have been called; else it is awake."""
    sleeping = ivec(workspace.sleeping, workspace.n_contacts)[k]
    if sleeping == AWAKE:
        return False
    if sleeping == DEEPLY or vec(loop.margin, workspace.n_contacts)[k] > way_of_gap(workspace, loop, k, 0):
        return True
    wake(workspace, method, loop, k)
    return False


@internal
def doze(workspace: Any, loop: Any) -> None:
    """The step that ends at the current point has been accepted: margins become smaller, and contacts that are far
    from touching fall asleep."""
    if loop.may_sleep == 0:
        return
    sleeping, margin = ivec(workspace.sleeping, workspace.n_contacts), vec(loop.margin, workspace.n_contacts)
    rows, scale, watch = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        vec(workspace.row_scale, workspace.m_ext),
        mat(loop.watch, workspace.n_contacts, WATCH),
    )
    memory, near = memories_at(workspace.memory, workspace.n_contacts), imat(loop.near, workspace.n_contacts, NEAR_SIZE)
    looked = ivec(workspace.looked, workspace.n_contacts + 1)
    for p in range(looked[0]):
        k = looked[p + 1]
        if sleeping[k] != AWAKE:
            margin[k] -= way_of_gap(workspace, loop, k, 0)
        elif memory[k].mode == OPEN and near[k, SLEEPS] != 0 and watch[k, 0] > PLAINLY * scale[rows[k]]:
            if watch[k, 0] > FAR * way_of_gap(workspace, loop, k, 0):
                sleeping[k], margin[k] = ASLEEP, watch[k, 0]
