"""What springs with a table, of the plane and of space, have in common."""

from typing import TYPE_CHECKING

from pydantic import model_validator

from ..model.signals import Table
from .base import ForceElement


class TableLaw(ForceElement):
    """Base of springs whose force over what they measure is a table. Each declares the fields itself: their order is
    that of its JSON."""

    if TYPE_CHECKING:
        lengths_table: tuple[float, ...]
        forces: tuple[float, ...]

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

    @property
    def farthest(self) -> float:
        """The larger size of what the table begins and ends with."""
        return max(abs(self.lengths_table[0]), abs(self.lengths_table[-1]))
