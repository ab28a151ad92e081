"""A heavy top on a fixed pivot that spins fast: the benchmark of Geradin and Cardona."""

from ..core.elements import RigidBody3D, Spherical3D
from ..core.model.attitude import RotationVector, rotation_matrix
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("mass", 15.0, "kg", "mass of the top", 0.0, exclusive=True),
    ScenarioParameter("length", 1.0, "m", "distance of the centre of mass from the pivot", 0.0, exclusive=True),
    ScenarioParameter("axial_inertia", 0.46875, "kg.m2", "inertia about the axis of symmetry", 0.0, exclusive=True),
    ScenarioParameter(
        "transverse_inertia", 0.234375, "kg.m2", "moment of inertia across it, about the centre of mass", 0.0,
        exclusive=True,
    ),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0),
    ScenarioParameter("spin", 150.0, "rad/s", "angular velocity about the axis of symmetry at the start"),
    ScenarioParameter("precession", -4.61538, "rad/s", "angular velocity about the vertical at the start"),
    ScenarioParameter("tilt_x", 0.0, "rad", "rotation vector of its attitude at the start, along x"),
    ScenarioParameter("tilt_y", 0.0, "rad", "the same along y"),
    ScenarioParameter("tilt_z", 0.0, "rad", "the same along z"),
)  # fmt: skip


@scenario("heavy_top", "a heavy top on a fixed pivot that spins fast (Geradin and Cardona)", PARAMETERS)
def heavy_top(
    *, mass: float, length: float, axial_inertia: float, transverse_inertia: float, gravity: float, spin: float,
    precession: float, tilt_x: float, tilt_y: float, tilt_z: float,
) -> Scenario:  # fmt: skip
    """Body `top`, whose axis of symmetry is its y axis; without a tilt it starts along y. Joint `pivot` at the origin.

    Reference: Geradin and Cardona, Flexible Multibody Dynamics (2001), 3.9; Bruls, Cardona and Arnold, Mechanism and
    Machine Theory 48 (2012), 121.
    """
    attitude = RotationVector(vector=(tilt_x, tilt_y, tilt_z))
    x, y, z = (float(part) for part in rotation_matrix(attitude.parameters())[:, 1])
    top = RigidBody3D(
        name="top", mass=mass, inertia=(transverse_inertia, axial_inertia, transverse_inertia), attitude=attitude,
        position=(length * x, length * y, length * z),
        velocity=(-precession * length * y, precession * length * x, 0.0),
        angular_velocity=(spin * x, spin * y, spin * z + precession), angular_velocity_in="space",
    )  # fmt: skip
    pivot = Spherical3D(name="pivot", a=Marker3D(), b=Marker3D(body="top", point=(0.0, -length, 0.0)))
    return Scenario(
        name="heavy_top",
        description="",
        model=Model(name="heavy_top", gravity=(0.0, 0.0, -gravity), bodies=(top,), joints=(pivot,)),
        t_end=2.0,
        rtol=1e-9,
        compare=("top.x", "top.y", "top.z", *(f"top.angular_velocity_{axis}" for axis in "xyz")),
    )
