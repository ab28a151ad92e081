"""Unit strings as powers of the base units."""

import math

import pytest
from tlismni.core.model.units import parse_unit


@pytest.mark.parametrize(
    ("text", "factor", "exponents"),
    [
        ("1", 1.0, {}),
        ("m/s", 1.0, {"m": 1, "s": -1}),
        ("m/s2", 1.0, {"m": 1, "s": -2}),
        ("m/s^2", 1.0, {"m": 1, "s": -2}),
        ("rad/s", 1.0, {"rad": 1, "s": -1}),
        ("N.m", 1.0, {"kg": 1, "m": 2, "s": -2}),
        ("N.s", 1.0, {"kg": 1, "m": 1, "s": -1}),
        ("N s/m", 1.0, {"kg": 1, "s": -1}),
        ("kg.m2", 1.0, {"kg": 1, "m": 2}),
        ("kg*m^2", 1.0, {"kg": 1, "m": 2}),
        ("m.s-2", 1.0, {"m": 1, "s": -2}),
        ("N/(m.s)", 1.0, {"kg": 1, "s": -3}),
        ("1/s", 1.0, {"s": -1}),
        ("J", 1.0, {"kg": 1, "m": 2, "s": -2}),
        ("N/mm", 1e3, {"kg": 1, "s": -2}),
        ("deg", math.pi / 180.0, {"rad": 1}),
    ],
)
def test_units(text, factor, exponents):
    unit = parse_unit(text)
    assert unit is not None
    assert unit.factor == pytest.approx(factor, rel=1e-15)
    assert unit.exponents == exponents


@pytest.mark.parametrize("text", ["N/m^1.5", "furlong", "", "N/(m", "m//s", "%"])
def test_what_has_no_base_unit(text):
    assert parse_unit(text) is None
