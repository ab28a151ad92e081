"""What an element says of the angle between two markers at the start."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from .markers import Marker3D


@dataclass(frozen=True)
class SaidAngle:
    """That the x axis of marker b is at `angle` (rad) from that of marker a, about the z axis of a; `by` says it."""

    a: Marker3D
    b: Marker3D
    angle: float
    by: str


@runtime_checkable
class SaysAngle(Protocol):
    """An element that says angles of markers at the start."""

    def said_angles(self, inputs: Mapping[str, float]) -> Sequence[SaidAngle]:
        """What it says, with these start values of the inputs."""
        ...
