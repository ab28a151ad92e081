"""Events: what happened at a contact, and when; and where one outer loop took over from another."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Event:
    """One event of one contact.

    kind : "impact" (velocity jump), "close" (a force law begins to act, or a contact becomes a constraint),
    "open" (it ends), "rest" (accumulating impacts end in persistent contact), "graze" (the gap touches zero without an
    approach that could be told from none), "stick" and "slip" (a closed contact with Coulomb friction comes to a stop,
    or begins to slide).
    """

    t: float
    """s."""
    kind: str
    contact: str
    impulse: float = 0.0
    """N s (N m s where the gap is an angle); for "open" of a force law: the impulse of the whole contact."""
    energy_loss: float = 0.0
    """J."""
    approach_speed: float = 0.0
    """m/s (or the unit of the contact's gap per s), before."""
    separation_speed: float = 0.0
    """m/s, after."""
    velocity_increment_residual: float = 0.0
    """Largest violation of the constraints at velocity-increment level, m/s."""
    friction_impulse: float = 0.0
    """Of an impact with friction, along the tangent, N s."""

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


@dataclass(frozen=True)
class Fallback:
    """The outer loop that was asked for failed, and Newton's took over for the rest of the run."""

    t: float
    """s."""
    outer: str
    """The outer loop that failed."""
    reason: str
