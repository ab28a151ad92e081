"""An own joint: a rope over two pulleys, in Atwood's machine with a bob that swings.

The joint is one formula of its markers, |p - a| + |q - b| = length: a class of ten lines, without derivatives or
indices. For a counterweight of three times the bob's mass the machine has a second integral besides its energy
(Tufillaro 1986) in the bob's radius r and angle w from the vertical, which the run has to keep:
I = r^2 w' (r' cos(w/2) - r w'/2 sin(w/2)) + g r^2 sin(w/2) cos^2(w/2).
"""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import Marker2D, Model, PointMass2D, Result, ScalarJoint2D, scalar_constraint, simulate

G, MASS, LENGTH, APART = 9.81, 1.0, 3.0, 0.4
RADIUS, ANGLE = 1.0, math.pi / 2.0


def excess(bob: Any, left: Any, weight: Any, right: Any, length: float) -> float:
    """How much longer the straight parts of the rope are than it is."""
    return math.hypot(bob.x - left.x, bob.y - left.y) + math.hypot(weight.x - right.x, weight.y - right.y) - length


class Rope2D(ScalarJoint2D):
    """A rope from `bob` over the pulleys `left` and `right`, which are points, to `weight`."""

    formula = scalar_constraint(excess)
    multiplier = ("tension", "N", "force in the rope")
    bob: Marker2D
    left: Marker2D
    weight: Marker2D
    right: Marker2D
    length: float


def build() -> Model:
    """The bob starts from rest, level with its pulley."""
    start = (RADIUS * math.sin(ANGLE), -RADIUS * math.cos(ANGLE))
    rope = Rope2D(
        name="rope",
        bob=Marker2D(body="bob"),
        left=Marker2D(point=(0.0, 0.0)),
        weight=Marker2D(body="weight"),
        right=Marker2D(point=(-APART, 0.0)),
        length=LENGTH,
    )
    return Model(
        name="swinging_atwood",
        gravity=(0.0, -G),
        bodies=[
            PointMass2D(name="bob", mass=MASS, position=start),
            PointMass2D(name="weight", mass=3.0 * MASS, position=(-APART, RADIUS - LENGTH)),
        ],
        joints=[rope],
    )


def second_integral(result: Result) -> np.ndarray:
    """Tufillaro's integral, m^3/s^2."""
    x, y, vx, vy = (result[f"bob.{name}"] for name in ("x", "y", "vx", "vy"))
    r, half = np.hypot(x, y), 0.5 * np.unwrap(np.arctan2(x, -y))
    rate, spin = (x * vx + y * vy) / r, (x * vy - y * vx) / r**2
    moving = r**2 * spin * (rate * np.cos(half) - 0.5 * r * spin * np.sin(half))
    return np.asarray(moving + G * r**2 * np.sin(half) * np.cos(half) ** 2)


def run() -> dict[str, Any]:
    """Figures of the run and of the closed forms."""
    result = simulate(build(), t_end=8.0, rtol=1e-9, atol=1e-11)
    return {
        "result": result,
        "integral": second_integral(result),
        "expected_integral": G * RADIUS**2 * math.sin(0.5 * ANGLE) * math.cos(0.5 * ANGLE) ** 2,
        "tension": result["rope.tension"],
        # the counterweight hangs straight: M a = T - M g
        "expected_tension": 3.0 * MASS * (G + result["weight.ay"]),
        "largest_energy_balance": np.max(np.abs(result["energy.balance"])),
        "residuals": {
            level: np.max(np.abs(result[f"residual.{level}"])) for level in ("position", "velocity", "acceleration")
        },
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """The bob's path, and the rope's force over time."""
    from matplotlib.figure import Figure

    result: Result = figures["result"]
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    plane, over_time = figure.subplots(1, 2)
    plane.plot(result["bob.x"], result["bob.y"], lw=0.8)
    plane.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    plane.locator_params(nbins=5)
    over_time.plot(result.t, figures["tension"], lw=0.8)
    over_time.set(xlabel="time, s", ylabel="force in the rope, N")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "own_elements.png")
    found = run()
    plot(found, file)
    drift = np.max(np.abs(found["integral"] - found["expected_integral"]))
    print(f"second integral {found['expected_integral']:.9f} m^3/s^2, kept to {drift:.1e}; wrote {file}")
