"""Time derivatives of channels, as far as they are known exactly at the present point.

Coordinates have velocities, those have accelerations; a gap and a sliding distance have their rates, those the
accelerations that the constraint rows give; accounts of work and impulse have the powers and forces that they add up;
what jumps at impacts only stands still between them. Of accelerations, joint and contact forces (third derivatives of
the constraints), single energies and residuals none is known.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .slopes import in_time

if TYPE_CHECKING:
    from .simulation import Simulation


def output_rates(sim: "Simulation") -> NDArray[np.float64]:
    """Rates (channels,) of all channels at the present time, NaN where they are not known.

    At a contact event they are those before it, as long as it has not happened.
    """
    sim.sample()
    found = np.zeros(len(sim.channels))
    in_time(sim.outside.record, found)
    return found
