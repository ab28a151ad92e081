"""Unit strings as powers of the SI base units, as FMI wants them."""

import math
import re
from dataclasses import dataclass, field

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

DERIVED: dict[str, tuple[float, dict[str, int]]] = {
    "1": (1.0, {}),
    "N": (1.0, {"kg": 1, "m": 1, "s": -2}),
    "J": (1.0, {"kg": 1, "m": 2, "s": -2}),
    "W": (1.0, {"kg": 1, "m": 2, "s": -3}),
    "Pa": (1.0, {"kg": 1, "m": -1, "s": -2}),
    "Hz": (1.0, {"s": -1}),
    "g": (1e-3, {"kg": 1}),
    "mm": (1e-3, {"m": 1}),
    "ms": (1e-3, {"s": 1}),
    "deg": (math.pi / 180.0, {"rad": 1}),
    **{base: (1.0, {base: 1}) for base in BASE},
}

_FACTOR = re.compile(r"([A-Za-z]+|1)(?:\^?([+-]?\d+))?$")


@dataclass(frozen=True)
class BaseUnit:
    """factor times a product of powers of base units (exponents that are 0 are left out)."""

    factor: float = 1.0
    exponents: dict[str, int] = field(default_factory=dict)


def parse_unit(text: str) -> BaseUnit | None:
    """The base unit of a unit such as "N.m", "m/s^2", "kg.m2", "N/(m.s)"; None if it is not of that form.

    A factor after "/" counts as denominator, up to the next "." or "/" ("J/kg/K" is J kg^-1 K^-1); powers that
    are not whole (Hertz' N/m^1.5) have no base unit in FMI.
    """
    outside, _, inside = text.replace("*", ".").replace(" ", ".").partition("/(")
    parts = [(sign, factor) for sign, factor in _factors(outside)]
    if inside:
        if not inside.endswith(")"):
            return None
        parts += [(-sign, factor) for sign, factor in _factors(inside[:-1])]
    scale, exponents = 1.0, dict.fromkeys(BASE, 0)
    for sign, factor in parts:
        match = _FACTOR.match(factor)
        if match is None or match[1] not in DERIVED:
            return None
        power = sign * int(match[2] or 1)
        unit_scale, unit = DERIVED[match[1]]
        scale *= unit_scale**power
        for base, exponent in unit.items():
            exponents[base] += power * exponent
    return BaseUnit(scale, {base: n for base, n in exponents.items() if n})


def _factors(text: str) -> list[tuple[int, str]]:
    """The factors of a product without brackets, each with +1 or, after "/", -1."""
    pieces = re.split(r"([./])", text)
    signs = [1, *(-1 if separator == "/" else 1 for separator in pieces[1::2])]
    return list(zip(signs, pieces[::2], strict=True))
