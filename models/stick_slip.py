"""A block on a moving belt, held by a spring: it sticks, is carried along, slips back, and sticks again."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import CoordinateDriver, PointMass2D, Prismatic2D, RigidBody2D, SpringDamper2D
from ..core.model.markers import Marker2D
from ..core.model.signals import Polynomial
from ..core.multibody_model import Model
from .frictions import contact_friction, friction_model_parameter, friction_parameters
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("mass", 1.0, "kg", "mass of the block", 0.0, exclusive=True),
    ScenarioParameter("spring_stiffness", 100.0, "N/m", "of the spring to the wall", 0.0, exclusive=True),
    ScenarioParameter("spring_damping", 0.0, "N.s/m", "of the spring", 0.0),
    ScenarioParameter("belt_speed", 0.1, "m/s", "of the belt, away from the wall", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0, exclusive=True),
    *law_parameters(restitution=0.0),
    *friction_parameters(coefficient=0.3, static_coefficient=0.4),
)
LENGTH = 1.0
"""Of the relaxed spring, m: it does not matter."""


@scenario("stick_slip", "a block on a belt, held by a spring, sticks and slips in turn", PARAMETERS)
def stick_slip(
    *,
    mass: float,
    spring_stiffness: float,
    spring_damping: float,
    belt_speed: float,
    gravity: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
    friction: float,
    static_friction: float | None,
    transition_speed: float,
) -> Scenario:
    """Bodies `block`, `belt`; joint `guide`, driver `drive` of the belt, force `spring`, contact `rubbing`.

    The block starts at x = 0 with the belt's speed V, the spring relaxed. Without damping, with x_s and x_k the
    stretches at which the spring holds the static and the kinetic friction and w^2 = k/m: it sticks until x_s, slips
    for (2/w)(pi - atan((x_s - x_k) w/V)) to 2 x_k - x_s, and sticks for 2 (x_s - x_k)/V, again and again.
    """
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=mass,
    )  # fmt: skip
    rubbing = contact_friction(
        contact, friction=friction, static_friction=static_friction, transition_speed=transition_speed
    )
    thickness = 0.05
    model = Model(
        name="stick_slip",
        gravity=(0.0, -gravity),
        bodies=(
            PointMass2D(name="block", mass=mass, velocity=(belt_speed, 0.0)),
            RigidBody2D(
                name="belt", mass=100.0 * mass, inertia=mass, position=(0.0, -thickness), velocity=(belt_speed, 0.0)
            ),
        ),
        joints=(
            Prismatic2D(name="guide", a=Marker2D(point=(0.0, -thickness)), b=Marker2D(body="belt")),
            CoordinateDriver(
                name="drive", body="belt", coordinate="x", motion=Polynomial(coefficients=(0.0, belt_speed))
            ),
        ),
        forces=(
            SpringDamper2D(
                name="spring", a=Marker2D(point=(-LENGTH, 0.0)), b=Marker2D(body="block"), stiffness=spring_stiffness,
                damping=spring_damping, natural_length=LENGTH,
            ),
        ),
        contacts=(
            DiskOnHalfPlane2D(
                name="rubbing",
                plane=HalfPlane2D(marker=Marker2D(body="belt", point=(0.0, thickness))),
                disk=Disk2D(marker=Marker2D(body="block")),
                law=contact,
                friction=rubbing,
            ),
        ),
        parameters=(*law_model_parameters("rubbing", contact), friction_model_parameter("rubbing")),
    )  # fmt: skip
    # until it first slips, and three cycles
    static = friction if static_friction is None else static_friction
    first = static * mass * gravity / spring_stiffness / belt_speed
    swing = 2.0 * math.pi * math.sqrt(mass / spring_stiffness)
    more = 2.0 * (static - friction) * mass * gravity / spring_stiffness / belt_speed
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=first + 3.0 * (swing + more),
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("block.x", "block.vx", "rubbing.normal_force", "rubbing.gap"),
    )
