"""A chain of slender rods, released horizontally at rest: the yardstick for speed and accuracy."""

from ..core.elements import Revolute2D, RigidBody2D
from ..core.model.base import Vector2
from ..core.model.markers import GROUND, Marker2D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("links", 10, "-", "number of links", 1, 20_000),
    ScenarioParameter("length", 1.0, "m", "length of each link", 0.0, exclusive=True),
    ScenarioParameter("mass", 1.0, "kg", "mass of each link", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0),
)


@scenario("chain", "a chain of rigid links, pinned at one end, released horizontally at rest", PARAMETERS)
def chain(*, links: int, length: float, mass: float, gravity: float) -> Scenario:
    """Bodies `link1` ..., joints `joint1` ...; link k hangs on joint k, joint 1 is at the origin."""
    half = 0.5 * length

    def end(k: int, side: float) -> Marker2D:
        """The start (-1) or end (+1) of link k; link 0 is the ground."""
        point: Vector2 = (side * half, 0.0) if k else (0.0, 0.0)
        return Marker2D(body=f"link{k}" if k else GROUND, point=point)

    model = Model(
        name="chain",
        gravity=(0.0, -gravity),
        bodies=tuple(
            RigidBody2D(
                name=f"link{k}",
                mass=mass,
                inertia=mass * length**2 / 12.0,
                position=((k - 0.5) * length, 0.0),
            )
            for k in range(1, links + 1)
        ),
        joints=tuple(Revolute2D(name=f"joint{k}", a=end(k - 1, 1.0), b=end(k, -1.0)) for k in range(1, links + 1)),
    )
    last = f"link{links}"
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=2.0,
        compare=(f"{last}.x", f"{last}.y", f"{last}.angle", f"{last}.angular_velocity"),
    )
