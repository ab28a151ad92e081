"""An elastic rod flies against a rigid wall: waves make it rebound."""

from ..core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from ..core.elements import AxialRod
from ..core.elements.axial_rod import MassMatrix
from ..core.laws import NewtonImpact
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .rods import rod_options, rod_parameters
from .scenario import Scenario

PARAMETERS = (
    *rod_parameters(),
    ScenarioParameter("gap", 5e-5, "m", "distance to the wall at the start", 0.0),
    ScenarioParameter("velocity", 0.1, "m/s", "of the rod, towards the wall", 0.0, exclusive=True),
)  # fmt: skip


@scenario("rod_wall", "an elastic rod strikes a rigid wall: the waves in it make it rebound", PARAMETERS)
def rod_wall(
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
    gap: float,
    velocity: float,
) -> Scenario:
    """Rod `rod` flies to the right; its last node meets the wall at x = length + gap in contact `wall` (restitution 0:
    what rebounds are the waves).

    Theory (St. Venant): contact lasts 2 L/c with the constant force EA v/c; then the rod leaves with its full speed.
    The data are those of the impacting bar of the siconos project's examples.
    """
    rod = AxialRod(
        name="rod", elements=elements, length=length, axial_stiffness=youngs_modulus * area,
        mass_per_length=density * area, mass_matrix=mass_matrix, damping_time=damping_time, velocity=velocity,
        massless_ends=("right",) if massless_contact else (),
    )  # fmt: skip
    end = f"x{elements}"
    model = Model(
        name="rod_wall",
        gravity=(0.0, 0.0),
        bodies=(rod,),
        contacts=(
            CoordinateContact(
                name="wall", offset=length + gap, law=NewtonImpact(restitution=0.0),
                terms=(CoordinateTerm(body="rod", coordinate=end, factor=-1.0),),
            ),
        ),
    )  # fmt: skip
    t_end = gap / velocity + 3.0 * length / rod.wave_speed
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=t_end,
        method="hht",
        options=rod_options(rod, t_end, step),
        compare=("wall.normal_force", "wall.gap", "rod.x0", "rod.vx0"),
    )
