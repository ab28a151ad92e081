"""Friction by plain coefficients: Coulomb's at contacts that are constraints, a regularised law at force contacts."""

from ..core.laws import ContactLaw, ForceLaw
from ..core.laws.friction import BrownMcPheeFriction, CoulombFriction, Friction
from ..core.model.channels import Parameter
from .parameters import ScenarioError, ScenarioParameter


def friction_parameters(
    coefficient: float, static_coefficient: float | None, transition_speed: float = 1e-3
) -> tuple[ScenarioParameter, ...]:
    """The parameters that set the friction of a contact."""
    return (
        ScenarioParameter("friction", coefficient, "-", "coefficient of friction while slipping", 0.0),
        ScenarioParameter(
            "static_friction", static_coefficient, "-", "coefficient while sticking; none: the same", 0.0, optional=True
        ),
        ScenarioParameter(
            "transition_speed", transition_speed, "m/s", "of the friction of force laws (Brown and McPhee)", 0.0,
            exclusive=True,
        ),
    )  # fmt: skip


def contact_friction(
    law: ContactLaw, *, friction: float, static_friction: float | None, transition_speed: float
) -> Friction:
    """The friction that fits a contact with this law.

    Raises ScenarioError for a static coefficient below the kinetic one.
    """
    if static_friction is not None and static_friction < friction:
        raise ScenarioError(
            f"static_friction = {static_friction:g} is below friction = {friction:g}: a body at rest holds at least "
            "what it holds when it slips"
        )
    if isinstance(law, ForceLaw):
        return BrownMcPheeFriction(
            coefficient=friction, static_coefficient=static_friction, transition_speed=transition_speed
        )
    return CoulombFriction(coefficient=friction, static_coefficient=static_friction)


def friction_model_parameter(*contacts: str) -> Parameter:
    """The model parameter `friction`, the kinetic coefficient of these contacts."""
    targets = tuple(f"{contact}.friction.coefficient" for contact in contacts)
    return Parameter(name="friction", unit="1", minimum=0.0, description="coefficient of friction", targets=targets)
