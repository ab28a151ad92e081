"""Gears with backlash: the driver swings, the driven wheel is struck by one flank and then by the other.

The play is a gap on either side of the teeth: r_a theta_a + r_b theta_b stays between plus and minus half the backlash.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import tlismni.core as tl

RADII, INERTIA, BACKLASH, SWING, RATE = (0.1, 0.15), 0.02, 2e-3, 0.1, 12.0
"""Pitch circles, m; of the driven wheel, kg m^2; play along the pitch circles, m; the driver's angle, rad, rad/s."""


def build() -> tl.Model:
    wheels = [
        tl.RigidBody2D(name="driver", mass=1.0, inertia=0.01, angular_velocity=SWING * RATE),
        tl.RigidBody2D(name="driven", mass=2.0, inertia=INERTIA, position=(sum(RADII), 0.0)),
    ]
    ends = [(w.name, tl.Marker2D(point=w.position), tl.Marker2D(body=w.name)) for w in wheels]
    pins = [tl.Revolute2D(name=f"{name}_pin", a=a, b=b) for name, a, b in ends]

    def flank(name: str, side: float) -> tl.CoordinateContact:
        pairs = zip(("driver", "driven"), RADII, strict=True)
        terms = [tl.CoordinateTerm(body=n, coordinate="angle", factor=side * r, unit="m/rad") for n, r in pairs]
        return tl.CoordinateContact(name=name, offset=BACKLASH / 2.0, terms=terms, law=tl.NewtonImpact(restitution=0.2))

    flanks, swing = [flank("front", 1.0), flank("back", -1.0)], tl.Sine(amplitude=SWING, angular_frequency=RATE)
    drive = tl.CoordinateDriver(name="drive", body="driver", coordinate="angle", motion=swing)
    return tl.Model(name="gear_backlash", gravity=(0.0, 0.0), bodies=wheels, joints=[*pins, drive], contacts=flanks)


def run() -> dict[str, Any]:
    """Between blows the driven wheel turns freely; the play is never more than the backlash."""
    result = tl.simulate(build(), 2.0, rtol=1e-8, t_eval=np.linspace(0.0, 2.0, 2001))
    play = RADII[0] * result["driver.angle"] + RADII[1] * result["driven.angle"]
    first = next(event for event in result.events if event.kind == "impact")
    return {"result": result, "play": play, "first": first, "blows": sum(e.kind == "impact" for e in result.events)}


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("driver.angle", "driven.angle", "front.gap", "back.gap", path=path)


def animate(figures: dict[str, Any], path: Path) -> None:
    outlines = {}
    for name, radius, teeth in zip(("driver", "driven"), RADII, (16, 24), strict=True):
        angles = np.linspace(0.0, 2.0 * np.pi, 12 * teeth, endpoint=False)
        rim = radius * (1.0 + 0.05 * np.sign(np.sin(teeth * angles + 0.1)))
        outlines[name] = list(zip((rim * np.cos(angles)).tolist(), (rim * np.sin(angles)).tolist(), strict=True))
    figures["result"].animate(path, channels=["driven.angle"], outlines=outlines)


if __name__ == "__main__":
    file, found = Path(sys.argv[1] if len(sys.argv) > 1 else "gear_backlash.html"), run()
    (plot if file.suffix == ".png" else animate)(found, file)
    print(f"{found['blows']} blows, the first at {found['first'].t:.6f} s; wrote {file}")
