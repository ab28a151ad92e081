"""The contact state machine: what events do to modes, velocities and structure."""

import logging
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import ConsistencyError, SimulationError
from ..events import Event
from ..rounding import FORCE_ROUNDING, GAP_ROUNDING, UNSOLVED
from .complementarity import MANY
from .force_contact import handle_force
from .impact import EndlessImpact, Impact, strike
from .laws import ForceLaw, ImpactLaw
from .lcp import NoComplementarySolution
from .massless import settle_massless
from .modes import (
    APPROACH_SPEED,
    CLOSED,
    GAP_START,
    IMPULSE_JUMP,
    LARGEST_APPROACH,
    LOSS_JUMP,
    MODE,
    OPEN,
    RATIO,
    SLIDE,
    SLIDE_START,
    STICKS,
)
from .resting import LOOSEST_RANK, Resting
from .settling import Settling, read, unresolved_speed
from .touching import Touching

if TYPE_CHECKING:
    from ..integrate.engine import Engine

logger = logging.getLogger(__name__)

ENERGY_GAIN = 1e-12
"""Of the kinetic energy: an impact that gains more is reported."""


def handle(sim: "Engine", pending: list[int]) -> None:
    """The contacts `pending` have events at the workspace's current point (the newest row of the history)."""
    constraints, massless = [], []
    for k in pending:
        law = sim.assembly.contacts[k].law
        if isinstance(law, ForceLaw):
            handle_force(sim, k, law)
        elif k in sim.assembly.massless_contacts:
            massless.append(k)
        else:
            constraints.append(k)
    if massless:
        settle_massless(sim, massless)
    if constraints:
        settle(sim, constraints)


def settle(sim: "Engine", pending: list[int]) -> None:
    """Impacts, then which of the touching constraint contacts stay, and which stick or slide."""
    contacts = sim.touching(pending)
    now = read(sim, contacts, pending)
    scale = sim.assembly.coordinate_scale
    accelerations = float(np.max(np.abs(sim.workspace.arrays["a"][: sim.assembly.n]) / scale, initial=0.0))
    slide_values, gaps = sim.slide_values(contacts), sim.gap_values(contacts)
    touching = Touching(sim, contacts, sim.held())
    rounding = sim.rate_rounding(contacts)
    gap_rate, slide_rate = touching.rates()
    if len(contacts) > MANY:
        # what an impact of many leaves is no reason for another
        left = UNSOLVED * float(max(np.max(np.abs(gap_rate)), np.max(np.abs(slide_rate))))
        rounding = np.where((gap_rate < -rounding) & (gap_rate >= -left), 2.0 * np.abs(gap_rate), rounding)
    approaching = (gap_rate < -rounding) & ((now.was == OPEN) | sim.formula.exact)
    if np.any(approaching):
        rounding = rounding * max(1.0, 2.0 * _impact(sim, touching, now, rounding))
        accelerations = 0.0
    resting = Resting(sim, touching, now, rounding, accelerations)
    chosen = resting.choose()
    while True:
        try:
            _take(sim, now, chosen, slide_values, gaps)
            break
        except ConsistencyError:
            # contacts that each can be told from any other repeat each other together
            if not chosen or resting.rank >= LOOSEST_RANK:
                raise
            chosen = resting.keep(min(100.0 * resting.rank, LOOSEST_RANK))
    _report(sim, now, pending)


# ---- velocity level -------------------------------------------------------------------------------------------------


