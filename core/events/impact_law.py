"""Impacts of contacts with two tangents, with exact friction cones (`contact_solvers/friction_cones.py`), at once or in
turn."""

import math
from typing import Any

from ..assembly.evaluate import evaluate_residuals
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal, record_view
from ..compiled.views import ivec, vec
from ..rounding import UNSOLVED
from ..state.run_records import LOOP_TYPE
from .impact_rounds import FIRST, MOST_BLOWS, MOST_BOUNCES, MOST_ROUNDS, OF_ALL, restitution, strikes_anew
from .laws import POISSON, SEQUENTIAL
from .rates import masses, push, read_all_rates
from .records import (
    APPROACH,
    BASE,
    COUNT,
    ENDLESS_BLOWS,
    ENDLESS_ROUNDS,
    FRICTION,
    IMPULSE,
    IN_ROUNDS,
    KNOWN,
    LEFT,
    LOSS,
    NO_IMPACT,
    P_N,
    P_S,
    P_SPIN,
    P_T,
    PART,
    RATE,
    RATE_BEFORE,
    RESIDUAL,
    ROUNDING,
    SEPARATION,
    SETTLED,
    SLIDE_BEFORE,
    SLIDE_RATE,
    SPIN,
    SPIN_BEFORE,
    SWAY_BEFORE,
    SWAY_RATE,
    WITHOUT,
    ZETA,
    clear,
    col,
    copy,
    real,
    whole,
)
from .spin_impulses import any_spins, find_spins, push_spins, solve_blow, strike_spinning

loop_at = record_view(LOOP_TYPE)
_WORKS = (
    (P_N, RATE_BEFORE, RATE),
    (P_T, SLIDE_BEFORE, SLIDE_RATE),
    (P_SPIN, SPIN_BEFORE, SPIN),
    (P_S, SWAY_BEFORE, SWAY_RATE),
)
"""Impulses, and the rates before and after them."""


