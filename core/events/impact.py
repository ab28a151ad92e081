"""What an impact does: contacts that would bounce ever lower are struck without restitution, if they then stay."""

from typing import Any

from ..assembly.evaluate import evaluate_energy, evaluate_residuals
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..methods.history import history_time
from ..rounding import ENERGY_GAIN, FORCE_ROUNDING
from ..state.modes import OPEN, memories_at
from ..state.run_records import GAINS, GRAZE, IMPACT, ROUNDS
from ..state.workspace_records import counters_at
from .reading import unresolved_speed
from .records import NO_FORCES, SETTLED, call_part, scalars, touching
from .report import report
from .touching import read_rates


@internal
def impact(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Strike the touching contacts, with events and accounts."""
    contact = touching(instant)
    count, v, before, energy = (
        scalars(instant).count,
        vec(workspace.v, workspace.n_ext),
        vec(instant.velocities, workspace.n_ext),
        vec(workspace.energy, 3),
    )
    evaluate_energy(workspace)
    kinetic = energy[0]
    for i in range(workspace.n_ext):
        before[i] = v[i]
    # the velocities jump: only they say what moves how
    scalars(instant).struck = 1
    for i in range(count):
        contact[i].opens = contact[i].stops = contact[i].slips = contact[i].comes_to_rest = 0.0
    scalars(instant).without_restitution = 0
    status = call_part(instant.strike, instant, drive, workspace, method)
    if status != SETTLED:
        return status
    if _any_low(instant, drive, workspace):
        status = _rest(instant, drive, workspace, method)
        if status != SETTLED:
            return status
    total, stopped = 0.0, 0.0
    for i in range(count):
        total += contact[i].impact_loss
        stopped += contact[i].stopping_loss
    evaluate_energy(workspace)
    if drive.input_account >= 0:
        v[drive.input_account] = before[drive.input_account] + energy[0] - kinetic + total + stopped
    _account(instant, drive, workspace, method, -total if total < -ENERGY_GAIN * max(kinetic, 1e-300) else 0.0)
    return SETTLED


@internal
def _any_low(instant: Any, drive: Any, workspace: Any) -> bool:
    """Contacts that have bounced by next to nothing, to `negligible_bounce`."""
    contact = touching(instant)
    memory, contacts = memories_at(workspace.memory, workspace.n_contacts), ivec(instant.contacts, instant.most)
    ratio, low, found = vec(drive.rest_ratio, workspace.n_contacts), contact.negligible_bounce, False
    for i in range(scalars(instant).count):
        k, approach = contacts[i], contact[i].approach_speed
        largest = max(memory[k].largest_approach, approach)
        least = max(ratio[k] * largest, unresolved_speed(workspace, k, contact[i].closing_acceleration))
        bounces = contact[i].impact_impulse > 0.0 and contact[i].restitution > 0.0
        low[i] = bounces and approach > contact[i].rate_rounding and contact[i].separation_speed <= least
        found = found or low[i] != 0.0
    return found


@internal
def _rest(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Strike those without restitution; if they do not all stay then, it was the bounce."""
    contact = touching(instant)
    count, v, bounced = scalars(instant).count, vec(workspace.v, workspace.n_ext), vec(instant.bounced, workspace.n_ext)
    left, residual, in_rounds = (
        scalars(instant).approach_left,
        scalars(instant).constraint_residual,
        scalars(instant).in_rounds,
    )
    for i in range(count):
        contact[i].first_impulse, contact[i].first_friction = contact[i].impact_impulse, contact[i].impact_friction
        contact[i].first_loss, contact[i].first_approach = contact[i].impact_loss, contact[i].approach_speed
        contact[i].first_separation = contact[i].separation_speed
    for i in range(workspace.n_ext):
        bounced[i], v[i] = v[i], vec(instant.velocities, workspace.n_ext)[i]
    evaluate_residuals(workspace)
    read_rates(instant, workspace)
    scalars(instant).without_restitution, scalars(instant).acceleration_scale = 1, 0.0
    status = call_part(instant.strike, instant, drive, workspace, method)
    if status == SETTLED:
        status = call_part(instant.begin_rest, instant, drive, workspace, method)
    if status == SETTLED:
        status = call_part(instant.find_forces, instant, drive, workspace, method)
    # forces that cannot be are no rest
    stay = status != NO_FORCES
    if stay and status != SETTLED:
        return status
    for i in range(count):
        stay = stay and (contact[i].negligible_bounce == 0.0 or contact[i].normal_force > 0.0)
    if stay:
        for i in range(count):
            contact[i].comes_to_rest = contact[i].negligible_bounce
        return SETTLED
    for i in range(count):
        contact[i].impact_impulse, contact[i].impact_friction = contact[i].first_impulse, contact[i].first_friction
        contact[i].impact_loss, contact[i].approach_speed = contact[i].first_loss, contact[i].first_approach
        contact[i].separation_speed = contact[i].first_separation
        contact[i].stopping_impulse = contact[i].stopping_loss = 0.0
    scalars(instant).approach_left, scalars(instant).constraint_residual, scalars(instant).in_rounds = (
        left,
        residual,
        in_rounds,
    )
    for i in range(workspace.n_ext):
        v[i] = bounced[i]
    evaluate_residuals(workspace)
    read_rates(instant, workspace)
    return SETTLED


@internal
def _speed(instant: Any, i: int) -> float:
    """Approach of touching contact i, 0 where that is rounding."""
    approach = touching(instant)[i].approach_speed
    return approach if approach > touching(instant)[i].rate_rounding else 0.0


@internal
def _account(instant: Any, drive: Any, workspace: Any, method: Any, gain: float) -> None:
    """Impulses and losses to the contacts' memories, and their events, that of the fastest approach first. `gain`: of
    energy, J."""
    contact = touching(instant)
    count, contacts, order = (
        scalars(instant).count,
        ivec(instant.contacts, instant.most),
        ivec(instant.order, 2 * instant.most),
    )
    memory, t = memories_at(workspace.memory, workspace.n_contacts), history_time(method, 0)
    impulse, loss, approach = contact.impact_impulse, contact.impact_loss, contact.approach_speed
    least, in_rounds, graze = 0.0, scalars(instant).in_rounds, True
    counters_at(workspace.counters).impacts_in_rounds += in_rounds
    for i in range(count):
        least = max(least, FORCE_ROUNDING * impulse[i])
        if gain > 0.0:
            report(drive, t, GAINS, contacts[i], 0.0, -gain, 0.0, 0.0, 0.0, 0.0)
        # those that rounding alone makes approach stay in the order of their numbers
        at, speed = i, _speed(instant, i)
        while at > 0 and _speed(instant, order[at - 1]) < speed:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i
    for j in range(count):
        i = order[j]
        k = contacts[i]
        if impulse[i] <= least:
            continue
        if in_rounds != 0:
            report(drive, t, ROUNDS, k, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        # a gap that would open again by itself before it could be seen to be negative, and that no other's blow closes
        graze = (
            graze
            and contact[i].mode_before == OPEN
            and approach[i] <= unresolved_speed(workspace, k, -contact[i].closing_acceleration)
        )
        memory[k].impulse_jump += impulse[i]
        memory[k].loss_jump += loss[i]
        if approach[i] > contact[i].rate_rounding:
            memory[k].approach_speed = approach[i]
            memory[k].largest_approach = max(memory[k].largest_approach, approach[i])
        report(
            drive, t, GRAZE if graze else IMPACT, k, impulse[i], loss[i], max(approach[i], 0.0),
            max(contact[i].separation_speed, 0.0), scalars(instant).constraint_residual, contact[i].impact_friction,
        )  # fmt: skip
