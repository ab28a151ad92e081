"""Impact of several contacts at once at velocity-increment level, joints and friction included.

[M Phi_q^T; Phi_q 0] (dv, Lambda) = (G_N^T P_N + G_T^T P_T, 0), v^+ = v^- + dv, with the impact law of each contact.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .complementarity import ContactSolution, solve_contacts
from .laws import ImpactLaw, NewtonImpact, PoissonImpact
from .touching import Touching

Vector = NDArray[np.float64]

MOST_BLOWS = 100_000
"""Of a sequential impact, before it is given up."""


class EndlessImpact(ArithmeticError):
    """A sequence of blows that does not end."""


@dataclass(frozen=True)
class Impact:
    """What an impact did, each entry for one contact, (contacts,)."""

    impulse: Vector
    """Normal impulses, N s."""
    friction_impulse: Vector
    """Along the tangents, N s."""
    energy_loss: Vector
    """J; negative where the law puts energy in."""
    approach: Vector
    """-g' before, m/s."""
    separation: Vector
    """g' after, m/s."""
    residual: float
    """Largest violation of the joints and of complementarity at velocity-increment level, m/s."""


def strike(touching: Touching, restitution: Vector, rounding: float) -> Impact:
    """Change the current velocities by the laws of the touching contacts, with these coefficients of restitution.

    Contacts whose gap closes by less than `rounding` (m/s) do not count as approaching.

    Raises
    ------
    NoComplementarySolution : if the laws have no solution.
    EndlessImpact : if sequential blows do not end.
    """
    laws: list[ImpactLaw] = [c.law for c in touching.infos]  # type: ignore[misc]
    mu = np.array([c.coulomb.coefficient if c.coulomb else 0.0 for c in touching.infos])
    joints = touching.sim.workspace.structure.active
    arrays = touching.sim.workspace.arrays
    gap_rate, slide_rate = touching.rates()
    before = arrays["phid"][joints].copy()
    if any(isinstance(law, NewtonImpact) and law.propagation == "sequential" for law in laws):
        normal, tangential = _sequence(touching, restitution, mu, rounding)
        violation = 0.0
    else:
        normal, tangential, violation = _at_once(touching, laws, restitution, mu)
    after_gap, after_slide = touching.rates()
    loss = -0.5 * (normal * (gap_rate + after_gap) + tangential * (slide_rate + after_slide))
    # the driver's jump is no error: joints keep their rates
    violation = max(violation, float(np.max(np.abs(arrays["phid"][joints] - before), initial=0.0)))
    return Impact(normal, tangential, loss, -gap_rate, after_gap, violation)


def _at_once(
    touching: Touching, laws: list[ImpactLaw], restitution: Vector, mu: Vector
) -> tuple[Vector, Vector, float]:
    """One complementarity problem, and a second one for the expansion of Poisson's contacts."""
    poisson = np.array([isinstance(law, PoissonImpact) for law in laws])
    newton_part = np.where(poisson, 0.0, restitution)
    free = np.zeros(len(laws))
    gap_rate, slide_rate = touching.rates()
    # a contact that separates already need only go on doing so
    wanted = newton_part * np.minimum(gap_rate, 0.0)
    found = solve_contacts(touching.a, gap_rate + wanted, slide_rate, mu, free)
    touching.push(found.normal, found.tangential)
    violation = _violation(found, *touching.rates(), wanted)
    normal, tangential = found.normal, found.tangential
    if np.any(poisson & (restitution > 0.0)):
        gap_rate, slide_rate = touching.rates()
        base = np.where(poisson, restitution * normal, 0.0)
        back = solve_contacts(touching.a, gap_rate + wanted, slide_rate, mu, free, base)
        touching.push(back.normal, back.tangential)
        normal, tangential = normal + back.normal, tangential + back.tangential
        # of what is beyond the given expansion, complementarity is asked
        left = ContactSolution(
            back.normal - base, back.tangential, back.normal_motion, back.tangential_motion, back.sticks
        )
        violation = max(violation, _violation(left, *touching.rates(), wanted))
    return normal, tangential, violation


def _violation(found: ContactSolution, gap_rate: Vector, slide_rate: Vector, wanted: Vector) -> float:
    """How far the velocities reached are from those of the solution, or below zero, m/s."""
    motion = gap_rate + wanted
    struck = found.normal > 1e-9 * float(np.max(found.normal, initial=0.0))
    return float(
        max(
            np.max(-np.minimum(motion, 0.0), initial=0.0),
            np.max(np.abs(motion[struck]), initial=0.0),
        )
    )


def _sequence(touching: Touching, restitution: Vector, mu: Vector, rounding: float) -> tuple[Vector, Vector]:
    """One blow after another, the fastest approach first, until none approaches."""
    count = len(restitution)
    normal, tangential = np.zeros(count), np.zeros(count)
    a = touching.a
    gap_rate, slide_rate = touching.rates()
    for _ in range(MOST_BLOWS):
        k = int(np.argmin(gap_rate))
        if gap_rate[k] >= -rounding:
            touching.push(normal, tangential)
            return normal, tangential
        one = np.array([k])
        alone = type(a)(a.nn[np.ix_(one, one)], a.nt[np.ix_(one, one)], a.tt[np.ix_(one, one)])
        blow = solve_contacts(alone, gap_rate[one] * (1.0 + restitution[one]), slide_rate[one], mu[one], np.zeros(1))
        normal[k] += blow.normal[0]
        tangential[k] += blow.tangential[0]
        gap_rate = gap_rate + a.nn[:, k] * blow.normal[0] + a.nt[:, k] * blow.tangential[0]
        slide_rate = slide_rate + a.nt[k] * blow.normal[0] + a.tt[:, k] * blow.tangential[0]
        # exactly, so that the same contact is not struck again by rounding
        gap_rate[k] = max(gap_rate[k], 0.0)
    raise EndlessImpact(f"{MOST_BLOWS} blows one after another do not end")
