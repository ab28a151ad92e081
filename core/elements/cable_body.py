"""What cables of the plane and of space have in common: equal elements in a row, and points along them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, model_validator

from ..errors import ModelError
from ..model.base import NonNegative, Positive
from ..rounding import BEYOND_END, ON_NODE
from .base import MOST_ELEMENTS, BodyElement, Numbering, Row

SLOPE_SCALE = 0.5
"""Less than the 1 of angles, so that of a point's frame and a slope it is the frame that counts as dependent: its rows
are linear in it."""


class CableBody(BodyElement):
    """Base of the cables."""

    if TYPE_CHECKING:
        shape: tuple[tuple[float, ...], ...] | None

    type: str
    elements: Annotated[int, Field(ge=1, le=MOST_ELEMENTS)]
    """Number of elements."""
    length: Positive
    """Undeformed length of the whole cable, m."""
    mass_per_length: Positive
    """kg/m."""
    axial_stiffness: Positive
    """EA, N."""
    bending_stiffness: NonNegative
    """EI, N m^2; 0 is a thread."""
    axial_damping: NonNegative = 0.0
    """Axial force per rate of the axial strain, N s."""

    @model_validator(mode="after")
    def _check(self) -> "CableBody":
        if self.shape is None:
            return self
        if len(self.shape) != self.elements + 1:
            raise ValueError(f"shape of '{self.name}' has {len(self.shape)} nodes: {self.elements} elements have "
                             f"{self.elements + 1}")  # fmt: skip
        for k, node in enumerate(self.shape):
            if not any(node[len(node) // 2 :]):
                raise ValueError(f"shape of '{self.name}': node {k} has slope zero, so that it has no direction; an "
                                 "unstretched cable has slopes of length 1")  # fmt: skip
        return self

    def lengths(self) -> Sequence[float]:
        return (self.length,)

    def typical_mass(self) -> float:
        return self.mass_per_length * self.length

    def row(self, numbering: Numbering) -> Row:
        return self.rows(numbering)[0]

    def find(self, s: float) -> tuple[int, float]:
        """(element, place in [0, 1]) of the point at s m along the undeformed cable. Raises ModelError beyond it."""
        if not -BEYOND_END * self.length <= s <= (1.0 + BEYOND_END) * self.length:
            raise ModelError(f"'{self.name}' has no point at s = {s:g} m: it reaches from 0 to {self.length:g} m")
        place = min(max(s / self.length, 0.0), 1.0) * self.elements
        # a node counts as one, in spite of rounding
        place = round(place) if abs(place - round(place)) < ON_NODE * self.elements else place
        e = min(int(place), self.elements - 1)
        return e, place - e
