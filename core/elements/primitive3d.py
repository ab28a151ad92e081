"""Primitives: the few constraints between two markers in space that joints are made of.

The coordinates of a primitive are the fourteen of its markers' bodies: R_a, p_a, R_b, p_b.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..model.markers import Marker3D
from ..model.signals import Constant, Signal
from .base import Form, Numbering, Part, Row, no_account

RA, PA, RB, PB = 0, 3, 7, 10
"""Where the places and the Euler parameters of both bodies begin among the local coordinates."""
SIZE = 14

Axis = Literal["x", "y", "z"]
AXIS: dict[Axis, int] = {"x": 0, "y": 1, "z": 2}


def block(i: int, rows: int, j: int, columns: int) -> list[tuple[int, int]]:
    """Pairs of a block of a matrix, and of its transpose."""
    pairs = {(i + k, j + l) for k in range(rows) for l in range(columns)}
    return sorted(pairs | {(l, k) for k, l in pairs})


def account(numbering: Numbering, signal: Signal) -> int:
    """Index of the work account of what moves by `signal`; of a constant the place at rest, since it does none."""
    return no_account(numbering) if isinstance(signal, Constant) else numbering.work("input")


class Primitive:
    """Base of the primitives."""

    form: ClassVar[Form]
    holds_axes: ClassVar[bool] = False
    """Whether it keeps bodies from turning, by a torque."""
    carries_force: ClassVar[bool] = False
    """Whether its multipliers are components of the force between both bodies, N."""
    load: ClassVar[Any]
    """numba function of DERIVE_SIGNATURE: adds the force on body b at the point of its marker (N) and the torque (N m),
    in the directions of space, to `out` (6,). Its places are those of both frames, `model/frame3d.FRAME` each, and of
    the multipliers of its rows; its numbers are its `parameters`."""

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
