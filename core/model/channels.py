"""Channels: what a model shows and takes. One list names the recorded columns, the FMU's variables and the
quantities that a cross-check compares."""

from dataclasses import dataclass
from typing import Literal

from pydantic import model_validator

from .base import Name, Record


class Input(Record):
    """An input channel: a number that comes from outside during the run (a force, a prescribed motion ...)."""

    name: Name
    """Name of the channel."""
    unit: str = "1"
    """SI unit, e.g. "N", "N.m", "m", "rad"."""
    start: float = 0.0
    """Value until another one is set, in `unit`."""
    description: str = ""
    """What it is, in words."""


class Parameter(Record):
    """A number of the model that may be changed from outside before a run, by name.

    With a `value` it is declared here, and put into its `targets`; without, its value is what stands at the first
    target. Formulas of a model may ask for it.
    """

    name: Name
    """By which it is set: in Python, on the command line, in a sweep, in an FMU."""
    value: float | None = None
    """Its value, in `unit`; left out: what stands at the first target."""
    unit: str = "1"
    """SI unit, e.g. "kg", "m", "N/m"."""
    minimum: float | None = None
    """Least value, in `unit`; left out: none of its own."""
    maximum: float | None = None
    """Largest value, in `unit`; left out: none of its own."""
    description: str = ""
    """What it is, in words."""
    targets: tuple[str, ...] = ()
    """Where the number stands: "element.field", or deeper, e.g. "stop.law.restitution", "rod.position.0"."""

    @model_validator(mode="after")
    def _check(self) -> "Parameter":
        if self.value is None and not self.targets:
            raise ValueError(
                f"parameter '{self.name}' has neither a `value` nor `targets`: give its value, or where its number "
                'stands in the model, e.g. targets=["rod.mass"]'
            )
        if self.minimum is not None and self.maximum is not None and self.minimum > self.maximum:
            raise ValueError(
                f"parameter '{self.name}' has minimum {self.minimum:g} above maximum {self.maximum:g}: "
                "no value fits; exchange them, or leave one out"
            )
        return self

    def refuse_outside(self, value: float) -> None:
        """Raise ValueError for a value outside the range."""
        low, high = self.minimum, self.maximum
        if (low is not None and value < low) or (high is not None and value > high):
            shown = f"[{'-inf' if low is None else low}, {'inf' if high is None else high}]"
            raise ValueError(f"parameter '{self.name}' = {value!r} is outside its range {shown}")


class Formula(Record):
    """A number of the model that follows from parameters. In a file it may stand in its own place: "= mass / 2"."""

    target: str
    """Where the number stands: "element.field", or deeper, as for a parameter."""
    formula: str
    """Arithmetic of parameters: + - * / **, brackets, sqrt, sin, cos, tan, asin, acos, atan, atan2, hypot, exp, log,
    abs, min, max, pi."""


@dataclass(frozen=True)
class Enumeration:
    """Names of the values 0, 1, ... of an integer channel, and of the set of them."""

    name: str
    items: tuple[str, ...]


@dataclass(frozen=True)
class Channel:
    """One column of the results: name, unit, kind of value; for an integer that is a choice, what its values mean."""

    name: str
    unit: str
    description: str
    kind: Literal["real", "integer", "boolean"] = "real"
    enumeration: Enumeration | None = None
