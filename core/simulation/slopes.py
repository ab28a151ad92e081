"""Derivatives of all channels at the workspace's point, compiled: along inputs, and in time.

What they are and why they are exact stands in `sensitivity.py` and `output_rates.py`, which call this; so does the C
code of runs without Python, which has all channels read before.
"""

import math
from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power, evaluate_residuals, evaluate_tangent
from ..assembly.redundant_reactions import factor_equations
from ..assembly.sticking_force import in_space
from ..compiled import types
from ..compiled.jit import compiled, internal
from ..compiled.views import imat, ivec, vec
from ..linalg import lu_at, solve
from ..model.derived import HEAD_SIZE, derive_row
from ..model.signals import INPUT_SIZE
from ..rounding import SENSITIVITY_SOLVED
from ..state.modes import ACTIVE, AT_LIMIT, CLOSED, STICKS, memories_at
from ..state.workspace_records import OK
from ..time_loop.drive import workspace_at
from ..time_loop.sample import write_sample
from .exchange_record import EXCHANGE, OF_GROUPS
from .read_channels import put_channels

LARGE = 2.0**40
"""s relative to what the residual holds without the change: its rounding is 2^-40 of itself beside the change."""
REFINEMENTS = 2
SLOPES_UNSOLVED = 1000
"""`along_inputs`: the system is too near a singular one, or a value is not finite."""

_REALS = types.Array(types.float64, 1, "C")
SLOPES_ARGUMENTS = (types.from_dtype(EXCHANGE), _REALS)
ALONG_ARGUMENTS = (types.from_dtype(EXCHANGE), _REALS, _REALS)


@internal
def _largest(x: Any) -> float:
    largest = 0.0
    for value in x:
        largest = max(largest, abs(value))
    return largest


@internal
def _channels_at(exchange: Any, workspace: Any, held: Any, out: Any) -> None:
    """All channels of the workspace's point as it stands: changes of what there is with the multipliers `held`."""
    evaluate_residuals(workspace)
    sample = vec(exchange.sample, exchange.sample_length)
    write_sample(workspace, sample)
    monitor, memory = (
        vec(workspace.monitor, 2 * workspace.n_contacts),
        memories_at(workspace.memory, workspace.n_contacts),
    )
    companion = ivec(workspace.contact_companion, workspace.n_contacts)
    for k in range(workspace.n_contacts):
        normal = 1 + 3 * workspace.n + workspace.m_ext - 1 + k
        if companion[k] < 0:
            continue  # (there stand components, which are linear)
        if companion[k] == 0 and (memory[k].mode == CLOSED or memory[k].mode == ACTIVE):
            # a change may have either sign, where a sample shows no force that pulls
            sample[normal] = monitor[k]
        along = normal + 6 * workspace.n_contacts
        sample[along] = _change_of_friction(workspace, k, held, sample[along])
    put_channels(exchange, out, ivec(exchange.wants, exchange.n_wants)[OF_GROUPS:])


@internal
def _change_of_friction(workspace: Any, k: int, held: Any, size: float) -> float:
    """How the friction force of contact k changes, N, of a change of this size. Of a closed contact in space it is the
    norm of a vector F, which changes by F.dF/|F|; where there is none, by |dF|."""
    memory, row = (
        memories_at(workspace.memory, workspace.n_contacts)[k],
        ivec(workspace.contact_slide_rows, workspace.n_contacts)[k],
    )
    if row < 0 or memory.mode != CLOSED or not in_space(workspace, k):
        return size
    lam, normal, state = (
        vec(workspace.lam, workspace.m_ext),
        ivec(workspace.contact_rows, workspace.n_contacts)[k],
        memory.slide_mode,
    )
    if state != STICKS and state != AT_LIMIT:
        # a part of the normal force, which is -lam
        return -size if lam[normal] > 0.0 else size
    across = normal if state == AT_LIMIT else row + 1
    part = memory.friction_ratio * memory.friction_ratio if state == AT_LIMIT else 1.0
    square = held[row] * held[row] + part * held[across] * held[across]
    change = held[row] * lam[row] + part * held[across] * lam[across]
    if ivec(workspace.contact_companion, workspace.n_contacts)[k] > 0:
        third = ivec(workspace.contact_slide_rows, workspace.n_contacts)[k + 1]
        square, change = square + held[third] * held[third], change + held[third] * lam[third]
    return change / math.sqrt(square) if square > 0.0 else size


