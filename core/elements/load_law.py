"""Force or torque between two bodies as a time function or an input: f(t) along the growth of a measure.

The bodies take it with opposite signs: r -= f(t) dx/dq for the measure x(a, b). Its power f x' counts as put in.
"""

from collections.abc import Sequence
from typing import ClassVar

from pydantic import model_validator

from ..model.signals import Signal
from .measured_force import LOAD, Measure, MeasuredForce


class LoadLaw(MeasuredForce):
    """Base of these loads."""

    law: ClassVar[int] = LOAD
    noun: ClassVar[str] = "load"
    dissipates: ClassVar[bool] = False

    type: str
    measure: Measure = "angle"
    load: Signal
    """Over time, N m or N; positive makes the measure grow."""

    @model_validator(mode="after")
    def _two_bodies(self) -> "LoadLaw":
        a, b = (marker.body for marker in self.markers())
        if a == b:
            raise ValueError(
                f"load '{self.name}': both markers are on '{a}', which would feel nothing of it: give it two bodies, "
                "or ground and a body"
            )
        return self

    def signals(self) -> Sequence[Signal]:
        return (self.load,)
