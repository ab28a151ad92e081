"""Whether a smooth motion here and in exudyn agree within the error bars of both."""

from collections.abc import Sequence

import numpy as np
from tlismni.core import Model, simulate
from tlismni.validation import ExudynSettings, run_exudyn

TRAPEZOIDAL = ExudynSettings(integrator="trapezoidal")
ROUNDING = 1e-8
"""Of a range: Newton's iterations of both."""


def agree(
    model: Model,
    channels: Sequence[str],
    end: float,
    step: float,
    within: float = 1e-5,
    settings: ExudynSettings = TRAPEZOIDAL,
) -> None:
    """Channels of both are apart by no more than their error bars.

    These are Richardson's of exudyn, from three steps of which `step` (s) is the largest and divides a twentieth of
    `end` (s), and what ten times the tolerance changes in ours. They are less than `within` of each range.
    """
    times = np.linspace(0.0, end, 21)
    ours, rough = (simulate(model, end, "irk", tol, 0.01 * tol, t_eval=times) for tol in (1e-9, 1e-8))
    runs = [run_exudyn(model, end, h, settings) for h in (step, 0.5 * step, 0.25 * step)]
    for channel in channels:
        first, second, third = (np.interp(times, r.t, r[channel]) for r in runs)
        limits = second + (second - first) / 3.0, third + (third - second) / 3.0
        bar = np.abs(limits[1] - limits[0]).max() + np.abs(ours[channel] - rough[channel]).max()
        scale = np.ptp(ours[channel])
        assert scale > 1e-2, channel
        assert bar < within * scale, channel
        assert np.abs(limits[1] - ours[channel]).max() < bar + ROUNDING * scale, channel
