"""The contact state machine: what events do to modes, velocities and structure."""

import logging
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from ..events import Event
from .complementarity import ContactSolution, independent, solve_contacts
from .force_contact import handle_force
from .impact import EndlessImpact, Impact, strike
from .laws import ForceLaw, ImpactLaw
from .lcp import NoComplementarySolution
from .modes import (
    APPROACH_SPEED,
    CLOSED,
    IDLE,
    IMPULSE_JUMP,
    LARGEST_APPROACH,
    LOSS_JUMP,
    MODE,
    OPEN,
    SLIDE,
    SLIDE_START,
    STICKS,
)
from .touching import Touching

if TYPE_CHECKING:
    from ..integrate.engine import Engine

logger = logging.getLogger(__name__)

MOST_EVENTS_AT_ONCE = 50
"""Events without progress in time before a run is given up."""
NO_FORCE = 1e-12
"""A contact force below this part of the largest is none."""
NO_ACCELERATION = 1e-11
"""A gap's acceleration below this part of what weights and forces make is none."""
ENERGY_GAIN = 1e-12
"""Of the kinetic energy: an impact that gains more is reported."""
NEARLY_SINGULAR = 1e-6
"""Part of a contact's inverse effective mass that friction leaves where it is about to jam."""

DEEPEST = 1e12
"""m; no spring that holds a weight needs a deeper penetration."""


def handle(sim: "Engine", pending: list[int]) -> None:
    """The contacts `pending` have events at the workspace's current point (the newest row of the history)."""
    constraints = []
    for k in pending:
        law = sim.assembly.contacts[k].law
        if isinstance(law, ForceLaw):
            handle_force(sim, k, law)
        else:
            constraints.append(k)
    if constraints:
        settle(sim, constraints)


@dataclass
class _Settling:
    """What is known of the touching contacts (their numbers in `contacts`) while an instant is settled."""

    contacts: list[int]
    was: NDArray[np.float64]
    """Modes before, (contacts,)."""
    slid: NDArray[np.float64]
    """SLIDE before, (contacts,)."""
    leaves: NDArray[np.bool_]
    """The event is that the contact's force became zero."""
    slips: NDArray[np.float64]
    """+-1 where the event is that a sticking contact reached its limit: the direction in which it goes; else 0."""
    stops: NDArray[np.bool_]
    """The event is that a sliding contact came to a stop."""
    struck: bool = False
    held: set[int] = field(default_factory=set)
    """Contacts at the limit of their friction that others keep from sliding."""
    rests: set[int] = field(default_factory=set)


def settle(sim: "Engine", pending: list[int]) -> None:
    """Impacts, then which of the touching constraint contacts stay, and which stick or slide."""
    contacts = sim.touching(pending)
    now = _read(sim, contacts, pending)
    accelerations = float(np.max(np.abs(sim.workspace.arrays["a"][: sim.assembly.n]), initial=0.0))
    slide_values = sim.slide_values(contacts)
    touching = Touching(sim, contacts)
    rounding = sim.rate_rounding()
    gap_rate, _ = touching.rates()
    approaching = (gap_rate < -rounding) & ((now.was == OPEN) | sim.formula.exact)
    if np.any(approaching):
        _impact(sim, touching, now, rounding)
        accelerations = 0.0
    chosen = _forces(sim, touching, now, rounding, accelerations)
    _take(sim, now, chosen, slide_values)
    _report(sim, now, pending)


