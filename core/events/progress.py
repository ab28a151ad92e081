"""Guard against runs that events keep from going on: so many at one instant, or so many in next to no time."""

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..errors import SimulationError

MOST_AT_ONCE = 50
"""Events at one instant before a run is given up."""
IN_A_ROW, STANDSTILL = 1000, 1e-7
"""So many events within this part of the time that has passed are no progress. Bounces that accumulate end by the rest
rule before that: with a restitution of 0.999 their last thousand take 2e-6 of it."""


RUN_BEGAN, COUNTED_SINCE, EVENTS_COUNTED = range(3)
"""Of the guard's numbers: when the run began, since when its events are counted, and how many there were."""
GUARD_SIZE = 3


class Progress:
    """Counts events in time. It decides when to give up, so its numbers belong to the state.

    Attributes
    ----------
    numbers : (GUARD_SIZE,), which compiled code counts on too; a part of the state's buffer.
    """

    def __init__(self, start: float, numbers: NDArray[np.float64]) -> None:
        self.numbers = numbers
        self.begin(start)

    def begin(self, start: float) -> None:
        """Count from the time `start`, s."""
        self.numbers[:] = start, start, 0.0

    def moved(self, take: Take) -> "Progress":
        """The same in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new.numbers = take(self.numbers)
        return new

    def note(self, t: float, here: int, contacts: list[str]) -> None:
        """Events of `contacts` (names) at time t, s, the `here`-th time at this instant.

        Raises
        ------
        SimulationError : if the run does not get on.
        """
        if here > MOST_AT_ONCE:
            raise _chatters(f"{here} events of contacts {contacts} at t = {t:.9g} s without progress in time", t)
        start, since, count = self.numbers.tolist()
        self.numbers[EVENTS_COUNTED] = count + 1.0
        if count < IN_A_ROW:
            return
        if not abs(t - since) > STANDSTILL * abs(t - start):
            span = f"{t - since:.3g} s up to t = {t:.9g} s"
            raise _chatters(f"{count + 1:.0f} events within {span}, of contacts {contacts} and others", t)
        self.numbers[COUNTED_SINCE], self.numbers[EVENTS_COUNTED] = t, 0.0


def _chatters(what: str, t: float) -> SimulationError:
    return SimulationError(
        f"{what}: the contact chatters. Use a larger rest_ratio, smaller tolerances or another method; or give these "
        "contacts a force law (KelvinVoigt, HuntCrossley, with TanhFriction for Coulomb's): forces need no decision "
        "which of many contacts carry. Contacts that say the same twice (corners on faces and faces on corners) can be "
        "left out.",
        t=t,
        loop="event",
    )
