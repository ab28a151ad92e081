"""A slider-crank whose crank turns across the way of its slider: problem A03 of the IFToMM library, after Haug."""

import math

import numpy as np

from ..core.elements import Prismatic3D, Revolute3D, RigidBody3D, Spherical3D, Universal3D
from ..core.model.attitude import Axes
from ..core.model.base import Vector3
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("crank_length", 0.08, "m", "length of the crank", 0.0, exclusive=True),
    ScenarioParameter("rod_length", 0.3, "m", "length of the rod", 0.0, exclusive=True),
    ScenarioParameter("crank_y", 0.1, "m", "place of the crank's bearing along y"),
    ScenarioParameter("crank_z", 0.12, "m", "place of the crank's bearing along z"),
    ScenarioParameter("crank_mass", 0.12, "kg", "mass of the crank", 0.0, exclusive=True),
    ScenarioParameter("crank_inertia", 1e-4, "kg.m2", "inertia of the crank across its length", 0.0, exclusive=True),
    ScenarioParameter(
        "crank_axial_inertia", 1e-5, "kg.m2", "inertia of the crank along its length", 0.0, exclusive=True
    ),
    ScenarioParameter("rod_mass", 0.5, "kg", "mass of the rod", 0.0, exclusive=True),
    ScenarioParameter("rod_inertia", 4e-3, "kg.m2", "inertia of the rod across its length", 0.0, exclusive=True),
    ScenarioParameter("rod_axial_inertia", 4e-4, "kg.m2", "inertia of the rod along its length", 0.0, exclusive=True),
    ScenarioParameter("slider_mass", 2.0, "kg", "mass of the slider", 0.0, exclusive=True),
    ScenarioParameter("slider_inertia", 1e-4, "kg.m2", "inertia of the slider about any axis", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0),
    ScenarioParameter("speed", 6.0, "rad/s", "angular velocity of the crank at the start"),
)  # fmt: skip


@scenario("spatial_slider_crank", "a slider-crank in space (Haug; IFToMM benchmark A03)", PARAMETERS)
def spatial_slider_crank(
    *, crank_length: float, rod_length: float, crank_y: float, crank_z: float, crank_mass: float, crank_inertia: float,
    crank_axial_inertia: float, rod_mass: float, rod_inertia: float, rod_axial_inertia: float, slider_mass: float,
    slider_inertia: float, gravity: float, speed: float,
) -> Scenario:  # fmt: skip
    """Bodies `arm`, `rod` and `slider`. Joints: `crank`, the hinge of the arm on the ground about x, whose angle is
    that of the arm from z; `pin`, a ball joint of arm and rod; `fork`, a universal joint of rod and slider;
    `guide` along x.

    The universal joint's axes are x of the slider, and that of the rod that is across the rod and x at the start.
    Reference: Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), 12.3.

    Raises
    ------
    ScenarioError : if the rod does not reach from the crank to the slider's way.
    """
    height = crank_z + crank_length
    reach = rod_length**2 - crank_y**2 - height**2
    if not reach > 0.0:
        raise ScenarioError(
            f"the rod of {rod_length:g} m does not reach from the crank's end at y = {crank_y:g}, z = {height:g} m to "
            f"the x axis: make rod_length larger than {math.hypot(crank_y, height):.6g} m"
        )
    slider_x = math.sqrt(reach)
    along = np.array([-slider_x, crank_y, height])  # the rod, from slider to crank
    x = np.array([1.0, 0.0, 0.0])
    across = np.cross(along, x)
    # velocities: the crank's end goes along -y, the rod keeps its length, and `across` stays across x
    end_velocity = np.array([0.0, -speed * crank_length, 0.0])
    slider_velocity = (along @ end_velocity) / along[0] * x
    relative = end_velocity - slider_velocity
    spin = np.cross(along, relative) / (along @ along)
    normal = np.cross(across, x)
    spin -= (spin @ normal) / (along @ normal) * along
    arm = RigidBody3D(
        name="arm", mass=crank_mass, inertia=(crank_inertia, crank_inertia, crank_axial_inertia),
        position=(0.0, crank_y, crank_z + 0.5 * crank_length), velocity=_vector(0.5 * end_velocity),
        angular_velocity=(speed, 0.0, 0.0),
    )  # fmt: skip
    centre = 0.5 * along + [slider_x, 0.0, 0.0]
    rod = RigidBody3D(
        name="rod", mass=rod_mass, inertia=(rod_inertia, rod_inertia, rod_axial_inertia), position=_vector(centre),
        attitude=Axes(z=_vector(along)), velocity=_vector(slider_velocity + 0.5 * relative),
        angular_velocity=_vector(spin), angular_velocity_in="space",
    )  # fmt: skip
    slider = RigidBody3D(
        name="slider", mass=slider_mass, inertia=(slider_inertia, slider_inertia, slider_inertia),
        position=(slider_x, 0.0, 0.0), velocity=_vector(slider_velocity),
    )  # fmt: skip
    hinge = Axes(z=(1.0, 0.0, 0.0), x=(0.0, 0.0, 1.0))
    guide = Axes(z=(1.0, 0.0, 0.0))
    cross = Axes(z=_vector(normal), x=(1.0, 0.0, 0.0))
    bearing, end = (0.0, crank_y, crank_z), (0.0, crank_y, height)
    start = (slider_x, 0.0, 0.0)
    joints = (
        Revolute3D(name="crank", a=Marker3D(point=bearing, attitude=hinge), b=arm.marker_at(bearing, hinge)),
        Spherical3D(name="pin", a=arm.marker_at(end), b=rod.marker_at(end)),
        Universal3D(name="fork", a=slider.marker_at(start, cross), b=rod.marker_at(start, cross)),
        Prismatic3D(name="guide", a=Marker3D(attitude=guide), b=slider.marker_at(start, guide)),
    )  # fmt: skip
    model = Model(name="spatial_slider_crank", gravity=(0.0, 0.0, -gravity), bodies=(arm, rod, slider), joints=joints)
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=5.0,
        compare=("slider.x", "crank.angle", "slider.vx", "crank.angular_velocity", "rod.x", "rod.y", "rod.z"),
    )


def _vector(x: "np.ndarray") -> Vector3:
    return float(x[0]), float(x[1]), float(x[2])
