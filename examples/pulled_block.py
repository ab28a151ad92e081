"""A block is pulled out of a stack: corners are small disks, faces are segments, friction sticks and slips."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import tlismni.core as tl

BLOCKS, WIDTH, HEIGHT, MASS, FRICTION, G, RATE, PULLED, CORNER = 4, 0.4, 0.2, 1.0, 0.3, 9.81, 40.0, 1, 2e-3
"""Number, m, m, kg; m/s^2; growth of the pull, N/s; which block it acts on, from below; radius of corners, m."""


def build() -> tl.Model:
    def corner(k: int, side: int, up: int) -> tl.Disk2D:
        point = (side * (WIDTH / 2.0 - CORNER), up * (HEIGHT / 2.0 - CORNER))
        return tl.Disk2D(marker=tl.Marker2D(body=f"block{k}", point=point), radius=CORNER)

    def face(k: int, up: int) -> tl.Segment2D:
        start, angle = (-up * WIDTH / 2.0, up * HEIGHT / 2.0), 0.0 if up > 0 else math.pi
        return tl.Segment2D(marker=tl.Marker2D(body=f"block{k}", point=start, angle=angle), length=WIDTH)

    how: Any = {"law": tl.NewtonImpact(restitution=0.0), "friction": tl.CoulombFriction(coefficient=FRICTION)}
    inertia, contacts = MASS * (WIDTH**2 + HEIGHT**2) / 12.0, []
    for side, name in ((-1, "left"), (1, "right")):
        foot = corner(0, side, -1)
        contacts.append(tl.DiskOnHalfPlane2D(name=f"ground_{name}", plane=tl.HalfPlane2D(), disk=foot, **how))
        for k in range(1, BLOCKS):
            sides = {"lower": (face(k - 1, 1), corner(k, side, -1)), "upper": (face(k, -1), corner(k - 1, side, 1))}
            for part, (line, disk) in sides.items():
                contacts.append(tl.DiskOnSegment2D(name=f"{part}{k}_{name}", segment=line, disk=disk, **how))
    heights = [HEIGHT * (k + 0.5) for k in range(BLOCKS)]
    bodies = [
        tl.RigidBody2D(name=f"block{k}", mass=MASS, inertia=inertia, position=(0, h)) for k, h in enumerate(heights)
    ]
    force = tl.Ramp(start=0.1, duration=2.0, after=2.0 * RATE)
    pull = tl.AppliedForce2D(name="pull", marker=tl.Marker2D(body=f"block{PULLED}"), force_x=force)
    return tl.Model(name="pulled_block", gravity=(0.0, -G), bodies=bodies, forces=[pull], contacts=contacts)


def run() -> dict[str, Any]:
    """The pulled block and those on it slip together, as soon as friction below them cannot hold them."""
    result = tl.simulate(build(), 0.9, rtol=1e-6)
    moving = result.t[np.argmax(np.abs(result[f"block{PULLED}.vx"]) > 1e-9)]
    slip = max(event.t for event in result.events if event.t < moving)
    expected, balance = 0.1 + FRICTION * MASS * G * (BLOCKS - PULLED) / RATE, np.abs(result["energy.balance"]).max()
    return {"result": result, "slip": slip, "expected_slip": expected, "balance": float(balance)}


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot(*(f"block{k}.x" for k in range(BLOCKS)), path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "pulled_block.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["block1.x"])
    print(f"it slips at {found['slip']:.6f} s, expected {found['expected_slip']:.6f} s; wrote {file}")
