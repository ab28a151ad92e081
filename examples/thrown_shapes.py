"""A box, a capsule and a ball are thrown on a floor, with friction: in space, to be turned in the browser."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import tlismni.core as tl

MU, G = 0.4, 9.81
BOX, PILL, BALL = (0.4, 0.3, 0.2), (0.3, 0.1), 0.12
"""Edges; length of the cylinder and radius; radius: m."""


def build() -> tl.Model:
    a, b, c = BOX
    on = {name: tl.Marker3D(body=name) for name in ("box", "pill", "ball")}
    tilt = tl.RotationVector(vector=(0.5, 0.3, 0.2))
    thrown = {"mass": 1.0, "attitude": tilt, "angular_velocity": (2.0, -1.0, 3.0)}
    box = ((b * b + c * c) / 12.0, (a * a + c * c) / 12.0, (a * a + b * b) / 12.0)
    round_ = (0.4 * BALL**2,) * 3
    return tl.Model(
        name="thrown_shapes",
        gravity=(0.0, 0.0, -G),
        bodies=[
            tl.RigidBody3D(name="box", inertia=box, position=(0.0, 0.0, 0.6), velocity=(1.5, 0.5, 0.0), **thrown),
            tl.RigidBody3D(name="pill", inertia=(0.016, 0.016, 0.005), position=(0.0, 1.0, 0.7), **thrown),
            tl.RigidBody3D(name="ball", inertia=round_, position=(0.0, -1.0, 0.5), velocity=(0.6, 0.0, 0.0), **thrown),
        ],
        groups=[
            tl.ContactGroup3D(
                name="floor",
                boxes=[tl.Box3D(marker=on["box"], size=BOX)],
                capsules=[tl.Capsule3D(marker=on["pill"], length=PILL[0], radius=PILL[1])],
                spheres=[tl.Sphere3D(marker=on["ball"], radius=BALL)],
                half_spaces=[tl.HalfSpace3D()],
                law=tl.NewtonImpact(restitution=0.4),
                friction=tl.CoulombFriction(coefficient=MU),
                except_bodies=[("box", "pill"), ("box", "ball"), ("pill", "ball")],
            )
        ],
    )  # fmt: skip


def run() -> dict[str, Any]:
    """In the end the box lies on a face, the pill and the ball roll on; none is below the floor."""
    result = tl.simulate(build(), 2.0, rtol=1e-6)
    gaps = [result[name] for name in result.channels if name.endswith(".gap")]
    rolling = result["ball.vx"] - BALL * result["ball.angular_velocity_y"]
    return {
        "result": result,
        "deepest": float(np.min(gaps)),
        "box_height": result["box.z"][-1],
        "box_speed": float(np.hypot(result["box.vx"][-1], result["box.vy"][-1])),
        "ball_slips": float(rolling[-1]),
        "gained": float(np.max(np.diff(result["energy.kinetic"] + result["energy.potential"]))),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("box.z", "pill.z", "ball.z", "energy.kinetic", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "thrown_shapes.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["box.z", "ball.vx"])
    print(f"the box rests at a height of {found['box_height']:.4f} m; wrote {file}")
