"""The model's own scales: how large its lengths, times and energies are, whatever the units.

Lengths stand in the model (`Assembly.coordinate_scale`, 1 for angles). What a row of Phi or a gap measures follows from
them: how far it moves when the coordinates move by their scales. The time is that in which the start's velocities,
accelerations and driven motions cross those lengths, those of angles less (`ANGLES`): what spins fast makes nothing
else fast. The energy is that of the masses at their speeds and the work of the forces along those lengths, where there
are none that of the masses at the model's speeds.
"""

from dataclasses import dataclass

SMALL_WORK = 0.1
"""Of the model's energy: work accounts below this are held to what it is worth, others relatively."""
MOST_TIMES = 40
"""Later times at which it is looked what forces and drivers do."""


@dataclass(frozen=True)
class Scales:
    """What the tolerances of a run are parts of.

    Attributes
    ----------
    length : size of the mechanism, m.
    rate : inverse of its time, 1/s.
    energy : of its motion and its forces, J.
    """

    length: float
    rate: float
    energy: float

    @property
    def time(self) -> float:
        """s."""
        return 1.0 / self.rate

    @property
    def speed(self) -> float:
        """m/s."""
        return self.length * self.rate