@internal
def _solve_joints(workspace: Any, x: Any, load: Any) -> int:
    """[M Phi_q^T; Phi_q 0] x = (-load, 0), the matrix being factorised: OK or SLOPES_UNSOLVED."""
    n, size = workspace.n, workspace.n + workspace.m_act + workspace.n_implied
    lu = lu_at(workspace.kkt_query)
    count = lu.nnz
    row, col, values = ivec(workspace.entry_row, count), ivec(workspace.entry_col, count), vec(workspace.values, count)
    rhs, product, sizes = vec(workspace.rhs, size), np.zeros(size), np.zeros(size)
    x[:] = 0.0
    for sweep in range(2 + REFINEMENTS):
        product[:] = 0.0
        sizes[:] = 0.0
        for k in range(count):
            term = values[k] * x[col[k]]
            product[row[k]] += term
            sizes[row[k]] += abs(term)
        if sweep == 1 + REFINEMENTS:
            break
        for i in range(size):
            rhs[i] = (-load[i] if i < n else 0.0) - product[i]
        solve(lu, workspace.rhs)
        for i in range(size):
            x[i] += rhs[i]
    most = _largest(load)
    for i in range(size):
        left = abs((-load[i] if i < n else 0.0) - product[i])
        if not left <= SENSITIVITY_SOLVED * (most + sizes[i]):
            return SLOPES_UNSOLVED
    return OK


@compiled
def along_inputs(exchange: Any, seed: Any, found: Any) -> int:
    """Derivatives of all channels along `seed` (inputs,), whose largest number is 1: OK, SLOPES_UNSOLVED, or what
    `factor` returns for the pivots that there are. The workspace's point is changed."""
    workspace = workspace_at(exchange.workspace)
    n, multipliers = workspace.n, workspace.m_act + workspace.n_implied
    active = ivec(workspace.active, multipliers)
    a, lam, r = (
        vec(workspace.a, workspace.n_ext),
        vec(workspace.lam, workspace.m_ext),
        vec(workspace.r, workspace.n_ext),
    )
    inputs, held = vec(workspace.inputs, len(seed) * INPUT_SIZE), lam.copy()
    for k in range(len(seed)):
        if seed[k] != 0.0:
            for j in range(3):
                inputs[INPUT_SIZE * k + j] = 0.0
    a[:n] = 0.0
    lam[:] = 0.0
    evaluate_residuals(workspace)
    at_rest = r[:n].copy()
    size, most = 1.0, 1.0 + _largest(at_rest)
    while size < most:
        size *= 2.0
    size *= LARGE
    resting = np.zeros(exchange.n_channels)
    _channels_at(exchange, workspace, held, resting)
    for k in range(len(seed)):
        if seed[k] != 0.0:
            inputs[INPUT_SIZE * k] = size * seed[k]
    evaluate_residuals(workspace)
    load = (r[:n] - at_rest) / size
    evaluate_tangent(workspace, 0.0, 0.0)
    status = factor_equations(workspace, workspace.kkt_query)
    if status != OK:
        return int(status)
    change = np.zeros(n + multipliers)
    if _solve_joints(workspace, change, load) != OK:
        return SLOPES_UNSOLVED
    for i in range(n):
        a[i] = size * change[i]
    for i in range(multipliers):
        lam[active[i]] = size * change[n + i]
    _channels_at(exchange, workspace, held, found)
    for k in range(exchange.n_channels):
        found[k] = (found[k] - resting[k]) / size
    for k in ivec(exchange.residual_channels, 3):
        # violations are zero for all inputs
        found[k] = 0.0
    return OK


