"""Two sweeps of an oscillator that strikes a stop: a bifurcation diagram and a basin of attraction.

x'' + 2 z x' + x = cos(w t) for x <= d, v+ = -r v- at x = d, looked at once a period of the force. With more restitution
the motion doubles its period, again and again, until it is chaotic. Where the stop stands beyond the amplitude
1/(w^2 - 1) of the free oscillator, two motions live side by side: one that never reaches the stop, in closed form, and
one that strikes it. Which of them is reached depends on the start.
"""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core.sweeps import sweep
from tlismni.models.sweep import ScenarioProblem

FREQUENCY, DAMPING = 2.8, 0.05
PERIOD = 2.0 * math.pi / FREQUENCY
STOP = 0.3


def settled(periods: int, seen: int, **fixed: float) -> ScenarioProblem:
    """The oscillator at the last `seen` of so many periods."""
    times = PERIOD * np.arange(periods - seen + 1, periods + 1)
    return ScenarioProblem.of(
        "impact_oscillator", {"frequency": FREQUENCY, "damping_ratio": DAMPING, **fixed},
        t_end=periods * PERIOD * (1.0 + 1e-12), times=times, channels=["mass.x", "mass.vx"],
    )  # fmt: skip


def free_motion() -> tuple[float, float]:
    """Position and velocity of the motion that never strikes, at the beginning of a period of the force."""
    response = 1.0 / (1.0 - FREQUENCY**2 + 2j * DAMPING * FREQUENCY)
    return response.real, -FREQUENCY * response.imag


def run(values: int = 31, side: int = 16) -> dict[str, Any]:
    """Both sweeps; how many velocities are seen at a restitution, and which starts reach the free motion."""
    bifurcation = sweep(settled(90, 16), {"restitution": np.linspace(0.3, 0.9, values)})
    basin = sweep(
        settled(80, 1, stop_position=STOP, restitution=0.6),
        {"start.mass.x": np.linspace(-1.0, STOP - 1e-3, side), "start.mass.vx": np.linspace(-1.0, 1.0, side)},
    )
    x, v = free_motion()
    free = np.hypot(basin["mass.x"] - x, basin["mass.vx"] - v) < 0.02
    return {"bifurcation": bifurcation, "basin": basin, "free": free, "free_motion": (x, v)}


def velocities(figures: dict[str, Any], restitution: float) -> int:
    """How many different velocities the motion has at the beginnings of periods, at the nearest restitution."""
    table = figures["bifurcation"]
    nearest = table["restitution"][np.argmin(np.abs(table["restitution"] - restitution))]
    seen = table["mass.vx"][table["restitution"] == nearest]
    return 1 + int(np.sum(np.diff(np.sort(seen)) > 1e-3))


def plot(figures: dict[str, Any], path: Path) -> None:
    """Velocities over restitution; starts that reach the free motion."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 8.0), layout="constrained")
    upper, lower = figure.subplots(2, 1)
    table = figures["bifurcation"]
    upper.plot(table["restitution"], table["mass.vx"], ".", ms=2.0, color="0.1", mew=0)
    upper.set(xlabel="restitution", ylabel="velocity once a period, m/s")
    basin = figures["basin"]
    x, v = np.unique(basin["start.mass.x"]), np.unique(basin["start.mass.vx"])
    reached = figures["free"].reshape(len(x), len(v)).T.astype(float)
    lower.pcolormesh(x, v, reached, shading="nearest", cmap="Blues", vmin=-0.3, vmax=1.3)
    lower.plot(*figures["free_motion"], "o", color="tab:red", label="motion that never strikes")
    lower.set(xlabel="position at the start, m", ylabel="velocity at the start, m/s",
              title="dark: the free motion is reached; light: one that strikes the stop")  # fmt: skip
    lower.legend(loc="lower left")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "oscillator_sweeps.png")
    found = run(200, 60)
    plot(found, file)
    print(f"velocities seen at restitution 0.35: {velocities(found, 0.35)}, at 0.5: {velocities(found, 0.5)}")
    print(f"{np.mean(found['free']):.0%} of the starts reach the motion that never strikes; wrote {file}")
