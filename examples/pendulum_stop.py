"""A rod swings onto a stop, bounces and comes to rest on it: contact as a constraint (CCM).

While the contact is open the pin alone constrains the rod. At each impact the velocities jump so that the joint
holds at velocity-increment level too; at the end the contact is one more constraint, and the whole system is static.
The residuals of all constraints are recorded at position, velocity and acceleration level.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import quad
from tlismni.core import Result, simulate
from tlismni.models import Scenario, load

STOP, RESTITUTION, T_END = -1.0, 0.4, 2.0
LEVELS = ("position", "velocity", "acceleration")


def scenario() -> Scenario:
    """The catalogue's pendulum, with the stop where gravity presses the rod onto it."""
    return load("pendulum_stop", stop_angle=STOP, restitution=RESTITUTION, driven=False)


def expected_first_impact(length: float, gravity: float) -> float:
    """Time to the stop, s: theta'^2 = -3 g/L sin(theta), from rest at theta = 0.

    With theta = -u^2 the integrand stays finite at the start.
    """
    time, _ = quad(lambda u: 2.0 * u / np.sqrt(3.0 * gravity / length * np.sin(u * u)), 0.0, np.sqrt(-STOP))
    return float(time)


def run() -> dict[str, Any]:
    """Figures of the run and of the closed form."""
    s = scenario()
    result = simulate(s.model, T_END, s.method, s.rtol, s.atol, **s.options)
    impacts = [event for event in result.events if event.kind == "impact"]
    length, mass, gravity = (s.parameters[name] for name in ("length", "mass", "gravity"))
    return {
        "result": result,
        "impacts": impacts,
        "expected_first_impact": expected_first_impact(length, gravity),
        # moments about the pin: the weight at L/2, the stop's force at L
        "force_at_rest": result["stop.normal_force"][-1],
        "expected_force_at_rest": 0.5 * mass * gravity * np.cos(STOP),
        "residuals": {level: np.max(np.abs(result[f"residual.{level}"])) for level in LEVELS},
        "velocity_increment_residual": max(event.velocity_increment_residual for event in impacts),
        "largest_energy_balance": np.max(np.abs(result["energy.balance"])),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """Angle, contact force, and the residuals at three levels."""
    from matplotlib.figure import Figure

    result: Result = figures["result"]
    figure = Figure(figsize=(7.0, 7.0), layout="constrained")
    angle, force, residuals = figure.subplots(3, 1, sharex=True)
    angle.plot(result.t, result["pendulum.angle"], ".-", ms=3, lw=0.8)
    angle.set_ylabel("angle, rad")
    force.plot(result.t, result["stop.normal_force"])
    force.axhline(figures["expected_force_at_rest"], color="0.6", ls="--")
    force.set_ylabel("force of the stop, N")
    for level in LEVELS:
        residuals.semilogy(result.t, np.maximum(result[f"residual.{level}"], 1e-18), lw=0.8, label=level)
    residuals.set(xlabel="time, s", ylabel="largest residual, SI")
    residuals.legend()
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "pendulum_stop.png")
    found = run()
    plot(found, file)
    print(f"{len(found['impacts'])} impacts; at rest the stop carries {found['force_at_rest']:.9f} N")
    print(f"statics: {found['expected_force_at_rest']:.9f} N; wrote {file}")
