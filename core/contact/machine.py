"""The contact state machine: what an event does to modes, velocities and structure."""

import logging
from typing import TYPE_CHECKING

from ..errors import SimulationError
from ..events import Event
from ..system.assembly import ContactInfo
from .impact import Impact, apply_impact
from .laws import ForceLaw, NewtonImpact
from .modes import (
    ACTIVE,
    APPROACH_SPEED,
    CLOSED,
    IMPULSE_JUMP,
    LARGEST_APPROACH,
    LOSS_JUMP,
    MODE,
    OPEN,
    RATE_ROUNDING,
    RELEASED,
)

if TYPE_CHECKING:
    from ..integrate.engine import Engine

logger = logging.getLogger(__name__)

MOST_EVENTS_AT_ONCE = 50
"""Events without progress in time before a run is given up."""

DEEPEST = 1e12
"""m; no spring that holds a weight needs a deeper penetration."""


def handle(sim: "Engine", k: int) -> None:
    """Contact k has an event at the workspace's current point (the newest row of the history)."""
    contact = sim.assembly.contacts[k]
    mode = sim.memory[k, MODE]
    if isinstance(contact.law, NewtonImpact):
        if mode == OPEN:
            _impact(sim, k, contact, contact.law)
        else:
            _open(sim, k, contact)
    elif mode == OPEN:
        _begin_force(sim, k, contact, contact.law)
    else:
        _end_force(sim, k, contact, contact.law, mode)


def _impact(sim: "Engine", k: int, contact: ContactInfo, law: NewtonImpact) -> None:
    memory = sim.memory[k]
    approach = -sim.gap_rate(k)
    if approach <= RATE_ROUNDING:
        # a touch without approach: a constraint only if it does not separate and the bodies are pressed together
        if approach > -RATE_ROUNDING and sim.presses(k):
            _close(sim, k, "close", approach)
        return
    largest = max(memory[LARGEST_APPROACH], approach)
    resting = law.restitution * approach <= law.rest_ratio * largest
    plastic = law.restitution == 0.0
    restitution = law.restitution
    kinetic, before = sim.kinetic_energy(), sim.workspace.arrays["v"].copy()
    stays = False
    if resting or plastic:
        impact, released = _strike(sim, k, contact, 0.0)
        stays = sim.presses(k)
        if resting and not plastic and not stays:
            # as it was before the try: the blow decides anew which contacts let go
            sim.workspace.arrays["v"][:] = before
            for j in released:
                sim.memory[j, MODE] = CLOSED
            impact, released = _strike(sim, k, contact, restitution)
        else:
            restitution = 0.0
    else:
        impact, released = _strike(sim, k, contact, restitution)
    memory[APPROACH_SPEED] = approach
    memory[LARGEST_APPROACH] = largest
    for j, other in enumerate(sim.assembly.contacts):
        # closed contacts carry their share of the blow
        sim.memory[j, IMPULSE_JUMP] += impact.impulses.get(other.row, 0.0)
    memory[LOSS_JUMP] += impact.energy_loss
    sim.add_input_work(sim.kinetic_energy() - kinetic + impact.energy_loss)
    sim.add_event(
        Event(
            sim.t_internal, "impact", contact.name, impact.impulse, impact.energy_loss, approach,
            restitution * approach, impact.residual,
        )
    )  # fmt: skip
    for j in released:
        other = sim.assembly.contacts[j]
        sim.add_event(Event(sim.t_internal, "open", other.name, separation_speed=max(sim.gap_rate(j), 0.0)))
    if stays:
        _close(sim, k, "rest" if resting and not plastic else "close", 0.0)
    else:
        sim.use_modes()


