"""Bricard's mechanism, IFToMM benchmark A04: a loop of six hinges that by the count of its equations is rigid."""

from itertools import pairwise

import numpy as np

from ..core.elements import Revolute3D, RigidBody3D
from ..core.model.attitude import Axes
from ..core.model.base import Vector3
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("length", 1.0, "m", "length of each rod", 0.0, exclusive=True),
    ScenarioParameter("width", 0.1, "m", "width of the rods' square section", 0.0, exclusive=True),
    ScenarioParameter("mass", 1.0, "kg", "mass of each rod", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against y", 0.0),
    ScenarioParameter("rate", 0.0, "rad/s", "of the first hinge at the start"),
)
CORNERS = ((0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1))
AXES: tuple[Vector3, ...] = ((0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0))


@scenario("bricard", "Bricard's loop of six hinges with a redundant equation (IFToMM benchmark A04)", PARAMETERS)
def bricard(*, length: float, width: float, mass: float, gravity: float, rate: float) -> Scenario:
    """Bodies `rod1` ... `rod5`, of which the k-th leads from corner k - 1 to corner k; hinges `hinge0` ... `hinge5` at
    the corners, the first and the last on the ground.

    With f the angle of the first hinge the others have -p, f, -p, f, -p, and sin p = sin f/(1 + sin f). So at the start
    all turn at the same rate, in turns to and fro.

    6 x 5 rods less 5 x 6 equations leave no freedom, but one equation follows from the others: the mechanism moves.
    Reference: problem A04 of the IFToMM library of multibody benchmarks; Gonzalez, Dopico, Lugris and Cuadrado, "A
    benchmarking system for MBS simulation software" (2006).
    """
    corners = [tuple(length * x for x in corner) for corner in CORNERS]
    along = mass * width**2 / 6.0
    across = mass * (length**2 + width**2) / 12.0
    # velocities go along the loop: of the corner, and of the rod that turns about it
    turn, go = np.zeros(3), np.zeros(3)
    rods = []
    for k, (start, end) in enumerate(pairwise(corners), 1):
        x, y, z = (0.5 * (a + b) for a, b in zip(start, end, strict=True))
        inertia = np.where(np.array(end) == np.array(start), across, along)
        turn = turn + (rate if k % 2 else -rate) * np.array(AXES[k - 1], dtype=float)
        way = np.cross(turn, np.subtract(end, start))
        rods.append(
            RigidBody3D(
                name=f"rod{k}", mass=mass, position=(x, y, z), inertia=_vector(inertia),
                velocity=_vector(go + 0.5 * way), angular_velocity=_vector(turn),
            )
        )  # fmt: skip
        go = go + way
    joints = []
    for k, (x, y, z) in enumerate(corners):
        axis = Axes(z=AXES[k])
        ground = Marker3D(point=(x, y, z), attitude=axis)
        a = rods[k - 1].marker_at((x, y, z), axis) if k > 0 else ground
        b = rods[k].marker_at((x, y, z), axis) if k < len(rods) else ground
        joints.append(Revolute3D(name=f"hinge{k}", a=a, b=b))
    return Scenario(
        name="bricard",
        description="",
        model=Model(name="bricard", gravity=(0.0, -gravity, 0.0), bodies=tuple(rods), joints=tuple(joints)),
        t_end=10.0,
        compare=("rod3.x", "rod3.y", "rod3.z", "hinge0.angle", "hinge0.angular_velocity"),
    )


def _vector(x: "np.ndarray") -> Vector3:
    return float(x[0]), float(x[1]), float(x[2])
