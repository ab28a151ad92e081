"""A cam turns faster and faster until its follower lifts off: an eccentric disk as a closed line, a spring, gravity."""

import math
import sys
from pathlib import Path
from typing import Any

import tlismni.core as tl

RADIUS, OFFSET, ROLLER, MASS, STIFFNESS, G, GAIN, NODES = 0.1, 0.02, 0.03, 0.5, 200.0, 9.81, 40.0, 48
"""Cam and roller, m; follower, kg, N/m; m/s^2; angular acceleration of the cam, rad/s^2; corners of the line."""
UP, REACH = math.pi / 2.0, RADIUS * math.cos(math.pi / NODES) + ROLLER


def build() -> tl.Model:
    """The cam: a circle about a point beside its shaft, as a closed line through its nodes."""
    angles = [2.0 * math.pi * k / NODES for k in range(NODES)]
    points = [(OFFSET + RADIUS * math.cos(a), RADIUS * math.sin(a)) for a in angles]
    profile = tl.Line2D(nodes=[tl.Marker2D(body="cam", point=p) for p in (*points, points[0])], rounding=1.0)
    roller, top, law = tl.Marker2D(body="follower"), math.sqrt(REACH**2 - OFFSET**2), tl.NewtonImpact(restitution=0.1)
    held = {"x": (0.0,), "y": (0.0,), "angle": (0.0, 0.0, GAIN / 2.0)}
    motions = {c: tl.Polynomial(coefficients=f) for c, f in held.items()}
    drives = [tl.CoordinateDriver(name=f"cam_{c}", body="cam", coordinate=c, motion=m) for c, m in motions.items()]
    spring = tl.SpringDamper2D(
        name="spring", a=tl.Marker2D(point=(0, 1)), b=roller, stiffness=STIFFNESS, natural_length=1.0
    )
    guide = tl.Prismatic2D(name="guide", a=tl.Marker2D(angle=UP), b=tl.Marker2D(body="follower", angle=UP))
    return tl.Model(
        name="cam_follower",
        gravity=(0.0, -G),
        bodies=[
            tl.RigidBody2D(name="cam", mass=1.0, inertia=0.01),
            tl.RigidBody2D(name="follower", mass=MASS, inertia=1e-3, position=(0.0, top + 1e-5)),
        ],
        joints=[*drives, guide],
        forces=[spring],
        contacts=[tl.DiskOnLine2D(name="touch", line=profile, disk=tl.Disk2D(marker=roller, radius=ROLLER), law=law)],
    )  # fmt: skip


def run() -> dict[str, Any]:
    """It lifts off near the top, where weight and spring give less than the acceleration that the cam asks for."""
    result = tl.simulate(build(), 2.0, rtol=1e-6)
    return {"result": result, "lift_off": next(e.t for e in result.events if e.kind == "open" and e.t > 0.1)}


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("follower.y", "touch.gap", "touch.normal_force", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "cam_follower.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["follower.y"])
    turns = GAIN * found["lift_off"] ** 2 / (4.0 * math.pi)
    print(f"the follower lifts off at {found['lift_off']:.4f} s, after {turns:.2f} turns; wrote {file}")
