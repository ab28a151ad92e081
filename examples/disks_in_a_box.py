"""40 disks fall into a box and come to rest on each other, with friction: `python disks_in_a_box.py heap.html 40`.

Contacts are forces: 20 s for 40 disks. `disks_in_a_box.py heap.html 8 constraints` makes them constraints: nothing
overlaps, friction does not creep. But each of the many blows is an event: 10 s for 8 disks, some minutes for 30.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import tlismni.core as tl

RADIUS, G, INERTIA = 0.05, 9.81, 0.5 * 0.05**2
STICKING, TANH = tl.CoulombFriction(coefficient=0.4), tl.TanhFriction(coefficient=0.4, transition_speed=0.01)
HARD, SOFT = tl.NewtonImpact(restitution=0.3, rest_ratio=1e-3), tl.HuntCrossley(stiffness=1e6, restitution=0.3)


def build(count: int = 40, hard: bool = False) -> tl.Model:
    (columns, width), shift = (
        (3, 0.34) if count < 20 else (5, 0.54),
        np.random.default_rng(1).uniform(-5e-3, 5e-3, count),
    )
    places = [(width * (k % columns + 0.5) / columns + shift[k], 0.08 + 0.12 * (k // columns)) for k in range(count)]
    bodies = [tl.RigidBody2D(name=f"disk{k}", mass=1, inertia=INERTIA, position=p) for k, p in enumerate(places)]
    walls = [((0.0, 0.0), 0.0), ((0.0, 0.0), -np.pi / 2.0), ((width, 0.0), np.pi / 2.0)]
    group = tl.ContactGroup2D(
        name="touch",
        disks=[tl.Disk2D(marker=tl.Marker2D(body=body.name), radius=RADIUS) for body in bodies],
        half_planes=[tl.HalfPlane2D(marker=tl.Marker2D(point=point, angle=angle)) for point, angle in walls],
        law=HARD if hard else SOFT,
        friction=STICKING if hard else TANH,
    )
    return tl.Model(name="disks_in_a_box", gravity=(0.0, -G), bodies=bodies, groups=[group])


def run(count: int = 40, hard: bool = False) -> dict[str, Any]:
    """At rest floor and walls carry the weight."""
    result = tl.simulate(build(count, hard), 2.0, rtol=1e-5 if hard else 1e-4, t_eval=np.linspace(0.0, 2.0, 201))

    def total(wall: int, channel: str) -> float:
        return float(sum(result[f"touch_disk{k}_ground_{wall}.{channel}"][-1] for k in range(count)))

    carried = total(1, "normal_force") - total(2, "friction_force") + total(3, "friction_force")
    loads = {"result": result, "carried": carried, "weight": count * G, "kinetic": result["energy.kinetic"][-1]}
    overlap = -min(result[name][-1] for name in result.channels if name.endswith(".gap"))
    return {**loads, "overlap": overlap, "balance": float(np.abs(result["energy.balance"]).max())}


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("disk0.y", "disk3.y", "energy.kinetic", path=path)


if __name__ == "__main__":
    file, count, kind = [*sys.argv[1:], *("disks_in_a_box.html", "40", "forces")[len(sys.argv) - 1 :]][:3]
    found = run(int(count), kind == "constraints")
    plot(found, Path(file)) if file.endswith(".png") else found["result"].animate(file, channels=["energy.kinetic"])
    print(f"floor and walls carry {found['carried']:.4f} N of {found['weight']:.4f} N; wrote {file}")
