"""An arm of two links, like a robot's, falls in space; its tip strikes a table and its elbow a stop."""

import math

from ..core.description import Model
from ..core.elements import Revolute3D, RigidBody3D, TorsionSpring3D
from ..core.model.attitude import Axes
from ..core.model.markers import Marker3D
from ..core.shapes.contact3d import HalfSpace3D, Sphere3D, SphereOnHalfSpace3D
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("upper_length", 0.5, "m", "length of the upper arm", 0.0, exclusive=True),
    ScenarioParameter("lower_length", 0.4, "m", "length of the lower arm", 0.0, exclusive=True),
    ScenarioParameter("upper_mass", 2.0, "kg", "mass of the upper arm", 0.0, exclusive=True),
    ScenarioParameter("lower_mass", 1.0, "kg", "mass of the lower arm", 0.0, exclusive=True),
    ScenarioParameter("shoulder_stiffness", 5.0, "N.m/rad", "of a spring at the shoulder", 0.0),
    ScenarioParameter("shoulder_damping", 0.2, "N.m.s/rad", "of a damper at the shoulder", 0.0),
    ScenarioParameter("turn_rate", 2.0, "rad/s", "of the column about the vertical at the start"),
    ScenarioParameter("column_inertia", 0.1, "kg.m2", "of the column about the vertical", 0.0, exclusive=True),
    ScenarioParameter("table", -0.45, "m", "height of the table under the shoulder", -10.0, -0.05),
    ScenarioParameter("tip_radius", 0.03, "m", "of the ball at the tip", 0.0),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0, exclusive=True),
    *law_parameters(restitution=0.4, stiffness=1e6),
)
COLUMN_MASS = 40.0
"""kg; with the height it only says what the column looks like, a solid cylinder with the inertia that is asked for."""
COLUMN_HEIGHT = 0.2
"""m"""


@scenario("arm_stop", "an arm on a turning column falls on a table", PARAMETERS)
def arm_stop(
    *, upper_length: float, lower_length: float, upper_mass: float, lower_mass: float, shoulder_stiffness: float,
    shoulder_damping: float, turn_rate: float, column_inertia: float, table: float, tip_radius: float, gravity: float,
    law: str, restitution: float, stiffness: float, exponent: float, damping: float | None,
    relaxation_time: float | None,
) -> Scenario:  # fmt: skip
    """Bodies `column`, `upper`, `lower`. Joints `base` about z, `shoulder` and `elbow` about the arm's y axis. Contacts
    `table` and `elbow_table` of a ball at the tip and one at the elbow with the table. It starts stretched out along x.

    The table has no friction, so about the vertical the angular momentum is kept.
    """
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=lower_mass / 3.0,
    )  # fmt: skip
    # all turn about the vertical at the start
    across = 0.5 * column_inertia + COLUMN_MASS * COLUMN_HEIGHT**2 / 12.0
    column = RigidBody3D(
        name="column", mass=COLUMN_MASS, inertia=(across, across, column_inertia),
        angular_velocity=(0.0, 0.0, turn_rate),
    )  # fmt: skip
    links, start = [], 0.0
    for name, mass, length in (("upper", upper_mass, upper_length), ("lower", lower_mass, lower_length)):
        centre = start + 0.5 * length
        across, along = mass * length**2 / 12.0, 0.01 * mass * length**2
        links.append(
            RigidBody3D(
                name=name, mass=mass, inertia=(along, across, across), position=(centre, 0.0, 0.0),
                velocity=(0.0, turn_rate * centre, 0.0), angular_velocity=(0.0, 0.0, turn_rate),
            )
        )  # fmt: skip
        start += length
    upper, lower = links
    pin = Axes(z=(0.0, 1.0, 0.0))
    socket, head = Marker3D(body="column", attitude=pin), upper.marker_at((0.0, 0.0, 0.0), pin)
    bend = (upper_length, 0.0, 0.0)
    plane = HalfSpace3D(marker=Marker3D(point=(0.0, 0.0, table)))
    balls = {
        "table": lower.marker_at((upper_length + lower_length, 0.0, 0.0)),
        "elbow_table": upper.marker_at(bend),
    }
    contacts = tuple(
        SphereOnHalfSpace3D(name=name, plane=plane, sphere=Sphere3D(marker=marker, radius=tip_radius), law=contact)
        for name, marker in balls.items()
    )
    model = Model(
        name="arm_stop",
        gravity=(0.0, 0.0, -gravity),
        bodies=(column, upper, lower),
        joints=(
            Revolute3D(name="base", a=Marker3D(), b=Marker3D(body="column")),
            Revolute3D(name="shoulder", a=socket, b=head),
            Revolute3D(name="elbow", a=upper.marker_at(bend, pin), b=lower.marker_at(bend, pin)),
        ),
        forces=(
            TorsionSpring3D(
                name="spring",
                a=socket,
                b=head,
                stiffness=shoulder_stiffness,
                damping=shoulder_damping,
                natural_angle=0.0,
            ),
        ),
        contacts=contacts,
        parameters=law_model_parameters("table", contact, "elbow_table"),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.0 * math.sqrt(9.81 / gravity),
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("lower.x", "lower.y", "lower.z", "shoulder.angle", "table.normal_force", "table.gap"),
    )