def _read(sim: "Engine", contacts: list[int], pending: list[int]) -> _Settling:
    memory, arrays = sim.memory, sim.workspace.arrays
    was, slid = memory[contacts, MODE].copy(), memory[contacts, SLIDE].copy()
    count = len(contacts)
    leaves, stops, slips = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool), np.zeros(count)
    no_force = sim.no_force()
    for i, k in enumerate(contacts):
        if k not in pending or was[i] != CLOSED:
            continue
        contact = sim.assembly.contacts[k]
        force = -float(arrays["lam"][contact.row])
        # a method that does not meet the constraints at all levels may end a little before its force is zero
        leaves[i] = contact.coulomb is None or slid[i] == IDLE or force <= no_force
        if leaves[i] or contact.coulomb is None:
            continue
        if slid[i] == STICKS:
            friction = -float(arrays["lam"][contact.slide_row])
            if abs(friction) >= contact.coulomb.sticking_coefficient * force * (1.0 - 1e-9):
                slips[i] = -np.sign(friction)
        elif abs(slid[i]) == 1.0:
            stops[i] = True
    return _Settling(contacts, was, slid, leaves, slips, stops)


# ---- velocity level -------------------------------------------------------------------------------------------------


def _impact(sim: "Engine", touching: Touching, now: _Settling, rounding: float) -> None:
    """Strike; contacts that would bounce ever lower are struck without restitution, if they then stay."""
    memory, contacts = sim.memory, now.contacts
    laws: list[ImpactLaw] = [sim.assembly.contacts[k].law for k in contacts]  # type: ignore[misc]
    restitution = np.array([law.restitution for law in laws])
    kinetic, before = sim.kinetic_energy(), sim.workspace.arrays["v"].copy()
    now.struck = True
    now.leaves[:], now.stops[:], now.slips[:] = False, False, 0.0
    impact = _strike(sim, touching, restitution, rounding)
    largest = np.maximum(memory[contacts, LARGEST_APPROACH], impact.approach)
    ratio = np.array([law.rest_ratio for law in laws])
    low = (impact.impulse > 0.0) & (restitution > 0.0) & (impact.separation <= ratio * largest)
    low &= impact.approach > rounding
    if np.any(low):
        bounced, velocities = impact, sim.workspace.arrays["v"].copy()
        sim.workspace.arrays["v"][:] = before
        impact = _strike(sim, touching, np.where(low, 0.0, restitution), rounding)
        stay = _solve_forces(sim, touching, now, rounding)[0].normal > 0.0
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
    least = NO_FORCE * float(np.max(impact.impulse))
    for i in np.argsort(-impact.approach, kind="stable"):
        k = contacts[i]
        if impact.impulse[i] <= least:
            continue
        memory[k, IMPULSE_JUMP] += impact.impulse[i]
        memory[k, LOSS_JUMP] += impact.energy_loss[i]
        if impact.approach[i] > rounding:
            memory[k, APPROACH_SPEED] = impact.approach[i]
            memory[k, LARGEST_APPROACH] = largest[i]
        sim.add_event(
            Event(
                sim.t_internal, "impact", sim.assembly.contacts[k].name, float(impact.impulse[i]),
                float(impact.energy_loss[i]), max(float(impact.approach[i]), 0.0),
                max(float(impact.separation[i]), 0.0), impact.residual, float(impact.friction_impulse[i]),
            )
        )  # fmt: skip


def _strike(sim: "Engine", touching: Touching, restitution: NDArray[np.float64], rounding: float) -> Impact:
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


# ---- acceleration level ---------------------------------------------------------------------------------------------


