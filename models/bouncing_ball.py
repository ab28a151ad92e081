"""A ball falls on a floor, bounces and comes to rest."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.elements import PointMass2D
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("height", 1.0, "m", "height of the ball's lowest point at the start", 0.0),
    ScenarioParameter("mass", 1.0, "kg", "mass of the ball", 0.0, exclusive=True),
    ScenarioParameter("radius", 0.0, "m", "radius of the ball", 0.0),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0, exclusive=True),
    *law_parameters(restitution=0.8),
)  # fmt: skip


@scenario("bouncing_ball", "a ball falls on a floor, bounces with restitution and comes to rest", PARAMETERS)
def bouncing_ball(
    *,
    height: float,
    mass: float,
    radius: float,
    gravity: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Body `ball`, contact `floor` at y = 0.

    With law newton the impacts accumulate: bounce n at sqrt(2h/g) (1 + 2 sum e^k), rest at
    sqrt(2h/g) (1+e)/(1-e), which is before the end for e <= 0.8.
    """
    contact = contact_law(
        law,
        restitution=restitution,
        stiffness=stiffness,
        exponent=exponent,
        damping=damping,
        relaxation_time=relaxation_time,
        mass=mass,
    )
    model = Model(
        name="bouncing_ball",
        gravity=(0.0, -gravity),
        bodies=(PointMass2D(name="ball", mass=mass, position=(0.0, height + radius)),),
        contacts=(
            DiskOnHalfPlane2D(
                name="floor",
                plane=HalfPlane2D(),
                disk=Disk2D(marker=Marker2D(body="ball"), radius=radius),
                law=contact,
            ),
        ),
        parameters=law_model_parameters("floor", contact),
    )
    # force laws: a few bounces; the decaying tail into rest is long and shows nothing new
    units = 5.0 if law == "newton" else 2.5
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=units * math.sqrt(max(height, 1e-3) * 9.81 / gravity),
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("ball.y", "ball.vy", "floor.normal_force", "floor.gap"),
    )
