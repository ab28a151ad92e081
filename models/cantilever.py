"""A slender elastic beam, clamped at one end, let go horizontally: it sags far under its weight and a tip force."""

from ..core.elements import AppliedForce2D, Clamp2D
from ..core.model.markers import Marker2D
from ..core.model.signals import Constant
from ..core.multibody_model import Model
from .cables import ends, round_cable, section_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    *section_parameters(elements=8, length=1.0, diameter=0.01, youngs_modulus=5e8, density=1200.0),
    ScenarioParameter("tip_force", 0.0, "N", "force on the tip, upwards, from the start on"),
)


@scenario("cantilever", "an elastic beam, clamped at one end, sags and swings under its weight", PARAMETERS)
def cantilever(
    *,
    elements: int,
    length: float,
    diameter: float,
    youngs_modulus: float,
    density: float,
    damping_time: float,
    gravity: float,
    tip_force: float,
) -> Scenario:
    """Body `cable`, its points `root` and `tip`, joint `clamp` at the origin, force `load`.

    Small deflections at rest: m g L^4/(8 EI) down and F L^3/(3 EI) up.
    """
    cable = round_cable(
        elements=elements,
        length=length,
        diameter=diameter,
        youngs_modulus=youngs_modulus,
        density=density,
        damping_time=damping_time,
    )
    model = Model(
        name="cantilever",
        gravity=(0.0, -gravity),
        bodies=(cable, *ends(length)),
        joints=(Clamp2D(name="clamp", a=Marker2D(), b=Marker2D(body="root")),),
        forces=(AppliedForce2D(name="load", marker=Marker2D(body="tip"), force_y=Constant(value=tip_force)),),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.0,
        method="hht",
        options={"step": 1e-3},
        compare=("tip.x", "tip.y", "tip.angle", "clamp.torque"),
    )
