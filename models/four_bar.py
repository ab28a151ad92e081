"""Coupled four-bar linkages: problem A02 of the IFToMM library of multibody benchmarks."""

import math

from ..core.elements import Revolute2D, RigidBody2D
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("loops", 2, "-", "number of four-bar loops", 1),
    ScenarioParameter("length", 1.0, "m", "length of each rod and distance of the pins", 0.0, exclusive=True),
    ScenarioParameter("mass", 1.0, "kg", "mass of each rod", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0),
    ScenarioParameter("speed", 1.0, "m/s", "speed of the upper points at the start, in x"),
)


@scenario("four_bar", "coupled four-bar loops that pass singular positions (IFToMM benchmark A02)", PARAMETERS)
def four_bar(*, loops: int, length: float, mass: float, gravity: float, speed: float) -> Scenario:
    """Bodies `crank0` ... `crankN` on the pins A_k = (k length, 0), and `coupler1` ... `couplerN` between their
    upper ends B_k; all are slender rods, N = `loops`.

    The start is upright. B_0 is crank0's far end: twice its centre, (2 x, 2 y), moving with (2 vx, 2 vy). Joints:
    `pin0` ... `pinN` on the ground, and at B_k `leftK` to the coupler before and `rightK` to the one behind.
    2 N + 1 bodies and 3 N + 1 revolute joints leave 3 (2 N + 1) - 2 (3 N + 1) = 1 degree of freedom, without
    redundant constraints. Wherever the cranks lie along the x axis the constraint Jacobian loses rank N, and
    each loop could fold over into an antiparallelogram.

    Reference: problem A02 "N four-bar mechanism" of Gonzalez, Dopico, Lugris and Cuadrado, "A benchmarking system
    for MBS simulation software" (2006). In the common angle of the cranks, while the couplers stay level:
    angle'' = -(gravity / length) cos(angle) ((N + 1)/2 + N) / ((N + 1)/3 + N), 7/6 for N = 2.
    """
    half = 0.5 * length
    inertia = mass * length**2 / 12.0

    def rod(name: str, x: float, y: float, angle: float, vx: float, rate: float) -> RigidBody2D:
        return RigidBody2D(
            name=name, mass=mass, inertia=inertia, position=(x, y), angle=angle, velocity=(vx, 0.0),
            angular_velocity=rate,
        )  # fmt: skip

    cranks = tuple(
        rod(f"crank{k}", k * length, half, 0.5 * math.pi, 0.5 * speed, -speed / length) for k in range(loops + 1)
    )
    couplers = tuple(rod(f"coupler{k}", (k - 0.5) * length, length, 0.0, speed, 0.0) for k in range(1, loops + 1))

    def end(body: str, side: float) -> Marker2D:
        return Marker2D(body=body, point=(side * half, 0.0))

    joints = []
    for k in range(loops + 1):
        ground = Marker2D(point=(k * length, 0.0))
        joints.append(Revolute2D(name=f"pin{k}", a=ground, b=end(f"crank{k}", -1.0)))
        if k > 0:
            joints.append(Revolute2D(name=f"left{k}", a=end(f"crank{k}", 1.0), b=end(f"coupler{k}", 1.0)))
        if k < loops:
            joints.append(Revolute2D(name=f"right{k}", a=end(f"crank{k}", 1.0), b=end(f"coupler{k + 1}", -1.0)))
    model = Model(name="four_bar", gravity=(0.0, -gravity), bodies=(*cranks, *couplers), joints=tuple(joints))
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=10.0,
        compare=("crank0.x", "crank0.y", "crank0.angle", "crank0.angular_velocity", f"coupler{loops}.angle"),
    )
