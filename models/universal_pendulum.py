"""A pendulum on a universal joint that falls from the horizontal: a test case of Chrono, checked there with ADAMS."""

import math

import numpy as np

from ..core.elements import RigidBody3D, Universal3D
from ..core.model.attitude import RotationVector, rotation_matrix
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("mass", 1.0, "kg", "mass", 0.0, exclusive=True),
    ScenarioParameter("length", 2.0, "m", "distance of the centre of mass from the joint", 0.0, exclusive=True),
    ScenarioParameter("transverse_inertia", 0.1, "kg.m2", "moment of inertia across the pendulum", 0.0, exclusive=True),
    ScenarioParameter("axial_inertia", 0.04, "kg.m2", "moment of inertia along the pendulum", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.80665, "m/s^2", "gravity, against z", 0.0),
    ScenarioParameter("tilt", 0.5 * math.pi, "rad", "turn of pendulum and joint about (1, -1, 0) from hanging down"),
    ScenarioParameter("rate_x", 0.0, "rad/s", "rate about the joint's axis in the ground at the start"),
    ScenarioParameter("rate_y", 0.0, "rad/s", "rate about the joint's axis in the pendulum at the start"),
)


@scenario("universal_pendulum", "a pendulum on a universal joint, released at rest (Chrono's test case)", PARAMETERS)
def universal_pendulum(
    *, mass: float, length: float, transverse_inertia: float, axial_inertia: float, gravity: float, tilt: float,
    rate_x: float, rate_y: float,
) -> Scenario:  # fmt: skip
    """Body `pendulum`, whose z axis points to joint `cross` at the origin, with its axes x in the ground and y in the
    body, both turned by `tilt`."""
    part = tilt / math.sqrt(2.0)
    attitude = RotationVector(vector=(part, -part, 0.0))
    sideways = length * math.sin(tilt) / math.sqrt(2.0)
    # w x (0, 0, -length) in the body's axes
    velocity = rotation_matrix(attitude.parameters()) @ np.array([-length * rate_y, length * rate_x, 0.0])
    pendulum = RigidBody3D(
        name="pendulum", mass=mass, inertia=(transverse_inertia, transverse_inertia, axial_inertia), attitude=attitude,
        position=(sideways, sideways, -length * math.cos(tilt)),
        velocity=(float(velocity[0]), float(velocity[1]), float(velocity[2])), angular_velocity=(rate_x, rate_y, 0.0),
    )  # fmt: skip
    cross = Universal3D(
        name="cross", a=Marker3D(attitude=attitude), b=Marker3D(body="pendulum", point=(0.0, 0.0, length))
    )
    return Scenario(
        name="universal_pendulum",
        description="",
        model=Model(name="universal_pendulum", gravity=(0.0, 0.0, -gravity), bodies=(pendulum,), joints=(cross,)),
        t_end=5.0,
        compare=("pendulum.x", "pendulum.y", "pendulum.z", *(f"pendulum.angular_velocity_{axis}" for axis in "xyz")),
    )