def _at_rest(
    touching: Touching, now: _Settling, rounding: float
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Which of the touching contacts neither separate nor approach, and the direction in which friction is known."""
    gap_rate, slide_rate = touching.rates()
    resting = np.abs(gap_rate) <= rounding
    if not now.struck:
        # a constraint that holds does not separate, however much its method drifts
        resting |= now.was == CLOSED
    direction = np.where(np.abs(slide_rate) > rounding, np.sign(slide_rate), 0.0)
    if not now.struck:
        held = (now.was == CLOSED) & ((now.slid == STICKS) | (now.slid == IDLE))
        direction[held | now.stops] = 0.0
        slides = (now.was == CLOSED) & (np.abs(now.slid) == 1.0) & ~now.stops
        direction[slides] = now.slid[slides]
    direction = np.where(now.slips != 0.0, now.slips, direction)
    return resting, direction


def _solve_forces(
    sim: "Engine", touching: Touching, now: _Settling, rounding: float, accelerations: float = 0.0
) -> tuple[ContactSolution, NDArray[np.float64], float]:
    """Forces of all touching contacts (zero where they separate), known directions, and what no acceleration is."""
    resting, direction = _at_rest(touching, now, rounding)
    b_n, b_t = touching.free_accelerations()
    arrays, n = sim.workspace.arrays, sim.assembly.n
    level = max(float(np.max(np.abs(arrays["a"][:n]), initial=0.0)), accelerations, 1e-300)
    size = np.max(np.abs(touching.normal), axis=1)
    none = NO_ACCELERATION * level
    b_n = np.where(np.abs(b_n) <= none * size, 0.0, b_n)
    along = np.max(np.abs(touching.tangential), axis=1)
    b_t = np.where(np.abs(b_t) <= none * along, 0.0, b_t)
    mu = np.array(
        [
            0.0 if c.coulomb is None else c.coulomb.coefficient if d else c.coulomb.sticking_coefficient
            for c, d in zip(touching.infos, direction, strict=True)
        ]
    )
    takes = resting & ~now.leaves
    for _ in range(2):
        try:
            found = _for(touching, takes, b_n, b_t, mu, direction)
        except NoComplementarySolution as error:
            raise SimulationError(_no_solution(sim, touching), t=sim.t_internal, loop="contact") from error
        # one that leaves does so unless the others' forces press it together again
        back = resting & ~takes & (found.normal_motion < -1e3 * none * size)
        if not (sim.formula.exact and np.any(back)):
            break
        takes |= back
    return found, direction, none


def _for(
    touching: Touching, takes: NDArray[np.bool_], b_n: NDArray[np.float64], b_t: NDArray[np.float64],
    mu: NDArray[np.float64], direction: NDArray[np.float64],
) -> ContactSolution:  # fmt: skip
    """The solution with the contacts `takes`; the others get no force."""
    a, some = touching.a, np.flatnonzero(takes)
    found = solve_contacts(a.among(some), b_n[some], b_t[some], mu[some], direction[some])
    normal, tangential = np.zeros(len(b_n)), np.zeros(len(b_n))
    normal[some], tangential[some] = found.normal, found.tangential
    return ContactSolution(
        normal, tangential, b_n + a.nn @ normal + a.nt @ tangential, b_t + a.nt.T @ normal + a.tt @ tangential,
        found.sticks,
    )  # fmt: skip


def _forces(
    sim: "Engine", touching: Touching, now: _Settling, rounding: float, accelerations: float
) -> dict[int, float]:
    """The contacts that stay closed, and how each moves along its tangent (a value of SLIDE)."""
    if not np.any(_at_rest(touching, now, rounding)[0]):
        return {}
    found, direction, none = _solve_forces(sim, touching, now, rounding, accelerations)
    _refuse_jam(sim, touching, now, found, direction)
    largest = float(np.max(found.normal, initial=0.0))
    closed = found.normal > NO_FORCE * max(1.0, largest)
    if not now.struck:
        # touching without force: as it was
        closed |= (now.was == CLOSED) & ~now.leaves & (np.abs(found.normal_motion) <= none)
    slides: dict[int, float] = {}
    sticking = []
    for i in np.flatnonzero(closed):
        coulomb = touching.infos[i].coulomb
        if coulomb is None:
            slides[i] = IDLE
        elif direction[i] != 0.0:
            slides[i] = direction[i]
        elif found.sticks or abs(found.tangential[i]) < coulomb.sticking_coefficient * found.normal[i] * (1.0 - 1e-9):
            sticking.append(i)
        elif coulomb.sticking_coefficient == 0.0:
            slides[i] = IDLE
        else:
            slides[i] = -np.sign(found.tangential[i])
    normals = np.flatnonzero(closed)[np.argsort(-found.normal[closed], kind="stable")]
    kept_n, kept_t = independent(touching.a, normals, np.array(sticking, dtype=np.intp))
    for j, i in enumerate(sticking):
        slides[i] = STICKS if j in kept_t else IDLE
    saturated = [i for i in normals if abs(slides[i]) == 1.0 and touching.infos[i].coulomb is not None]
    both = np.array(sticking + saturated, dtype=np.intp)
    free = independent(touching.a, normals, both)[1]
    now.held = {now.contacts[i] for j, i in enumerate(both) if j >= len(sticking) and j not in free}
    return {now.contacts[normals[j]]: slides[normals[j]] for j in kept_n}


def _refuse_jam(
    sim: "Engine", touching: Touching, now: _Settling, found: ContactSolution, direction: NDArray[np.float64]
) -> None:
    """Painleve's paradox: friction turns the effect of the normal force round."""
    for i, contact in enumerate(touching.infos):
        if direction[i] == 0.0 or contact.coulomb is None:
            continue
        own = touching.a.nn[i, i]
        left = own - contact.coulomb.coefficient * direction[i] * touching.a.nt[i, i]
        if left > NEARLY_SINGULAR * own:
            continue
        if found.normal[i] > 0.0 or now.was[i] == CLOSED:
            raise SimulationError(
                _painleve(sim, contact.name, contact.coulomb.coefficient), t=sim.t_internal, loop="contact"
            )


def _painleve(sim: "Engine", name: str, mu: float) -> str:
    return (
        f"contact '{name}', t = {sim.t_internal:.9g} s: Painleve's paradox. Sliding with mu = {mu:g}, the friction "
        "presses the bodies together more than the normal force keeps them apart, so that rigid bodies with Coulomb "
        "friction have no (or no unique) accelerations here: use a smaller coefficient, or a force law with "
        "regularised friction for this contact"
    )


def _no_solution(sim: "Engine", touching: Touching) -> str:
    for i, contact in enumerate(touching.infos):
        if contact.coulomb is None:
            continue
        mu = contact.coulomb.coefficient
        if touching.a.nn[i, i] <= mu * abs(touching.a.nt[i, i]):
            return _painleve(sim, contact.name, mu)
    names = ", ".join(f"'{c.name}'" for c in touching.infos)
    return (
        f"contacts {names}, t = {sim.t_internal:.9g} s: no contact forces satisfy complementarity and friction at once "
        "(Painleve's paradox of several contacts): use smaller friction coefficients, or force laws"
    )


# ---- taking and reporting -------------------------------------------------------------------------------------------


def _take(sim: "Engine", now: _Settling, chosen: dict[int, float], slide_values: dict[int, float]) -> None:
    """Set the modes, bring gaps and rates of new constraints to zero, and solve for the accelerations."""
    memory = sim.memory
    changed = False
    for i, k in enumerate(now.contacts):
        slide = chosen.get(k)
        memory[k, MODE] = OPEN if slide is None else CLOSED
        memory[k, SLIDE] = STICKS if slide is None else slide
        if slide is None:
            continue
        kept = now.was[i] == CLOSED and now.slid[i] == slide
        changed |= not kept
        if slide == STICKS and not kept and k in slide_values:
            memory[k, SLIDE_START] = slide_values[k]
    sim.use_modes(accelerations=False)
    if changed and sim.formula.exact:
        sim.meet_constraints()
    sim.solve_accelerations()


def _report(sim: "Engine", now: _Settling, pending: list[int]) -> None:
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
            kind = "" if k in now.held else "slip" if slides else "stick" if slid else ""
        if kind:
            speed = max(sim.gap_rate(k), 0.0) if kind == "open" else 0.0
            sim.add_event(Event(sim.t_internal, kind, contact.name, separation_speed=speed))
