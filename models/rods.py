"""What the scenarios with elastic rods share: their parameters and their time steps."""

from typing import Any

from ..core.elements import AxialRod
from .parameters import ScenarioParameter

COURANT = 0.2
"""Part of an element that a wave passes in a step."""
MOST_STEPS = 20_000
"""Of a run at the default step: fine meshes get longer steps than COURANT asks for."""
MOST_ELEMENTS = 1_000_000


def rod_parameters(elements: int = 50, mass_matrix: str = "consistent") -> tuple[ScenarioParameter, ...]:
    """Mesh, material and step."""
    return (
        ScenarioParameter("elements", elements, "-", "number of linear bar elements", 3, MOST_ELEMENTS),
        ScenarioParameter(
            "mass_matrix", mass_matrix, "-", "of the elements", choices=("consistent", "lumped")
        ),
        ScenarioParameter(
            "massless_contact", False, "-", "no mass at the contact node: closing takes no energy"
        ),
        ScenarioParameter("length", 1.0, "m", "of the rod", 0.0, exclusive=True),
        ScenarioParameter("youngs_modulus", 210e9, "Pa", "of the rod", 0.0, exclusive=True),
        ScenarioParameter("density", 7800.0, "kg/m^3", "of the rod", 0.0, exclusive=True),
        ScenarioParameter("area", 3.14e-4, "m2", "cross-section of the rod", 0.0, exclusive=True),
        ScenarioParameter("damping_time", 0.0, "s", "damping of the rod = this time times its stiffness", 0.0),
        ScenarioParameter(
            "step", None, "s", "time step; none: a wave passes 0.2 of an element, but at most 20 000 steps", 0.0,
            exclusive=True, optional=True,
        ),
    )  # fmt: skip


def rod_options(rod: AxialRod, t_end: float, step: float | None) -> dict[str, Any]:
    """Fixed steps of undamped HHT (Newmark): error control would follow the front of the wave with tiny ones."""
    courant = COURANT * rod.length / rod.elements / rod.wave_speed
    return {"step": step or max(courant, t_end / MOST_STEPS), "alpha": 0.0}
