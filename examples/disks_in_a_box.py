"""Disks fall into a box and come to rest on each other, with friction: `python disks_in_a_box.py heap.html 40`.

Each contact is a constraint. 8 disks rest within a second of motion and ten of computing. The number of contacts and of
events grows fast with the number of disks: 40 take tens of minutes.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import tlismni.core as tl

RADIUS, WIDTH, MASS, G = 0.05, 0.34, 1.0, 9.81


def build(count: int = 8) -> tl.Model:
    shift = np.random.default_rng(1).uniform(-0.005, 0.005, count)
    places = [(WIDTH * (k % 3 + 0.5) / 3 + shift[k], 0.08 + 0.12 * (k // 3)) for k in range(count)]
    inertia = 0.5 * MASS * RADIUS**2
    bodies = [tl.RigidBody2D(name=f"disk{k}", mass=MASS, inertia=inertia, position=p) for k, p in enumerate(places)]
    walls = [((0.0, 0.0), 0.0), ((0.0, 0.0), -np.pi / 2.0), ((WIDTH, 0.0), np.pi / 2.0)]
    shapes = [
        *(tl.Disk2D(marker=tl.Marker2D(body=body.name), radius=RADIUS) for body in bodies),
        *(tl.HalfPlane2D(marker=tl.Marker2D(point=point, angle=angle)) for point, angle in walls),
    ]
    law = tl.NewtonImpact(restitution=0.3, rest_ratio=1e-3)
    contacts = tl.contacts_between("touch", shapes, law=law, friction=tl.CoulombFriction(coefficient=0.4))
    return tl.Model(name="disks_in_a_box", gravity=(0.0, -G), bodies=bodies, contacts=contacts)


def run(count: int = 8) -> dict[str, Any]:
    """At rest, floor and walls carry the weight; nothing overlaps; the energy ledger closes."""
    end = 1.5 if count < 20 else 2.5
    result = tl.simulate(build(count), end, rtol=1e-5, t_eval=np.linspace(0.0, end, 301))

    def total(wall: int, channel: str) -> float:
        return float(sum(result[f"touch_disk{k}_ground_{wall}.{channel}"][-1] for k in range(count)))

    carried = total(1, "normal_force") - total(2, "friction_force") + total(3, "friction_force")
    return {
        "result": result,
        "carried": carried,
        "weight": count * MASS * G,
        "kinetic": result["energy.kinetic"][-1],
        "overlap": -min(result[name][-1] for name in result.channels if name.endswith(".gap")),
        "balance": float(np.abs(result["energy.balance"]).max()),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("disk0.y", "disk3.y", "disk6.y", "energy.kinetic", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "disks_in_a_box.html")
    found = run(int(sys.argv[2]) if len(sys.argv) > 2 else 8)
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["energy.kinetic"])
    print(f"floor and walls carry {found['carried']:.6f} N of {found['weight']:.6f} N; wrote {file}")
