"""Speeds of surfaces that may jump, and the methods that cannot tell."""

from typing import Any

from ..errors import ModelError
from ..laws.friction import CoulombFriction
from ..methods.registry import Formula
from ..model.signals import InputSignal, Step
from ..multibody_model import Model


def refuse_surface_jumps(system: Any, formula: Formula, method: str) -> None:
    """Raise ModelError for a surface with Coulomb friction whose speed may jump, if the method does not meet
    constraints of velocities: it would pull along what sticks, whatever friction can hold."""
    if formula.exact or not isinstance(system, Model):
        return
    for contact in system.contacts:
        speed = contact.surface_speed
        if isinstance(speed, Step | InputSignal) and isinstance(contact.friction, CoulombFriction):
            raise ModelError(
                f"contact '{contact.name}' has a surface whose speed, a {type(speed).__name__}, may jump, and method "
                f"'{method}' does not meet the constraints of velocities that tell so: take a method of the family "
                "such as 'ebdf', or a speed without jumps, such as a Ramp"
            )
