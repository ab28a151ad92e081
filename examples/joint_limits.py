"""A double pendulum whose elbow cannot turn all the way: end stops as contacts of an angle."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import AngleStop2D, Marker2D, Model, NewtonImpact, Revolute2D, RigidBody2D, simulate

LENGTH, MASS, G, RANGE = 0.5, 1.0, 9.81, (0.0, math.radians(120.0))
"""Of each link, m and kg; m/s^2; the elbow's angles, rad."""


def build() -> Model:
    def end(name: str, side: float) -> Marker2D:
        return Marker2D(body=name, point=(side * LENGTH / 2.0, 0.0))

    law = NewtonImpact(restitution=0.4)
    links = [
        RigidBody2D(name=name, mass=MASS, inertia=MASS * LENGTH**2 / 12.0, position=(x, 0.0), angular_velocity=0.0)
        for name, x in (("arm", LENGTH / 2.0), ("forearm", 1.5 * LENGTH))
    ]
    return Model(
        name="joint_limits",
        gravity=(0.0, -G),
        bodies=links,
        joints=[
            Revolute2D(name="shoulder", a=Marker2D(), b=end("arm", -1)),
            Revolute2D(name="elbow", a=end("arm", 1), b=end("forearm", -1)),
        ],
        contacts=[
            AngleStop2D(name=side, a=end("arm", 1), b=end("forearm", -1), side=side, limit=limit, law=law)
            for side, limit in zip(("lower", "upper"), RANGE, strict=True)
        ],
    )  # fmt: skip


def run() -> dict[str, Any]:
    """The elbow stays in its range, and only blows take energy."""
    result = simulate(build(), 4.0, rtol=1e-8, t_eval=np.linspace(0.0, 4.0, 801))
    elbow = result["forearm.angle"] - result["arm.angle"]
    lost = sum(event.energy_loss for event in result.events if event.kind == "impact")
    total = result["energy.kinetic"] + result["energy.potential"]
    return {"result": result, "elbow": elbow, "lost": lost, "missing": total[0] - total[-1]}


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("arm.angle", "forearm.angle", "upper.gap", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "joint_limits.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["forearm.angle"])
    low, high = np.degrees([found["elbow"].min(), found["elbow"].max()])
    print(f"elbow between {low:.3f} and {high:.3f} degrees; blows took {found['lost']:.6f} J; wrote {file}")
