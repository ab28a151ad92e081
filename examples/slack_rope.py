"""A pendulum on a slack rope: it falls freely, is caught with a jerk, swings, and goes slack again on the way up."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import Marker2D, Model, NewtonImpact, PointMass2D, Rope2D, simulate

LENGTH, MASS, G, BESIDE, ABOVE = 1.0, 2.0, 9.81, 0.95, 0.3
"""Rope, m; bob, kg; m/s^2; where the bob starts beside and above the pin, m."""


def build() -> Model:
    bob = PointMass2D(name="bob", mass=MASS, position=(BESIDE, ABOVE))
    rope = Rope2D(name="rope", b=Marker2D(body="bob"), length=LENGTH, law=NewtonImpact(restitution=0.0))
    return Model(name="slack_rope", gravity=(0.0, -G), bodies=[bob], contacts=[rope])


def run() -> dict[str, Any]:
    """The jerk takes the part of the velocity along the rope: m v cos a, and the energy of that part."""
    result = simulate(build(), 2.5, rtol=1e-10, atol=1e-12, t_eval=np.linspace(0.0, 2.5, 501))
    drop = math.sqrt(LENGTH**2 - BESIDE**2)
    speed = math.sqrt(2.0 * G * (drop + ABOVE)) * drop / LENGTH
    return {
        "result": result,
        "jerk": next(event for event in result.events if event.kind == "impact"),
        "expected_time": math.sqrt(2.0 * (drop + ABOVE) / G),
        "expected_impulse": MASS * speed,
        "expected_loss": 0.5 * MASS * speed**2,
        "longest": float(np.hypot(result["bob.x"], result["bob.y"]).max()),
        "balance": float(np.abs(result["energy.balance"]).max()),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("rope.gap", "rope.normal_force", "bob.y", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "slack_rope.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["rope.normal_force"])
    jerk = found["jerk"]
    print(f"jerk at {jerk.t:.6f} s with {jerk.impulse:.4f} N s; expected {found['expected_time']:.6f} s, ", end="")
    print(f"{found['expected_impulse']:.4f} N s; wrote {file}")
