"""A disk that rolls on a plane without sliding: a coin, a hoop, a wheel."""

import math

from ..core.elements import RigidBody3D, RollingDisk3D
from ..core.model.attitude import Axes
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

MASS, RADIUS, AXIAL, TRANSVERSE, GRAVITY, TILT, PRECESSION = 1.0, 0.3, 0.045, 0.0225, 9.81, 1.1, 3.0


def steady_spin(
    mass: float, radius: float, axial: float, transverse: float, gravity: float, tilt: float, precession: float
) -> float:
    """Angular velocity about the axle (rad/s, of the disk against space) with which the disk rolls in a circle.

    Moments about the point that touches, with the axle `tilt` rad from the vertical, C axial and A transverse inertia:
    (C + m r^2) W w sin(tilt) - A W^2 sin(tilt) cos(tilt) + m g r cos(tilt) = 0 (Neimark and Fufaev 1972, II.2).
    """
    s, c = math.sin(tilt), math.cos(tilt)
    moment = transverse * precession**2 * s * c - mass * gravity * radius * c
    return moment / ((axial + mass * radius**2) * precession * s)


PARAMETERS = (
    ScenarioParameter("mass", MASS, "kg", "mass of the disk", 0.0, exclusive=True),
    ScenarioParameter("radius", RADIUS, "m", "radius of the disk", 0.0, exclusive=True),
    ScenarioParameter("rim_radius", 0.0, "m", "radius of the rounding of its rim", 0.0),
    ScenarioParameter("axial_inertia", AXIAL, "kg.m2", "moment of inertia about the axle", 0.0, exclusive=True),
    ScenarioParameter("transverse_inertia", TRANSVERSE, "kg.m2", "moment of inertia across it", 0.0, exclusive=True),
    ScenarioParameter("gravity", GRAVITY, "m/s^2", "gravity, against z", 0.0),
    ScenarioParameter("tilt", TILT, "rad", "angle of the axle from the vertical at the start", 0.0, math.pi),
    ScenarioParameter("tilt_rate", 0.0, "rad/s", "rate of that angle at the start"),
    ScenarioParameter("precession", PRECESSION, "rad/s", "rate at which the axle turns about the vertical at first"),
    ScenarioParameter(
        "spin", steady_spin(MASS, RADIUS, AXIAL, TRANSVERSE, GRAVITY, TILT, PRECESSION), "rad/s",
        "angular velocity of the disk about its axle at the start; the default makes it roll in a circle",
    ),
    ScenarioParameter("end_time", 2.0 * math.pi / PRECESSION, "s", "length of the run", 0.0, exclusive=True),
)  # fmt: skip


@scenario("rolling_disk", "a disk that rolls on a plane without sliding; with the defaults in a circle", PARAMETERS)
def rolling_disk(
    *, mass: float, radius: float, rim_radius: float, axial_inertia: float, transverse_inertia: float, gravity: float,
    tilt: float, tilt_rate: float, precession: float, spin: float, end_time: float,
) -> Scenario:  # fmt: skip
    """Body `disk`, whose axle is its z axis and leans towards x at the start; joint `rolling` on the plane z = 0.

    The disk can neither slide nor leave the plane. Neimark and Fufaev, Dynamics of Nonholonomic Systems (1972).
    """
    s, c = math.sin(tilt), math.cos(tilt)
    axle, up = (s, 0.0, c), (-c, 0.0, s)  # `up` points from the point that touches to the centre
    # w = spin axle + precession s up + tilt_rate y
    along_up = precession * s
    w = tuple(spin * a + along_up * u + tilt_rate * y for a, u, y in zip(axle, up, (0.0, 1.0, 0.0), strict=True))
    lever = [(radius - rim_radius) * u + rim_radius * z for u, z in zip(up, (0.0, 0.0, 1.0), strict=True)]
    velocity = (
        w[1] * lever[2] - w[2] * lever[1], w[2] * lever[0] - w[0] * lever[2], w[0] * lever[1] - w[1] * lever[0],
    )  # fmt: skip
    disk = RigidBody3D(
        name="disk", mass=mass, inertia=(transverse_inertia, transverse_inertia, axial_inertia),
        position=(0.0, 0.0, lever[2]), velocity=velocity, attitude=Axes(z=axle),
        angular_velocity=(w[0], w[1], w[2]), angular_velocity_in="space",
    )  # fmt: skip
    rolling = RollingDisk3D(name="rolling", a=Marker3D(), b=Marker3D(body="disk"), radius=radius, rim_radius=rim_radius)
    return Scenario(
        name="rolling_disk",
        description="",
        model=Model(name="rolling_disk", gravity=(0.0, 0.0, -gravity), bodies=(disk,), joints=(rolling,)),
        t_end=end_time,
        rtol=1e-9,
        compare=("disk.x", "disk.y", "disk.z", *(f"disk.angular_velocity_{axis}" for axis in "xyz")),
    )
