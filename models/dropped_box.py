"""A box is dropped on a floor, corner first, and comes to rest on a face."""

from ..core.contacts.contact3d import HalfSpace3D
from ..core.contacts.cornered3d import Box3D
from ..core.contacts.group2d import contacts_between
from ..core.elements import RigidBody3D
from ..core.model.attitude import RotationVector
from ..core.model.channels import Parameter
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .frictions import contact_friction, friction_parameters
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

REST_RATIO = 1e-3
"""Eight corners strike in turns without end: below this part of their largest approach they stay."""
PARAMETERS = (
    ScenarioParameter("mass", 2.0, "kg", "mass of the box", 0.0, exclusive=True),
    ScenarioParameter("length", 0.4, "m", "along its x axis", 0.0, exclusive=True),
    ScenarioParameter("width", 0.3, "m", "along its y axis", 0.0, exclusive=True),
    ScenarioParameter("thickness", 0.2, "m", "along its z axis", 0.0, exclusive=True),
    *(
        ScenarioParameter(
            f"inertia_{axis}", None, "kg.m2", f"moment of inertia about its {axis} axis; none: that of a full box", 0.0,
            exclusive=True, optional=True,
        )
        for axis in "xyz"
    ),
    ScenarioParameter("height", 0.5, "m", "height of its centre at the start", 0.0, exclusive=True),
    ScenarioParameter("tilt_x", 0.4, "rad", "rotation vector of its attitude at the start, along x"),
    ScenarioParameter("tilt_y", 0.2, "rad", "the same along y"),
    ScenarioParameter("tilt_z", 0.0, "rad", "the same along z"),
    *(ScenarioParameter(f"velocity_{axis}", 0.0, "m/s", f"velocity at the start, along {axis}") for axis in "xyz"),
    *(
        ScenarioParameter(f"spin_{axis}", 0.0, "rad/s", f"angular velocity at the start, about the box's {axis} axis")
        for axis in "xyz"
    ),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0, exclusive=True),
    *law_parameters(restitution=0.2, stiffness=1e6),
    *friction_parameters(0.0, None, 1e-3),
)  # fmt: skip


@scenario("dropped_box", "a box falls on a floor, corner first, and comes to rest on a face", PARAMETERS)
def dropped_box(
    *, mass: float, length: float, width: float, thickness: float, inertia_x: float | None, inertia_y: float | None,
    inertia_z: float | None, height: float, tilt_x: float, tilt_y: float, tilt_z: float, velocity_x: float,
    velocity_y: float, velocity_z: float, spin_x: float, spin_y: float, spin_z: float, gravity: float, law: str,
    restitution: float, stiffness: float, exponent: float, damping: float | None, relaxation_time: float | None,
    friction: float, static_friction: float | None, transition_speed: float,
) -> Scenario:  # fmt: skip
    """Body `box`, contacts `floor_ground_box_1` to `_8` of its corners with the floor at z = 0.

    Whatever the tilt and the friction, it comes to lie on a face.
    """
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=0.25 * mass,
    )  # fmt: skip
    if law == "newton":
        contact = contact.model_copy(update={"rest_ratio": REST_RATIO})
    x, y, z = length**2, width**2, thickness**2
    body = RigidBody3D(
        name="box", mass=mass,
        inertia=(
            mass * (y + z) / 12.0 if inertia_x is None else inertia_x,
            mass * (x + z) / 12.0 if inertia_y is None else inertia_y,
            mass * (x + y) / 12.0 if inertia_z is None else inertia_z,
        ),
        position=(0.0, 0.0, height), attitude=RotationVector(vector=(tilt_x, tilt_y, tilt_z)),
        velocity=(velocity_x, velocity_y, velocity_z), angular_velocity=(spin_x, spin_y, spin_z),
    )  # fmt: skip
    rubs = contact_friction(
        contact, friction=friction, static_friction=static_friction, transition_speed=transition_speed
    )
    box = Box3D(marker=Marker3D(body="box"), size=(length, width, thickness))
    contacts = contacts_between("floor", [HalfSpace3D()], [box], law=contact, friction=rubs if friction > 0.0 else None)
    names = [record.name for record in contacts]
    parameters = tuple(
        Parameter(
            **{
                **parameter.model_dump(),
                "targets": tuple(f"{name}.{parameter.targets[0].partition('.')[2]}" for name in names),
            }
        )
        for parameter in law_model_parameters(names[0], contact)
    )
    model = Model(
        name="dropped_box", gravity=(0.0, 0.0, -gravity), bodies=(body,), contacts=contacts, parameters=parameters
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.5,
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("box.x", "box.y", "box.z", f"{names[0]}.normal_force"),
    )
