"""Markers in space as compiled code reads them from a row of numbers: places, attitudes and their rates.

What the body of a marker lacks (the attitude of a point mass, all of the ground's) has the place -1: it rests, with the
Euler parameters (1, 0, 0, 0).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..compiled.jit import inlined
from .markers import Marker3D
from .rotation3d import turned, turning

FRAME = 7
"""Places of a frame: three of its position, four of its Euler parameters."""
ARMS_AT = 3
"""Where those begin."""


@dataclass(frozen=True)
class Frame3D:
    """A marker and where the coordinates of its body's frame stand: indices (7,), -1 for those that it lacks."""

    marker: Marker3D
    index: tuple[int, ...]

    @classmethod
    def of(cls, marker: Marker3D, index: Sequence[int]) -> "Frame3D":
        """The same, from any sequence."""
        return cls(marker, tuple(index))

    def axes(self) -> list[float]:
        """The marker's axes x, y, z in its body, one after another (9,)."""
        return [float(x) for axis in self.marker.axes().T for x in axis]


@inlined
def _at(row: Any, place: int, rest: float) -> float:
    return row[place] if place >= 0 else rest


@inlined
def three_of(row: Any, places: Any, first: int) -> Any:
    """Three numbers whose places begin at `first`."""
    return _at(row, places[first], 0.0), _at(row, places[first + 1], 0.0), _at(row, places[first + 2], 0.0)


@inlined
def four_of(row: Any, places: Any, first: int, rest: float) -> Any:
    """Four numbers, Euler parameters (`rest` 1) or their rates (0)."""
    return (
        _at(row, places[first], rest), _at(row, places[first + 1], 0.0), _at(row, places[first + 2], 0.0),
        _at(row, places[first + 3], 0.0),
    )  # fmt: skip


@inlined
def vector_of(numbers: Any, first: int) -> Any:
    """Three of the numbers of the model."""
    return numbers[first], numbers[first + 1], numbers[first + 2]


@inlined
def in_space(row: Any, places: Any, first: int, u: Any) -> Any:
    """A u of the frame whose places begin at `first`."""
    p = four_of(row, places, first + ARMS_AT, 1.0)
    return turned(turning(p, u), p)


@inlined
def point_of(row: Any, places: Any, first: int, u: Any) -> Any:
    """The point u of that frame."""
    r, arm = three_of(row, places, first), in_space(row, places, first, u)
    return r[0] + arm[0], r[1] + arm[1], r[2] + arm[2]
