"""The reference of a problem: a tight run, checked against a tight run of another family."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly

from ...core import ModelError, Result, simulate
from ...models import Scenario
from .cases import Setting

Array = NDArray[np.float64]

RTOL = 1e-12
FIRST = Setting("ebdf", {"k": 6})
SECOND = (Setting("irk", {"tableau": "gauss3"}), Setting("irk"))
"""What the errors refer to, and what says how exact that is: the first that the core has."""
ATOL_SHARE = 0.01
"""atol over rtol, in the references and in all runs of the study."""


@dataclass(frozen=True)
class Reference:
    """Coordinates of a problem over time."""

    spline: BPoly
    scale: Array
    """Half the range of each coordinate; of one that does not move, the largest of all."""
    accuracy: float
    """Largest difference between the two references, in the measure of `error`."""

    def error(self, result: Result) -> float:
        """Largest |q - q_ref| over all recorded steps and coordinates, relative to the scale of each."""
        return float(np.max(np.abs(result.q - self.spline(result.t)) / self.scale))


def make_reference(scenario: Scenario, t_end: float) -> Reference:
    """Integrate tightly, twice.

    Raises ModelError if there are events: the errors of a run around a jump would mean nothing.
    """
    first, second = (
        simulate(scenario.model, t_end, setting.method, RTOL, ATOL_SHARE * RTOL, **setting.options)
        for setting in (FIRST, next(setting for setting in SECOND if setting.available))
    )
    if first.events:
        raise ModelError(
            f"scenario '{scenario.name}' has an event at t = {first.events[0].t:.4g} s: the study needs a smooth "
            "motion; set a smaller t_end"
        )
    # quintic between the steps: q, v and a agree at both ends
    spline = BPoly.from_derivatives(first.t, np.stack([first.q, first.v, first.a], axis=1))
    half = 0.5 * np.ptp(first.q, axis=0)
    scale = np.where(half > 1e-6 * half.max(), half, half.max())
    reference = Reference(spline, scale, 0.0)
    return Reference(spline, scale, reference.error(second))
