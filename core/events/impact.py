"""Impact of several contacts at once at velocity-increment level, joints and friction included.

[M Phi_q^T; Phi_q 0] (dv, Lambda) = (G_N^T P_N + G_T^T P_T, 0), v^+ = v^- + dv, with the impact law of each contact.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..cones.sweeps import one_contact
from ..rounding import ADDED, ENERGY_GAIN, UNSOLVED
from ..tables.evaluate import evaluate_residuals
from .forces import NO_SOLUTION, impulses_among
from .laws import POISSON, SEQUENTIAL
from .records import (
    APPROACH,
    BASE,
    COUNT,
    ENDLESS_BLOWS,
    ENDLESS_ROUNDS,
    FRICTION,
    IMPULSE,
    IN_ROUNDS,
    KINETIC,
    LEFT,
    LOSS,
    LOW,
    NO_IMPACT,
    NOW_N,
    NOW_T,
    P_N,
    P_T,
    PART,
    RATE,
    RATE_BEFORE,
    RESIDUAL,
    RESTITUTION,
    RIGHT_N,
    RIGHT_T,
    ROUNDING,
    SEPARATION,
    SETTLED,
    SLIDE_BEFORE,
    SLIDE_RATE,
    SPIN,
    SPIN_BEFORE,
    SWAY_BEFORE,
    SWAY_RATE,
    WANTED,
    WITHOUT,
    col,
    copy,
    delassus,
    real,
    whole,
)
from .touching import push, read_rates

MOST_BLOWS = 100_000
"""Of a sequential impact, before it is given up."""
MOST_BOUNCES, MOST_ROUNDS = 50, 2000
"""Of impacts at one instant, each of the contacts that approach then: with restitution, and at all. Contacts that slide
fast can feed bounces that go to and fro between the others and do not become lower."""
FIRST, OF_ALL = range(2)
"""Attempts at the first round of an impact."""
_OF_MOTION = ((RATE, RATE_BEFORE), (SLIDE_RATE, SLIDE_BEFORE), (SWAY_RATE, SWAY_BEFORE), (SPIN, SPIN_BEFORE))


@internal
def strike(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Change the current velocities by the laws of the touching contacts.

    Those that separate beforehand take no part, so that none can put energy in without friction. Where they approach
    afterwards, velocities are looked for that fulfil the laws of all contacts at once (`strikes_anew`); where there are
    none that do not raise the energy, they are struck in another round: IN_ROUNDS. What it does goes to IMPULSE,
    FRICTION, LOSS, APPROACH, SEPARATION.
    """
    count, law, contacts = whole(ev)[COUNT], ivec(dr.law, ws.n_contacts), ivec(ev.contacts, ev.most)
    rate, slide_rate, rounding, low = col(ev, RATE), col(ev, SLIDE_RATE), col(ev, ROUNDING), whole(ev)[WITHOUT] != 0
    approach, loss, p_n, p_t = col(ev, APPROACH), col(ev, LOSS), col(ev, P_N), col(ev, P_T)
    active, joint_rates, phid = ivec(ws.active, ws.m_act), vec(ev.joint_rates, ws.m_act), vec(ws.phid, ws.m_ext)
    for i in range(ws.m_act):
        joint_rates[i] = phid[active[i]]
    sequential, largest = False, 0.0
    for i in range(count):
        col(ev, IMPULSE)[i] = col(ev, FRICTION)[i] = loss[i] = 0.0
        approach[i] = max(-rate[i], 0.0)
        sequential = sequential or law[contacts[i]] == SEQUENTIAL
        largest = max(largest, abs(rate[i]), abs(slide_rate[i]))
    real(ev)[RESIDUAL], left, noise = 0.0, np.inf, UNSOLVED * largest
    whole(ev)[IN_ROUNDS] = 0
    before_n, before_t = col(ev, RATE_BEFORE), col(ev, SLIDE_BEFORE)
    for turn in range(MOST_ROUNDS + 1):
        before_round, left, fastest = left, 0.0, 0.0
        for i in range(count):
            left, fastest = max(left, -rate[i] / rounding[i]), max(fastest, -rate[i])
        # where contacts repeat each other nearly, no round gets below what rounding leaves in the forces: a part of the
        # fastest motion, for each contact, whatever its own rounding is
        if left <= 1.0 or (0.5 * before_round <= left and fastest <= noise):
            break
        if turn == MOST_ROUNDS:
            return ENDLESS_ROUNDS
        for i in range(count):
            approach[i] = approach[i] if approach[i] > rounding[i] else -rate[i]
            before_n[i], before_t[i] = rate[i], slide_rate[i]
        attempt, anew = FIRST, True
        while anew:
            last = turn >= MOST_BOUNCES
            status = _sequence(ev, ws, low) if sequential else _at_once(ev, dr, ws, low, last, attempt == OF_ALL)
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
            col(ev, FRICTION)[i] += p_t[i]
    # the joints keep their rates
    evaluate_residuals(ws)
    read_rates(ev, ws)
    for i in range(ws.m_act):
        real(ev)[RESIDUAL] = max(real(ev)[RESIDUAL], abs(phid[active[i]] - joint_rates[i]))
    copy(col(ev, SEPARATION), rate, count)
    real(ev)[LEFT] = left
    return SETTLED


