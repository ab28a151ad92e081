"""Coulomb's friction as it is: set-valued at zero speed. It has no formula; contacts as constraints resolve it."""

from typing import Literal

from pydantic import ValidationInfo, field_validator

from ...model.base import Record
from .base import FrictionCoefficient


def not_below_kinetic(static: float | None, kinetic: float | None) -> float | None:
    """`static` if it is None or >= `kinetic` (which is None if it was itself refused).

    Raises
    ------
    ValueError : else.
    """
    if static is not None and kinetic is not None and static < kinetic:
        raise ValueError(
            f"{static:g} is below coefficient = {kinetic:g}: a body at rest holds at least what it holds when it "
            "slides; give static_coefficient >= coefficient, or leave it out"
        )
    return static


class CoulombFriction(Record):
    """|F_t| <= mu_s F_n while it sticks, F_t = -mu F_n sgn(v_t) while it slips."""

    type: Literal["Coulomb"] = "Coulomb"
    coefficient: FrictionCoefficient
    """mu while slipping, dimensionless."""
    static_coefficient: FrictionCoefficient | None = None
    """mu_s >= mu while sticking; none: mu."""

    @field_validator("static_coefficient")
    @classmethod
    def _not_below_kinetic(cls, value: float | None, info: ValidationInfo) -> float | None:
        return not_below_kinetic(value, info.data.get("coefficient"))

    @property
    def sticking_coefficient(self) -> float:
        """mu_s, whether given or not."""
        return self.coefficient if self.static_coefficient is None else self.static_coefficient
