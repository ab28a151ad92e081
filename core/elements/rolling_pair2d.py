"""Planar joints of two bodies that roll on each other: the formula is what has passed, less what it is at the start."""

import math
from collections.abc import Mapping
from typing import ClassVar

from pydantic import model_validator

from ..model.markers import Marker2D
from .base import Numbering, PairElement2D
from .formula2d import Frame2D
from .geometry2d import place
from .scalar_joint2d import ScalarJoint2D


def arcs(a: Frame2D, b: Frame2D, radius_a: float, turning_b: float, phase: float) -> float:
    """Arcs past the line of the centres on two wheels, whole turns of that line taken off."""
    direction = math.atan2(b.y - a.y, b.x - a.x)
    arc = radius_a * (a.angle - direction) - turning_b * (b.angle - direction) - phase
    period = 2.0 * math.pi * (radius_a - turning_b)
    if period == 0.0:
        return arc
    turns = math.floor(arc / period + 0.5)
    return arc - period * turns


class RollingPair2D(ScalarJoint2D, PairElement2D):
    """Base of these joints. Their formula takes off its value at the start, `phase`."""

    derived: ClassVar[tuple[str, ...]] = ("phase",)
    sides: ClassVar[str] = "both wheels are"
    """What must not be on one body, in words."""

    @model_validator(mode="after")
    def _two_bodies(self) -> "RollingPair2D":
        if self.a.body == self.b.body:
            raise ValueError(f"'{self.name}': {self.sides} on '{self.a.body}': give it two bodies")
        return self

    def numbers(self, numbering: Numbering) -> Mapping[str, float]:
        """What the formula says at the start."""
        given = {"a": _start(self.a, numbering), "b": _start(self.b, numbering), "phase": 0.0}
        return {
            "phase": self.formula.formula(*(given[n] if n in given else getattr(self, n) for n in self.formula.names))
        }


def _start(marker: Marker2D, numbering: Numbering) -> Frame2D:
    """Where a marker is at the start."""
    at = numbering.initial(marker.body)
    angle = at[2] + marker.angle
    return Frame2D(*place(marker.point, at), angle, math.cos(angle), math.sin(angle))
