"""What a code without an impact law does: the constraint is switched on at closing, the approach velocity left in.

For the study of failures only. The contact opens when its multiplier has become tensile, located as always.
"""

from ...core import Simulation
from ...core.events import Event
from ...core.state.modes import CLOSED, OPEN


class NoVelocityJump(Simulation):
    """A run whose contacts close without an impact; contacts with force laws are not meant."""

    def handle_contacts(self, pending: list[int]) -> None:
        """Switch constraints on and off; velocities stay as they are."""
        for k in pending:
            rate, contact = self.gap_rate(k), self.assembly.contacts[k]
            closes = self.memory.mode[k] == OPEN and rate < 0.0
            if closes:
                self.memory.mode[k] = CLOSED
                event = Event(self.t_internal, "close", contact.name, approach_speed=-rate)
            else:
                self.memory.mode[k] = OPEN
                event = Event(self.t_internal, "open", contact.name, separation_speed=rate)
            self.add_event(event)
        self.use_modes()

    def unsettled(self) -> list[int]:
        """None: the multiplier is looked at after steps only, where the method's own equations have formed it."""
        return []