def _impact(sim: "Engine", touching: Touching, now: Settling, rounding: NDArray[np.float64]) -> float:
    """Strike; contacts that would bounce ever lower are struck without restitution, if they then stay. Returns the
    approach that rounding has left, in parts of `rounding`."""
    memory, contacts = sim.memory, now.contacts
    laws: list[ImpactLaw] = [sim.assembly.contacts[k].law for k in contacts]  # type: ignore[misc]
    restitution = np.array([law.restitution for law in laws])
    kinetic, before = sim.kinetic_energy(), sim.workspace.arrays["v"].copy()
    now.forget_events()
    impact = _strike(sim, touching, restitution, rounding)
    largest = np.maximum(memory[contacts, LARGEST_APPROACH], impact.approach)
    ratio = np.array([law.rest_ratio for law in laws])
    low = impact.separation <= np.maximum(ratio * largest, unresolved_speed(sim, contacts, now.falls))
    low &= (impact.impulse > 0.0) & (restitution > 0.0) & (impact.approach > rounding)
    if np.any(low):
        bounced, velocities = impact, sim.workspace.arrays["v"].copy()
        sim.workspace.arrays["v"][:] = before
        impact = _strike(sim, touching, np.where(low, 0.0, restitution), rounding)
        stay = Resting(sim, touching, now, rounding).forces().normal > 0.0
        if np.all(stay[low]):
            now.rests = {k for k, rest in zip(contacts, low, strict=True) if rest}
        else:
            sim.workspace.arrays["v"][:] = velocities
            impact = bounced
    total_loss = float(np.sum(impact.energy_loss))
    sim.add_input_work(sim.kinetic_energy() - kinetic + total_loss)
    if total_loss < -ENERGY_GAIN * max(kinetic, 1e-300):
        named = ", ".join(f"'{c.name}' ({type(law).__name__})" for c, law in zip(touching.infos, laws, strict=True))
        logger.warning(
            "at t = %.9g s an impact of %s raises the energy by %.3g J: Newton's law can with friction or several "
            "contacts; PoissonImpact does not with friction",
            sim.t_internal,
            named,
            -total_loss,
        )
    least = FORCE_ROUNDING * float(np.max(impact.impulse))
    # a gap that would open again by itself before it could be seen to be negative
    grazes = (now.was == OPEN) & (impact.approach <= unresolved_speed(sim, contacts, -now.falls))
    for i in np.argsort(-impact.approach, kind="stable"):
        k = contacts[i]
        if impact.impulse[i] <= least:
            continue
        memory[k, IMPULSE_JUMP] += impact.impulse[i]
        memory[k, LOSS_JUMP] += impact.energy_loss[i]
        if impact.approach[i] > rounding[i]:
            memory[k, APPROACH_SPEED] = impact.approach[i]
            memory[k, LARGEST_APPROACH] = largest[i]
        kind, name = "graze" if grazes[i] else "impact", sim.assembly.contacts[k].name
        sim.add_event(
            Event(
                sim.t_internal, kind, name, float(impact.impulse[i]),
                float(impact.energy_loss[i]), max(float(impact.approach[i]), 0.0),
                max(float(impact.separation[i]), 0.0), impact.residual, float(impact.friction_impulse[i]),
            )
        )  # fmt: skip
    return impact.left


def _strike(
    sim: "Engine", touching: Touching, restitution: NDArray[np.float64], rounding: NDArray[np.float64]
) -> Impact:
    try:
        return strike(touching, restitution, rounding)
    except (NoComplementarySolution, EndlessImpact) as error:
        names = ", ".join(f"'{c.name}'" for c in touching.infos)
        raise SimulationError(
            f"impact of contacts {names} at t = {sim.t_internal:.9g} s: {error}. With large friction coefficients the "
            "impact laws may have no solution: use PoissonImpact, less friction, or force laws",
            t=sim.t_internal,
            loop="impact",
        ) from error


# ---- taking and reporting -------------------------------------------------------------------------------------------


def _take(
    sim: "Engine",
    now: Settling,
    chosen: dict[int, tuple[float, float]],
    slide_values: dict[int, float],
    gaps: NDArray[np.float64],
) -> None:
    """Set the modes, bring gaps that are more than rounding and all rates of new constraints to zero, and solve for the
    accelerations."""
    memory, none = sim.memory, GAP_ROUNDING * sim.gap_size(now.contacts)
    changed = False
    for i, k in enumerate(now.contacts):
        memory[k, MODE] = CLOSED if k in chosen else OPEN
        slide, memory[k, RATIO] = chosen.get(k, (STICKS, 0.0))
        memory[k, SLIDE] = slide
        if k not in chosen:
            memory[k, GAP_START] = 0.0
            continue
        if now.was[i] != CLOSED:
            memory[k, GAP_START] = gaps[i] if abs(gaps[i]) <= none[i] else 0.0
        kept = now.was[i] == CLOSED and now.slid[i] == slide
        changed |= not kept
        if slide == STICKS and not kept and k in slide_values:
            memory[k, SLIDE_START] = slide_values[k]
    if chosen or np.any(now.was == CLOSED):
        sim.use_modes(accelerations=False)
    if changed and sim.formula.exact:
        sim.meet_constraints()
    sim.solve_accelerations()


def _report(sim: "Engine", now: Settling, pending: list[int]) -> None:
    memory, started = sim.memory, sim.started
    for i, k in enumerate(now.contacts):
        contact, mode, slide = sim.assembly.contacts[k], memory[k, MODE], memory[k, SLIDE]
        kind = ""
        if mode == CLOSED and now.was[i] != CLOSED:
            kind = "rest" if k in now.rests else "close"
        elif mode == OPEN and now.was[i] == CLOSED:
            kind = "open"
        elif mode == OPEN and not now.struck and k in pending and started:
            kind = "graze"
        elif mode == CLOSED and contact.coulomb is not None and slide != now.slid[i]:
            slides, slid = abs(slide) == 1.0, abs(now.slid[i]) == 1.0
            kind = "slip" if slides else "stick" if slid else ""
        if kind:
            speed = max(sim.gap_rate(k), 0.0) if kind == "open" else 0.0
            sim.add_event(Event(sim.t_internal, kind, contact.name, separation_speed=speed))
