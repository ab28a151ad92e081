"""Outlines for models in generalised coordinates, whose bodies have no place of their own."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Sketch:
    """A polygon that moves with coordinates: each of its place x, y (m) and its angle (rad) is a constant plus factors
    times coordinates, by their names ("toy.y")."""

    name: str
    outline: tuple[tuple[float, float], ...]
    """In its own frame, m."""
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """x, y and angle where all coordinates are zero."""
    x: Mapping[str, float] = field(default_factory=dict)
    y: Mapping[str, float] = field(default_factory=dict)
    angle: Mapping[str, float] = field(default_factory=dict)

    @property
    def fixed(self) -> bool:
        """True if it does not move."""
        return not (self.x or self.y or self.angle)
