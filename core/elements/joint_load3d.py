"""Channels of a joint in space: what it does to body b, seen from marker a."""

from collections.abc import Sequence
from typing import Any

from ..compiled.jit import address_of, internal
from ..model.channels import Channel
from ..model.derived import DERIVE_SIGNATURE, NOT_KNOWN, Derived, Places, call_derive
from ..model.frame3d import FRAME, Frame3D, in_space, vector_of
from ..model.rotation3d import dot
from .primitive3d import Primitive

HEAD = 3
"""Of each primitive: address of its kernel, number of its places and of its numbers."""
AXES = 9


@internal
def joint_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    out[:] = 0.0
    place, number = FRAME, AXES
    while place < len(places):
        first, size, count = place + HEAD, places[place + 1], places[place + 2]
        call_derive(places[place], row, places[first : first + size], numbers[number : number + count], out)
        place, number = first + size, number + count
    force, torque = (out[0], out[1], out[2]), (out[3], out[4], out[5])
    for k in range(3):
        axis = in_space(row, places, 0, vector_of(numbers, 3 * k))
        out[k], out[3 + k] = dot(axis, force), dot(axis, torque)


class JointLoad(Derived):
    """Force (N) and torque (N m) of a joint on its body b at the point of marker b, along the axes of marker a.

    Joints that repeat each other share their loads as compliant ones do (`assembly/joint_compliance.py`).
    """

    kernel = joint_load

    def __init__(
        self, name: str, a: Frame3D, b: Frame3D, primitives: Sequence[tuple[Primitive, Sequence[int]]]
    ) -> None:
        self._a, self._b, self._primitives = a, b, primitives
        self.channels = tuple(
            Channel(f"{name}.{what}_{axis}", unit, f"{what} of the joint on its body b, along {axis} of marker a")
            for what, unit in (("force", "N"), ("torque", "N.m"))
            for axis in "xyz"
        )
        self.rate_of = (NOT_KNOWN,) * 6

    def places(self, at: Places) -> list[int]:
        of_a, of_b = at.of(at.q, self._a.index), at.of(at.q, self._b.index)
        found = [*of_a]
        for primitive, rows in self._primitives:
            own = (*of_a, *of_b, *(at.multipliers + row for row in rows))
            found += [address_of(type(primitive).load, DERIVE_SIGNATURE), len(own), len(self._numbers_of(primitive))]
            found += own
        return found

    def numbers(self) -> list[float]:
        found = self._a.axes()
        for primitive, _ in self._primitives:
            found += self._numbers_of(primitive)
        return found

    def _numbers_of(self, primitive: Primitive) -> list[float]:
        return [float(x) for x in primitive.parameters(self._a.marker, self._b.marker)]
