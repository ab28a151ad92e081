"""A mechanism in two halves that touch: a hammer and an anvil as two co-simulation instances.

The file split_mechanism.toml beside this one says how they are coupled. A master that steps both with what it knew at
the start of the step (Jacobi) lets the contact push a little too late: it gives energy to the blow, and its error
halves with the step. One that repeats the step until both agree, with the mean of the force's two ends held during it,
divides its error by four.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import simulate
from tlismni.fmu_wrapper.master import read_system, simulate_system
from tlismni.models import load

HERE = Path(__file__).parent
STEPS = (1e-3, 5e-4, 2.5e-4)
"""Communication steps, s."""


def run() -> dict[str, Any]:
    """The whole mechanism, and both couplings with each step."""
    system = read_system(HERE / "split_mechanism.toml")
    t_end = system.master.t_end
    whole = simulate(load("split_whole").model, t_end, rtol=1e-10, atol=1e-13)
    found: dict[str, Any] = {"whole": whole, "runs": {}, "errors": {}}
    for algorithm in ("jacobi", "newton"):
        for step in STEPS:
            master = system.master.model_copy(update={"algorithm": algorithm, "step": step})
            result = simulate_system(system.model_copy(update={"master": master}), HERE, load_scenario=load)
            found["runs"][algorithm, step] = result
            found["errors"][algorithm, step] = abs(float(result["striker.hammer.vx"][-1] - whole["hammer.vx"][-1]))
    return found


def plot(figures: dict[str, Any], path: Path) -> None:
    """The contact's force, and the hammer's velocity after the blow."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 6.5), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    whole, step = figures["whole"], STEPS[0]
    upper.plot(1e3 * whole.t, whole["blow.normal_force"], color="0.6", lw=2.5, label="in one piece")
    lower.plot(1e3 * whole.t, whole["hammer.vx"], color="0.6", lw=2.5)
    for algorithm, label, style in (("jacobi", "Jacobi", "#d1495b"), ("newton", "iterated by Newton", "#0b3c5d")):
        result = figures["runs"][algorithm, step]
        upper.plot(1e3 * result.t, result["wall.blow.normal_force"], "o-", ms=3.0, lw=0.8, color=style,
                   label=f"in two, {label}, {1e3 * step:g} ms")  # fmt: skip
        lower.plot(1e3 * result.t, result["striker.hammer.vx"], "o-", ms=3.0, lw=0.8, color=style)
    upper.set_ylabel("contact force, N")
    upper.legend()
    lower.set(xlabel="time, ms", ylabel="velocity of the hammer, m/s")
    for axes in (upper, lower):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "split_mechanism.png")
    figures = run()
    plot(figures, file)
    print(f"velocity of the hammer after the blow: {figures['whole']['hammer.vx'][-1]:.6f} m/s in one piece")
    for algorithm, step in figures["errors"]:
        error = figures["errors"][algorithm, step]
        passes = figures["runs"][algorithm, step].stats["passes"]
        print(f"{algorithm:8s} {1e3 * step:5g} ms: off by {error:.2e} m/s, {passes:4d} passes")
    ratios = [np.log2(figures["errors"][a, STEPS[1]] / figures["errors"][a, STEPS[2]]) for a in ("jacobi", "newton")]
    print(f"orders: jacobi {ratios[0]:.2f}, newton {ratios[1]:.2f}; wrote {file}")
