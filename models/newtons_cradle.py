"""Newton's cradle: balls on strings side by side; some are pulled aside and let go."""

import math

from ..core.contacts.contact2d import Disk2D, DiskOnDisk2D
from ..core.elements import Distance2D, PointMass2D
from ..core.laws import NewtonImpact
from ..core.model.channels import Parameter
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PROPAGATIONS = ("sequential", "simultaneous")
PARAMETERS = (
    ScenarioParameter("balls", 5, "-", "number of balls", 2, 50),
    ScenarioParameter("released", 1, "-", "balls that are pulled aside to the left", 1),
    ScenarioParameter("angle", 0.5, "rad", "of their strings, from the vertical", 0.0, 1.5, exclusive=True),
    ScenarioParameter("length", 0.2, "m", "of the strings, to the centres of the balls", 0.0, exclusive=True),
    ScenarioParameter("radius", 0.01, "m", "of the balls", 0.0, exclusive=True),
    ScenarioParameter("mass", 0.03, "kg", "of each ball", 0.0, exclusive=True),
    ScenarioParameter("gap", 0.0, "m", "between balls that hang at rest; 0: they touch", 0.0),
    ScenarioParameter(
        "propagation", "sequential", "-", "of a blow along balls that touch, with law newton", choices=PROPAGATIONS
    ),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0, exclusive=True),
    *law_parameters(restitution=1.0, stiffness=1e9),
)  # fmt: skip


@scenario("newtons_cradle", "balls on strings side by side; some are pulled aside and let go", PARAMETERS)
def newtons_cradle(
    *,
    balls: int,
    released: int,
    angle: float,
    length: float,
    radius: float,
    mass: float,
    gap: float,
    propagation: str,
    gravity: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Bodies `ball1` ... from left to right, joints `string1` ..., contacts `contact1` ... (ball k with ball k + 1).

    With law newton and `propagation` sequential, or with a gap, the balls strike one pair after the other and as many
    fly off as were released. Simultaneous, a blow on a row of balls that touch is one problem of all contacts: one
    ball of speed v against two at rest gives (-1/3, 2/3, 2/3) v. Both conserve momentum and energy (restitution 1). A
    force law passes the blow on as a wave.
    """
    if released >= balls:
        raise ScenarioError(f"released = {released} must be below balls = {balls}: else nothing is struck")
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=0.5 * mass,
    )  # fmt: skip
    if isinstance(contact, NewtonImpact):
        contact = contact.model_copy(update={"propagation": propagation})
    spacing = 2.0 * radius + gap
    bodies, strings = [], []
    for k in range(1, balls + 1):
        x = (k - 1) * spacing
        swing = angle if k <= released else 0.0
        position = (x - length * math.sin(swing), -length * math.cos(swing))
        bodies.append(PointMass2D(name=f"ball{k}", mass=mass, position=position))
        strings.append(
            Distance2D(name=f"string{k}", a=Marker2D(point=(x, 0.0)), b=Marker2D(body=f"ball{k}"), length=length)
        )

    def disk(k: int) -> Disk2D:
        return Disk2D(marker=Marker2D(body=f"ball{k}"), radius=radius)

    contacts = tuple(DiskOnDisk2D(name=f"contact{k}", a=disk(k), b=disk(k + 1), law=contact) for k in range(1, balls))
    parameters = tuple(
        Parameter(
            **{
                **parameter.model_dump(),
                "targets": tuple(f"{c.name}.{parameter.targets[0].partition('.')[2]}" for c in contacts),
            }
        )
        for parameter in law_model_parameters("contact1", contact)
    )
    model = Model(
        name="newtons_cradle",
        gravity=(0.0, -gravity),
        bodies=tuple(bodies),
        joints=tuple(strings),
        contacts=contacts,
        parameters=parameters,
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=2.0 * math.pi * math.sqrt(length / gravity),
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("ball1.x", f"ball{balls}.x", "contact1.normal_force", "contact1.gap"),
    )
