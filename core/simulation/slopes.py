"""Derivatives of all channels at the workspace's point, compiled: along inputs, and in time.

What they are and why they are exact stands in `sensitivity.py` and `output_rates.py`, which call this; so does the C
code of runs without Python, which has all channels read before.
"""

import math
from typing import Any

import numpy as np

from ..assembly.compatibility import factor_equations
from ..assembly.evaluate import evaluate_power, evaluate_residuals, evaluate_tangent
from ..assembly.sticking_force import in_space
from ..compiled import types
from ..compiled.jit import compiled, internal
from ..compiled.views import imat, ivec, mat, vec
from ..linalg import lu_at, solve
from ..model.derived import HEAD_SIZE, derive_row
from ..model.signals import INPUT_SIZE
from ..rounding import SENSITIVITY_SOLVED
from ..state.modes import ACTIVE, AT_LIMIT, CLOSED, MEMORY_SIZE, MODE, RATIO, SLIDE, STICKS
from ..state.workspace_records import OK
from ..time_loop.drive import workspace_at
from ..time_loop.sample import write_sample
from .exchange_record import EXCHANGE, OF_GROUPS
from .read_channels import put_channels

LARGE = 2.0**40
"""s relative to what the residual holds without the change: its rounding is 2^-40 of itself beside the change."""
REFINEMENTS = 2
UNSOLVED = 1000
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
def _channels_at(ex: Any, ws: Any, held: Any, out: Any) -> None:
    """All channels of the workspace's point as it stands: changes of what there is with the multipliers `held`."""
    evaluate_residuals(ws)
    sample = vec(ex.sample, ex.sample_length)
    write_sample(ws, sample)
    monitor, memory = vec(ws.monitor, 2 * ws.n_contacts), mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    companion = ivec(ws.contact_companion, ws.n_contacts)
    for k in range(ws.n_contacts):
        normal = 1 + 3 * ws.n + ws.m_ext - 1 + k
        if companion[k] < 0:
            continue  # (there stand components, which are linear)
        if companion[k] == 0 and (memory[k, MODE] == CLOSED or memory[k, MODE] == ACTIVE):
            # a change may have either sign, where a sample shows no force that pulls
            sample[normal] = monitor[k]
        along = normal + 6 * ws.n_contacts
        sample[along] = _change_of_friction(ws, k, held, sample[along])
    put_channels(ex, out, ivec(ex.wants, ex.n_wants)[OF_GROUPS:])


@internal
def _change_of_friction(ws: Any, k: int, held: Any, size: float) -> float:
    """How the friction force of contact k changes, N, of a change of this size. Of a closed contact in space it is the
    norm of a vector F, which changes by F.dF/|F|; where there is none, by |dF|."""
    memory, row = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k], ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    if row < 0 or memory[MODE] != CLOSED or not in_space(ws, k):
        return size
    lam, normal, state = vec(ws.lam, ws.m_ext), ivec(ws.contact_rows, ws.n_contacts)[k], memory[SLIDE]
    if state != STICKS and state != AT_LIMIT:
        # a part of the normal force, which is -lam
        return -size if lam[normal] > 0.0 else size
    across = normal if state == AT_LIMIT else row + 1
    part = memory[RATIO] * memory[RATIO] if state == AT_LIMIT else 1.0
    square = held[row] * held[row] + part * held[across] * held[across]
    change = held[row] * lam[row] + part * held[across] * lam[across]
    if ivec(ws.contact_companion, ws.n_contacts)[k] > 0:
        third = ivec(ws.contact_slide_rows, ws.n_contacts)[k + 1]
        square, change = square + held[third] * held[third], change + held[third] * lam[third]
    return change / math.sqrt(square) if square > 0.0 else size


@internal
def _solve_joints(ws: Any, x: Any, load: Any) -> int:
    """[M Phi_q^T; Phi_q 0] x = (-load, 0), the matrix being factorised: OK or UNSOLVED."""
    n, size = ws.n, ws.n + ws.m_act + ws.n_implied
    lu = lu_at(ws.kkt_query)
    count = lu.nnz
    row, col, values = ivec(ws.entry_row, count), ivec(ws.entry_col, count), vec(ws.values, count)
    rhs, product, sizes = vec(ws.rhs, size), np.zeros(size), np.zeros(size)
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
        solve(lu, ws.rhs)
        for i in range(size):
            x[i] += rhs[i]
    most = _largest(load)
    for i in range(size):
        left = abs((-load[i] if i < n else 0.0) - product[i])
        if not left <= SENSITIVITY_SOLVED * (most + sizes[i]):
            return UNSOLVED
    return OK


