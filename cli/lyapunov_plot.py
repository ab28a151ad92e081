"""The figure of `tlismni lyapunov`: running estimates, and the section of the motion at its impacts."""

from pathlib import Path

import numpy as np

from ..core.analysis import LyapunovResult
from .plots import save

MOST_POINTS = 100_000


def plot_lyapunov(result: LyapunovResult, name: str, period: float | None, path: Path) -> Path:
    """Running estimates with the standard error of the last one; below, if there are impacts and a force of one
    period, the separation speed over the phase at each impact."""
    from matplotlib.figure import Figure

    impacts = [event for event in result.events if event.kind == "impact"][-MOST_POINTS:]
    section = period is not None and len(impacts) > 0
    figure = Figure(figsize=(8.0, 7.0 if section else 4.0), layout="constrained")
    axes = figure.subplots(2 if section else 1, 1, squeeze=False)[:, 0]
    upper = axes[0]
    for k in range(len(result.exponents)):
        if np.isfinite(result.exponents[k]):
            (line,) = upper.plot(result.times, result.running[:, k], lw=1.0, label=f"{result.exponents[k]:.4f}")
            low, high = result.exponents[k] - result.errors[k], result.exponents[k] + result.errors[k]
            upper.axhspan(low, high, color=line.get_color(), alpha=0.15, lw=0)
    upper.axhline(0.0, color="0.6", lw=0.6)
    finite = result.exponents[np.isfinite(result.exponents)]
    if len(finite):
        # the first estimates swing far: the band that they settle in is of interest
        room = 0.25 * float(np.ptp(finite)) + 0.05
        upper.set_ylim(float(np.min(finite)) - room, float(np.max(finite)) + room)
    upper.set(xlabel="time, s", ylabel="running estimate, 1/s")
    upper.legend(fontsize=8)
    upper.grid(alpha=0.3)
    if section and period is not None:
        phase = np.array([event.t / period % 1.0 for event in impacts])
        speed = np.array([event.separation_speed for event in impacts])
        axes[1].plot(phase, speed, ".", ms=1.5, color="0.15")
        axes[1].set(xlabel="phase of the force at the impact, periods", ylabel="separation speed, m/s", xlim=(0.0, 1.0))
        axes[1].grid(alpha=0.3)
    figure.suptitle(f"{name}: Lyapunov exponents, {result.impacts} impacts", fontsize=10)
    return save(figure, path)
