"""A cart keeps a pole upright: a controller pushes it by what the pole does, also when a ball strikes it."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import (
    Constant,
    Disk2D,
    DiskOnDisk2D,
    Distance2D,
    Marker2D,
    Model,
    NewtonImpact,
    PIDController2D,
    PointMass2D,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    simulate,
)

CART, POLE, BALL = 1.0, 0.3, 0.1
"""Masses, kg."""
LENGTH, ROPE, KNOB, G, UP = 1.0, 0.8, 0.06, 9.81, 0.5 * math.pi
"""Of the pole; of what the ball hangs on; radius of the ball and of the knob at the pole's end, m; m/s^2; rad."""


def build() -> Model:
    cart = RigidBody2D(name="cart", mass=CART, inertia=0.01)
    pole = RigidBody2D(name="pole", mass=POLE, inertia=POLE * LENGTH**2 / 12.0, position=(0.0, 0.5 * LENGTH), angle=UP)
    hook = Marker2D(point=(-2.0 * KNOB, LENGTH + ROPE))
    ball = PointMass2D(name="ball", mass=BALL, position=(hook.point[0] - 0.6 * ROPE, hook.point[1] - 0.8 * ROPE))
    end = Marker2D(body="pole", point=(0.5 * LENGTH, 0.0))
    disks = {"a": Disk2D(marker=end, radius=KNOB), "b": Disk2D(marker=Marker2D(body="ball"), radius=KNOB)}
    # both controllers push the cart along the rail
    push = {"a": Marker2D(), "b": Marker2D(body="cart"), "measure": "slide"}
    upright = PIDController2D(
        name="upright", **push, sensor_a=Marker2D(), sensor_b=Marker2D(body="pole"), sensed="angle",
        target=Constant(value=UP), gain=60.0, integral_gain=10.0, rate_gain=16.0, largest=25.0,
    )  # fmt: skip
    # the way back begins with a push away, so that the pole leans: gains below zero
    home = PIDController2D(name="home", **push, target=Constant(value=0.0), gain=-6.0, rate_gain=-9.0, largest=5.0)
    return Model(
        name="cart_pole",
        gravity=(0.0, -G),
        bodies=[cart, pole, ball],
        joints=[
            Prismatic2D(name="rail", a=Marker2D(), b=Marker2D(body="cart")),
            Revolute2D(name="hinge", a=Marker2D(body="cart"), b=Marker2D(body="pole", point=(-0.5 * LENGTH, 0.0))),
            Distance2D(name="rope", a=hook, b=Marker2D(body="ball"), length=ROPE),
        ],
        forces=[upright, home],
        contacts=[DiskOnDisk2D(name="blow", **disks, law=NewtonImpact(restitution=0.6))],
    )


def run() -> dict[str, Any]:
    result = simulate(build(), 10.0, rtol=1e-8, t_eval=np.linspace(0.0, 10.0, 1001))
    force = CART * result["cart.ax"] + POLE * result["pole.ax"]
    return {"result": result, "lean": result["pole.angle"] - UP, "force": force,
            "balance": float(np.abs(result["energy.balance"]).max())}  # fmt: skip


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("pole.angle", "cart.x", "cart.vx", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "cart_pole.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["pole.angle", "cart.x"])
    print(f"the blow tips the pole by {np.degrees(np.abs(found['lean']).max()):.2f} degrees; wrote {file}")
