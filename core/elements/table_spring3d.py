"""Spring in space whose force over its length, place or angle is a table: F = f(x) + c x', f a cubic spline."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ..model.base import NonNegative
from .measured_force3d import CountingForce3D, Measure
from .table_law import TableLaw


class TableSpring3D(TableLaw, CountingForce3D):
    """Spring between markers `a` and `b` with a measured characteristic: `forces` over `lengths`, a cubic spline.

    measure "distance": of the points, which must not meet, pulling is positive; "slide": place of b along the z axis of
    a; "angle": of b about it, turns counted, with angles and torques in the table. Beyond the table the first or last
    cubic goes on.
    """

    type: Literal["TableSpring3D"] = "TableSpring3D"
    symbol: ClassVar[str] = "spring"

    measure: Measure = "distance"
    """What its force depends on."""
    lengths_table: Annotated[tuple[float, ...], Field(min_length=4)]
    """Lengths or places, m, or angles, rad, growing."""
    forces: Annotated[tuple[float, ...], Field(min_length=4)]
    """Force against the growth at each of them, N, or torque, N m."""
    damping: NonNegative = 0.0
    """N s/m or N m s/rad."""
