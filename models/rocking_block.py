"""A block stands tilted on one of its lower corners and rocks from corner to corner."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import RigidBody2D
from ..core.model.channels import Parameter
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .frictions import contact_friction, friction_model_parameter, friction_parameters
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("width", 0.2, "m", "of the block", 0.0, exclusive=True),
    ScenarioParameter("height", 0.8, "m", "of the block", 0.0, exclusive=True),
    ScenarioParameter("mass", 50.0, "kg", "of the block, homogeneous", 0.0, exclusive=True),
    ScenarioParameter("tilt", 0.15, "rad", "at the start, about its right lower corner, at rest", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0, exclusive=True),
    *law_parameters(restitution=0.0, stiffness=1e9),
    *friction_parameters(coefficient=1.0, static_coefficient=None),
)  # fmt: skip


@scenario("rocking_block", "a block tilted on a lower corner rocks on a floor (Housner)", PARAMETERS)
def rocking_block(
    *,
    width: float,
    height: float,
    mass: float,
    tilt: float,
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
    """Body `block`, contacts `left` and `right` of its lower corners with the floor y = 0.

    With R the half diagonal and tan(alpha) = width/height the block turns as angle'' = -p^2 sin(alpha - |angle|)
    sgn(angle), p^2 = 3 g/(4 R), as long as it does not slip. With restitution 0 a blow of the other corner leaves
    angle'^+ = (1 - 1.5 sin^2 alpha) angle'^- (Housner, "The behavior of inverted pendulum structures during
    earthquakes", 1963).
    """
    alpha = math.atan2(width, height)
    if tilt >= alpha:
        raise ScenarioError(
            f"tilt = {tilt:g} rad must be below the angle of the diagonal, atan(width/height) = {alpha:g}: "
            "else the block falls over"
        )
    half = 0.5 * math.hypot(width, height)
    # a blow at one corner while the other turns freely: mass that it feels, at the corner of a rectangle
    inertia = mass * (width**2 + height**2) / 12.0
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=1.0 / (1.0 / mass + 0.25 * width**2 / inertia),
    )  # fmt: skip
    rubbing = contact_friction(
        contact, friction=friction, static_friction=static_friction, transition_speed=transition_speed
    )
    # turned by -tilt about the right lower corner, which stays at (width/2, 0)
    direction = 0.5 * math.pi + alpha - tilt
    position = (0.5 * width + half * math.cos(direction), half * math.sin(direction))

    def corner(name: str, side: float) -> DiskOnHalfPlane2D:
        marker = Marker2D(body="block", point=(0.5 * side * width, -0.5 * height))
        return DiskOnHalfPlane2D(
            name=name, plane=HalfPlane2D(), disk=Disk2D(marker=marker), law=contact, friction=rubbing
        )

    model = Model(
        name="rocking_block",
        gravity=(0.0, -gravity),
        bodies=(RigidBody2D(name="block", mass=mass, inertia=inertia, position=position, angle=-tilt),),
        contacts=(corner("left", -1.0), corner("right", 1.0)),
        parameters=(
            *(
                Parameter(
                    **{**p.model_dump(), "targets": (*p.targets, *(t.replace("left", "right") for t in p.targets))}
                )
                for p in law_model_parameters("left", contact)
            ),
            friction_model_parameter("left", "right"),
        ),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=2.0 * math.sqrt(half / 0.4123 * 9.81 / gravity),
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("block.angle", "block.angular_velocity", "left.normal_force", "right.normal_force"),
    )