@compiled
def in_time(exchange: Any, found: Any) -> None:
    """Time derivatives of all channels, NaN where they are not known."""
    workspace = workspace_at(exchange.workspace)
    n, m, contacts, work = workspace.n, workspace.m_ext - 1, workspace.n_contacts, workspace.n_work
    sample = vec(exchange.sample, exchange.sample_length)
    write_sample(workspace, sample)
    evaluate_power(workspace)
    rates = np.full(exchange.sample_length, np.nan)
    rates[1 : 1 + 2 * n] = sample[1 + n : 1 + 3 * n]
    at = 1 + 3 * n + m
    phidd = vec(workspace.phidd, workspace.m_ext)
    rows, slide_rows = ivec(workspace.contact_rows, contacts), ivec(workspace.contact_slide_rows, contacts)
    for k in range(contacts):
        # in the order of a sample: force, gap, its rate, mode, jumps of impulse and loss, friction, sliding
        rates[at + contacts + k] = sample[at + 2 * contacts + k]
        rates[at + 2 * contacts + k] = phidd[rows[k]]
        rates[at + 4 * contacts + k] = rates[at + 5 * contacts + k] = 0.0
        if slide_rows[k] >= 0:
            rates[at + 7 * contacts + k] = _sliding_rate(workspace, k, slide_rows[k])
    at += 8 * contacts + 3
    a = vec(workspace.a, workspace.n_ext)
    for i in range(work):
        rates[at + i] = a[workspace.n_ext - work + i]
    places = ivec(exchange.places, exchange.n_channels)
    for k in range(exchange.n_channels):
        found[k] = rates[places[k]]
    flags, summed = ivec(exchange.flags, exchange.n_flags), ivec(exchange.summed, exchange.n_sums)
    for k in range(exchange.n_flags):
        found[flags[k]] = np.nan
    for k in range(exchange.n_sums):
        found[summed[k]] = 0.0
    number, column, signs = (
        ivec(exchange.number, exchange.n_terms),
        ivec(exchange.column, exchange.n_terms),
        vec(exchange.signs, exchange.n_terms),
    )
    for i in range(exchange.n_terms):
        found[summed[number[i]]] += signs[i] * rates[column[i]]
    _derived_rates(exchange, sample, found)


@internal
def _sliding_rate(workspace: Any, k: int, row: int) -> float:
    """Rate of the sliding velocity that a sample has of contact k."""
    phid, phidd = vec(workspace.phid, workspace.m_ext), vec(workspace.phidd, workspace.m_ext)
    memory = memories_at(workspace.memory, workspace.n_contacts)[k]
    if not in_space(workspace, k):
        return float(phidd[row])
    if memory.mode == CLOSED and abs(memory.slide_mode) == 1.0:
        return float(phidd[row + 1])
    x, y, x_rate, y_rate = phid[row], phid[row + 1], phidd[row], phidd[row + 1]
    speed = math.sqrt(x * x + y * y)
    return (x * x_rate + y * y_rate) / speed if speed > 0.0 else math.sqrt(x_rate * x_rate + y_rate * y_rate)


@internal
def _derived_rates(exchange: Any, sample: Any, found: Any) -> None:
    """Those of derived channels are others of them, or not known."""
    if exchange.n_derived == 0:
        return
    rate_of = ivec(exchange.derived_rates, exchange.n_derived_rates)
    values = np.full(len(rate_of), np.nan)
    heads = imat(exchange.derived, exchange.n_derived, HEAD_SIZE)
    derive_row(
        sample, heads, ivec(exchange.derived_places, exchange.n_derived_places), vec(exchange.derived_numbers,
        exchange.n_derived_numbers),
        values,
    )  # fmt: skip
    for k in range(len(rate_of)):
        found[exchange.first_derived + k] = values[rate_of[k]] if rate_of[k] >= 0 else np.nan
