"""Contacts that act as forces: what their beginning and end do."""

from typing import TYPE_CHECKING

from ..events import Event
from ..rounding import DEEPEST, FIRST_PENETRATION
from ..system.assembly import ContactInfo
from .friction import LuGreFriction
from .laws import ForceLaw
from .modes import ACTIVE, APPROACH_SPEED, LARGEST_APPROACH, LOSS_JUMP, MODE, OPEN, RELEASED

if TYPE_CHECKING:
    from ..integrate.engine import Engine


def handle_force(sim: "Engine", k: int, law: ForceLaw) -> None:
    """Contact k with a force law has an event at the workspace's current point."""
    contact, mode = sim.assembly.contacts[k], sim.memory[k, MODE]
    if mode == OPEN:
        _begin_force(sim, k, contact, law)
    else:
        _end_force(sim, k, contact, law, mode)


def _begin_force(sim: "Engine", k: int, contact: ContactInfo, law: ForceLaw) -> None:
    memory = sim.memory[k]
    approach = -sim.gap_rate(k)
    least = law.least_approach_speed(sim.scales.rate * float(sim.workspace.arrays["row_scale"][contact.row]))
    memory[APPROACH_SPEED] = max(approach, least, _settling_speed(sim, k, contact, law))
    memory[MODE] = ACTIVE
    memory[LARGEST_APPROACH] = max(memory[LARGEST_APPROACH], approach)
    _let_bristles_go(sim, k, contact)
    sim.open_accounts[k] = sim.contact_accounts(k)
    sim.use_modes()
    sim.start_small(k, memory[APPROACH_SPEED])
    sim.add_event(Event(sim.t_internal, "close", contact.name, approach_speed=approach))


def _let_bristles_go(sim: "Engine", k: int, contact: ContactInfo) -> None:
    """LuGre's bristles stand straight again; what they held is lost."""
    if isinstance(contact.friction, LuGreFriction):
        v = sim.workspace.arrays["v"]
        sim.memory[k, LOSS_JUMP] += 0.5 * contact.friction.bristle_stiffness * float(v[contact.bristle]) ** 2
        v[contact.bristle] = 0.0


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
    size = float(sim.workspace.arrays["row_scale"][contact.row])
    low, high = 0.0, FIRST_PENETRATION * size
    while law.evaluate(high, 0.0, 1.0)[3] < weight:
        low, high = high, 2.0 * high
        if high > DEEPEST * size:
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
            sim.start_small(k, memory[APPROACH_SPEED])
        sim.use_modes()
        return
    early = law.release == "force"
    if early:
        # what the spring still holds when the force has reached zero is never given back
        memory[LOSS_JUMP] += sim.elastic_energy(k, contact)
    memory[MODE] = RELEASED if early else OPEN
    _let_bristles_go(sim, k, contact)
    impulse, loss = sim.contact_accounts(k)
    impulse_before, loss_before = sim.open_accounts.get(k, (0.0, 0.0))
    sim.use_modes()
    sim.add_event(
        Event(
            sim.t_internal, "open", contact.name, impulse - impulse_before, loss - loss_before,
            float(memory[APPROACH_SPEED]), sim.gap_rate(k),
        )
    )  # fmt: skip