@internal
def _lost(ev: Any, i: int) -> float:
    """Energy that contact i has taken in this round, J."""
    along = col(ev, P_N)[i] * (col(ev, RATE_BEFORE)[i] + col(ev, RATE)[i])
    return float(-0.5 * (along + col(ev, P_T)[i] * (col(ev, SLIDE_BEFORE)[i] + col(ev, SLIDE_RATE)[i])))


@internal
def strikes_anew(ev: Any, dr: Any, ws: Any, status: int, attempt: int, lost: float) -> bool:
    """True if the first round of an impact is undone, for the next attempt at it: FIRST, where a contact that separated
    beforehand approaches now; OF_ALL, where impulses of all contacts are not found or raise the energy (`lost` < 0, J).
    The third, with the impulses of FIRST, is the first of some rounds, and so is FIRST where Poisson's law takes part,
    which speaks of the impulses of each round."""
    count, part, rate, rounding = whole(ev)[COUNT], col(ev, PART), col(ev, RATE), col(ev, ROUNDING)
    poisson, anew = 0, attempt == OF_ALL and (status != SETTLED or lost < -ENERGY_GAIN * vec(ws.energy, 3)[0])
    whole(ev)[IN_ROUNDS] = 1 if attempt > OF_ALL or anew else 0
    if attempt == FIRST and status == SETTLED:
        for i in range(count):
            anew = anew or (part[i] == 0.0 and rate[i] < -rounding[i])
        for i in range(count):
            poisson += ivec(dr.law, ws.n_contacts)[ivec(ev.contacts, ev.most)[i]] == POISSON
        if anew and poisson > 0:
            whole(ev)[IN_ROUNDS] = 1 if poisson < count else 0
            anew = False
    if not anew:
        return False
    for i in range(ws.n):
        vec(ws.v, ws.n_ext)[i] = vec(ev.velocities, ws.n_ext)[i]
    for now, before in _OF_MOTION:
        copy(col(ev, now), col(ev, before), count)
    real(ev)[RESIDUAL] = 0.0
    return True


@internal
def restitution(ev: Any, low: bool, i: int) -> float:
    """Of touching contact i; `low`: those that are `LOW` are struck without it."""
    return 0.0 if low and col(ev, LOW)[i] != 0.0 else col(ev, RESTITUTION)[i]


