"""Angles at the start whose whole turns a driver says: asked for while tables are built of a model that is watched."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ..contacts import Contact
from ..elements.base import BodyElement, Element
from ..model.channels import Input
from ..model.outputs import MarkerOutput
from .parts import Parts

if TYPE_CHECKING:
    from ..elements.start_angle3d import DriverTurn

SHIFT = 2.0 * math.pi


class Watched:
    """The parts of a model; `turns` has the angles at the start that its tables have asked for, in that order: None for
    those that are the same whenever a run starts.

    Parameters
    ----------
    shifted : number of the one that counts as a whole turn more; -1: none.
    """

    def __init__(self, parts: Parts, shifted: int = -1) -> None:
        self._parts, self._shifted = parts, shifted
        self.angles: list[float] = []
        self.turns: list[DriverTurn | None] = []

    def seen(self, angle: float, turn: "DriverTurn | None") -> float:
        """Note that one was asked for; what is told."""
        told = angle + SHIFT if len(self.turns) == self._shifted else angle
        self.angles.append(told)
        self.turns.append(turn)
        return told

    @property
    def name(self) -> str:
        return self._parts.name

    @property
    def gravity(self) -> tuple[float, ...]:
        return self._parts.gravity

    @property
    def bodies(self) -> Sequence[BodyElement]:
        return self._parts.bodies

    @property
    def contacts(self) -> Sequence[Contact]:
        return self._parts.contacts

    @property
    def inputs(self) -> Sequence[Input]:
        return self._parts.inputs

    @property
    def outputs(self) -> Sequence[MarkerOutput]:
        return self._parts.outputs

    def elements(self) -> Iterator[Element]:
        """All elements of the model."""
        return self._parts.elements()
