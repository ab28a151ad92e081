"""What an impact does: contacts that would bounce ever lower are struck without restitution, if they then stay."""

from typing import Any

from ..assembly.evaluate import evaluate_energy, evaluate_residuals
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_time
from ..rounding import ENERGY_GAIN, FORCE_ROUNDING
from ..state.modes import APPROACH_SPEED, IMPULSE_JUMP, LARGEST_APPROACH, LOSS_JUMP, MEMORY_SIZE, OPEN
from ..state.run_records import GAINS, GRAZE, IMPACT, ROUNDS
from ..state.workspace_records import COUNTERS_SIZE, IMPACTS_IN_ROUNDS
from .reading import unresolved_speed
from .records import (
    ACCELERATIONS,
    APPROACH,
    COUNT,
    F_N,
    FALLS,
    FIRST_APPROACH,
    FIRST_FRICTION,
    FIRST_IMPULSE,
    FIRST_LOSS,
    FIRST_SEPARATION,
    FRICTION,
    IMPULSE,
    IN_ROUNDS,
    LEAVES,
    LEFT,
    LOSS,
    LOW,
    NO_FORCES,
    RESIDUAL,
    RESTITUTION,
    RESTS,
    ROUNDING,
    SEPARATION,
    SETTLED,
    SLIPS,
    STOP_IMPULSE,
    STOP_LOSS,
    STOPS,
    STRUCK,
    WAS,
    WITHOUT,
    call_part,
    clear,
    col,
    copy,
    real,
    whole,
)
from .report import report
from .touching import read_rates

_RESULTS = (
    (IMPULSE, FIRST_IMPULSE),
    (FRICTION, FIRST_FRICTION),
    (LOSS, FIRST_LOSS),
    (APPROACH, FIRST_APPROACH),
    (SEPARATION, FIRST_SEPARATION),
)


