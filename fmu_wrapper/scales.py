"""Length, mass and time that are typical of a model, and the limits of its parameters."""

import math
from dataclasses import dataclass
from typing import Any

from ..core.model.base import Record
from ..core.model.channels import Parameter
from ..core.model.units import parse_unit
from ..core.multibody_model import Model
from ..viewer.drawing.places import Places


@dataclass(frozen=True)
class Scales:
    """Length (m), mass (kg) and time (s) that are typical of a model: those of its dimensions, of all bodies, and of
    falling or flying through its dimensions."""

    length: float
    mass: float
    time: float

    @classmethod
    def of(cls, model: Model, t_end: float | None) -> "Scales":
        """The scales of `model`; where it has neither weight nor speed, a tenth of `t_end` (s) is its time."""
        places = Places(model)
        length = places.size
        gravity = math.hypot(*model.gravity)
        speed = max((abs(v) for name in places.bodies for v in _speeds(places, name)), default=0.0)
        times = [0.1 * t_end] if t_end else []
        if gravity or speed:
            times = [*([math.sqrt(length / gravity)] if gravity else []), *([length / speed] if speed else [])]
        mass = sum(body.typical_mass() for body in places.bodies.values())
        return cls(length, mass or 1.0, min(times, default=1.0))

    def nominal(self, unit: str | None) -> float | None:
        """A power of ten, or 2 or 5 times one, near `magnitude`, or None."""
        value = self.magnitude(unit)
        return None if value is None else round_number(value)

    def magnitude(self, unit: str | None) -> float | None:
        """What has this unit is about so large; None for units without dimension (whose nominal value is 1) and such as
        are unknown. For units with a factor (mm) it is in that unit."""
        base = None if unit is None else parse_unit(unit)
        if base is None or not {"m", "kg", "s"} & base.exponents.keys():
            return None
        own = {"m": self.length, "kg": self.mass, "s": self.time}
        value = math.prod(own[name] ** power for name, power in base.exponents.items() if name in own)
        return value / base.factor


def round_number(value: float) -> float:
    """The nearest of 1, 2, 5 times a power of ten, by ratio; `value` is positive."""
    power = math.floor(math.log10(value))
    candidates = [float(f"{digit}e{power + shift}") for shift in (0, 1) for digit in (1, 2, 5)]
    return min(candidates, key=lambda c: abs(math.log(c / value)))


def _speeds(places: Places, name: str) -> tuple[float, ...]:
    """Initial speeds of a body's coordinates in m."""
    body = places.bodies[name]
    rates = body.start_in(places.bodies)[1]
    return tuple(v for c, v in zip(body.coordinate_records(), rates, strict=True) if c.unit == "m")


def parameter_limits(model: Model, parameter: Parameter) -> tuple[float | None, float | None]:
    """Least and largest value of a parameter: its own limits, and those of the fields that it sets."""
    lows, highs = [parameter.minimum], [parameter.maximum]
    elements = {element.name: element for element in model.elements()}
    for target in parameter.targets:
        name, *fields, last = target.split(".")
        record: Any = elements[name]
        for field in fields:
            record = getattr(record, field)
        for bound in type(record).model_fields[last].metadata if isinstance(record, Record) else ():
            lows += [getattr(bound, "ge", None), getattr(bound, "gt", None)]
            highs += [getattr(bound, "le", None), getattr(bound, "lt", None)]
    return (
        max((float(x) for x in lows if x is not None), default=None),
        min((float(x) for x in highs if x is not None), default=None),
    )
