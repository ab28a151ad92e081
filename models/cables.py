"""What the scenarios with ANCF cables share: a round rubber rope or a slender beam by its section, as a body."""

import math
from collections.abc import Sequence

from ..core.elements import Cable2D, MaterialPoint2D
from .parameters import ScenarioParameter


def section_parameters(
    elements: int, length: float, diameter: float, youngs_modulus: float, density: float, damping_time: float = 0.0
) -> tuple[ScenarioParameter, ...]:
    """The parameters of a cable with a round section, and of the weight on it."""
    return (
        ScenarioParameter("elements", elements, "-", "number of elements", 1, 20_000),
        ScenarioParameter("length", length, "m", "length of the cable", 0.0, exclusive=True),
        ScenarioParameter("diameter", diameter, "m", "diameter of its round section", 0.0, exclusive=True),
        ScenarioParameter("youngs_modulus", youngs_modulus, "Pa", "Young's modulus", 0.0, exclusive=True),
        ScenarioParameter("density", density, "kg/m^3", "density", 0.0, exclusive=True),
        ScenarioParameter(
            "damping_time",
            damping_time,
            "s",
            "stress = E (strain + damping_time * strain rate): Kelvin-Voigt material",
            0.0,
        ),
        ScenarioParameter("gravity", 9.81, "m/s^2", "gravity, downwards", 0.0),
    )


def round_cable(
    *,
    elements: int,
    length: float,
    diameter: float,
    youngs_modulus: float,
    density: float,
    damping_time: float,
    position: tuple[float, float] = (0.0, 0.0),
) -> Cable2D:
    """A straight horizontal cable `cable` that starts at `position`: EA = E pi d^2/4, EI = E pi d^4/64."""
    area, inertia = 0.25 * math.pi * diameter**2, math.pi * diameter**4 / 64.0
    return Cable2D(
        name="cable",
        elements=elements,
        length=length,
        mass_per_length=density * area,
        axial_stiffness=youngs_modulus * area,
        bending_stiffness=youngs_modulus * inertia,
        axial_damping=damping_time * youngs_modulus * area,
        bending_damping=damping_time * youngs_modulus * inertia,
        position=position,
    )


def ends(length: float) -> Sequence[MaterialPoint2D]:
    """Frames of its material points `root` and `tip`."""
    return (
        MaterialPoint2D(name="root", body="cable", point=(0.0, 0.0)),
        MaterialPoint2D(name="tip", body="cable", point=(length, 0.0)),
    )
