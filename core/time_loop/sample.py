"""A sample: one recorded row of numbers at the current point of the workspace.

Columns: t; q, v, a (n each); lam (m); force, gap, gap rate, mode, impact impulse, impact loss, friction force and
sliding velocity of each contact; kinetic, potential, strain energy; work accounts; residuals at position, velocity and
acceleration level; the pair of each slot of contact pools.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_energy, recorded_norm
from ..assembly.sticking_force import in_space, torque_of_three
from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..event_detection.joint_loads import share_joint_loads
from ..state.modes import ACTIVE, AT_ZERO_FORCE, CLOSED, OPEN, memories_at


def sample_length(n: int, m: int, contacts: int, work: int, slots: int) -> int:
    """Number of columns."""
    return 1 + 3 * n + m + 8 * contacts + 3 + work + 3 + slots


@compiled
def write_sample(workspace: Any, out: Any) -> None:
    """Fill one row; the residuals of the current point must have been evaluated."""
    write_row(workspace, out, True)


@internal
def write_row(workspace: Any, out: Any, energies: bool) -> None:
    """The same; with the `energies`, or with what was known of them."""
    n, m, contacts = workspace.n, workspace.m_ext - 1, workspace.n_contacts
    q, v, a = vec(workspace.q, workspace.n_ext), vec(workspace.v, workspace.n_ext), vec(workspace.a, workspace.n_ext)
    out[0] = vec(workspace.t, 1)[0]
    for i in range(n):
        out[1 + i] = q[i]
        out[1 + n + i] = v[i]
        out[1 + 2 * n + i] = a[i]
    at = 1 + 3 * n
    lam = vec(workspace.lam, workspace.m_ext)
    active = ivec(workspace.active, workspace.m_act + workspace.n_implied)
    for i in range(m):
        out[at + i] = 0.0
    for i in range(workspace.m_act + workspace.n_implied):
        out[at + active[i]] = lam[active[i]]
    if workspace.n_redundant > 0:
        share_joint_loads(workspace, out[at : at + m])
    at += m
    if contacts:
        monitor = vec(workspace.monitor, 2 * contacts)
        slide_rows = ivec(workspace.contact_slide_rows, contacts)
        memory = memories_at(workspace.memory, contacts)
        rows, release = ivec(workspace.contact_rows, contacts), ivec(workspace.contact_release, contacts)
        phi, phid = vec(workspace.phi, workspace.m_ext), vec(workspace.phid, workspace.m_ext)
        for k in range(contacts):
            mode = memory[k].mode
            # of an open one the mean force while instants are stepped through, else 0; where a force jumps, the point
            # at which it is to end lies behind the jump, and what its equations say there would pull
            force = monitor[k] if mode == ACTIVE or mode == CLOSED else memory[k].step_force[0]
            pushes = mode == CLOSED or (mode == ACTIVE and release[k] >= AT_ZERO_FORCE)
            out[at + k] = max(force, 0.0) if pushes else force
            out[at + contacts + k] = phi[rows[k]]
            out[at + 2 * contacts + k] = phid[rows[k]]
            out[at + 3 * contacts + k] = CLOSED if mode == OPEN and memory[k].step_force[0] > 0.0 else mode
            out[at + 4 * contacts + k] = memory[k].impulse_jump
            out[at + 5 * contacts + k] = memory[k].loss_jump
            with_friction = slide_rows[k] >= 0
            acts = with_friction and (mode == ACTIVE or mode == CLOSED)
            out[at + 6 * contacts + k] = monitor[contacts + k] if acts else _pushed_along(workspace, k)
            out[at + 7 * contacts + k] = phid[slide_rows[k]] if with_friction else 0.0
            if vec(workspace.contact_sticking, contacts)[k] > 0.0 and in_space(workspace, k):
                # in space: how fast it slides
                x, y = phid[slide_rows[k]], phid[slide_rows[k] + 1]
                slides = mode == CLOSED and abs(memory[k].slide_mode) == 1.0
                out[at + 7 * contacts + k] = y if slides else np.sqrt(x * x + y * y)
            if ivec(workspace.contact_companion, contacts)[k] < 0:
                # (friction with three tangents: its size and components, where a normal force and friction stand)
                x, y, z = torque_of_three(workspace, k - 1)
                out[at + k - 1], out[at + k], out[at + 6 * contacts + k] = x, y, z
                out[at + 6 * contacts + k - 1] = np.sqrt(x * x + y * y + z * z)
        at += 8 * contacts
    if energies:
        evaluate_energy(workspace)
    energy = vec(workspace.energy, 3)
    for i in range(3):
        out[at + i] = energy[i]
    at += 3
    for i in range(workspace.n_work):
        out[at + i] = v[workspace.n_ext - workspace.n_work + i]
    at += workspace.n_work
    out[at] = recorded_norm(workspace, workspace.phi)
    out[at + 1] = recorded_norm(workspace, workspace.phid)
    out[at + 2] = recorded_norm(workspace, workspace.phidd)
    pairs = ivec(workspace.slot_pair, workspace.n_slots)
    for slot in range(workspace.n_slots):
        out[at + 3 + slot] = pairs[slot]


@internal
def _pushed_along(workspace: Any, k: int) -> float:
    """Mean force along the tangents of contact k in the last step of impulses, N."""
    memory = memories_at(workspace.memory, workspace.n_contacts)[k]
    first, second = memory.step_force[1], memory.step_force[2]
    return float(np.sqrt(first * first + second * second) if in_space(workspace, k) else first)


def empty_buffer(capacity: int, length: int) -> np.ndarray:
    """Room for `capacity` samples."""
    return np.zeros((capacity, length))
