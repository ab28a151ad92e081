"""Channels: what a model shows and takes. One list names the recorded columns, the FMU's variables and the
quantities that a cross-check compares."""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field, model_validator

from .base import Name, Record


class Input(Record):
    """An input channel: a number that comes from outside during the run (a force, a prescribed motion ...)."""

    name: Name
    unit: str = "1"
    """SI unit, e.g. "N", "N.m", "m", "rad"."""
    start: float = 0.0
    description: str = ""


class Parameter(Record):
    """A number of the model that may be changed from outside before a run, by name."""

    name: Name
    unit: str = "1"
    minimum: float | None = None
    maximum: float | None = None
    description: str = ""
    targets: Annotated[tuple[str, ...], Field(min_length=1)]
    """Where the number stands: "element.field" or "element.field.field", e.g. "stop.law.restitution"."""

    @model_validator(mode="after")
    def _check(self) -> "Parameter":
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
