"""Spring in space whose force over its length, place or angle is a table: F = f(x) + c x', f a cubic spline."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ..model.base import NonNegative
from .base import Numbering
from .measured_force3d import MEASURE_KINDS, TABLE, CountingForce3D, Measure3D
from .table_law import TableLaw


class TableSpring3D(TableLaw, CountingForce3D):
    """Spring between markers `a` and `b` with a measured characteristic: `forces` over `lengths`, a cubic spline.

    measure "distance": of the points, which must not meet, pulling is positive; "slide": place of b along the z axis of
    a; "angle": of b about it, turns counted, with angles and torques in the table. Beyond the table the first or last
    cubic goes on.
    """

    type: Literal["TableSpring3D"] = "TableSpring3D"
    law: ClassVar[int] = TABLE

    measure: Measure3D = "distance"
    """What its force depends on."""
    lengths_table: Annotated[tuple[float, ...], Field(min_length=4)]
    """Lengths or places, m, or angles, rad, growing."""
    forces: Annotated[tuple[float, ...], Field(min_length=4)]
    """Force against the growth at each of them, N, or torque, N m."""
    damping: NonNegative = 0.0
    """N s/m or N m s/rad."""

    def kind(self) -> int:
        return MEASURE_KINDS[self.measure]

    def lengths(self) -> Sequence[float]:
        return () if self.measure == "angle" else (self.farthest,)

    def numbers(self) -> tuple[float, float, float, float]:
        return (0.0, self.damping, 0.0, 0.0)

    def signal_in(self, numbering: Numbering) -> int:
        return numbering.signal(self.table)
