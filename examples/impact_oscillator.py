"""An oscillator strikes a stop: a stable orbit and a chaotic one, told apart by Lyapunov exponents.

Two motions of x'' + 2 z x' + x = cos(w t), x <= 0, v+ = -r v- at x = 0. The first (z = 0.02, w = 2) settles on an orbit
with one impact a period T: its Floquet multipliers lie inside the unit circle, and their product is that of the damping
and of the impact, r^2 exp(-2 z T). The second (z = 0.05, w = 2.8) never repeats itself: neighbouring motions part at
the rate of the first exponent, while the sum of both is what damping and impacts take, -2 z + 2 ln r times the impacts
a second.
"""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import simulate
from tlismni.core.analysis import LyapunovResult, floquet_multipliers, lyapunov_exponents
from tlismni.models import load

RESTITUTION = 0.8
STABLE = {"damping_ratio": 0.02, "frequency": 2.0}
CHAOTIC = {"damping_ratio": 0.05, "frequency": 2.8}
SETTLING, PERIODS = 120, 300


def orbit() -> dict[str, Any]:
    """The stable orbit: where it is after SETTLING periods, and its multipliers."""
    period = 2.0 * math.pi / STABLE["frequency"]
    settled = simulate(
        load("impact_oscillator", **STABLE).model, SETTLING * period, rtol=1e-10, atol=1e-12, record=False
    )
    # the force has the same phase as at t = 0
    start = {"start_position": settled["mass.x"][-1], "start_velocity": settled["mass.vx"][-1]}
    found = floquet_multipliers(load("impact_oscillator", **STABLE, **start).model, period)
    return {
        "multipliers": found.multipliers.real,
        "closure": found.closure,
        "product": float(np.prod(found.multipliers).real),
        "expected_product": RESTITUTION**2 * math.exp(-2.0 * STABLE["damping_ratio"] * period),
    }


def run() -> dict[str, Any]:
    """Figures of both motions."""
    period = 2.0 * math.pi / CHAOTIC["frequency"]
    chaos = lyapunov_exponents(load("impact_oscillator", **CHAOTIC).model, PERIODS * period, transient=20.0 * period)
    duration = float(chaos.times[-1]) - chaos.start
    lost = -2.0 * CHAOTIC["damping_ratio"] + 2.0 * math.log(RESTITUTION) * chaos.impacts / duration
    return {**orbit(), "chaos": chaos, "period": period, "sum": float(np.sum(chaos.exponents)), "expected_sum": lost}


def plot(figures: dict[str, Any], path: Path) -> None:
    """Running estimates of the exponents, and the motion at its impacts."""
    from matplotlib.figure import Figure

    chaos: LyapunovResult = figures["chaos"]
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    upper, lower = figure.subplots(2, 1)
    for k in range(2):
        upper.plot(chaos.times, chaos.running[:, k], lw=1.0, label=f"{chaos.exponents[k]:.3f} ± {chaos.errors[k]:.3f}")
    upper.axhline(0.0, color="0.6", lw=0.6)
    upper.set(xlabel="time, s", ylabel="running estimate, 1/s", ylim=(-0.7, 0.4))
    upper.legend()
    impacts = [event for event in chaos.events if event.kind == "impact"]
    phases = [event.t / figures["period"] % 1.0 for event in impacts]
    lower.plot(phases, [event.separation_speed for event in impacts], ".", ms=2.0, color="0.15")
    lower.set(xlabel="phase of the force at the impact, periods", ylabel="separation speed, m/s", xlim=(0.0, 1.0))
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "impact_oscillator.png")
    found = run()
    plot(found, file)
    first, second = found["multipliers"]
    print(f"stable orbit: multipliers {first:.8f} and {second:.8f}, product {found['product']:.8f}")
    print(f"r^2 exp(-2 z T):{found['expected_product']:49.8f}")
    exponents = ", ".join(
        f"{x:+.3f} ± {e:.3f}" for x, e in zip(found["chaos"].exponents, found["chaos"].errors, strict=True)
    )
    print(f"chaotic motion, {found['chaos'].impacts} impacts: exponents {exponents} 1/s")
    print(f"sum {found['sum']:.9f}, damping and impacts {found['expected_sum']:.9f} 1/s; wrote {file}")
