"""Units of contacts between coordinates follow from their terms, in channels, events and FMUs."""

import numpy as np
import pytest
from helpers import GROUND, on
from tlismni.cli.summary import event_units
from tlismni.core import (
    CoordinateContact,
    CoordinateTerm,
    KelvinVoigt,
    LinearSystem,
    LuGreFriction,
    Model,
    ModelError,
    NewtonImpact,
    Revolute2D,
    RigidBody2D,
    simulate,
)
from tlismni.core.model.units import conjugate, parse_unit, per_second, product, times_second
from tlismni.core.simulation.simulation import Simulation
from tlismni.fmu_wrapper import Slave

LINEAR = {"gap": "m", "gap_rate": "m/s", "normal_force": "N", "impulse": "N.s", "dissipation": "J"}
TURNING = {"gap": "rad", "gap_rate": "rad/s", "normal_force": "N.m", "impulse": "N.m.s", "dissipation": "J"}
OPEN = {"gap": "-", "gap_rate": "-", "normal_force": "-", "impulse": "-", "dissipation": "J"}
PLAIN = {"gap": "1", "gap_rate": "1/s", "normal_force": "J", "impulse": "J.s", "dissipation": "J"}
BODIES = [
    RigidBody2D(name="a", mass=1.0, inertia=0.1, angular_velocity=2.0),
    RigidBody2D(name="b", mass=1.0, inertia=0.1, position=(1.0, 0.0)),
    LinearSystem(name="s", coordinates=("u", "w"), mass=((1.0, 0.0), (0.0, 1.0)), units=("-", "rad")),
]


def term(body, coordinate, factor=1.0, unit=None):
    return CoordinateTerm(body=body, coordinate=coordinate, factor=factor, unit=unit)


def contact(*terms, law=None, **fields):
    return CoordinateContact(name="c", offset=0.1, terms=terms, law=law or NewtonImpact(restitution=0.5), **fields)


def units(model):
    return {c.name: c.unit for c in Simulation(model).channels}


@pytest.mark.parametrize(
    "terms, expected",
    [
        ([term("a", "x", -1.0)], LINEAR),
        ([term("a", "angle", -1.0)], TURNING),
        ([term("a", "angle", -1.0), term("b", "angle", 2.0)], TURNING),
        ([term("a", "angle", -1.0), term("s", "w")], TURNING),
        ([term("a", "angle", -0.1), term("b", "x")], LINEAR),  # undeclared: m per unit of the coordinate
        ([term("a", "angle", -0.1, "m/rad"), term("b", "angle", 0.2, "m/rad")], LINEAR),  # gears by their radii
        ([term("a", "angle", -0.1, "m/rad"), term("b", "x")], LINEAR),
        ([term("a", "x", -10.0, "rad/m"), term("b", "angle")], TURNING),
        ([term("a", "x", -10.0, "1/m"), term("b", "angle", 1.0, "1/rad")], PLAIN),
        ([term("s", "u", -1.0)], OPEN),
        ([term("a", "x", -1.0), term("a", "angle", 0.0)], LINEAR),  # a term without effect has no say
    ],
)
def test_units_of_channels_follow_from_the_terms(terms, expected):
    found = units(Model(bodies=BODIES, contacts=[contact(*terms)]))
    assert {name: found[f"c.{name}"] for name in expected} == expected


def test_units_reach_the_fmu_and_the_table_of_events():
    turning, plain = contact(term("a", "angle", -1.0)), contact(term("b", "x"))
    model = Model(bodies=BODIES[:2], contacts=[turning, plain.model_copy(update={"name": "d"})])
    variables = Slave(model).variables.by_name
    assert {name: variables[f"c.{name}"].unit for name in TURNING} == TURNING
    assert {name: variables[f"d.{name}"].unit for name in LINEAR} == LINEAR
    result = simulate(Model(bodies=BODIES[:1], contacts=[turning]), 0.2)
    assert event_units(result) == {"c": ("N.m.s", "rad/s")}


def test_friction_has_the_unit_of_what_slides():
    friction = LuGreFriction(coefficient=0.4, static_coefficient=0.6, stribeck_speed=0.5, bristle_stiffness=0.3,
                             bristle_damping=0.2, viscous_damping=0.1)  # fmt: skip
    law = KelvinVoigt(stiffness=1e3, damping=0.0)
    brake = contact(term("a", "x"), law=law, friction=friction, slide=(term("a", "angle"),))
    found = units(Model(bodies=BODIES, contacts=[brake]))
    assert {name: found[f"c.{name}"] for name in ("gap", "normal_force")} == {"gap": "m", "normal_force": "N"}
    turning = {name: found[f"c.{name}"] for name in ("friction_force", "sliding_velocity", "bristle")}
    assert turning == {"friction_force": "N.m", "sliding_velocity": "rad/s", "bristle": "rad"}


def test_declared_units_that_do_not_add_up_are_refused():
    with pytest.raises(ModelError, match=r"gap of contact 'c' adds terms in different units.*'m/rad'"):
        Model(bodies=BODIES, contacts=[contact(term("a", "angle", -0.1, "1"), term("b", "x"))])
    with pytest.raises(ModelError, match=r"unit 'furlong' of the factor of 'a\.x' is not understood"):
        term("a", "x", 1.0, "furlong")


def test_torque_of_an_angular_stop_is_a_torque():
    """A rod that a stop of K N m/rad holds: its torque is K times the angle, its impulse the change of spin."""
    stop = contact(term("a", "angle", -1.0), law=KelvinVoigt(stiffness=50.0, damping=0.0))
    pin = Revolute2D(name="pin", a=GROUND, b=on("a"))
    result = simulate(Model(bodies=BODIES[:1], joints=[pin], contacts=[stop]), 0.4, rtol=1e-8)
    (opened,) = [event for event in result.events if event.kind == "open"]
    assert opened.impulse == pytest.approx(2.0 * 0.1 * 2.0, rel=1e-5)
    assert np.max(result["c.normal_force"]) == pytest.approx(2.0 * np.sqrt(50.0 * 0.1), rel=1e-3)


@pytest.mark.parametrize(
    "first, second, expected",
    [("m/rad", "rad", "m"), ("1", "mm", "mm"), ("N.m/rad", "rad/m", "N"), ("m", "m/s", "m2/s"), ("x", "m", None),
     ("mm", "m", None)],
)  # fmt: skip
def test_product_of_units(first, second, expected):
    assert product(first, second) == expected


@pytest.mark.parametrize("unit", ["m", "rad", "mm", "deg", "m2", "1"])
def test_force_times_gap_is_energy(unit):
    """Units of force, rate and impulse are understood, and force times gap is J (a radian counts as 1 in a torque)."""
    gap, force = parse_unit(unit), parse_unit(conjugate(unit))
    powers = {b: gap.exponents.get(b, 0) + force.exponents.get(b, 0) for b in ("kg", "m", "s")}
    assert powers == {"kg": 1, "m": 2, "s": -2} and gap.factor * force.factor == pytest.approx(1.0)
    assert parse_unit(per_second(unit)).exponents.get("s") == -1
    assert parse_unit(times_second(conjugate(unit))).exponents["s"] == -1
