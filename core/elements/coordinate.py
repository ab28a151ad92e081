"""What a coordinate of a body is."""

from dataclasses import dataclass

from ..model.units import UNKNOWN

UNKNOWN_UNIT = UNKNOWN
"""Of generalised coordinates that do not say theirs."""


@dataclass(frozen=True)
class Coordinate:
    """A coordinate of a body: its name, what its channels are called, and how large it typically is."""

    name: str
    unit: str
    rate: str
    """Channel of its rate."""
    acceleration: str
    """Channel of its second rate."""
    scale: float | None = None
    """Typical magnitude, in its unit; None: the size of the mechanism."""
    turns: bool = False
    """Whether it tells an attitude, as an angle does."""

    @property
    def is_angle(self) -> bool:
        """Whether tolerances of angles hold for it."""
        return self.turns or self.unit == "rad"

    def unit_of(self, level: int) -> str:
        """Unit of the coordinate (level 0), its rate (1) or second rate (2); "-" stays as it is."""
        return self.unit if level == 0 or self.unit == UNKNOWN_UNIT else self.unit + ("", "/s", "/s2")[level]


X, Y, Z = (Coordinate(name, "m", f"v{name}", f"a{name}") for name in "xyz")
"""Those of a place, in the plane and in space."""
