"""Impacts of contacts with two tangents, with exact friction cones (`contact_solvers/friction_cones.py`), at once or in
turn."""

import math
from typing import Any

from ..assembly.evaluate import evaluate_residuals
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal, record_view
from ..compiled.views import ivec, vec
from ..rounding import UNSOLVED
from ..state.impact_law_codes import BY_NEWTON_IN_TURN, BY_POISSON
from ..state.run_records import LOOP_TYPE
from .impact_retries import ALL_ROUNDS, FIRST_ROUND, MOST_BLOWS, MOST_BOUNCES, MOST_ROUNDS, restitution, strikes_anew
from .rates import masses, push, read_all_rates
from .records import ENDLESS_BLOWS, ENDLESS_ROUNDS, NO_IMPACT, SETTLED, scalars, touching
from .spin_impulses import any_spins, find_spins, push_spins, solve_blow, strike_spinning

loop_at = record_view(LOOP_TYPE)


@internal
def strike(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Change the current velocities by the laws of the touching contacts. Newton's law of restitution speaks of end
    velocities, and so does the friction with both laws."""
    contact = touching(instant)
    count, phid = scalars(instant).count, vec(workspace.phid, workspace.m_ext)
    rate, slide, sway, rounding = contact.gap_rate, contact.sliding_rate, contact.sliding_rate2, contact.rate_rounding
    active, joint_rates = ivec(workspace.active, workspace.m_act), vec(instant.joint_rates, workspace.m_act)
    before_n, before_t, before_s = contact.gap_rate_before, contact.sliding_rate_before, contact.sliding_rate2_before
    loss, p_n, p_t, p_s = (
        contact.impact_loss,
        contact.normal_impulse,
        contact.friction_impulse,
        contact.friction_impulse2,
    )
    read_all_rates(instant, workspace)
    if any_spins(instant):
        find_spins(instant, workspace, loop_at(drive.loop))
    for i in range(workspace.m_act):
        joint_rates[i] = phid[active[i]]
    largest, left, sequential = 0.0, math.inf, False
    for i in range(count):
        sequential = (
            sequential
            or ivec(drive.law, workspace.n_contacts)[ivec(instant.contacts, instant.most)[i]] == BY_NEWTON_IN_TURN
        )
        contact[i].impact_impulse = contact[i].impact_friction = loss[i] = 0.0
        contact[i].approach_speed = max(-rate[i], 0.0)
        largest = max(largest, abs(rate[i]), abs(slide[i]), abs(sway[i]))
    scalars(instant).constraint_residual, noise = 0.0, UNSOLVED * largest
    scalars(instant).in_rounds = 0
    for turn in range(MOST_ROUNDS + 1):
        before_round, left, fastest = left, 0.0, 0.0
        for i in range(count):
            left, fastest = max(left, -rate[i] / rounding[i]), max(fastest, -rate[i])
        # (as `impact_retries.py`)
        if left <= 1.0 or (0.5 * before_round <= left and fastest <= noise):
            break
        if turn == MOST_ROUNDS:
            return ENDLESS_ROUNDS
        for i in range(count):
            approach = contact[i].approach_speed
            contact[i].approach_speed = approach if approach > rounding[i] else -rate[i]
            before_n[i], before_t[i], before_s[i] = rate[i], slide[i], sway[i]
            contact[i].spin_rate_before = contact[i].spin_rate
        attempt, anew = FIRST_ROUND, True
        while anew:
            for i in range(count):
                contact[i].spin_impulse = 0.0
            last = turn >= MOST_BOUNCES
            status = (
                _sequence(instant, drive, workspace)
                if sequential
                else _blow(instant, drive, workspace, last, attempt == ALL_ROUNDS)
            )
            lost = 0.0
            for i in range(count):
                lost += _lost(instant, i)
            anew = turn == 0 and not sequential and strikes_anew(instant, drive, workspace, status, attempt, lost)
            attempt += 1
        if status != SETTLED:
            return status
        for i in range(count):
            loss[i] += _lost(instant, i)
            contact[i].impact_impulse += p_n[i]
            rubs = math.sqrt(p_t[i] * p_t[i] + p_s[i] * p_s[i])
            contact[i].impact_friction += (
                rubs if in_space(workspace, ivec(instant.contacts, instant.most)[i]) else p_t[i]
            )
    evaluate_residuals(workspace)
    read_all_rates(instant, workspace)
    for i in range(workspace.m_act):
        scalars(instant).constraint_residual = max(
            scalars(instant).constraint_residual, abs(phid[active[i]] - joint_rates[i])
        )
    for i in range(count):
        contact[i].separation_speed = rate[i]
    scalars(instant).approach_left = left
    return SETTLED


@internal
def _lost(instant: Any, i: int) -> float:
    """Energy that contact i has taken in this round, J."""
    c = touching(instant)[i]
    work = c.normal_impulse * (c.gap_rate_before + c.gap_rate)
    work += c.friction_impulse * (c.sliding_rate_before + c.sliding_rate)
    work += c.spin_impulse * (c.spin_rate_before + c.spin_rate)
    work += c.friction_impulse2 * (c.sliding_rate2_before + c.sliding_rate2)
    return -0.5 * work


@internal
def _blow(instant: Any, drive: Any, workspace: Any, last: bool, every: bool) -> int:
    """One problem of the contacts that do not separate, or of `every` one, and a second one for the expansion of
    Poisson's contacts; or the `last`, of all contacts and without restitution."""
    contact = touching(instant)
    count, law, contacts = (
        scalars(instant).count,
        ivec(drive.law, workspace.n_contacts),
        ivec(instant.contacts, instant.most),
    )
    part, base, rate, rounding = (
        vec(instant.part, instant.most),
        vec(instant.base, instant.most),
        contact.gap_rate,
        contact.rate_rounding,
    )
    p_n, p_t, p_s, back = contact.normal_impulse, contact.friction_impulse, contact.friction_impulse2, False
    low = scalars(instant).without_restitution != 0
    for i in range(count):
        part[i] = 1.0 if last or every or rate[i] <= rounding[i] else 0.0
        base[i] = p_n[i] = p_t[i] = p_s[i] = 0.0
    for phase in range(2):
        b, p = vec(instant.space_b, 3 * count), vec(instant.space_p, 3 * count)
        for i in range(count):
            poisson = law[contacts[i]] == BY_POISSON
            e = 0.0 if last else restitution(instant, low, i)
            back = back or (part[i] != 0.0 and poisson and e > 0.0)
            if phase == 1:
                base[i] = e * max(p_n[i], 0.0) if poisson else 0.0
            clear_rate = 0.0 if abs(rate[i]) <= rounding[i] else rate[i]
            before = min(contact[i].gap_rate_before if phase == 1 else clear_rate, 0.0)
            wanted = 0.0 if poisson else e * before
            b[i] = clear_rate + wanted
            b[count + i], b[2 * count + i] = contact[i].sliding_rate, contact[i].sliding_rate2
            if abs(b[count + i]) <= rounding[i] and abs(b[2 * count + i]) <= rounding[i]:
                b[count + i] = b[2 * count + i] = 0.0
            vec(instant.known_direction, instant.most)[i] = 0.0
        if not solve_blow(instant, drive, workspace, part, b, p):
            return NO_IMPACT
        push(instant, workspace, p)
        push_spins(instant, workspace)
        for i in range(count):
            p_n[i] += p[i]
            p_t[i] += p[count + i]
            p_s[i] += p[2 * count + i]
        if not back:
            break
    return SETTLED


@internal
def _sequence(instant: Any, drive: Any, workspace: Any) -> int:
    """One blow after another, the fastest approach first, until none approaches."""
    contact = touching(instant)
    count, low = scalars(instant).count, scalars(instant).without_restitution != 0
    a, v, p, rounding = (
        masses(instant, count),
        vec(instant.space_b, 3 * count),
        vec(instant.space_p, 3 * count),
        contact.rate_rounding,
    )
    for i in range(count):
        v[i], v[count + i], v[2 * count + i] = contact[i].gap_rate, contact[i].sliding_rate, contact[i].sliding_rate2
        p[i] = p[count + i] = p[2 * count + i] = contact[i].problem_spin_impulse = 0.0
    for _ in range(MOST_BLOWS):
        i = 0
        for k in range(count):
            i = k if v[k] < v[i] else i
        if v[i] >= -rounding[i]:
            push(instant, workspace, p)
            push_spins(instant, workspace)
            for r in range(count):
                contact[r].normal_impulse, contact[r].friction_impulse, contact[r].friction_impulse2 = (
                    p[r],
                    p[count + r],
                    p[2 * count + r],
                )
            return SETTLED
        j, k = count + i, 2 * count + i
        wanted = v[i] * (1.0 + restitution(instant, low, i))
        found, one, first, second = strike_spinning(instant, drive, workspace, i, v, wanted)
        if not found:
            return NO_IMPACT
        p[i] += one
        p[j] += first
        p[k] += second
        for r in range(3 * count):
            v[r] += a[r, i] * one + a[r, j] * first + a[r, k] * second
    return ENDLESS_BLOWS
