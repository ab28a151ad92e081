"""Spring whose force along a measure is a table: F = f(x) + c x', f a cubic spline."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from pydantic import model_validator

from ..model.signals import Table
from .base import Numbering
from .measured_force import TABLE, MeasuredForce, Numbers


class TableLaw(MeasuredForce):
    """Base of springs whose force over what they measure is a table. Each declares the fields itself: their order is
    that of its JSON."""

    law: ClassVar[int] = TABLE
    noun: ClassVar[str] = "spring"

    if TYPE_CHECKING:
        lengths_table: tuple[float, ...]
        forces: tuple[float, ...]
        damping: float

    @model_validator(mode="after")
    def _check(self) -> "TableLaw":
        if len(self.lengths_table) != len(self.forces):
            raise ValueError(
                f"spring '{self.name}' has {len(self.lengths_table)} lengths, {len(self.forces)} forces: give as many"
            )
        if any(y <= x for x, y in zip(self.lengths_table, self.lengths_table[1:], strict=False)):
            raise ValueError(f"the lengths of spring '{self.name}' must grow strictly")
        return self

    @property
    def table(self) -> Table:
        """The force over what is measured."""
        return Table(times=self.lengths_table, values=self.forces)

    def lengths(self) -> Sequence[float]:
        return () if self.acts_along == "angle" else (max(abs(self.lengths_table[0]), abs(self.lengths_table[-1])),)

    def numbers(self) -> Numbers:
        return (0.0, self.damping, 0.0, 0.0)

    def signal_in(self, numbering: Numbering) -> int:
        return numbering.signal(self.table)
