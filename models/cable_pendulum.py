"""A rubber rope on a pin, let go horizontally at rest."""

from ..core.elements import Revolute2D
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .cables import ends, round_cable, section_parameters
from .registry import scenario
from .scenario import Scenario

PARAMETERS = section_parameters(elements=8, length=1.0, diameter=0.02, youngs_modulus=1e7, density=1100.0)


@scenario("cable_pendulum", "a rubber rope on a pin, released horizontally at rest", PARAMETERS)
def cable_pendulum(
    *,
    elements: int,
    length: float,
    diameter: float,
    youngs_modulus: float,
    density: float,
    damping_time: float,
    gravity: float,
) -> Scenario:
    """Body `cable`, its points `root` and `tip`, joint `pin` at the origin."""
    cable = round_cable(
        elements=elements,
        length=length,
        diameter=diameter,
        youngs_modulus=youngs_modulus,
        density=density,
        damping_time=damping_time,
    )
    model = Model(
        name="cable_pendulum",
        gravity=(0.0, -gravity),
        bodies=(cable, *ends(length)),
        joints=(Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="root")),),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.0,
        method="hht",
        options={"step": 1e-3},
        compare=("tip.x", "tip.y", "pin.force_x", "pin.force_y"),
    )
