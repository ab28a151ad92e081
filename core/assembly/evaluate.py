"""Compiled evaluation of the system at its current point: one pass over all kernels."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..compiled.kernels import CONSTRAINTS, ENERGY, POWER, RESIDUAL, TANGENT, batch_at, call_kernel
from ..compiled.views import ivec, vec
from ..state.modes import CLOSED, memories_at
from ..state.workspace_records import call_evaluate, counters_at
from .redundant_reactions import write_compatibility


@internal
def _hold_gaps(workspace: Any) -> None:
    """Closed contacts hold their gaps where they have closed: none touches without rounding, and where contacts repeat
    each other nearly, to bring all of these gaps to zero would take motions of many times their size."""
    memory, rows, phi = (
        memories_at(workspace.memory, workspace.n_contacts),
        ivec(workspace.contact_rows, workspace.n_contacts),
        vec(workspace.phi, workspace.m_ext),
    )
    looked = ivec(workspace.looked, workspace.n_contacts + 1)
    for p in range(looked[0]):
        k = looked[p + 1]
        if memory[k].mode == CLOSED:
            phi[rows[k]] -= memory[k].closed_gap


@internal
def all_kernels(workspace: Any, job: int) -> None:
    """Ask every kernel for `job` at the current point; for CONSTRAINTS those with constraint rows for RESIDUAL."""
    kernels = ivec(workspace.kernels, workspace.n_kernels)
    batches = ivec(workspace.batches, workspace.n_kernels)
    t = vec(workspace.t, 1)[0]
    for k in range(workspace.n_kernels):
        batch = batch_at(batches[k])
        if job != CONSTRAINTS:
            call_kernel(kernels[k], job, t, batch)
        elif batch.nrow > 0:
            call_kernel(kernels[k], RESIDUAL, t, batch)
    if job == RESIDUAL or job == CONSTRAINTS:
        _hold_gaps(workspace)


@compiled
def evaluate_residuals(workspace: Any) -> None:
    """r = M a + Phi_q^T lam - Q, and the constraints at position, velocity and acceleration level."""
    r = vec(workspace.r, workspace.n_ext)
    for i in range(workspace.n_ext):
        r[i] = 0.0
    call_evaluate(workspace.evaluate_function, workspace, RESIDUAL)
    counters_at(workspace.counters).evaluations += 1


@internal
def evaluate_constraints(workspace: Any) -> None:
    """The constraints at all levels, where that is much cheaper than all residuals: then r means nothing
    (`workspace.part_first` tells)."""
    if workspace.part_first == 0:
        evaluate_residuals(workspace)
    else:
        call_evaluate(workspace.evaluate_function, workspace, CONSTRAINTS)


@compiled
def evaluate_tangent(workspace: Any, c_q: float, c_v: float) -> None:
    """values = [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] at the current point."""
    coef = vec(workspace.coef, 2)
    coef[0], coef[1] = c_q, c_v
    values = vec(workspace.values, workspace.n_values)
    for i in range(workspace.n_values):
        values[i] = 0.0
    call_evaluate(workspace.evaluate_function, workspace, TANGENT)
    write_compatibility(workspace, False)


@compiled
def evaluate_power(workspace: Any) -> None:
    """Rates of the work accounts, into the last entries of a."""
    if workspace.n_work == 0:
        return
    a = vec(workspace.a, workspace.n_ext)
    for i in range(workspace.n_ext - workspace.n_work, workspace.n_ext):
        a[i] = 0.0
    call_evaluate(workspace.evaluate_function, workspace, POWER)


@compiled
def evaluate_energy(workspace: Any) -> None:
    """Kinetic, potential and strain energy, J."""
    energy = vec(workspace.energy, 3)
    energy[:] = 0.0
    call_evaluate(workspace.evaluate_function, workspace, ENERGY)


@internal
def recorded_norm(workspace: Any, address: int) -> float:
    """Largest magnitude among the active and the redundant rows of phi, phid or phidd; NaN counts as infinite."""
    largest = 0.0
    x = vec(address, workspace.m_ext)
    active, redundant = ivec(workspace.active, workspace.m_act), ivec(workspace.redundant, workspace.n_redundant)
    for i in range(workspace.m_act + workspace.n_redundant):
        y = abs(x[active[i]] if i < workspace.m_act else x[redundant[i - workspace.m_act]])
        if not y <= largest:
            largest = y if y > largest else np.inf
    return largest


@compiled
def constraint_norm(workspace: Any, address: int) -> float:
    """Largest magnitude among the active rows of phi, phid or phidd, in parts of their scales; NaN counts as
    infinite."""
    x, row_scale = vec(address, workspace.m_ext), vec(workspace.row_scale, workspace.m_ext)
    active = ivec(workspace.active, workspace.m_act)
    largest = 0.0
    for i in range(workspace.m_act):
        y = abs(x[active[i]]) / row_scale[active[i]]
        if y > largest:
            largest = y
        elif y != y:
            return np.inf
    return largest