@internal
def _at_once(ev: Any, dr: Any, ws: Any, low: bool, last: bool, every: bool) -> int:
    """One complementarity problem of the contacts that do not separate, or of `every` one, and a second one for the
    expansion of Poisson's contacts. `last`: one of all contacts, without restitution, after which none approaches."""
    count, law, contacts = whole(ev)[COUNT], ivec(dr.law, ws.n_contacts), ivec(ev.contacts, ev.most)
    part, p_n, p_t, base = col(ev, PART), col(ev, P_N), col(ev, P_T), col(ev, BASE)
    rate, rounding, wanted, back = col(ev, RATE), col(ev, ROUNDING), col(ev, WANTED), False
    for i in range(count):
        part[i] = last or every or rate[i] <= rounding[i]
        poisson = law[contacts[i]] == POISSON
        clear = 0.0 if abs(rate[i]) <= rounding[i] else min(rate[i], 0.0)
        wanted[i] = 0.0 if poisson or last else restitution(ev, low, i) * clear
        base[i] = 0.0
        p_n[i] = p_t[i] = 0.0
        back = back or (part[i] != 0.0 and poisson and restitution(ev, low, i) > 0.0)
    status = _solve_and_push(ev, ws, wanted)
    if status != SETTLED or last or not back:
        return status
    for i in range(count):
        base[i] = restitution(ev, low, i) * p_n[i] if law[contacts[i]] == POISSON else 0.0
    return _solve_and_push(ev, ws, wanted)


@internal
def _solve_and_push(ev: Any, ws: Any, wanted: Any) -> int:
    """Impulses of the contacts `PART` from the current rates, pushed and added to `P_N` and `P_T`; `BASE` is given in
    any case, and of what is beyond it complementarity is asked."""
    count, part, base = whole(ev)[COUNT], col(ev, PART), col(ev, BASE)
    rate, slide_rate, rounding = col(ev, RATE), col(ev, SLIDE_RATE), col(ev, ROUNDING)
    normal, tangential = col(ev, NOW_N), col(ev, NOW_T)
    for i in range(count):
        clear = 0.0 if abs(rate[i]) <= rounding[i] else rate[i]
        col(ev, RIGHT_N)[i] = clear + wanted[i]
        col(ev, RIGHT_T)[i] = 0.0 if abs(slide_rate[i]) <= rounding[i] else slide_rate[i]
    if impulses_among(ev, count) == NO_SOLUTION:
        return NO_IMPACT
    push(ev, ws, normal, tangential)
    largest, off = 0.0, 0.0
    for i in range(count):
        if part[i] != 0.0:
            largest = max(largest, normal[i] - base[i])
    for i in range(count):
        if part[i] == 0.0:
            continue
        motion = rate[i] + wanted[i]
        off = max(off, -motion)
        if normal[i] - base[i] > ADDED * largest:
            off = max(off, abs(motion))
        col(ev, P_N)[i] += normal[i]
        col(ev, P_T)[i] += tangential[i]
    real(ev)[RESIDUAL] = max(real(ev)[RESIDUAL], off)
    return SETTLED


@internal
def _sequence(ev: Any, ws: Any, low: bool) -> int:
    """One blow after another, the fastest approach first, until none approaches."""
    count, p_n, p_t, rounding = whole(ev)[COUNT], col(ev, P_N), col(ev, P_T), col(ev, ROUNDING)
    rate, slide_rate, a, mu = col(ev, RIGHT_N), col(ev, RIGHT_T), delassus(ev, count), col(ev, KINETIC)
    for i in range(count):
        p_n[i] = p_t[i] = 0.0
        rate[i], slide_rate[i] = col(ev, RATE)[i], col(ev, SLIDE_RATE)[i]
    for _ in range(MOST_BLOWS):
        k = 0
        for i in range(count):
            k = i if rate[i] < rate[k] else k
        if rate[k] >= -rounding[k]:
            push(ev, ws, p_n, p_t)
            return SETTLED
        one, other = one_contact(
            a[k, k], a[k, count + k], a[count + k, count + k], rate[k] * (1.0 + restitution(ev, low, k)),
            slide_rate[k], mu[k] if a[count + k, count + k] > 0.0 else 0.0, 0.0, 0.0,
        )  # fmt: skip
        if not np.isfinite(one):
            return NO_IMPACT
        p_n[k] += one
        p_t[k] += other
        for i in range(count):
            rate[i] += a[i, k] * one + a[i, count + k] * other
            slide_rate[i] += a[count + i, k] * one + a[count + i, count + k] * other
        # exactly, so that the same contact is not struck again by rounding
        rate[k] = max(rate[k], 0.0)
    return ENDLESS_BLOWS
