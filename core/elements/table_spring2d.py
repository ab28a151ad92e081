"""Spring whose force over its length is a table: F = f(l) + c l', f a cubic spline."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ..model.base import NonNegative
from .measured_force import Measure, MeasuredForce2D
from .table_law import TableLaw


class TableSpring2D(TableLaw, MeasuredForce2D):
    """Spring between markers `a` and `b` with a measured characteristic: `forces` over `lengths`, a cubic spline.

    Pulling is positive. Beyond the table the first or last cubic goes on. The markers must not meet.
    """

    type: Literal["TableSpring2D"] = "TableSpring2D"
    symbol: ClassVar[str] = "spring"
    own_measure: ClassVar[Measure | None] = "distance"

    lengths_table: Annotated[tuple[float, ...], Field(min_length=4)]
    """Lengths, m, growing."""
    forces: Annotated[tuple[float, ...], Field(min_length=4)]
    """Force at each length, N."""
    damping: NonNegative = 0.0
    """N s/m."""