@internal
def strike(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Change the current velocities by the laws of the touching contacts. Newton's law of restitution speaks of end
    velocities, and so does the friction with both laws."""
    count, phid = whole(ev)[COUNT], vec(ws.phid, ws.m_ext)
    rate, slide, sway, rounding = col(ev, RATE), col(ev, SLIDE_RATE), col(ev, SWAY_RATE), col(ev, ROUNDING)
    active, joint_rates = ivec(ws.active, ws.m_act), vec(ev.joint_rates, ws.m_act)
    before_n, before_t, before_s = col(ev, RATE_BEFORE), col(ev, SLIDE_BEFORE), col(ev, SWAY_BEFORE)
    loss, p_n, p_t, p_s = col(ev, LOSS), col(ev, P_N), col(ev, P_T), col(ev, P_S)
    read_all_rates(ev, ws)
    if any_spins(ev):
        find_spins(ev, ws, loop_at(dr.loop))
    for i in range(ws.m_act):
        joint_rates[i] = phid[active[i]]
    largest, left, sequential = 0.0, math.inf, False
    for i in range(count):
        sequential = sequential or ivec(dr.law, ws.n_contacts)[ivec(ev.contacts, ev.most)[i]] == SEQUENTIAL
        col(ev, IMPULSE)[i] = col(ev, FRICTION)[i] = loss[i] = 0.0
        col(ev, APPROACH)[i] = max(-rate[i], 0.0)
        largest = max(largest, abs(rate[i]), abs(slide[i]), abs(sway[i]))
    real(ev)[RESIDUAL], noise = 0.0, UNSOLVED * largest
    whole(ev)[IN_ROUNDS] = 0
    for turn in range(MOST_ROUNDS + 1):
        before_round, left, fastest = left, 0.0, 0.0
        for i in range(count):
            left, fastest = max(left, -rate[i] / rounding[i]), max(fastest, -rate[i])
        # (as `impact_rounds.py`)
        if left <= 1.0 or (0.5 * before_round <= left and fastest <= noise):
            break
        if turn == MOST_ROUNDS:
            return ENDLESS_ROUNDS
        for i in range(count):
            approach = col(ev, APPROACH)[i]
            col(ev, APPROACH)[i] = approach if approach > rounding[i] else -rate[i]
            before_n[i], before_t[i], before_s[i] = rate[i], slide[i], sway[i]
            col(ev, SPIN_BEFORE)[i] = col(ev, SPIN)[i]
        attempt, anew = FIRST, True
        while anew:
            clear(col(ev, P_SPIN), count)
            last = turn >= MOST_BOUNCES
            status = _sequence(ev, dr, ws) if sequential else _blow(ev, dr, ws, last, attempt == OF_ALL)
            lost = 0.0
            for i in range(count):
                lost += _lost(ev, i)
            anew = turn == 0 and not sequential and strikes_anew(ev, dr, ws, status, attempt, lost)
            attempt += 1
        if status != SETTLED:
            return status
        for i in range(count):
            loss[i] += _lost(ev, i)
            col(ev, IMPULSE)[i] += p_n[i]
            rubs = math.sqrt(p_t[i] * p_t[i] + p_s[i] * p_s[i])
            col(ev, FRICTION)[i] += rubs if in_space(ws, ivec(ev.contacts, ev.most)[i]) else p_t[i]
    evaluate_residuals(ws)
    read_all_rates(ev, ws)
    for i in range(ws.m_act):
        real(ev)[RESIDUAL] = max(real(ev)[RESIDUAL], abs(phid[active[i]] - joint_rates[i]))
    copy(col(ev, SEPARATION), rate, count)
    real(ev)[LEFT] = left
    return SETTLED


@internal
def _lost(ev: Any, i: int) -> float:
    """Energy that contact i has taken in this round, J."""
    work = 0.0
    for p, before, now in _WORKS:
        work += col(ev, p)[i] * (col(ev, before)[i] + col(ev, now)[i])
    return -0.5 * work


@internal
def _blow(ev: Any, dr: Any, ws: Any, last: bool, every: bool) -> int:
    """One problem of the contacts that do not separate, or of `every` one, and a second one for the expansion of
    Poisson's contacts; or the `last`, of all contacts and without restitution."""
    count, law, contacts = whole(ev)[COUNT], ivec(dr.law, ws.n_contacts), ivec(ev.contacts, ev.most)
    part, base, rate, rounding = col(ev, PART), col(ev, BASE), col(ev, RATE), col(ev, ROUNDING)
    p_n, p_t, p_s, back = col(ev, P_N), col(ev, P_T), col(ev, P_S), False
    low = whole(ev)[WITHOUT] != 0
    for i in range(count):
        part[i] = 1.0 if last or every or rate[i] <= rounding[i] else 0.0
        base[i] = p_n[i] = p_t[i] = p_s[i] = 0.0
    for phase in range(2):
        b, p = vec(ev.space_b, 3 * count), vec(ev.space_p, 3 * count)
        for i in range(count):
            poisson = law[contacts[i]] == POISSON
            e = 0.0 if last else restitution(ev, low, i)
            back = back or (part[i] != 0.0 and poisson and e > 0.0)
            if phase == 1:
                base[i] = e * max(p_n[i], 0.0) if poisson else 0.0
            clear_rate = 0.0 if abs(rate[i]) <= rounding[i] else rate[i]
            before = min(col(ev, RATE_BEFORE)[i] if phase == 1 else clear_rate, 0.0)
            wanted = 0.0 if poisson else e * before
            b[i] = clear_rate + wanted
            b[count + i], b[2 * count + i] = col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i]
            if abs(b[count + i]) <= rounding[i] and abs(b[2 * count + i]) <= rounding[i]:
                b[count + i] = b[2 * count + i] = 0.0
            col(ev, KNOWN)[i] = 0.0
        if not solve_blow(ev, dr, ws, part, b, p):
            return NO_IMPACT
        push(ev, ws, p)
        push_spins(ev, ws)
        for i in range(count):
            p_n[i] += p[i]
            p_t[i] += p[count + i]
            p_s[i] += p[2 * count + i]
        if not back:
            break
    return SETTLED


@internal
def _sequence(ev: Any, dr: Any, ws: Any) -> int:
    """One blow after another, the fastest approach first, until none approaches."""
    count, low = whole(ev)[COUNT], whole(ev)[WITHOUT] != 0
    a, v, p, rounding = masses(ev, count), vec(ev.space_b, 3 * count), vec(ev.space_p, 3 * count), col(ev, ROUNDING)
    for i in range(count):
        v[i], v[count + i], v[2 * count + i] = col(ev, RATE)[i], col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i]
        p[i] = p[count + i] = p[2 * count + i] = col(ev, ZETA)[i] = 0.0
    for _ in range(MOST_BLOWS):
        i = 0
        for k in range(count):
            i = k if v[k] < v[i] else i
        if v[i] >= -rounding[i]:
            push(ev, ws, p)
            push_spins(ev, ws)
            for r in range(count):
                col(ev, P_N)[r], col(ev, P_T)[r], col(ev, P_S)[r] = p[r], p[count + r], p[2 * count + r]
            return SETTLED
        j, k = count + i, 2 * count + i
        wanted = v[i] * (1.0 + restitution(ev, low, i))
        found, one, first, second = strike_spinning(ev, dr, ws, i, v, wanted)
        if not found:
            return NO_IMPACT
        p[i] += one
        p[j] += first
        p[k] += second
        for r in range(3 * count):
            v[r] += a[r, i] * one + a[r, j] * first + a[r, k] * second
        # exactly, so that the same contact is not struck again by rounding
        v[i] = max(v[i], 0.0)
    return ENDLESS_BLOWS
