"""A block is pulled out of a stack: boxes that stick, slip and tip on each other."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import (
    AppliedForce2D, Box2D, CoulombFriction, HalfPlane2D, Marker2D, Model, NewtonImpact, Ramp, RigidBody2D, contacts_between,
    simulate,
)  # fmt: skip

BLOCKS, WIDTH, HEIGHT, MASS, FRICTION, G, RATE, PULLED = 4, 0.4, 0.2, 1.0, 0.3, 9.81, 40.0, 1
"""Number, m, m, kg; m/s^2; growth of the pull, N/s; which block it acts on, from below."""


def build() -> Model:
    names = [f"block{k}" for k in range(BLOCKS)]
    inertia = MASS * (WIDTH**2 + HEIGHT**2) / 12.0
    bodies = [RigidBody2D(name=n, mass=MASS, inertia=inertia, position=(0.0, (k + 0.5) * HEIGHT)) for k, n in enumerate(names)]
    boxes = [Box2D(marker=Marker2D(body=name), width=WIDTH, height=HEIGHT) for name in names]
    pairs = [(HalfPlane2D(), boxes[0]), *zip(boxes, boxes[1:], strict=False)]
    how = {"law": NewtonImpact(restitution=0.0), "friction": CoulombFriction(coefficient=FRICTION)}
    contacts = [contact for k, pair in enumerate(pairs) for contact in contacts_between(f"joint{k}", pair, **how)]
    pull = Ramp(start=0.1, duration=2.0, after=2.0 * RATE)
    return Model(
        name="pulled_block",
        gravity=(0.0, -G),
        bodies=bodies,
        forces=[AppliedForce2D(name="pull", marker=Marker2D(body=names[PULLED]), force_x=pull)],
        contacts=contacts,
    )  # fmt: skip


def run() -> dict[str, Any]:
    """The block slips when the pull is more than the friction above and below it can hold."""
    result = simulate(build(), 0.7, rtol=1e-6)
    slip = next(event.t for event in result.events if event.kind == "slip")
    return {
        "result": result,
        "slip": slip,
        # all blocks from the pulled one upwards would go together: the joint below gives way first
        "expected_slip": 0.1 + FRICTION * MASS * G * (BLOCKS - PULLED) / RATE,
        "balance": float(np.abs(result["energy.balance"]).max()),
        "out": result[f"block{PULLED}.x"][-1] - result["block0.x"][-1],
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot(*(f"block{k}.x" for k in range(BLOCKS)), path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "pulled_block.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["block1.x"])
    print(f"it slips at {found['slip']:.6f} s, expected {found['expected_slip']:.6f} s; wrote {file}")
