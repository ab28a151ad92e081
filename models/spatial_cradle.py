"""A cradle in space: balls on strings in a row; the first is pulled aside, across the row too."""

import math

from ..core.contacts.contact3d import Sphere3D, SphereOnSphere3D
from ..core.elements import Distance3D, PointMass3D
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .frictions import contact_friction, friction_parameters
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("balls", 3, "-", "number of balls", 2, 50),
    ScenarioParameter("angle", 0.5, "rad", "of the first one's string, from the vertical", 0.0, 1.5, exclusive=True),
    ScenarioParameter("aside", 0.1, "rad", "by which it is pulled across the row", -1.0, 1.0),
    ScenarioParameter("angle_rate", 0.0, "rad/s", "rate of that angle of the first one's string at the start"),
    ScenarioParameter("aside_rate", 0.0, "rad/s", "rate at which it turns about the vertical at the start"),
    ScenarioParameter("length", 0.2, "m", "of the strings, to the centres of the balls", 0.0, exclusive=True),
    ScenarioParameter("radius", 0.02, "m", "of the balls", 0.0, exclusive=True),
    ScenarioParameter("mass", 0.03, "kg", "of each ball", 0.0, exclusive=True),
    ScenarioParameter("gap", 2e-3, "m", "between balls that hang at rest", 0.0),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0, exclusive=True),
    *law_parameters(restitution=1.0, stiffness=1e9),
    *friction_parameters(0.0, None, 1e-3),
)  # fmt: skip


@scenario("spatial_cradle", "balls on strings in space; the first one strikes the row beside its middle", PARAMETERS)
def spatial_cradle(
    *, balls: int, angle: float, aside: float, angle_rate: float, aside_rate: float, length: float, radius: float,
    mass: float, gap: float, gravity: float, law: str, restitution: float, stiffness: float, exponent: float,
    damping: float | None, relaxation_time: float | None, friction: float, static_friction: float | None,
    transition_speed: float,
) -> Scenario:  # fmt: skip
    """Bodies `ball1` ... along x, joints `string1` ..., contacts `contact1` ... (ball k with ball k + 1).

    Without `aside` it is a cradle in the plane. Energy, and the momentum about the vertical through each string's
    end between blows, are kept with restitution 1 and without friction. The balls do not turn, so friction slides at
    once with the whole velocity across the line of centres.
    """
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=0.5 * mass,
    )  # fmt: skip
    bodies, strings = [], []
    for k in range(1, balls + 1):
        x = (k - 1) * (2.0 * radius + gap)
        # from the hanging position: by `angle` away from the row, turned by `aside` about the vertical
        swing, turn = (angle, aside) if k == 1 else (0.0, 0.0)
        out = length * math.sin(swing)
        c, s = math.cos(turn), math.sin(turn)
        position = (x - out * c, out * s, -length * math.cos(swing))
        up, round_ = (length * angle_rate, out * aside_rate) if k == 1 else (0.0, 0.0)
        level = up * math.cos(swing)
        velocity = (round_ * s - level * c, round_ * c + level * s, up * math.sin(swing))
        bodies.append(PointMass3D(name=f"ball{k}", mass=mass, position=position, velocity=velocity))
        strings.append(
            Distance3D(
                name=f"string{k}", a=Marker3D(point=(x, 0.0, 0.0)), b=Marker3D(body=f"ball{k}"), length=length
            )
        )  # fmt: skip

    def sphere(k: int) -> Sphere3D:
        return Sphere3D(marker=Marker3D(body=f"ball{k}"), radius=radius)

    rubs = contact_friction(
        contact, friction=friction, static_friction=static_friction, transition_speed=transition_speed
    )
    contacts = tuple(
        SphereOnSphere3D(
            name=f"contact{k}", a=sphere(k), b=sphere(k + 1), law=contact, friction=rubs if friction > 0.0 else None
        )
        for k in range(1, balls)
    )
    model = Model(
        name="spatial_cradle",
        gravity=(0.0, 0.0, -gravity),
        bodies=tuple(bodies),
        joints=tuple(strings),
        contacts=contacts,
        parameters=law_model_parameters("contact1", contact, *(c.name for c in contacts[1:])),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=2.0 * math.pi * math.sqrt(length / gravity),
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("ball1.x", "ball1.y", f"ball{balls}.x", "contact1.normal_force", "contact1.gap"),
    )
