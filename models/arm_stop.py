"""An arm of two links, like a robot's, falls in space: its elbow has an end stop, and it strikes a table."""

import math

import numpy as np

from ..core.contacts.contact3d import HalfSpace3D, Sphere3D, SphereOnHalfSpace3D
from ..core.contacts.stop3d import AngleStop3D
from ..core.elements import Revolute3D, RigidBody3D, TorsionSpring3D
from ..core.model.attitude import Axes, RotationVector
from ..core.model.base import Vector3
from ..core.model.channels import Parameter
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .frictions import contact_friction, friction_parameters
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario


def _of_link(name: str, length: float, mass: float) -> tuple[ScenarioParameter, ...]:
    text = f"of the {name} arm"
    return (
        ScenarioParameter(f"{name}_length", length, "m", f"length {text}", 0.0, exclusive=True),
        ScenarioParameter(f"{name}_mass", mass, "kg", f"mass {text}", 0.0, exclusive=True),
        ScenarioParameter(
            f"{name}_inertia", None, "kg.m2", f"inertia {text} across it, about its middle; none: m l^2/12", 0.0,
            exclusive=True, optional=True,
        ),
        ScenarioParameter(
            f"{name}_axial_inertia", None, "kg.m2", f"inertia {text} along it; none: m l^2/100", 0.0, exclusive=True,
            optional=True,
        ),
    )  # fmt: skip


PARAMETERS = (
    *_of_link("upper", 0.5, 2.0),
    *_of_link("lower", 0.4, 1.0),
    ScenarioParameter("shoulder_stiffness", 5.0, "N.m/rad", "of a spring at the shoulder", 0.0),
    ScenarioParameter("shoulder_damping", 0.2, "N.m.s/rad", "of a damper at the shoulder", 0.0),
    ScenarioParameter("shoulder_angle", 0.0, "rad", "at the start; 0 is level, downwards positive"),
    ScenarioParameter("elbow_angle", 0.0, "rad", "at the start; 0 is stretched, downwards positive"),
    ScenarioParameter("shoulder_rate", 0.0, "rad/s", "rate of that angle at the start"),
    ScenarioParameter("elbow_rate", 0.0, "rad/s", "rate of that angle at the start"),
    ScenarioParameter("turn_rate", 2.0, "rad/s", "of the column about the vertical at the start"),
    ScenarioParameter("column_inertia", 0.1, "kg.m2", "of the column about the vertical", 0.0, exclusive=True),
    ScenarioParameter("column_mass", 40.0, "kg", "of the column, which turns only", 0.0, exclusive=True),
    ScenarioParameter("table", -0.45, "m", "height of the table under the shoulder", -10.0, -0.05),
    ScenarioParameter("tip_radius", 0.03, "m", "of the ball at the tip", 0.0),
    ScenarioParameter(
        "elbow_limit", -0.4, "rad", "lowest angle of the elbow, where its end stop is; none: no stop", optional=True
    ),
    ScenarioParameter("stop_restitution", 0.3, "-", "coefficient of restitution of the end stop", 0.0, 1.0),
    ScenarioParameter(
        "stop_stiffness", 1e4, "N.m/rad^n", "stiffness of the end stop with force laws", 0.0, exclusive=True
    ),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0, exclusive=True),
    *law_parameters(restitution=0.4, stiffness=1e6),
    *friction_parameters(0.0, None, 1e-3),
)  # fmt: skip
COLUMN_HEIGHT = 0.2
"""m; with the mass it only says what the column looks like, a solid cylinder with the inertia that is asked for."""


