"""A sphere is thrown with spin on a floor: it bounces, slides and rolls."""

from ..core.contacts.contact3d import HalfSpace3D, Sphere3D, SphereOnHalfSpace3D
from ..core.elements import RigidBody3D
from ..core.model.markers import Marker3D
from ..core.multibody_model import Model
from .frictions import contact_friction, friction_model_parameter, friction_parameters
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("mass", 1.0, "kg", "mass of the sphere", 0.0, exclusive=True),
    ScenarioParameter("radius", 0.1, "m", "radius of the sphere", 0.0, exclusive=True),
    ScenarioParameter(
        "inertia", None, "kg.m2", "moment of inertia; none: that of a full sphere, 2/5 m r^2", 0.0, exclusive=True,
        optional=True,
    ),
    ScenarioParameter("height", 0.3, "m", "height of its lowest point at the start", 0.0),
    ScenarioParameter("velocity_x", 2.0, "m/s", "velocity at the start, along x"),
    ScenarioParameter("velocity_y", -0.5, "m/s", "velocity at the start, along y"),
    ScenarioParameter("velocity_z", 0.0, "m/s", "velocity at the start, upwards"),
    ScenarioParameter("spin_x", 30.0, "rad/s", "angular velocity at the start, about x"),
    ScenarioParameter("spin_y", -60.0, "rad/s", "angular velocity at the start, about y"),
    ScenarioParameter("spin_z", 20.0, "rad/s", "angular velocity at the start, about z"),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, against z", 0.0, exclusive=True),
    *law_parameters(restitution=0.5, stiffness=1e6),
    *friction_parameters(0.3, None, 1e-3),
)  # fmt: skip


@scenario("spinning_sphere", "a sphere with spin falls on a floor, bounces, slides and rolls", PARAMETERS)
def spinning_sphere(
    *, mass: float, radius: float, inertia: float | None, height: float, velocity_x: float, velocity_y: float,
    velocity_z: float, spin_x: float, spin_y: float, spin_z: float, gravity: float, law: str, restitution: float,
    stiffness: float, exponent: float, damping: float | None, relaxation_time: float | None, friction: float,
    static_friction: float | None, transition_speed: float,
) -> Scenario:  # fmt: skip
    """Body `ball`, contact `floor` at z = 0.

    With slip s = v - R w x n each blow has P_N = m (1 + e) |v_n| and P_T = min(mu P_N, 2/7 m |s|) against s, whose
    direction never changes; at the end it rolls with (5 v + 2 R w x n)/7. With another inertia J, k = m R^2/J, 2/7 is
    1/(1 + k), and it rolls with (k v + R w x n)/(1 + k).
    """
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=mass,
    )  # fmt: skip
    moment = 0.4 * mass * radius**2 if inertia is None else inertia
    ball = RigidBody3D(
        name="ball", mass=mass, inertia=(moment, moment, moment), position=(0.0, 0.0, height + radius),
        velocity=(velocity_x, velocity_y, velocity_z), angular_velocity=(spin_x, spin_y, spin_z),
    )  # fmt: skip
    floor = SphereOnHalfSpace3D(
        name="floor", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=radius), law=contact,
        friction=contact_friction(
            contact, friction=friction, static_friction=static_friction, transition_speed=transition_speed
        ),
    )  # fmt: skip
    model = Model(
        name="spinning_sphere",
        gravity=(0.0, 0.0, -gravity),
        bodies=(ball,),
        contacts=(floor,),
        parameters=(*law_model_parameters("floor", contact), friction_model_parameter("floor")),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=3.0,
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("ball.x", "ball.y", "ball.z", "floor.normal_force", "floor.gap"),
    )
