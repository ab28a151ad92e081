"""A trolley with a hanging load runs into a buffer: built, run, seen, stored, and gone on from.

The rail holds the trolley up and lets it run. Nothing else pushes along it, so the centre of mass of trolley and load
goes on with constant speed until the buffer strikes, and the buffer's impulse is what the momentum along the rail
loses. The page shows the mechanism, the blow and the load that swings on; it is one file and plays in any browser.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from tlismni.core import (
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    Prismatic2D,
    Result,
    Revolute2D,
    RigidBody2D,
    load_result,
    simulate,
)

TROLLEY, LOAD, ROPE, SPEED = 200.0, 400.0, 3.0, 1.5
"""Masses, kg; from the trolley to the load's centre of mass, m; speed at the start, m/s."""
BLOCK = [(-0.35, -0.3), (0.35, -0.3), (0.35, 0.3), (0.05, 0.3), (0.02, ROPE), (-0.02, ROPE), (-0.05, 0.3), (-0.35, 0.3)]
"""The load with its hanger, in its own frame, m."""
WANTED = ["trolley.x", "trolley.vx", "load.angle", "pin.force_y"]


def crane() -> Model:
    """Trolley, load and buffer; the buffer is 2 m away."""
    right = Marker2D(body="trolley", point=(0.4, 0.0))
    return Model(
        name="crane",
        bodies=[
            RigidBody2D(name="trolley", mass=TROLLEY, inertia=10.0, velocity=(SPEED, 0.0)),
            RigidBody2D(name="load", mass=LOAD, inertia=40.0, position=(0.0, -ROPE), velocity=(SPEED, 0.0)),
        ],
        joints=[
            Prismatic2D(name="rail", a=Marker2D(), b=Marker2D(body="trolley")),
            Revolute2D(name="pin", a=Marker2D(body="trolley"), b=Marker2D(body="load", point=(0.0, ROPE))),
        ],
        contacts=[
            DiskOnHalfPlane2D(
                name="buffer",
                plane=HalfPlane2D(marker=Marker2D(point=(2.4, 0.0), angle=np.pi / 2.0)),
                disk=Disk2D(marker=right),
                law=NewtonImpact(restitution=0.4),
            )
        ],
    )


def momentum(result: Result) -> np.ndarray:
    """Along the rail (N,), kg m/s."""
    return TROLLEY * result["trolley.vx"] + LOAD * result["load.vx"]


def run() -> dict[str, Any]:
    """The run, the same from its file, and its second half from the end of the first."""
    result = simulate(crane(), 6.0, rtol=1e-9)
    first = simulate(crane(), 3.0, rtol=1e-9)
    rest = simulate(first.model_at(), 6.0, rtol=1e-9, t0=3.0)
    with TemporaryDirectory() as folder:
        stored = load_result(result.save(Path(folder, "crane.npz")))
    p = momentum(result)
    before = result.t < result.events[0].t
    return {
        "result": result,
        "stored": stored,
        "rest": rest,
        "momentum_before": p[before],
        "expected_momentum": (TROLLEY + LOAD) * SPEED,
        "expected_strike": 2.0 / SPEED,
        "impulses": np.array([event.impulse for event in result.events if event.kind == "impact"]),
        "losses": -np.diff(p)[np.diff(result.t) == 0.0],
        "largest_energy_balance": float(np.max(np.abs(result["energy.balance"]))),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """Channels over time as a figure."""
    figures["result"].plot(*WANTED, path=path)


def animate(figures: dict[str, Any], path: Path) -> None:
    """The page to play (.html), or a film (.gif, .mp4)."""
    figures["result"].animate(path, title="A trolley strikes a buffer", channels=WANTED, outlines={"load": BLOCK})


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "crane.html")
    found = run()
    (plot if file.suffix in (".png", ".pdf", ".svg") else animate)(found, file)
    print(found["result"])
    print(found["result"].event_list())
    print(f"wrote {file}")
