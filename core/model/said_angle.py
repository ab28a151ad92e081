"""What an element says of angles between two markers whose turns are counted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from .markers import Marker3D
from .signals import Signal


@dataclass(frozen=True)
class SaidAngle:
    """That the x axis of marker b is at `angle` (rad) from that of marker a, about the z axis of a; `by` says it.

    What is not `firm` is asked where nobody else says anything: `signal` says it, which is another one at another time.
    """

    a: Marker3D
    b: Marker3D
    angle: float
    by: str
    signal: Signal | None = None

    @property
    def firm(self) -> bool:
        """Whether it is the same whenever a run starts."""
        return self.signal is None


@runtime_checkable
class SaysAngle(Protocol):
    """An element that says angles of markers at the start."""

    def said_angles(self, inputs: Mapping[str, float], t: float) -> Sequence[SaidAngle]:
        """What it says, with these start values of the inputs, for a run that starts at t, s."""
        ...


@dataclass(frozen=True)
class CountedAngle:
    """An angle of marker b about the z axis of marker a whose turns an element counts; `name` stands for it among start
    values."""

    name: str
    a: Marker3D
    b: Marker3D


@runtime_checkable
class CountsTurns(Protocol):
    """An element that counts turns."""

    def counted_angles(self) -> Sequence[CountedAngle]:
        """The angles."""
        ...
