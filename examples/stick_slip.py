"""Stick-slip on a belt: the times at which a block sticks and slips against the closed form.

A block of mass m, held by a spring k, lies on a belt that runs with u. It sticks until k x = mu_s m g, slips back as a
harmonic oscillation about mu m g/k, and sticks again when it has the speed of the belt. With A = (mu_s - mu) m g/k and
w = sqrt(k/m) it slips for 2 (pi - atan(A w/u))/w and sticks for 2 A/u.
"""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from tlismni.core import (
    CoordinateDriver,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    Result,
    RigidBody2D,
    SpringDamper2D,
    simulate,
)

MASS, STIFFNESS, BELT_SPEED, STATIC, KINETIC, GRAVITY = 1.5, 60.0, 0.3, 0.5, 0.3, 9.81
FAR = 100.0  # m; the spring is that long, so that its force acts along the belt
END = 6.0


def build() -> Model:
    """The belt is a body that is driven; its upper side is a half-plane, on which the block lies with friction."""
    motions = {"x": (0.0, BELT_SPEED), "y": (0.0,), "angle": (0.0,)}
    return Model(
        name="belt",
        gravity=(0.0, -GRAVITY),
        bodies=[
            PointMass2D(name="block", mass=MASS, velocity=(BELT_SPEED, 0.0)),
            RigidBody2D(name="belt", mass=3.0, inertia=1.0, velocity=(BELT_SPEED, 0.0)),
        ],
        joints=[
            CoordinateDriver(name=f"belt_{name}", body="belt", coordinate=name, motion=Polynomial(coefficients=c))
            for name, c in motions.items()
        ],
        forces=[
            SpringDamper2D(
                name="spring",
                a=Marker2D(point=(-FAR, 0.0)),
                b=Marker2D(body="block"),
                stiffness=STIFFNESS,
                damping=0.0,
                natural_length=FAR,
            )
        ],
        contacts=[
            DiskOnHalfPlane2D(
                name="shoe",
                plane=HalfPlane2D(marker=Marker2D(body="belt")),
                disk=Disk2D(marker=Marker2D(body="block")),
                law=NewtonImpact(restitution=0.0),
                friction=CoulombFriction(coefficient=KINETIC, static_coefficient=STATIC),
            )
        ],
    )


def expected_times(until: float) -> np.ndarray:
    """Times at which it slips, sticks, slips ..., s."""
    w, lead = math.sqrt(STIFFNESS / MASS), (STATIC - KINETIC) * MASS * GRAVITY / STIFFNESS
    phases = 2.0 * (math.pi - math.atan(lead * w / BELT_SPEED)) / w, 2.0 * lead / BELT_SPEED
    times = [STATIC * MASS * GRAVITY / STIFFNESS / BELT_SPEED]
    while times[-1] < until:
        times.append(times[-1] + phases[(len(times) - 1) % 2])
    return np.array(times[:-1])


def run() -> dict[str, Any]:
    """Figures of the run and of the closed form."""
    result = simulate(build(), END, rtol=1e-10, atol=1e-12, t_eval=np.linspace(0.0, END, 2401))
    changes = [event for event in result.events if event.kind in ("stick", "slip")]
    return {
        "result": result,
        "kinds": [event.kind for event in changes],
        "times": np.array([event.t for event in changes]),
        "expected_times": expected_times(END),
        "largest_energy_balance": float(np.max(np.abs(result["energy.balance"]))),
    }


def plot(figures: dict[str, Any], path: Path) -> None:
    """Speeds of block and belt; friction between its limits."""
    from matplotlib.figure import Figure

    result: Result = figures["result"]
    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(result.t, result["block.vx"], lw=1.0, label="block")
    upper.axhline(BELT_SPEED, color="0.6", lw=0.8, ls="--", label="belt")
    upper.set(ylabel="speed, m/s", ylim=(-0.5, 0.5))
    upper.legend(loc="upper right", ncols=2)
    lower.plot(result.t, result["shoe.friction_force"], lw=1.0)
    weight = MASS * GRAVITY
    for mu, name in ((STATIC, r"$\mu_s F_n$"), (KINETIC, r"$\mu F_n$")):
        lower.axhline(mu * weight, color="0.6", lw=0.8, ls="--")
        lower.annotate(name, (0.62, mu * weight), va="bottom")
    for t, kind in zip(figures["times"], figures["kinds"], strict=True):
        lower.axvline(t, color="C3" if kind == "slip" else "C2", lw=0.6)
    lower.set(xlabel="time, s (red: slips, green: sticks)", ylabel="friction, N", ylim=(-0.5, 8.8))
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "stick_slip.png")
    found = run()
    plot(found, file)
    error = np.max(np.abs(found["times"] - found["expected_times"]))
    print(f"{len(found['times'])} changes between sticking and slipping; largest error of their times {error:.1e} s")
    print(f"largest error of the energy ledger {found['largest_energy_balance']:.1e} J; wrote {file}")
