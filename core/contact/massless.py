"""Contacts at massless ends of flexible bodies: they close and open without impulse.

While such a contact is open, the balance of forces at the end's node, "its element carries no force", is a constraint
with multiplier zero; while it is closed the gap is the constraint instead, and the element's force is the contact's.
Closing and opening exchange the two rows. Positions meet both at that moment (gap zero and force zero); the node's
velocity jumps, which takes no impulse and no energy, since nothing but the massless node moves in the M-norm's least
correction.
"""

from typing import TYPE_CHECKING

from ..events import Event
from .modes import APPROACH_SPEED, CLOSED, LARGEST_APPROACH, MODE, OPEN

if TYPE_CHECKING:
    from ..integrate.contact_side import ContactSide


def settle_massless(sim: "ContactSide", pending: list[int]) -> None:
    """The contacts `pending` (numbers), all at massless ends, have events at the workspace's current point: closed
    ones whose force became zero open, open ones that approach close."""
    memory, rows = sim.memory, [sim.assembly.contacts[k].row for k in pending]
    rates, accelerations = (sim.workspace.arrays[level][rows].copy() for level in ("phid", "phidd"))
    rounding = sim.rate_rounding(pending)
    was = memory[pending, MODE].copy()
    closes = (was != CLOSED) & ((rates < -rounding) | ((rates <= rounding) & (accelerations < 0.0)))
    memory[pending, MODE] = [CLOSED if closing else OPEN for closing in closes]
    sim.use_modes(accelerations=False)
    sim.meet_constraints()
    sim.solve_accelerations()
    for k, before, closing, rate in zip(pending, was, closes, rates, strict=True):
        name = sim.assembly.contacts[k].name
        if closing:
            speed = max(-float(rate), 0.0)
            memory[k, APPROACH_SPEED] = speed
            memory[k, LARGEST_APPROACH] = max(memory[k, LARGEST_APPROACH], speed)
            sim.add_event(Event(sim.t_internal, "close", name, approach_speed=speed))
        elif before == CLOSED:
            sim.add_event(Event(sim.t_internal, "open", name, separation_speed=max(sim.gap_rate(k), 0.0)))
        elif sim.started:
            sim.add_event(Event(sim.t_internal, "graze", name))
