"""Impact of several contacts at once at velocity-increment level, joints and friction included.

[M Phi_q^T; Phi_q 0] (dv, Lambda) = (G_N^T P_N + G_T^T P_T, 0), v^+ = v^- + dv, with the impact law of each contact.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..rounding import UNSOLVED
from .complementarity import ContactSolution, solve_contacts
from .laws import ImpactLaw, NewtonImpact, PoissonImpact
from .touching import Touching

Vector = NDArray[np.float64]

MOST_BLOWS = 100_000
"""Of a sequential impact, before it is given up."""


MOST_ROUNDS = 2000
"""Of impacts at one instant, each of the contacts that approach then."""


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
    """-g' before (of a contact that is struck later at the same instant: before that), m/s."""
    separation: Vector
    """g' after, m/s."""
    left: float
    """Approach that the last round has left because of rounding, in parts of what counts as none."""
    residual: float
    """Largest violation of the joints and of complementarity at velocity-increment level, m/s."""


def strike(touching: Touching, restitution: Vector, rounding: Vector) -> Impact:
    """Change the current velocities by the laws of the touching contacts, with these coefficients of restitution.

    Those that separate beforehand take no part, so that none can put energy in without friction; if they approach
    afterwards they are struck in another round. Rates below `rounding` (contacts,) in m/s are none.

    Raises
    ------
    NoComplementarySolution : if the laws have no solution.
    EndlessImpact : if the rounds, or sequential blows, do not end.
    """
    laws: list[ImpactLaw] = [c.law for c in touching.infos]  # type: ignore[misc]
    mu = np.array([c.coulomb.coefficient if c.coulomb else 0.0 for c in touching.infos])
    joints = touching.sim.workspace.structure.active
    arrays = touching.sim.workspace.arrays
    first, _ = touching.rates()
    before = arrays["phid"][joints].copy()
    count, violation = len(laws), 0.0
    normal, tangential, loss = np.zeros(count), np.zeros(count), np.zeros(count)
    approach = np.maximum(-first, 0.0)
    sequential = any(isinstance(law, NewtonImpact) and law.propagation == "sequential" for law in laws)
    rates = touching.rates()
    left, noise = np.inf, UNSOLVED * max(float(np.max(np.abs(x) / rounding)) for x in rates)
    for _ in range(MOST_ROUNDS):
        gap_rate, slide_rate = touching.rates()
        before_round, left = left, max(-float(np.min(gap_rate / rounding)), 0.0)
        # where contacts repeat each other nearly, no round gets below what rounding leaves in the forces
        if left <= 1.0 or 0.5 * before_round <= left <= noise:
            break
        approach = np.where(approach > rounding, approach, -gap_rate)
        if sequential:
            p_n, p_t = _sequence(touching, restitution, mu, rounding)
        else:
            part = np.flatnonzero(gap_rate <= rounding)
            p_n, p_t, off = _at_once(touching, part, [laws[i] for i in part], restitution[part], mu[part], rounding)
            violation = max(violation, off)
        after_gap, after_slide = touching.rates()
        loss -= 0.5 * (p_n * (gap_rate + after_gap) + p_t * (slide_rate + after_slide))
        normal, tangential = normal + p_n, tangential + p_t
    else:
        raise EndlessImpact(f"{MOST_ROUNDS} impacts of the touching contacts at one instant do not end")
    # the joints keep their rates
    violation = max(violation, float(np.max(np.abs(arrays["phid"][joints] - before), initial=0.0)))
    return Impact(normal, tangential, loss, approach, touching.rates()[0], left, violation)


def _at_once(
    touching: Touching,
    part: NDArray[np.intp],
    laws: list[ImpactLaw],
    restitution: Vector,
    mu: Vector,
    rounding: Vector,
) -> tuple[Vector, Vector, float]:
    """One complementarity problem of the contacts `part`, and a second one for the expansion of Poisson's contacts."""
    poisson = np.array([isinstance(law, PoissonImpact) for law in laws])
    a, free = touching.a.among(part), np.zeros(len(part))
    gap_rate, slide_rate = _clear_rates(touching, part, rounding)
    wanted = np.where(poisson, 0.0, restitution) * gap_rate
    found = solve_contacts(a, gap_rate + wanted, slide_rate, mu, free)
    _push(touching, part, found)
    violation = _violation(found, touching.rates()[0][part] + wanted)
    normal, tangential = np.zeros(len(touching.infos)), np.zeros(len(touching.infos))
    normal[part], tangential[part] = found.normal, found.tangential
    if np.any(poisson & (restitution > 0.0)):
        gap_rate, slide_rate = _clear_rates(touching, part, rounding)
        base = np.where(poisson, restitution * found.normal, 0.0)
        back = solve_contacts(a, gap_rate + wanted, slide_rate, mu, free, base)
        _push(touching, part, back)
        normal[part] += back.normal
        tangential[part] += back.tangential
        # of what is beyond the given expansion, complementarity is asked
        violation = max(violation, _violation(back, touching.rates()[0][part] + wanted, base))
    return normal, tangential, violation


def _clear_rates(touching: Touching, part: NDArray[np.intp], rounding: Vector) -> tuple[Vector, Vector]:
    """The rates of the contacts `part`, with zero for what is rounding."""
    gap_rate, slide_rate = (np.where(np.abs(x[part]) <= rounding[part], 0.0, x[part]) for x in touching.rates())
    return gap_rate, slide_rate


def _push(touching: Touching, part: NDArray[np.intp], found: ContactSolution) -> None:
    normal, tangential = np.zeros(len(touching.infos)), np.zeros(len(touching.infos))
    normal[part], tangential[part] = found.normal, found.tangential
    touching.push(normal, tangential)


def _violation(found: ContactSolution, motion: Vector, base: Vector | float = 0.0) -> float:
    """How far the motion reached is below zero, or from zero where a contact was struck, m/s."""
    free = found.normal - base
    struck = free > 1e-9 * float(np.max(free, initial=0.0))
    return max(float(np.max(-motion, initial=0.0)), float(np.max(np.abs(motion[struck]), initial=0.0)))


def _sequence(touching: Touching, restitution: Vector, mu: Vector, rounding: Vector) -> tuple[Vector, Vector]:
    """One blow after another, the fastest approach first, until none approaches."""
    count = len(restitution)
    normal, tangential = np.zeros(count), np.zeros(count)
    a = touching.a
    gap_rate, slide_rate = touching.rates()
    for _ in range(MOST_BLOWS):
        k = int(np.argmin(gap_rate))
        if gap_rate[k] >= -rounding[k]:
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
