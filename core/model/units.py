"""Unit strings as powers of the SI base units, as FMI wants them; products of units, and what does work on one."""

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

UNKNOWN = "-"
"""Of quantities whose unit is left open."""

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


def product(first: str, second: str) -> str | None:
    """The unit of a product, as short as can be ("m/rad" times "rad" is "m"); None for units that are unknown."""
    if "1" in (first, second):
        return second if first == "1" else first
    units = [parse_unit(first), parse_unit(second)]
    if units[0] is None or units[1] is None:
        return None
    factor = units[0].factor * units[1].factor
    powers = {b: units[0].exponents.get(b, 0) + units[1].exponents.get(b, 0) for b in BASE}
    exponents = {base: n for base, n in powers.items() if n}
    for name, (scale, own) in DERIVED.items():
        if own == exponents and math.isclose(scale, factor, rel_tol=1e-12):
            return name
    if factor != 1.0:
        return None
    above = ".".join(base + (str(n) if n > 1 else "") for base, n in exponents.items() if n > 0)
    below = "".join(f"/{base}{-n if n < -1 else ''}" for base, n in exponents.items() if n < 0)
    return (above or "1") + below


def conjugate(unit: str) -> str:
    """The unit of what does work on a change of `unit`: N for m, N.m for rad; "-" where that is open."""
    known = {"m": "N", "rad": "N.m", "1": "J", UNKNOWN: UNKNOWN}
    return known.get(unit) or (f"J/({unit})" if "." in unit else f"J/{unit}" if "/" not in unit else UNKNOWN)


def per_second(unit: str) -> str:
    """`unit`/s; "-" stays as it is."""
    return unit if unit == UNKNOWN else f"{unit}/s"


def times_second(unit: str) -> str:
    """`unit` times s; "-" stays as it is."""
    above, slash, below = unit.partition("/")
    return unit if unit == UNKNOWN else f"{above}.s{slash}{below}"
