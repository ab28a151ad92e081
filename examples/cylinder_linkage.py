"""A hydraulic cylinder lifts a boom against a stop: a servo of limited force, and an end stop of the joint."""

import math
import sys
from pathlib import Path
from typing import Any

from tlismni.core import AngleStop2D, Marker2D, Model, NewtonImpact, Ramp, Revolute2D, RigidBody2D, Servo2D, simulate

MASS, LENGTH, G, LIMIT, PUSH = 200.0, 3.0, 9.81, math.radians(40.0), 15000.0
"""Of the boom: kg, m; m/s^2; where the stop is, rad; largest force of the cylinder, N."""
FOOT, EYE = (0.5, -0.8), 1.0
"""Pin of the cylinder on the ground, m; distance of its eye on the boom from the boom's pin, m."""


def build() -> Model:
    boom = RigidBody2D(name="boom", mass=MASS, inertia=MASS * LENGTH**2 / 12.0, position=(LENGTH / 2.0, 0.0))
    eye = Marker2D(body="boom", point=(EYE - LENGTH / 2.0, 0.0))
    cylinder = Servo2D(
        name="cylinder", a=Marker2D(point=FOOT), b=eye, measure="distance", gain=2e5, rate_gain=2e4, largest=PUSH,
        target=Ramp(start=0.2, duration=2.0, before=math.hypot(EYE - FOOT[0], FOOT[1]) + 0.05, after=1.8),
    )  # fmt: skip
    return Model(
        name="cylinder_linkage",
        gravity=(0.0, -G),
        bodies=[boom],
        joints=[Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="boom", point=(-LENGTH / 2.0, 0.0)))],
        forces=[cylinder],
        contacts=[AngleStop2D(name="stop", b=Marker2D(body="boom"), limit=LIMIT, law=NewtonImpact(restitution=0.3))],
    )


def run() -> dict[str, Any]:
    """At rest on the stop, its torque is the cylinder's less the weight's."""
    result = simulate(build(), 4.0, rtol=1e-7)
    x, y = EYE * math.cos(LIMIT), EYE * math.sin(LIMIT)
    length = math.hypot(x - FOOT[0], y - FOOT[1])
    arm = (FOOT[0] * y - FOOT[1] * x) / length
    asked = 2e5 * (1.8 - length)
    force = asked * (1.0 + (asked / PUSH) ** 8) ** -0.125
    expected = force * arm - MASS * G * LENGTH / 2.0 * math.cos(LIMIT)
    return {"result": result, "stop_torque": result["stop.normal_force"][-1], "expected_stop_torque": expected}


def plot(figures: dict[str, Any], path: Path) -> None:
    figures["result"].plot("boom.angle", "boom.angular_velocity", "stop.normal_force", path=path)


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else "cylinder_linkage.html")
    found = run()
    plot(found, file) if file.suffix == ".png" else found["result"].animate(file, channels=["stop.normal_force"])
    torque, expected = found["stop_torque"], found["expected_stop_torque"]
    print(f"torque on the stop {torque:.3f} N m, by statics {expected:.3f} N m; wrote {file}")
