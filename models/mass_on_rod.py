"""A rigid mass strikes the free end of an elastic rod whose other end is fixed."""

from ..core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from ..core.elements import AxialRod, CoordinateDriver, LinearSystem
from ..core.elements.axial_rod import MassMatrix
from ..core.laws import NewtonImpact
from ..core.model.signals import Polynomial
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .rods import rod_options, rod_parameters
from .scenario import Scenario

PARAMETERS = (
    *rod_parameters(100, "lumped"),
    ScenarioParameter("mass_ratio", 1.0, "-", "striking mass over the mass of the rod", 0.0, exclusive=True),
    ScenarioParameter("gap", 5e-5, "m", "distance of mass and rod at the start", 0.0),
    ScenarioParameter("velocity", 0.1, "m/s", "of the mass", 0.0, exclusive=True),
)  # fmt: skip


@scenario("mass_on_rod", "a rigid mass strikes a rod that is fixed at its far end", PARAMETERS)
def mass_on_rod(
    *,
    elements: int,
    mass_matrix: MassMatrix,
    massless_contact: bool,
    length: float,
    youngs_modulus: float,
    density: float,
    area: float,
    damping_time: float,
    step: float | None,
    mass_ratio: float,
    gap: float,
    velocity: float,
) -> Scenario:
    """Body `mass`, coordinate `u` = its position, flies to the right against node `x0` of rod `rod` in contact
    `contact` (restitution 0); driver `clamp` holds the rod's right end.

    Theory (St. Venant; Goldsmith, Impact, 1960, 3.4): contact ends at c t / L = 3.0677 for mass_ratio 1, 4.7086 for 2,
    5.8996 for 4, 7.4076 for 6.
    """
    rod = AxialRod(
        name="rod", elements=elements, length=length, axial_stiffness=youngs_modulus * area,
        mass_per_length=density * area, mass_matrix=mass_matrix, damping_time=damping_time,
        massless_ends=("left",) if massless_contact else (),
    )  # fmt: skip
    mass = LinearSystem(
        name="mass", coordinates=("u",), mass=((mass_ratio * density * area * length,),), units=("m",),
        position=(-gap,), velocity=(velocity,), scales=(length,),
    )  # fmt: skip
    model = Model(
        name="mass_on_rod",
        gravity=(0.0, 0.0),
        bodies=(mass, rod),
        joints=(
            CoordinateDriver(
                name="clamp", body="rod", coordinate=f"x{elements}", motion=Polynomial(coefficients=(length, 0.0))
            ),
        ),
        contacts=(
            CoordinateContact(
                name="contact", law=NewtonImpact(restitution=0.0),
                terms=(
                    CoordinateTerm(body="rod", coordinate="x0"),
                    CoordinateTerm(body="mass", coordinate="u", factor=-1.0),
                ),
            ),
        ),
    )  # fmt: skip
    t_end = gap / velocity + (4.0 + 1.2 * mass_ratio**0.75) * length / rod.wave_speed
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=t_end,
        method="hht",
        options=rod_options(rod, t_end, step),
        compare=("contact.normal_force", "contact.gap", "mass.d_u", "clamp.reaction"),
    )
