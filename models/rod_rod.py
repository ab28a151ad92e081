"""A short rod strikes a longer one at rest: the waves decide what is given back."""

from typing import Any

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
    ScenarioParameter("length_ratio", 0.5, "-", "length of the striking rod over the struck one's", 0.01, 1.0),
    ScenarioParameter("gap", 5e-5, "m", "distance of the rods at the start", 0.0),
    ScenarioParameter("velocity", 0.1, "m/s", "of the striking rod", 0.0, exclusive=True),
)  # fmt: skip


@scenario("rod_rod", "an elastic rod strikes a longer one: restitution is the ratio of their lengths", PARAMETERS)
def rod_rod(
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
    length_ratio: float,
    gap: float,
    velocity: float,
) -> Scenario:
    """Rod `striker` flies to the right against rod `struck`, of the same section and material, in contact `contact`
    (restitution 0). `elements` and `length` are those of `striker`; the elements of `struck` are about as long.

    Theory (St. Venant): contact lasts 2 L1/c, L1 the shorter length, and the velocities of the centres of mass separate
    with L1/L2 of the speed of approach.
    """
    rod: dict[str, Any] = {
        "axial_stiffness": youngs_modulus * area, "mass_per_length": density * area, "mass_matrix": mass_matrix,
        "damping_time": damping_time,
    }  # fmt: skip
    striker = AxialRod(
        name="striker", elements=elements, length=length, position=-length - gap, velocity=velocity,
        massless_ends=("right",) if massless_contact else (), **rod,
    )  # fmt: skip
    count = round(elements / length_ratio)
    struck = AxialRod(name="struck", elements=count, length=length / length_ratio, **rod)
    model = Model(
        name="rod_rod",
        gravity=(0.0, 0.0),
        bodies=(striker, struck),
        contacts=(
            CoordinateContact(
                name="contact", law=NewtonImpact(restitution=0.0),
                terms=(
                    CoordinateTerm(body="struck", coordinate="x0"),
                    CoordinateTerm(body="striker", coordinate=f"x{elements}", factor=-1.0),
                ),
            ),
        ),
    )  # fmt: skip
    t_end = gap / velocity + 3.0 * length / striker.wave_speed
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=t_end,
        method="hht",
        options=rod_options(striker, t_end, step),
        compare=("contact.normal_force", "contact.gap", "striker.vx0", f"struck.vx{count}"),
    )