def _strike(sim: "Engine", k: int, contact: ContactInfo, restitution: float) -> tuple[Impact, list[int]]:
    """The velocity jump, computed in the structure in which the contact is closed; its mode is left as it was.

    Other closed contacts can push but not pull: those whose impulse would be tensile let go, and the impact is
    computed again from the velocities before, until none pulls. Returns the impact and the contacts that let go.
    """
    before = sim.workspace.arrays["v"].copy()
    mode = sim.memory[k, MODE]
    released: list[int] = []
    while True:
        sim.memory[k, MODE] = CLOSED
        sim.use_modes(accelerations=False)
        impact = apply_impact(sim.workspace, contact.row, restitution)
        sim.memory[k, MODE] = mode
        if impact is None:
            raise SimulationError(
                f"impact at contact '{contact.name}', t = {sim.t_internal:.9g} s: the matrix of the velocity increment "
                "is singular, so the contact repeats what other constraints say. Remove one of them.",
                t=sim.t_internal,
                loop="impact",
            )
        pulling = [
            j
            for j, other in enumerate(sim.assembly.contacts)
            if j != k and impact.impulses.get(other.row, 0.0) < -1e-12 * impact.impulse
        ]
        if not pulling:
            return impact, released
        sim.workspace.arrays["v"][:] = before
        for j in pulling:
            sim.memory[j, MODE] = OPEN
        released += pulling


def _close(sim: "Engine", k: int, kind: str, approach: float) -> None:
    sim.memory[k, MODE] = CLOSED
    sim.use_modes()
    sim.add_event(Event(sim.t_internal, kind, sim.assembly.contacts[k].name, approach_speed=max(approach, 0.0)))


def _open(sim: "Engine", k: int, contact: ContactInfo) -> None:
    sim.memory[k, MODE] = OPEN
    sim.use_modes()
    sim.add_event(Event(sim.t_internal, "open", contact.name, separation_speed=max(sim.gap_rate(k), 0.0)))


def _begin_force(sim: "Engine", k: int, contact: ContactInfo, law: ForceLaw) -> None:
    memory = sim.memory[k]
    approach = -sim.gap_rate(k)
    memory[APPROACH_SPEED] = max(approach, law.minimum_approach_speed, _settling_speed(sim, k, contact, law))
    memory[MODE] = ACTIVE
    memory[LARGEST_APPROACH] = max(memory[LARGEST_APPROACH], approach)
    sim.open_accounts[k] = sim.contact_accounts(k)
    sim.use_modes()
    sim.start_small(memory[APPROACH_SPEED])
    sim.add_event(Event(sim.t_internal, "close", contact.name, approach_speed=approach))


def _settling_speed(sim: "Engine", k: int, contact: ContactInfo, law: ForceLaw) -> float:
    """Speed with which shapes that are laid on each other settle: sqrt(g d), with g the acceleration that presses them
    and d the static penetration under it, m/s.

    Laws that divide by the approach speed would hold a contact that begins without one like glue. 0 for a law whose
    spring holds nothing.
    """
    pressing = -float(sim.workspace.arrays["phidd"][contact.row])
    if pressing <= 0.0:
        return 0.0
    weight = pressing * sim.effective_mass(k)
    low, high = 0.0, 1e-12
    while law.evaluate(high, 0.0, 1.0)[3] < weight:
        low, high = high, 2.0 * high
        if high > DEEPEST:
            return 0.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        if law.evaluate(middle, 0.0, 1.0)[3] < weight:
            low = middle
        else:
            high = middle
    return float((pressing * high) ** 0.5)


def _end_force(sim: "Engine", k: int, contact: ContactInfo, law: ForceLaw, mode: float) -> None:
    memory = sim.memory[k]
    if mode == RELEASED:
        if sim.gap(k) >= 0.0 or sim.gap_rate(k) > 0.0:
            memory[MODE] = OPEN
        else:
            # pressed again before the shapes came apart
            memory[MODE] = ACTIVE
            memory[LOSS_JUMP] -= sim.elastic_energy(k, contact)
            sim.start_small(memory[APPROACH_SPEED])
        sim.use_modes()
        return
    early = law.release == "force"
    if early:
        # what the spring still holds when the force has reached zero is never given back
        memory[LOSS_JUMP] += sim.elastic_energy(k, contact)
    memory[MODE] = RELEASED if early else OPEN
    impulse, loss = sim.contact_accounts(k)
    impulse_before, loss_before = sim.open_accounts.get(k, (0.0, 0.0))
    sim.use_modes()
    sim.add_event(
        Event(
            sim.t_internal, "open", contact.name, impulse - impulse_before, loss - loss_before,
            float(memory[APPROACH_SPEED]), sim.gap_rate(k),
        )
    )  # fmt: skip
