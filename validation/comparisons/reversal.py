"""Impacts in which the sliding turns round: there Newton's law with Coulomb's friction is no limit of a penalty.

Along the normal impulse of a contact that takes time, friction works against the sliding of the moment (Darboux 1880;
Keller, "Impact with friction", J. Appl. Mech. 53 (1986) 1).
"""

from dataclasses import dataclass

import numpy as np

from ...core import Result
from ...core.laws.friction import CoulombFriction
from ...core.multibody_model import Model

LEAST = 1e-6
"""m/s: slower sliding is none."""


@dataclass(frozen=True)
class Reversal:
    """An impact (s) and the sliding speeds (m/s) of its contact before and after it."""

    t: float
    contact: str
    before: float
    after: float

    def text(self) -> str:
        """Why what follows cannot be compared."""
        return (
            f"in the impact of '{self.contact}' at {self.t:.5g} s the sliding turns round, from {self.before:.3g} to "
            f"{self.after:.3g} m/s: Newton's law has all friction against the sliding after it, a contact that takes "
            "time (whatever its stiffness) friction both ways and another normal impulse: two impact laws"
        )


def first_reversal(model: Model, run: Result) -> Reversal | None:
    """The first impact with friction in which the sliding turns round."""
    rubbing = {c.name for c in model.contacts if isinstance(c.friction, CoulombFriction)}
    for event in run.events:
        channel = f"{event.contact}.sliding_velocity"
        if event.kind != "impact" or event.contact not in rubbing or channel not in run.channels:
            continue
        before = float(run[channel][np.searchsorted(run.t, event.t, "left")])
        after = float(run[channel][np.searchsorted(run.t, event.t, "right") - 1])
        if before * after < 0.0 and min(abs(before), abs(after)) > LEAST:
            return Reversal(event.t, event.contact, before, after)
    return None