@internal
def impact(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Strike the touching contacts, with events and accounts."""
    count, v, before, energy = whole(ev)[COUNT], vec(ws.v, ws.n_ext), vec(ev.velocities, ws.n_ext), vec(ws.energy, 3)
    evaluate_energy(ws)
    kinetic = energy[0]
    for i in range(ws.n_ext):
        before[i] = v[i]
    # the velocities jump: only they say what moves how
    whole(ev)[STRUCK] = 1
    for i in range(count):
        col(ev, LEAVES)[i] = col(ev, STOPS)[i] = col(ev, SLIPS)[i] = col(ev, RESTS)[i] = 0.0
    whole(ev)[WITHOUT] = 0
    status = call_part(ev.strike, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    if _any_low(ev, dr, ws):
        status = _rest(ev, dr, ws, ms)
        if status != SETTLED:
            return status
    total, stopped = 0.0, 0.0
    for i in range(count):
        total += col(ev, LOSS)[i]
        stopped += col(ev, STOP_LOSS)[i]
    evaluate_energy(ws)
    if dr.input_account >= 0:
        v[dr.input_account] = before[dr.input_account] + energy[0] - kinetic + total + stopped
    _account(ev, dr, ws, ms, -total if total < -ENERGY_GAIN * max(kinetic, 1e-300) else 0.0)
    return SETTLED


@internal
def _any_low(ev: Any, dr: Any, ws: Any) -> bool:
    """Contacts that have bounced by next to nothing, to `LOW`."""
    memory, contacts = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), ivec(ev.contacts, ev.most)
    ratio, low, found = vec(dr.rest_ratio, ws.n_contacts), col(ev, LOW), False
    for i in range(whole(ev)[COUNT]):
        k, approach = contacts[i], col(ev, APPROACH)[i]
        largest = max(memory[k, LARGEST_APPROACH], approach)
        least = max(ratio[k] * largest, unresolved_speed(ws, k, col(ev, FALLS)[i]))
        bounces = col(ev, IMPULSE)[i] > 0.0 and col(ev, RESTITUTION)[i] > 0.0
        low[i] = bounces and approach > col(ev, ROUNDING)[i] and col(ev, SEPARATION)[i] <= least
        found = found or low[i] != 0.0
    return found


@internal
def _rest(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Strike those without restitution; if they do not all stay then, it was the bounce."""
    count, v, bounced = whole(ev)[COUNT], vec(ws.v, ws.n_ext), vec(ev.bounced, ws.n_ext)
    left, residual, in_rounds = real(ev)[LEFT], real(ev)[RESIDUAL], whole(ev)[IN_ROUNDS]
    for one, other in _RESULTS:
        copy(col(ev, other), col(ev, one), count)
    for i in range(ws.n_ext):
        bounced[i], v[i] = v[i], vec(ev.velocities, ws.n_ext)[i]
    evaluate_residuals(ws)
    read_rates(ev, ws)
    whole(ev)[WITHOUT], real(ev)[ACCELERATIONS] = 1, 0.0
    status = call_part(ev.strike, ev, dr, ws, ms)
    if status == SETTLED:
        status = call_part(ev.begin_rest, ev, dr, ws, ms)
    if status == SETTLED:
        status = call_part(ev.find_forces, ev, dr, ws, ms)
    # forces that cannot be are no rest
    stay = status != NO_FORCES
    if stay and status != SETTLED:
        return status
    for i in range(count):
        stay = stay and (col(ev, LOW)[i] == 0.0 or col(ev, F_N)[i] > 0.0)
    if stay:
        copy(col(ev, RESTS), col(ev, LOW), count)
        return SETTLED
    for one, other in _RESULTS:
        copy(col(ev, one), col(ev, other), count)
    real(ev)[LEFT], real(ev)[RESIDUAL], whole(ev)[IN_ROUNDS] = left, residual, in_rounds
    for i in range(ws.n_ext):
        v[i] = bounced[i]
    clear(col(ev, STOP_IMPULSE), count)
    clear(col(ev, STOP_LOSS), count)
    evaluate_residuals(ws)
    read_rates(ev, ws)
    return SETTLED


@internal
def _speed(ev: Any, i: int) -> float:
    """Approach of touching contact i, 0 where that is rounding."""
    approach = col(ev, APPROACH)[i]
    return approach if approach > col(ev, ROUNDING)[i] else 0.0


@internal
def _account(ev: Any, dr: Any, ws: Any, ms: Any, gain: float) -> None:
    """Impulses and losses to the contacts' memories, and their events, that of the fastest approach first. `gain`: of
    energy, J."""
    count, contacts, order = whole(ev)[COUNT], ivec(ev.contacts, ev.most), ivec(ev.order, 2 * ev.most)
    memory, t = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), history_time(ms, 0)
    impulse, loss, approach = col(ev, IMPULSE), col(ev, LOSS), col(ev, APPROACH)
    least, in_rounds, graze = 0.0, whole(ev)[IN_ROUNDS], True
    ivec(ws.counters, COUNTERS_SIZE)[IMPACTS_IN_ROUNDS] += in_rounds
    for i in range(count):
        least = max(least, FORCE_ROUNDING * impulse[i])
        if gain > 0.0:
            report(dr, t, GAINS, contacts[i], 0.0, -gain, 0.0, 0.0, 0.0, 0.0)
        # those that rounding alone makes approach stay in the order of their numbers
        at, speed = i, _speed(ev, i)
        while at > 0 and _speed(ev, order[at - 1]) < speed:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i
    for j in range(count):
        i = order[j]
        k = contacts[i]
        if impulse[i] <= least:
            continue
        if in_rounds != 0:
            report(dr, t, ROUNDS, k, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        # a gap that would open again by itself before it could be seen to be negative, and that no other's blow closes
        graze = graze and col(ev, WAS)[i] == OPEN and approach[i] <= unresolved_speed(ws, k, -col(ev, FALLS)[i])
        memory[k, IMPULSE_JUMP] += impulse[i]
        memory[k, LOSS_JUMP] += loss[i]
        if approach[i] > col(ev, ROUNDING)[i]:
            memory[k, APPROACH_SPEED] = approach[i]
            memory[k, LARGEST_APPROACH] = max(memory[k, LARGEST_APPROACH], approach[i])
        report(
            dr, t, GRAZE if graze else IMPACT, k, impulse[i], loss[i], max(approach[i], 0.0),
            max(col(ev, SEPARATION)[i], 0.0), real(ev)[RESIDUAL], col(ev, FRICTION)[i],
        )  # fmt: skip
