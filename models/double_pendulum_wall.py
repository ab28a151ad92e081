"""Two rods hang on a pin, one below the other; the disk at their tip strikes a wall again and again."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import Revolute2D, RigidBody2D
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("upper_length", 0.5, "m", "length of the upper rod", 0.0, exclusive=True),
    ScenarioParameter("lower_length", 0.5, "m", "length of the lower rod", 0.0, exclusive=True),
    ScenarioParameter("upper_mass", 1.0, "kg", "mass of the upper rod", 0.0, exclusive=True),
    ScenarioParameter("lower_mass", 1.0, "kg", "mass of the lower rod", 0.0, exclusive=True),
    ScenarioParameter("radius", 0.05, "m", "radius of the disk at the tip (it has no mass)", 0.0),
    ScenarioParameter("wall", -0.05, "m", "x of the wall; the rods hang on its right side, the pin is at x = 0"),
    ScenarioParameter("upper_angle", -0.5, "rad", "of the upper rod at the start, from the x axis, at rest"),
    ScenarioParameter("lower_angle", -1.0, "rad", "of the lower rod at the start, from the x axis, at rest"),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0, exclusive=True),
    *law_parameters(restitution=0.8),
)


@scenario("double_pendulum_wall", "two rods swing on a pin; the disk at their tip strikes a wall", PARAMETERS)
def double_pendulum_wall(
    *,
    upper_length: float,
    lower_length: float,
    upper_mass: float,
    lower_mass: float,
    radius: float,
    wall: float,
    upper_angle: float,
    lower_angle: float,
    gravity: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Bodies `upper` and `lower`, joints `pin` at the origin and `elbow`, contact `wall`.

    The gap is the tip's x - wall - radius. Each impact changes the rates of both rods and loads both joints.
    """
    x1, y1 = upper_length * math.cos(upper_angle), upper_length * math.sin(upper_angle)
    x2, y2 = lower_length * math.cos(lower_angle), lower_length * math.sin(lower_angle)
    gap = x1 + x2 - wall - radius
    if gap <= 0.0:
        raise ScenarioError(
            f"with these angles the tip starts at x = {x1 + x2:g} m, {-gap:g} m behind the touch with the wall at "
            f"{wall:g} m (radius {radius:g} m): start further right, or move the wall to the left"
        )
    # mass that the wall feels while both rods hang straight down, for the damping of a force law
    a, b, c = (
        (upper_mass / 3.0 + lower_mass) * upper_length**2,
        0.5 * lower_mass * upper_length * lower_length,
        lower_mass * lower_length**2 / 3.0,
    )
    mass = (a * c - b * b) / (c * upper_length**2 - 2.0 * b * upper_length * lower_length + a * lower_length**2)
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=mass,
    )  # fmt: skip
    model = Model(
        name="double_pendulum_wall",
        gravity=(0.0, -gravity),
        bodies=(
            RigidBody2D(
                name="upper", mass=upper_mass, inertia=upper_mass * upper_length**2 / 12.0,
                position=(0.5 * x1, 0.5 * y1), angle=upper_angle,
            ),
            RigidBody2D(
                name="lower", mass=lower_mass, inertia=lower_mass * lower_length**2 / 12.0,
                position=(x1 + 0.5 * x2, y1 + 0.5 * y2), angle=lower_angle,
            ),
        ),
        joints=(
            Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="upper", point=(-0.5 * upper_length, 0.0))),
            Revolute2D(
                name="elbow",
                a=Marker2D(body="upper", point=(0.5 * upper_length, 0.0)),
                b=Marker2D(body="lower", point=(-0.5 * lower_length, 0.0)),
            ),
        ),
        contacts=(
            DiskOnHalfPlane2D(
                name="wall",
                plane=HalfPlane2D(marker=Marker2D(point=(wall, 0.0), angle=-0.5 * math.pi)),
                disk=Disk2D(marker=Marker2D(body="lower", point=(0.5 * lower_length, 0.0)), radius=radius),
                law=contact,
            ),
        ),
        parameters=law_model_parameters("wall", contact),
    )  # fmt: skip
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=4.0 * math.sqrt((upper_length + lower_length) * 9.81 / gravity),
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("upper.angle", "lower.angle", "lower.angular_velocity", "wall.normal_force", "wall.gap"),
    )
