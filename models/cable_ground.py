"""A rubber rope on a pin swings down and falls on the ground, with a contact at each of its nodes."""

from ..core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from ..core.elements import Revolute2D
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .cables import ends, round_cable, section_parameters
from .laws import contact_law, law_parameters
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    *section_parameters(elements=8, length=1.0, diameter=0.02, youngs_modulus=1e7, density=1100.0, damping_time=1e-3),
    ScenarioParameter("height", 0.4, "m", "height of the pin above the ground", 0.0, exclusive=True),
    *law_parameters(restitution=0.0, stiffness=1e4),
)


@scenario("cable_ground", "a rubber rope on a pin falls on the ground, contacts at all nodes", PARAMETERS)
def cable_ground(
    *,
    elements: int,
    length: float,
    diameter: float,
    youngs_modulus: float,
    density: float,
    damping_time: float,
    gravity: float,
    height: float,
    law: str,
    restitution: float,
    stiffness: float,
    exponent: float,
    damping: float | None,
    relaxation_time: float | None,
) -> Scenario:
    """Body `cable`, its points `root` and `tip`, joint `pin` at (0, height), contacts `ground1` ... at the nodes, with
    the ground at y = 0. With restitution 0, what comes back comes from the waves in the rope."""
    cable = round_cable(
        elements=elements,
        length=length,
        diameter=diameter,
        youngs_modulus=youngs_modulus,
        density=density,
        damping_time=damping_time,
        position=(0.0, height),
    )
    contact = contact_law(
        law,
        restitution=restitution,
        stiffness=stiffness,
        exponent=exponent,
        damping=damping,
        relaxation_time=relaxation_time,
        mass=cable.mass_per_length * length / elements,
    )
    model = Model(
        name="cable_ground",
        gravity=(0.0, -gravity),
        bodies=(cable, *ends(length)),
        joints=(Revolute2D(name="pin", a=Marker2D(point=(0.0, height)), b=Marker2D(body="root")),),
        contacts=tuple(
            CoordinateContact(name=f"ground{k}", law=contact, terms=(CoordinateTerm(body="cable", coordinate=f"y{k}"),))
            for k in range(1, elements + 1)
        ),
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=0.6,
        rtol=1e-4,
        atol=1e-7,
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("tip.x", "tip.y", f"ground{elements}.normal_force"),
    )
