"""Compiled evaluation of the system at its current point: one pass over all kernels."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..compiled.kernels import CONSTRAINTS, ENERGY, POWER, RESIDUAL, TANGENT, batch_at, call_kernel
from ..compiled.views import ivec, mat, vec
from ..state.modes import CLOSED, GAP_START, MEMORY_SIZE, MODE
from ..state.workspace_records import COUNTERS_SIZE, EVALUATIONS, call_evaluate
from .compatibility import write_compatibility


@internal
def _hold_gaps(ws: Any) -> None:
    """Closed contacts hold their gaps where they have closed: none touches without rounding, and where contacts repeat
    each other nearly, to bring all of these gaps to zero would take motions of many times their size."""
    memory, rows, phi = (
        mat(ws.memory, ws.n_contacts, MEMORY_SIZE),
        ivec(ws.contact_rows, ws.n_contacts),
        vec(ws.phi, ws.m_ext),
    )
    looked = ivec(ws.looked, ws.n_contacts + 1)
    for p in range(looked[0]):
        k = looked[p + 1]
        if memory[k, MODE] == CLOSED:
            phi[rows[k]] -= memory[k, GAP_START]


@internal
def all_kernels(ws: Any, job: int) -> None:
    """Ask every kernel for `job` at the current point; for CONSTRAINTS those with constraint rows for RESIDUAL."""
    kernels = ivec(ws.kernels, ws.n_kernels)
    batches = ivec(ws.batches, ws.n_kernels)
    t = vec(ws.t, 1)[0]
    for k in range(ws.n_kernels):
        batch = batch_at(batches[k])
        if job != CONSTRAINTS:
            call_kernel(kernels[k], job, t, batch)
        elif batch.nrow > 0:
            call_kernel(kernels[k], RESIDUAL, t, batch)
    if job == RESIDUAL or job == CONSTRAINTS:
        _hold_gaps(ws)


@compiled
def evaluate_residuals(ws: Any) -> None:
    """r = M a + Phi_q^T lam - Q, and the constraints at position, velocity and acceleration level."""
    r = vec(ws.r, ws.n_ext)
    for i in range(ws.n_ext):
        r[i] = 0.0
    call_evaluate(ws.evaluate_function, ws, RESIDUAL)
    ivec(ws.counters, COUNTERS_SIZE)[EVALUATIONS] += 1


@internal
def evaluate_constraints(ws: Any) -> None:
    """The constraints at all levels, where that is much cheaper than all residuals: then r means nothing
    (`ws.part_first` tells)."""
    if ws.part_first == 0:
        evaluate_residuals(ws)
    else:
        call_evaluate(ws.evaluate_function, ws, CONSTRAINTS)


@compiled
def evaluate_tangent(ws: Any, c_q: float, c_v: float) -> None:
    """values = [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] at the current point."""
    coef = vec(ws.coef, 2)
    coef[0], coef[1] = c_q, c_v
    values = vec(ws.values, ws.n_values)
    for i in range(ws.n_values):
        values[i] = 0.0
    call_evaluate(ws.evaluate_function, ws, TANGENT)
    write_compatibility(ws, False)


@compiled
def evaluate_power(ws: Any) -> None:
    """Rates of the work accounts, into the last entries of a."""
    if ws.n_work == 0:
        return
    a = vec(ws.a, ws.n_ext)
    for i in range(ws.n_ext - ws.n_work, ws.n_ext):
        a[i] = 0.0
    call_evaluate(ws.evaluate_function, ws, POWER)


@compiled
def evaluate_energy(ws: Any) -> None:
    """Kinetic, potential and strain energy, J."""
    energy = vec(ws.energy, 3)
    energy[:] = 0.0
    call_evaluate(ws.evaluate_function, ws, ENERGY)


@internal
def recorded_norm(ws: Any, address: int) -> float:
    """Largest magnitude among the active and the redundant rows of phi, phid or phidd; NaN counts as infinite."""
    largest = 0.0
    x = vec(address, ws.m_ext)
    active, redundant = ivec(ws.active, ws.m_act), ivec(ws.redundant, ws.n_redundant)
    for i in range(ws.m_act + ws.n_redundant):
        y = abs(x[active[i]] if i < ws.m_act else x[redundant[i - ws.m_act]])
        if not y <= largest:
            largest = y if y > largest else np.inf
    return largest


@compiled
def constraint_norm(ws: Any, address: int) -> float:
    """Largest magnitude among the active rows of phi, phid or phidd, in parts of their scales; NaN counts as
    infinite."""
    x, row_scale = vec(address, ws.m_ext), vec(ws.row_scale, ws.m_ext)
    active = ivec(ws.active, ws.m_act)
    largest = 0.0
    for i in range(ws.m_act):
        y = abs(x[active[i]]) / row_scale[active[i]]
        if y > largest:
            largest = y
        elif y != y:
            return np.inf
    return largest
