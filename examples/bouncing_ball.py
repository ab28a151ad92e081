"""A ball bounces to rest: impact times against the closed form.

Dropped from height h with restitution e, the ball strikes at sqrt(2h/g) (1 + 2 (e + e^2 + ...)) and is at rest at
sqrt(2h/g) (1 + e)/(1 - e), after infinitely many impacts. Each impact is located to rounding; the rest rule ends the
sequence, and the floor becomes a constraint whose force is the ball's weight.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import (
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Result,
    simulate,
)

HEIGHT, GRAVITY, RESTITUTION, MASS = 1.0, 9.81, 0.8, 2.0


def build() -> Model:
    """The model is data: `build().save("ball.json")` gives the file that `tlismni run ball.json` takes."""
    return Model(
        name="ball",
        gravity=(0.0, -GRAVITY),
        bodies=[PointMass2D(name="ball", mass=MASS, position=(0.0, HEIGHT))],
        contacts=[
            DiskOnHalfPlane2D(
                name="floor",
                plane=HalfPlane2D(),
                disk=Disk2D(marker=Marker2D(body="ball")),
                law=NewtonImpact(restitution=RESTITUTION),
            )
        ],
    )


def expected_impacts(count: int) -> np.ndarray:
    """Times of the first `count` impacts, s."""
    powers = RESTITUTION ** np.arange(1, count)
    return np.sqrt(2.0 * HEIGHT / GRAVITY) * (1.0 + 2.0 * np.concatenate([[0.0], np.cumsum(powers)]))


def run() -> dict[str, Any]:
    """Figures of the run and of the closed form."""
    # free flight is a parabola, which the method steps over in one go: times to record are for the plot
    result = simulate(build(), t_end=5.0, t_eval=np.linspace(0.0, 5.0, 1001))
    impacts = np.array([event.t for event in result.events if event.kind == "impact"])
    return {
        "result": result,
        "impacts": impacts,
        "expected_impacts": expected_impacts(len(impacts)),
        "rest": next(event.t for event in result.events if event.kind == "rest"),
        "expected_rest": np.sqrt(2.0 * HEIGHT / GRAVITY) * (1.0 + RESTITUTION) / (1.0 - RESTITUTION),
        "force_at_rest": result["floor.normal_force"][-1],
        "largest_energy_balance": np.max(np.abs(result["energy.balance"])),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """Height, and the error of each impact's time."""
    from matplotlib.figure import Figure

    result: Result = figures["result"]
    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    upper, lower = figure.subplots(2, 1)
    upper.plot(result.t, result["ball.y"], lw=0.8)
    upper.set(xlabel="time, s", ylabel="height, m")
    error = np.abs(figures["impacts"] - figures["expected_impacts"])
    lower.semilogy(np.arange(1, len(error) + 1), np.maximum(error, 1e-17), "o", ms=4)
    lower.set(xlabel="impact", ylabel="error of its time, s")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "bouncing_ball.png")
    found = run()
    plot(found, file)
    print(f"{len(found['impacts'])} impacts, then rest at {found['rest']:.9f} s")
    print(f"closed form, after infinitely many: {found['expected_rest']:.9f} s; wrote {file}")
