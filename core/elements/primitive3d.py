"""Primitives: the few constraints between two markers in space that joints are made of.

The coordinates of a primitive are the fourteen of its markers' bodies: R_a, p_a, R_b, p_b.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from ..model.markers import Marker3D
from ..model.signals import Constant, Signal
from .base import Form, Numbering, Part, Row

RA, PA, RB, PB = 0, 3, 7, 10
"""Where the places and the Euler parameters of both bodies begin among the local coordinates."""
SIZE = 14

Axis = Literal["x", "y", "z"]
AXIS: dict[Axis, int] = {"x": 0, "y": 1, "z": 2}
Floats = NDArray[np.float64]


def block(i: int, rows: int, j: int, columns: int) -> list[tuple[int, int]]:
    """Pairs of a block of a matrix, and of its transpose."""
    pairs = {(i + k, j + l) for k in range(rows) for l in range(columns)}
    return sorted(pairs | {(l, k) for k, l in pairs})


def account(numbering: Numbering, signal: Signal) -> int:
    """Index of the work account of what moves by `signal`; of a constant the place at rest, since it does none."""
    return numbering.frame(Marker3D())[0] if isinstance(signal, Constant) else numbering.work("input")


@dataclass(frozen=True)
class Motion3D:
    """Where both markers are, over N samples: of each its point (N, 3) and its axes (N, 3, 3) as columns."""

    point_a: Floats
    axes_a: Floats
    point_b: Floats
    axes_b: Floats


class Primitive:
    """Base of the primitives."""

    form: ClassVar[Form]

    def parameters(self, a: Marker3D, b: Marker3D) -> Sequence[float]:
        """Those of its kernel behind both bodies' `rest`."""
        raise NotImplementedError

    def extra(self, numbering: Numbering) -> Sequence[int]:
        """Indices of its kernel."""
        return ()

    def signals(self) -> Sequence[Signal]:
        """Its time functions."""
        return ()

    def part(self, a: Marker3D, b: Marker3D, numbering: Numbering) -> Part:
        """Its equations between two markers, as tables."""
        rest = (numbering.at_rest(a)[3], numbering.at_rest(b)[3])
        coordinates = (*numbering.frame(a), *numbering.frame(b))
        return Part(self.form, (Row((*rest, *self.parameters(a, b)), coordinates, self.extra(numbering)),))

    def load(self, motion: Motion3D, multipliers: Floats) -> tuple[Floats, Floats]:
        """Force on body b, at the point of its marker, and torque (N, 3 each), N and N m in the directions of space,
        from the multipliers of its rows (N, rows)."""
        raise NotImplementedError