@scenario("arm_stop", "an arm on a turning column falls: an end stop of its elbow, and a table", PARAMETERS)
def arm_stop(
    *, upper_length: float, upper_mass: float, upper_inertia: float | None, upper_axial_inertia: float | None,
    lower_length: float, lower_mass: float, lower_inertia: float | None, lower_axial_inertia: float | None,
    shoulder_stiffness: float, shoulder_damping: float, shoulder_angle: float, elbow_angle: float,
    shoulder_rate: float, elbow_rate: float, turn_rate: float, column_inertia: float, column_mass: float, table: float,
    tip_radius: float, elbow_limit: float | None, stop_restitution: float, stop_stiffness: float, gravity: float,
    law: str, restitution: float, stiffness: float, exponent: float, damping: float | None,
    relaxation_time: float | None, friction: float, static_friction: float | None, transition_speed: float,
) -> Scenario:  # fmt: skip
    """Bodies `column`, `upper`, `lower`. Joints `base` about z, `shoulder` and `elbow` about the arm's y axis. Contacts
    `elbow_stop`, the end stop of the elbow's angle, and `table` and `elbow_table` of a ball at the tip and one at the
    elbow with the table. With the defaults it starts stretched out along x.

    Without friction on the table the angular momentum about the vertical is kept. `damping` is that of the table; the
    stop's follows from its restitution.

    Raises
    ------
    ScenarioError : if the elbow starts beyond its stop, or a ball in the table.
    """
    if elbow_limit is not None and not elbow_limit < elbow_angle:
        raise ScenarioError(
            f"elbow_angle = {elbow_angle:g} rad starts at or beyond the end stop at elbow_limit = {elbow_limit:g}: "
            "give a larger angle or a lower limit"
        )
    touch = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=lower_mass / 3.0,
    )  # fmt: skip
    rubs = contact_friction(
        touch, friction=friction, static_friction=static_friction, transition_speed=transition_speed
    )
    across = 0.5 * column_inertia + column_mass * COLUMN_HEIGHT**2 / 12.0
    column = RigidBody3D(
        name="column", mass=column_mass, inertia=(across, across, column_inertia),
        angular_velocity=(0.0, 0.0, turn_rate),
    )  # fmt: skip
    end, pace = np.zeros(3), np.zeros(3)
    links: list[RigidBody3D] = []
    for name, mass, length, own, along, angle, rate in (
        ("upper", upper_mass, upper_length, upper_inertia, upper_axial_inertia, shoulder_angle, shoulder_rate),
        ("lower", lower_mass, lower_length, lower_inertia, lower_axial_inertia, shoulder_angle + elbow_angle,
         shoulder_rate + elbow_rate),
    ):  # fmt: skip
        own = mass * length**2 / 12.0 if own is None else own
        along = 0.01 * mass * length**2 if along is None else along
        arm = length * np.array([math.cos(angle), 0.0, -math.sin(angle)])
        spin = np.array([0.0, rate, turn_rate])
        links.append(
            RigidBody3D(
                name=name, mass=mass, inertia=(along, own, own), position=_vector(end + 0.5 * arm),
                attitude=RotationVector(vector=(0.0, angle, 0.0)), velocity=_vector(pace + 0.5 * np.cross(spin, arm)),
                angular_velocity=_vector(spin), angular_velocity_in="space",
            )
        )  # fmt: skip
        end, pace = end + arm, pace + np.cross(spin, arm)
        if end[2] - tip_radius < table:
            raise ScenarioError(
                f"the end of the {name} arm starts at {end[2]:g} m, with its ball of {tip_radius:g} m in the table at "
                f"{table:g} m: lower the table, or the angles"
            )
    pin = Axes(z=(0.0, 1.0, 0.0))
    near, far = -0.5 * upper_length, 0.5 * upper_length
    socket, head = Marker3D(body="column", attitude=pin), Marker3D(body="upper", point=(near, 0, 0), attitude=pin)
    bend = {
        "a": Marker3D(body="upper", point=(far, 0.0, 0.0), attitude=pin),
        "b": Marker3D(body="lower", point=(-0.5 * lower_length, 0.0, 0.0), attitude=pin),
    }
    plane = HalfSpace3D(marker=Marker3D(point=(0.0, 0.0, table)))
    balls = {
        "table": Marker3D(body="lower", point=(0.5 * lower_length, 0.0, 0.0)),
        "elbow_table": Marker3D(body="upper", point=(far, 0.0, 0.0)),
    }
    tables = tuple(
        SphereOnHalfSpace3D(
            name=name, plane=plane, sphere=Sphere3D(marker=marker, radius=tip_radius), law=touch,
            friction=rubs if friction > 0.0 else None,
        )
        for name, marker in balls.items()
    )  # fmt: skip
    stops: tuple[AngleStop3D, ...] = ()
    if elbow_limit is not None:
        end_stop = contact_law(
            law, restitution=stop_restitution, stiffness=stop_stiffness, exponent=exponent, damping=None,
            relaxation_time=relaxation_time, mass=lower_mass * lower_length**2 / 3.0,
        )  # fmt: skip
        stops = (AngleStop3D(name="elbow_stop", **bend, limit=elbow_limit, side="lower", law=end_stop),)
    model = Model(
        name="arm_stop",
        gravity=(0.0, 0.0, -gravity),
        bodies=(column, *links),
        joints=(
            Revolute3D(name="base", a=Marker3D(), b=Marker3D(body="column")),
            Revolute3D(name="shoulder", a=socket, b=head),
            Revolute3D(name="elbow", **bend),
        ),
        forces=(
            TorsionSpring3D(
                name="spring", a=socket, b=head, stiffness=shoulder_stiffness, damping=shoulder_damping,
                natural_angle=0.0,
            ),
        ),
        contacts=(*tables, *stops),
        parameters=(*law_model_parameters("table", touch, "elbow_table"), *_of_stop(stops)),
    )  # fmt: skip
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.0 * math.sqrt(9.81 / gravity),
        parameters={"damping": getattr(touch, "damping", None)},
        compare=(
            "lower.x", "lower.y", "lower.z", "shoulder.angle", "elbow.angle", "table.normal_force", "table.gap",
            *(f"{stop.name}.{what}" for stop in stops for what in ("normal_force", "gap")),
        ),
    )  # fmt: skip


def _of_stop(stops: tuple[AngleStop3D, ...]) -> tuple[Parameter, ...]:
    """Model parameters of the end stop."""
    found = []
    for stop in stops:
        found.append(
            Parameter(
                name="elbow_limit", unit="rad", description="lowest angle of the elbow", targets=(f"{stop.name}.limit",)
            )
        )
        if getattr(stop.law, "restitution", None) is not None:
            found.append(
                Parameter(
                    name="stop_restitution", unit="1", minimum=0.0, maximum=1.0,
                    description="coefficient of restitution of the end stop",
                    targets=(f"{stop.name}.law.restitution",),
                )
            )  # fmt: skip
    return tuple(found)


def _vector(x: "np.ndarray") -> Vector3:
    return float(x[0]), float(x[1]), float(x[2])
