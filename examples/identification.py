"""Restitution and damping of an oscillator that strikes a stop, from a noisy record of its position.

The record is synthetic: the run with the true parameters, sampled 60 times, with noise of 1 % of the motion. The fit
starts far away. The intervals of 95 % hold the true value in about 95 of 100 such records (`tests/core/test_fit.py`).
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import simulate
from tlismni.core.analysis import Fit, Measurement, fit
from tlismni.models import load

TRUE = {"stop.law.restitution": 0.7, "spring.damping": 0.08}
START = {"stop.law.restitution": (0.05, 0.4, 0.99), "spring.damping": (0.0, 0.3, 1.0)}
NOISE = 0.01


def run(seed: int = 1) -> dict[str, Any]:
    """A record, what is found from it, and the motion with that."""
    model = load("impact_oscillator", frequency=2.0).model
    times = np.linspace(0.1, 6.0, 60)
    clean = simulate(model.with_parameters(TRUE), 6.0, rtol=1e-10, atol=1e-12, t_eval=times)["mass.x"]
    sigma = NOISE * float(np.ptp(clean))
    record = clean + np.random.default_rng(seed).normal(0.0, sigma, len(times))
    found = fit(model, Measurement(times, {"mass.x": record}, {"mass.x": sigma}), START)
    first = {name: start for name, (_, start, _) in START.items()}
    sets = {"where the search starts": first, "fitted": dict(zip(found.names, found.values.tolist(), strict=True))}
    runs = {name: simulate(model.with_parameters(p), 6.0, rtol=1e-9, atol=1e-11) for name, p in sets.items()}
    return {"times": times, "record": record, "found": found, "runs": runs, "true": TRUE}


def plot(figures: dict[str, Any], path: Path) -> None:
    """The record, the motion that was started from and the fitted one; below, what is left."""
    from matplotlib.figure import Figure

    found: Fit = figures["found"]
    figure = Figure(figsize=(7.5, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.0, 1.0])
    for (name, result), colour in zip(figures["runs"].items(), ("0.7", "tab:blue"), strict=True):
        upper.plot(result.t, result["mass.x"], color=colour, lw=1.2, label=name)
    upper.plot(figures["times"], figures["record"], ".", color="tab:red", ms=5, label="record")
    upper.set(ylabel="position, m", title=str(found))
    upper.title.set_fontsize(9)
    upper.legend()
    lower.plot(figures["times"], found.residuals, ".", color="0.2")
    lower.axhline(0.0, color="0.6", lw=0.6)
    lower.set(xlabel="time, s", ylabel="left over, in parts of sigma")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "identification.png")
    outcome = run()
    plot(outcome, file)
    print(outcome["found"])
    print(f"noise {outcome['found'].noise:.3f} sigma, {outcome['found'].runs} runs; true: {TRUE}; wrote {file}")
