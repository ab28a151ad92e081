"""Impact of several contacts at once at velocity-increment level, joints and friction included.

[M Phi_q^T; Phi_q 0] (dv, Lambda) = (G_N^T P_N + G_T^T P_T, 0), v^+ = v^- + dv, with the impact law of each contact.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import ENERGY_GAIN
from ..state.impact_law_codes import BY_POISSON
from .records import SETTLED, scalars, touching

MOST_BLOWS = 100_000
"""Of a sequential impact, before it is given up."""
MOST_BOUNCES, MOST_ROUNDS = 50, 2000
"""Of impacts at one instant, each of the contacts that approach then: with restitution, and at all. Contacts that slide
fast can feed bounces that go to and fro between the others and do not become lower."""
FIRST_ROUND, ALL_ROUNDS = range(2)
"""Attempts at the first round of an impact."""


@internal
def strikes_anew(instant: Any, drive: Any, workspace: Any, status: int, attempt: int, lost: float) -> bool:
    """True if the first round of an impact is undone, for the next attempt at it: FIRST_ROUND, where a contact that
    separated beforehand approaches now; ALL_ROUNDS, where impulses of all contacts are not found or raise the energy
    (`lost` < 0, J). The third, with the impulses of FIRST_ROUND, is the first of some rounds, and so is FIRST_ROUND
    where Poisson's law takes part, which speaks of the impulses of each round."""
    contact = touching(instant)
    count, part, rate, rounding = (
        scalars(instant).count,
        vec(instant.part, instant.most),
        contact.gap_rate,
        contact.rate_rounding,
    )
    poisson, anew = (
        0,
        attempt == ALL_ROUNDS and (status != SETTLED or lost < -ENERGY_GAIN * vec(workspace.energy, 3)[0]),
    )
    scalars(instant).in_rounds = 1 if attempt > ALL_ROUNDS or anew else 0
    if attempt == FIRST_ROUND and status == SETTLED:
        for i in range(count):
            anew = anew or (part[i] == 0.0 and rate[i] < -rounding[i])
        for i in range(count):
            poisson += ivec(drive.law, workspace.n_contacts)[ivec(instant.contacts, instant.most)[i]] == BY_POISSON
        if anew and poisson > 0:
            scalars(instant).in_rounds = 1 if poisson < count else 0
            anew = False
    if not anew:
        return False
    for i in range(workspace.n):
        vec(workspace.v, workspace.n_ext)[i] = vec(instant.velocities, workspace.n_ext)[i]
    for i in range(count):
        contact[i].gap_rate, contact[i].sliding_rate = contact[i].gap_rate_before, contact[i].sliding_rate_before
        contact[i].sliding_rate2, contact[i].spin_rate = contact[i].sliding_rate2_before, contact[i].spin_rate_before
    scalars(instant).constraint_residual = 0.0
    return True


@internal
def restitution(instant: Any, low: bool, i: int) -> float:
    """Of touching contact i; `low`: those with a negligible bounce are struck without it."""
    return 0.0 if low and touching(instant)[i].negligible_bounce != 0.0 else touching(instant)[i].restitution
