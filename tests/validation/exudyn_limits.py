"""A model against exudyn's limit for small steps, where its own error goes with their square."""

import numpy as np
from tlismni.core import Model, simulate
from tlismni.validation import ExudynSettings, run_exudyn

SETTINGS = ExudynSettings(modified_newton=False, absolute_tolerance=1e-10)


def compare(model: Model, end: float, channels: tuple[str, ...], tolerance: float) -> None:
    """exudyn's limit for small steps (Richardson's) is ours, to a twentieth of its own error at the smaller step and
    `tolerance` in parts of each channel's range."""
    ours = simulate(model, end, "irk", 1e-9, 1e-11, t_eval=np.linspace(0.0, end, 21))
    coarse, fine = (run_exudyn(model, end, h, SETTINGS) for h in (end / 500, end / 1000))
    for channel in channels:
        values = [np.interp(ours.t[1:], r.t, r[channel]) for r in (coarse, fine)]
        limit, scale = values[1] + (values[1] - values[0]) / 3.0, np.ptp(ours[channel])
        own = np.abs(values[1] - values[0]).max() / 3.0
        assert scale > 1e-3 and own < 5e-3 * scale, channel
        assert np.abs(limit - ours[channel][1:]).max() < 0.05 * own + tolerance * scale, channel
