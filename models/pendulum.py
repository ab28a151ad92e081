"""A point mass on a massless rod, released at rest: problem A01 of the IFToMM library of multibody benchmarks."""

import math

from ..core.elements import Distance2D, PointMass2D
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("mass", 1.0, "kg", "mass of the bob", 0.0, exclusive=True),
    ScenarioParameter("length", 1.0, "m", "length of the rod", 0.0, exclusive=True),
    ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0),
    ScenarioParameter("angle", math.pi, "rad", "angle of the rod at the start, from the x axis"),
)


@scenario("pendulum", "a point mass on a massless rod, released at rest (IFToMM benchmark A01)", PARAMETERS)
def pendulum(*, mass: float, length: float, gravity: float, angle: float) -> Scenario:
    """Body `bob`, joint `rod` from the origin.

    With the defaults the start is (-1, 0) m and the run 10 s, as in problem A01 "Simple pendulum" of Gonzalez,
    Dopico, Lugris and Cuadrado, "A benchmarking system for MBS simulation software" (2006). In the angle:
    angle'' = -(gravity / length) cos(angle).
    """
    model = Model(
        name="pendulum",
        gravity=(0.0, -gravity),
        bodies=(PointMass2D(name="bob", mass=mass, position=(length * math.cos(angle), length * math.sin(angle))),),
        joints=(Distance2D(name="rod", a=Marker2D(), b=Marker2D(body="bob"), length=length),),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=10.0,
        compare=("bob.x", "bob.y", "bob.vx", "bob.vy", "rod.tension"),
    )
