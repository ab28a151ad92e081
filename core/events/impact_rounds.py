"""Impact of several contacts at once at velocity-increment level, joints and friction included.

[M Phi_q^T; Phi_q 0] (dv, Lambda) = (G_N^T P_N + G_T^T P_T, 0), v^+ = v^- + dv, with the impact law of each contact.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import ENERGY_GAIN
from .laws import POISSON
from .records import (
    COUNT,
    IN_ROUNDS,
    LOW,
    PART,
    RATE,
    RATE_BEFORE,
    RESIDUAL,
    RESTITUTION,
    ROUNDING,
    SETTLED,
    SLIDE_BEFORE,
    SLIDE_RATE,
    SPIN,
    SPIN_BEFORE,
    SWAY_BEFORE,
    SWAY_RATE,
    col,
    copy,
    real,
    whole,
)

MOST_BLOWS = 100_000
"""Of a sequential impact, before it is given up."""
MOST_BOUNCES, MOST_ROUNDS = 50, 2000
"""Of impacts at one instant, each of the contacts that approach then: with restitution, and at all. Contacts that slide
fast can feed bounces that go to and fro between the others and do not become lower."""
FIRST, OF_ALL = range(2)
"""Attempts at the first round of an impact."""
_OF_MOTION = ((RATE, RATE_BEFORE), (SLIDE_RATE, SLIDE_BEFORE), (SWAY_RATE, SWAY_BEFORE), (SPIN, SPIN_BEFORE))


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
