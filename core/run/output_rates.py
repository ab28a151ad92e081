"""Time derivatives of channels, as far as they are known exactly at the present point.

Coordinates have velocities, those have accelerations; a gap and a sliding distance have their rates, those the
accelerations that the constraint rows give; accounts of work and impulse have the powers and forces that they add up;
what jumps at impacts only stands still between them. Of accelerations, joint and contact forces (third derivatives of
the constraints), single energies and residuals none is known.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..tables.evaluate import evaluate_power

if TYPE_CHECKING:
    from .simulation import Simulation


def output_rates(sim: "Simulation") -> NDArray[np.float64]:
    """Rates (channels,) of all channels at the present time, NaN where they are not known.

    At a contact event they are those before it, as long as it has not happened.
    """
    sample, layout, assembly, arrays = sim.sample(), sim.table.layout, sim.assembly, sim.workspace.arrays
    evaluate_power(sim.workspace.record)
    rates = np.full(len(sample), np.nan)
    rates[layout.q], rates[layout.v] = sample[layout.v], sample[layout.a]
    for k, contact in enumerate(assembly.contacts):
        rates[layout.gap + k] = sample[layout.gap_rate + k]
        rates[layout.gap_rate + k] = arrays["phidd"][contact.row]
        if contact.slide_row >= 0:
            rates[layout.sliding + k] = arrays["phidd"][contact.slide_row]
        rates[layout.impulse_jump + k] = rates[layout.loss_jump + k] = 0.0
    for name, column in layout.work.items():
        rates[column] = arrays["a"][assembly.work_index(name)]
    return sim.table.rates(sample, rates)
