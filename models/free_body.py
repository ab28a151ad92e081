"""A free body that turns about nearly its middle axis of inertia, and so turns over again and again."""

from ..core.elements import RigidBody3D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("mass", 1.0, "kg", "mass", 0.0, exclusive=True),
    ScenarioParameter("inertia_x", 1.0, "kg.m2", "moment of inertia about x", 0.0, exclusive=True),
    ScenarioParameter("inertia_y", 2.0, "kg.m2", "moment of inertia about y", 0.0, exclusive=True),
    ScenarioParameter("inertia_z", 3.0, "kg.m2", "moment of inertia about z", 0.0, exclusive=True),
    ScenarioParameter("spin", 5.0, "rad/s", "angular velocity about y at the start"),
    ScenarioParameter("disturbance_x", 0.01, "rad/s", "angular velocity about x at the start"),
    ScenarioParameter("disturbance_z", 0.01, "rad/s", "angular velocity about z at the start"),
)


@scenario("free_body", "a free body that turns about nearly its middle axis of inertia", PARAMETERS)
def free_body(
    *, mass: float, inertia_x: float, inertia_y: float, inertia_z: float, spin: float, disturbance_x: float,
    disturbance_z: float,
) -> Scenario:  # fmt: skip
    """Body `body`, without weight, for two periods of its angular velocity in the body's axes.

    Closed form by Jacobi's elliptic functions: Landau and Lifshitz, Mechanics (1976), section 37.
    """
    body = RigidBody3D(
        name="body", mass=mass, inertia=(inertia_x, inertia_y, inertia_z),
        angular_velocity=(disturbance_x, spin, disturbance_z),
    )  # fmt: skip
    return Scenario(
        name="free_body",
        description="",
        model=Model(name="free_body", gravity=(0.0, 0.0, 0.0), bodies=(body,)),
        t_end=20.103716552,
        rtol=1e-12,  # the turn is unstable: errors grow 500 times while it turns over
        compare=("body.body_angular_velocity_x", "body.body_angular_velocity_y", "body.body_angular_velocity_z"),
    )
