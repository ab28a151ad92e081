"""A cam turns faster and faster until its follower lifts off: an eccentric disk as a closed line, a spring, gravity."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import (
    CoordinateDriver, Disk2D, DiskOnLine2D, Line2D, Marker2D, Model, NewtonImpact, Polynomial, Prismatic2D, RigidBody2D,
    SpringDamper2D, simulate,
)  # fmt: skip

RADIUS, OFFSET, ROLLER, MASS, STIFFNESS, G, GAIN, NODES = 0.1, 0.02, 0.03, 0.5, 200.0, 9.81, 40.0, 48
"""Cam and roller, m; follower, kg, N/m; m/s^2; angular acceleration of the cam, rad/s^2; corners of the line."""
UP = 0.5 * math.pi


def profile() -> Line2D:
    """The cam: a circle about a point beside its shaft."""
    angles = np.linspace(0.0, 2.0 * np.pi, NODES + 1)
    points = [(OFFSET + RADIUS * math.cos(a), RADIUS * math.sin(a)) for a in angles[:-1]]
    return Line2D(nodes=[Marker2D(body="cam", point=p) for p in (*points, points[0])], rounding=1.0)


def build() -> Model:
    reach = RADIUS * math.cos(math.pi / NODES) + ROLLER
    roller = Marker2D(body="follower")
    spring = SpringDamper2D(name="spring", a=Marker2D(point=(0.0, 1.0)), b=roller, stiffness=STIFFNESS, natural_length=1.0)
    held = [("x", (0.0,)), ("y", (0.0,)), ("angle", (0.0, 0.0, GAIN / 2.0))]
    return Model(
        name="cam_follower",
        gravity=(0.0, -G),
        bodies=[
            RigidBody2D(name="cam", mass=1.0, inertia=0.01),
            RigidBody2D(name="follower", mass=MASS, inertia=1e-3, position=(0.0, math.sqrt(reach**2 - OFFSET**2) + 1e-5)),
        ],
        joints=[
            *(CoordinateDriver(name=f"cam_{c}", body="cam", coordinate=c, motion=Polynomial(coefficients=f)) for c, f in held),
            Prismatic2D(name="guide", a=Marker2D(angle=UP), b=Marker2D(body="follower", angle=UP)),
        ],
        forces=[spring],
        contacts=[
            DiskOnLine2D(name="cam_contact", line=profile(), disk=Disk2D(marker=roller, radius=ROLLER), law=NewtonImpact(restitution=0.1))
        ],
    )  # fmt: skip


def run() -> dict[str, Any]:
    """It lifts off near the top, where weight and spring give less than the acceleration that the cam asks for."""
    result = simulate(build(), 2.0, rtol=1e-6)
    lift = next(event.t for event in result.events if event.kind == "open" and event.t > 0.1)
    t = np.linspace(0.1, 2.0, 200_001)
    p, rate, reach = 0.5 * GAIN * t**2, GAIN * t, RADIUS * math.cos(math.pi / NODES) + ROLLER
    s, c = OFFSET * np.sin(p), OFFSET * np.cos(p)
    root = np.sqrt(reach**2 - c**2)
    slope, bend = c + c * s / root, -s + (c**2 - s**2) / root - (c * s) ** 2 / root**3
    pressed = MASS * (G + bend * rate**2 + slope * GAIN) + STIFFNESS * (s + root) > 0.0
    return {"result": result, "lift_off": lift, "expected_lift_off": t[np.argmin(pressed)], "angle": 0.5 * GAIN * lift**2}


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("follower.y", "cam_contact.gap", "cam_contact.normal_force", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "cam_follower.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["follower.y"])
    print(f"the follower lifts off at {found['lift_off']:.4f} s, after {found['angle'] / math.tau:.2f} turns; {file}")
