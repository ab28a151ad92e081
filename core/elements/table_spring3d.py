"""Spring in space whose force over its length, place or angle is a table: F = f(x) + c x', f a cubic spline."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ..model.base import NonNegative
from ..model.signals import Table
from .base import Numbering
from .measured_force3d import KINDS, TABLE, CountingForce3D, Measure3D


class TableSpring3D(CountingForce3D):
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

    @model_validator(mode="after")
    def _check(self) -> "TableSpring3D":
        if len(self.lengths_table) != len(self.forces):
            raise ValueError(
                f"spring '{self.name}' has {len(self.lengths_table)} lengths, {len(self.forces)} forces: give as many"
            )
        if any(y <= x for x, y in zip(self.lengths_table, self.lengths_table[1:], strict=False)):
            raise ValueError(f"the lengths of spring '{self.name}' must grow strictly")
        return self

    def kind(self) -> int:
        return KINDS[self.measure]

    def lengths(self) -> Sequence[float]:
        return () if self.measure == "angle" else (max(abs(self.lengths_table[0]), abs(self.lengths_table[-1])),)

    def numbers(self) -> tuple[float, float, float, float]:
        return (0.0, self.damping, 0.0, 0.0)

    def signal_in(self, numbering: Numbering) -> int:
        return numbering.signal(Table(times=self.lengths_table, values=self.forces))
