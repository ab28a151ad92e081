"""Absolute tolerances: numbers as they stand, or parts of the model's own scales."""


class OfScales(float):
    """An absolute tolerance in parts of the model's own scales (`Simulation.scales`): of its size for lengths, of 1 rad
    for angles, and of these over the model's time for speeds. So it means the same in all units; a plain number counts
    in those of q and v."""

    __slots__ = ()

    def __mul__(self, factor: float) -> "OfScales":
        return OfScales(float(self) * factor)

    __rmul__ = __mul__

    def __repr__(self) -> str:
        return f"OfScales({float(self)!r})"


DEFAULT_ATOL = OfScales(1e-9)
"""What `atol` is unless told otherwise, and of kinds that a mapping leaves out."""
