"""Coefficients of friction while sliding and while sticking."""

from pydantic import ValidationInfo, field_validator

from ...model.base import Record
from .base import FrictionCoefficient


class StaticAndKinetic(Record):
    """Base of the laws that know a static coefficient beside the kinetic one.

    Raises
    ------
    ModelError : for a static coefficient below the kinetic one.
    """

    coefficient: FrictionCoefficient
    """mu while slipping, dimensionless."""
    static_coefficient: FrictionCoefficient | None = None
    """mu_s >= mu while sticking, dimensionless; none: mu."""

    @field_validator("static_coefficient")
    @classmethod
    def _not_below_kinetic(cls, value: float | None, info: ValidationInfo) -> float | None:
        kinetic = info.data.get("coefficient")
        if value is not None and kinetic is not None and value < kinetic:
            raise ValueError(
                f"{value:g} is below coefficient = {kinetic:g}: a body at rest holds at least what it holds when it "
                "slips; give static_coefficient >= coefficient, or leave it out"
            )
        return value

    @property
    def sticking_coefficient(self) -> float:
        """mu_s, whether given or not."""
        return self.coefficient if self.static_coefficient is None else self.static_coefficient