@compiled
def along_inputs(ex: Any, seed: Any, found: Any) -> int:
    """Derivatives of all channels along `seed` (inputs,), whose largest number is 1: OK, UNSOLVED, or what `factor`
    returns for the pivots that there are. The workspace's point is changed."""
    ws = workspace_at(ex.workspace)
    n, multipliers = ws.n, ws.m_act + ws.n_implied
    active = ivec(ws.active, multipliers)
    a, lam, r = vec(ws.a, ws.n_ext), vec(ws.lam, ws.m_ext), vec(ws.r, ws.n_ext)
    inputs, held = vec(ws.inputs, len(seed) * INPUT_SIZE), lam.copy()
    for k in range(len(seed)):
        if seed[k] != 0.0:
            for j in range(3):
                inputs[INPUT_SIZE * k + j] = 0.0
    a[:n] = 0.0
    lam[:] = 0.0
    evaluate_residuals(ws)
    at_rest = r[:n].copy()
    size, most = 1.0, 1.0 + _largest(at_rest)
    while size < most:
        size *= 2.0
    size *= LARGE
    resting = np.zeros(ex.n_channels)
    _channels_at(ex, ws, held, resting)
    for k in range(len(seed)):
        if seed[k] != 0.0:
            inputs[INPUT_SIZE * k] = size * seed[k]
    evaluate_residuals(ws)
    load = (r[:n] - at_rest) / size
    evaluate_tangent(ws, 0.0, 0.0)
    status = factor_equations(ws, ws.kkt_query)
    if status != OK:
        return int(status)
    change = np.zeros(n + multipliers)
    if _solve_joints(ws, change, load) != OK:
        return UNSOLVED
    for i in range(n):
        a[i] = size * change[i]
    for i in range(multipliers):
        lam[active[i]] = size * change[n + i]
    _channels_at(ex, ws, held, found)
    for k in range(ex.n_channels):
        found[k] = (found[k] - resting[k]) / size
    for k in ivec(ex.residual_channels, 3):
        # violations are zero for all inputs
        found[k] = 0.0
    return OK


@compiled
def in_time(ex: Any, found: Any) -> None:
    """Time derivatives of all channels, NaN where they are not known."""
    ws = workspace_at(ex.workspace)
    n, m, contacts, work = ws.n, ws.m_ext - 1, ws.n_contacts, ws.n_work
    sample = vec(ex.sample, ex.sample_length)
    write_sample(ws, sample)
    evaluate_power(ws)
    rates = np.full(ex.sample_length, np.nan)
    rates[1 : 1 + 2 * n] = sample[1 + n : 1 + 3 * n]
    at = 1 + 3 * n + m
    phidd = vec(ws.phidd, ws.m_ext)
    rows, slide_rows = ivec(ws.contact_rows, contacts), ivec(ws.contact_slide_rows, contacts)
    for k in range(contacts):
        # in the order of a sample: force, gap, its rate, mode, jumps of impulse and loss, friction, sliding
        rates[at + contacts + k] = sample[at + 2 * contacts + k]
        rates[at + 2 * contacts + k] = phidd[rows[k]]
        rates[at + 4 * contacts + k] = rates[at + 5 * contacts + k] = 0.0
        if slide_rows[k] >= 0:
            rates[at + 7 * contacts + k] = _sliding_rate(ws, k, slide_rows[k])
    at += 8 * contacts + 3
    a = vec(ws.a, ws.n_ext)
    for i in range(work):
        rates[at + i] = a[ws.n_ext - work + i]
    places = ivec(ex.places, ex.n_channels)
    for k in range(ex.n_channels):
        found[k] = rates[places[k]]
    flags, summed = ivec(ex.flags, ex.n_flags), ivec(ex.summed, ex.n_sums)
    for k in range(ex.n_flags):
        found[flags[k]] = np.nan
    for k in range(ex.n_sums):
        found[summed[k]] = 0.0
    number, column, signs = ivec(ex.number, ex.n_terms), ivec(ex.column, ex.n_terms), vec(ex.signs, ex.n_terms)
    for i in range(ex.n_terms):
        found[summed[number[i]]] += signs[i] * rates[column[i]]
    _derived_rates(ex, sample, found)


@internal
def _sliding_rate(ws: Any, k: int, row: int) -> float:
    """Rate of the sliding velocity that a sample has of contact k."""
    phid, phidd = vec(ws.phid, ws.m_ext), vec(ws.phidd, ws.m_ext)
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    if not in_space(ws, k):
        return float(phidd[row])
    if memory[MODE] == CLOSED and abs(memory[SLIDE]) == 1.0:
        return float(phidd[row + 1])
    x, y, x_rate, y_rate = phid[row], phid[row + 1], phidd[row], phidd[row + 1]
    speed = math.sqrt(x * x + y * y)
    return (x * x_rate + y * y_rate) / speed if speed > 0.0 else math.sqrt(x_rate * x_rate + y_rate * y_rate)


@internal
def _derived_rates(ex: Any, sample: Any, found: Any) -> None:
    """Those of derived channels are others of them, or not known."""
    if ex.n_derived == 0:
        return
    rate_of = ivec(ex.derived_rates, ex.n_derived_rates)
    values = np.full(len(rate_of), np.nan)
    heads = imat(ex.derived, ex.n_derived, HEAD_SIZE)
    derive_row(
        sample, heads, ivec(ex.derived_places, ex.n_derived_places), vec(ex.derived_numbers, ex.n_derived_numbers),
        values,
    )  # fmt: skip
    for k in range(len(rate_of)):
        found[ex.first_derived + k] = values[rate_of[k]] if rate_of[k] >= 0 else np.nan
