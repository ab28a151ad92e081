"""Own equations of motion: a bead on a rod that turns at constant speed, with a stop at the rod's end.

No elements: mass, force, constraint and gap are functions. The constraint y cos(W t) - x sin(W t) = 0 depends on
time; its Jacobian, its time derivatives and gamma are formed by automatic differentiation. From rest on the rod the
bead moves as r = r0 cosh(W t), strikes the stop at acosh(L/r0)/W, bounces, and at last is held there by the
centrifugal force m W^2 L.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import EquationSystem, GapContact, NewtonImpact, Result, simulate

SPEED, START, LENGTH, MASS, RESTITUTION = 2.0, 0.2, 1.0, 0.5, 0.5


def build() -> EquationSystem:
    """The equations M a + Phi_q^T lambda = Q, with Phi(t, q) = 0 and g(t, q) >= 0."""
    return EquationSystem(
        mass=MASS * np.eye(2),
        force=lambda t, q, v: np.zeros(2),
        constraint=lambda t, q: q[1] * np.cos(SPEED * t) - q[0] * np.sin(SPEED * t),
        q0=[START, 0.0],
        v0=[0.0, SPEED * START],
        contacts=[
            GapContact(
                name="stop",
                gap=lambda t, q: LENGTH - np.sqrt(q[0] ** 2 + q[1] ** 2),
                law=NewtonImpact(restitution=RESTITUTION),
            )
        ],
        coordinates=["x", "y"],
    )


def run() -> dict[str, Any]:
    """Figures of the run and of the closed form."""
    result = simulate(build(), t_end=4.0, rtol=1e-7, atol=1e-9, max_step=0.05)
    impacts = [event for event in result.events if event.kind == "impact"]
    before = result.t < impacts[0].t
    radius = np.hypot(result["x"], result["y"])
    speed_at_stop = SPEED * np.sqrt(LENGTH**2 - START**2)
    return {
        "result": result,
        "radius": radius,
        "largest_radius_error": np.max(np.abs(radius - START * np.cosh(SPEED * result.t))[before]),
        "impacts": impacts,
        "expected_first_impact": np.arccosh(LENGTH / START) / SPEED,
        "expected_approach_speed": speed_at_stop,
        # between impacts r = L cosh - (u/W) sinh of W times the time since the impact, u the speed of the rebound
        "expected_second_impact": np.arccosh(LENGTH / START) / SPEED
        + 2.0 * np.arctanh(RESTITUTION * speed_at_stop / (SPEED * LENGTH)) / SPEED,
        "force_at_rest": result["stop.normal_force"][-1],
        "expected_force_at_rest": MASS * SPEED**2 * LENGTH,
        "residuals": {
            level: np.max(np.abs(result[f"residual.{level}"])) for level in ("position", "velocity", "acceleration")
        },
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """Radius over time, and the bead's path."""
    from matplotlib.figure import Figure

    result: Result = figures["result"]
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    over_time, plane = figure.subplots(1, 2)
    over_time.plot(result.t, figures["radius"], ".-", ms=3, lw=0.8)
    over_time.axhline(LENGTH, color="0.6", ls="--")
    over_time.set(xlabel="time, s", ylabel="radius, m")
    plane.plot(result["x"], result["y"], lw=0.8)
    plane.set(xlabel="x, m", ylabel="y, m", aspect="equal")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "own_equations.png")
    found = run()
    plot(found, file)
    print(f"first impact at {found['impacts'][0].t:.9f} s; held with {found['force_at_rest']:.9f} N")
    print(f"closed form: {found['expected_first_impact']:.9f} s, {found['expected_force_at_rest']:.9f} N; wrote {file}")
