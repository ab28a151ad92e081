"""The motion does not depend on units: mechanisms of a nanometre and of a thousand kilometres, in ms and in ns."""

import math

import numpy as np
import pytest
from helpers import ball_over_floor, floor_contact, on, rod_pendulum
from linkages import three_cranks
from tlismni.core import (
    CoordinateDriver,
    Disk2D,
    DiskOnLine2D,
    EquationSystem,
    GapContact,
    Gonthier,
    Hertz,
    HuntCrossley,
    KelvinVoigt,
    Line2D,
    LuGreFriction,
    Marker2D,
    Model,
    NewtonImpact,
    OfScales,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    Simulation,
    Sine,
    TanhFriction,
    simulate,
)
from tlismni.models import load
from units import Units

# as numbers in m, kg, s: what is small here is small to the solver
UNITS = {
    "mm": Units(length=1e3),
    "um": Units(length=1e6),
    "a nanometre": Units(length=1e-9),
    "a nanometre, a femtogram": Units(length=1e-9, mass=1e-18),
    "a nanometre in ns": Units(length=1e-9, time=1e-9),
    "ms": Units(time=1e3),
    "us": Units(time=1e6),
    "a thousand kilometres": Units(length=1e6),
}
# multiplying by a power of two is exact: there not even rounding differs (roots need an even power)
POWERS = {
    "length": Units(length=2.0**-30),
    "large": Units(length=2.0**20),
    "time": Units(time=2.0**-20),
    "all": Units(length=2.0**-30, mass=2.0**-70, time=2.0**10),
}


def striking(law, friction=None, speed=(0.3, -1.0)):
    """A ball thrown at a floor."""
    ball = PointMass2D(name="ball", mass=0.5, position=(0.0, 0.2), velocity=speed)
    contact = floor_contact(law).model_copy(update={"friction": friction})
    return Model(bodies=[ball], contacts=[contact])


def driven_pendulum():
    """A pendulum on a cart that is driven to and fro, with a stop."""
    cart = RigidBody2D(name="cart", mass=1.0, inertia=0.1)
    bob = RigidBody2D(name="bob", mass=0.3, inertia=0.01, position=(0.0, -0.4))
    motion = Sine(amplitude=0.1, angular_frequency=4.0, phase=-0.5 * math.pi, offset=0.1)
    still = Sine(amplitude=0.0, angular_frequency=1.0)
    drivers = [
        CoordinateDriver(name=f"drive_{name}", body="cart", coordinate=name, motion=motion if name == "x" else still)
        for name in ("x", "y", "angle")
    ]
    pin = Revolute2D(name="pin", a=on("cart"), b=on("bob", 0.0, 0.4))
    stop = floor_contact(NewtonImpact(restitution=0.6), body="bob", name="stop", radius=0.02, height=-0.43)
    return Model(bodies=[cart, bob], joints=[*drivers, pin], contacts=[stop])


def twice_pinned():
    """A rod with its pin given twice, from a hair's breadth beside its rest."""
    again = Revolute2D(name="again", a=Marker2D(), b=on("rod", -0.5))
    return rod_pendulum(0.3, joints=[again])


OWN = {
    "Hertz": (striking(Hertz(stiffness=1e5)), 0.6),
    "Kelvin and Voigt": (striking(KelvinVoigt(stiffness=2e4, damping=20.0)), 0.6),
    "Hunt and Crossley": (striking(HuntCrossley(stiffness=1e5, restitution=0.7)), 0.6),
    "Gonthier": (
        striking(Gonthier(stiffness=1e5, restitution=0.4), TanhFriction(coefficient=0.3, transition_speed=0.01)),
        0.6,
    ),
    "laid down": (striking(HuntCrossley(stiffness=1e4, restitution=0.5), speed=(0.1, 0.0)), 0.8),
    "bristles": (
        striking(
            KelvinVoigt(stiffness=1e4, damping=30.0),
            LuGreFriction(coefficient=0.3, stribeck_speed=0.01, bristle_stiffness=1e4, bristle_damping=10.0),
        ),
        0.6,
    ),
    "driven": (driven_pendulum(), 1.5),
    "redundant": (three_cranks(1.0, -1.0), 0.8),
    "redundant pin": (twice_pinned(), 1.0),
    "bounces to rest": (ball_over_floor(NewtonImpact(restitution=0.5)), 3.0),
}  # fmt: skip
SCENARIOS = {
    "bouncing_ball": 5.0, "pendulum_stop": 2.5, "rocking_block": 2.0, "slider_crank_stop": 1.5, "stick_slip": 2.8,
    "double_pendulum_wall": 1.2, "impact_oscillator": 5.0, "newtons_cradle": 0.8, "woodpecker": 0.3,
}  # fmt: skip
LONG = {"four_bar": 2.0, "sphere_beam": 0.0013, "hub_beam_stop": 0.05, "cable_ground": 0.3, "rod_wall": 0.0006}


def model_of(name):
    """(model, end) of a case."""
    if name in OWN:
        return OWN[name]
    return load(name).model, {**SCENARIOS, **LONG}[name]


def run(system, end, units, **options):
    """Result at 21 times; scales of the coordinates."""
    times = np.linspace(0.0, end, 21) * units.time
    steps = {"step": options.pop("step") * units.time} if "step" in options else {}
    result = simulate(system, times[-1], t_eval=times, max_steps=100_000, **steps, **options)
    return result, system.assemble().coordinate_scale


def blows(result):
    """Events that are not of rounding: contacts that keep touching may open and close at an instant."""
    strongest = max((event.impulse for event in result.events), default=0.0)
    found = [e for e in result.events if e.kind in ("stick", "slip", "rest") or e.impulse > 1e-6 * strongest]
    return sorted(found, key=lambda e: e.contact)  # those of one instant in any order


def compare(name, units, within=1e-5, method="ebdf", **options):
    """The same motion and the same events in other units, to `within`."""
    model, end = model_of(name)
    plain, scale = run(model, end, Units(), method=method, **options)
    other, scaled = run(units.model(model), end, units, method=method, **options)
    assert np.ptp(plain.q, axis=0).max() > 0.0
    own = ~model.assemble().is_internal
    size = np.maximum(np.abs(plain.q).max(axis=0), 1e-3 * scale)
    assert (np.abs(other.q / (scaled / scale) - plain.q) / size)[:, own].max() < within
    rates = np.maximum(np.abs(plain.v).max(axis=0), 1e-3 * np.abs(plain.v / scale)[:, own].max() * scale)
    assert (np.abs(other.v / (scaled / scale) * units.time - plain.v) / rates)[:, own].max() < 100.0 * within
    here, there = (blows(result) for result in (other, plain))
    kinds = [[(e.contact, "impact" if e.kind == "graze" else e.kind) for e in found] for found in (here, there)]
    assert kinds[0] == kinds[1]
    impulse = units.factor((1, 1, -1))
    strongest = max((event.impulse for event in there), default=0.0)
    for a, b in zip(here, there, strict=True):
        assert a.t / units.time == pytest.approx(b.t, abs=within * end)
        assert a.impulse / impulse == pytest.approx(b.impulse, abs=100.0 * within * strongest)


@pytest.mark.parametrize("units", [UNITS[name] for name in ("a nanometre, a femtogram", "us")], ids=("nm", "us"))
@pytest.mark.parametrize("name", [*OWN, *SCENARIOS])
def test_same_motion_and_events(name, units):
    compare(name, units)


@pytest.mark.full
@pytest.mark.parametrize("units", UNITS.values(), ids=UNITS)
@pytest.mark.parametrize("name", [*OWN, *SCENARIOS, *LONG])
def test_same_motion_and_events_in_all_units(name, units):
    # a step past a singular position costs the four-bar linkage digits
    compare(name, units, 1e-3 if name == "four_bar" else 1e-5)


@pytest.mark.parametrize("method", ["irk", "hht", "bdf", "adams", "hht_i3", "generalized_alpha"])
@pytest.mark.parametrize("name", ["pendulum_stop", "slider_crank_stop", "bounces to rest", "Hunt and Crossley"])
def test_same_motion_by_all_methods(name, method):
    compare(name, Units(length=2.0**-30), 1e-4, method)


@pytest.mark.parametrize("units", POWERS.values(), ids=POWERS)
@pytest.mark.parametrize("name", ["bounces to rest", "rocking_block", "slider_crank_stop", "newtons_cradle", "driven"])
def test_powers_of_two_do_not_even_change_rounding(name, units):
    model, end = model_of(name)
    plain, scale = run(model, end, Units())
    other, scaled = run(units.model(model), end, units)
    assert np.array_equal(other.q, plain.q * (scaled / scale))
    assert np.array_equal(other.v, plain.v * (scaled / scale) / units.time)
    assert other.stats["steps"] == plain.stats["steps"]
    assert [(e.kind, e.contact, e.t) for e in other.events] == [
        (e.kind, e.contact, e.t * units.time) for e in plain.events
    ]
    impulse = units.factor((1, 1, -1))
    assert [event.impulse for event in other.events] == [event.impulse * impulse for event in plain.events]


@pytest.mark.parametrize("step", [1e-3])
@pytest.mark.parametrize("name", ["pendulum_stop", "bounces to rest"])
def test_fixed_steps_too(name, step):
    compare(name, UNITS["a nanometre"], method="hht", step=step)


def swinging_point(units, law, told):
    """A point on a circle in equations of its own, with a floor. `told`: the scale of its coordinates is given."""
    length, mass, gravity = (units.factor(d) for d in ((1, 0, 0), (0, 1, 0), (1, 0, -2)))
    weight = np.array([0.0, -9.81 * gravity * mass])
    return EquationSystem(
        mass=mass * np.eye(2),
        force=lambda t, q, v: weight,
        constraint=lambda t, q: q[0] ** 2 + q[1] ** 2 - length**2,
        q0=[length, 0.0],
        v0=[0.0, 0.0],
        contacts=[GapContact("floor", lambda t, q: q[1] + 0.5 * length, law)],
        scale=[length, length] if told else None,
    )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("units, told", [(UNITS["a nanometre"], False), (UNITS["ms"], True)], ids=("nm", "ms"))
def test_own_equations(units, told):
    for law in (NewtonImpact(restitution=0.5), KelvinVoigt(stiffness=2e3, damping=5.0)):
        same = law
        if isinstance(law, KelvinVoigt):
            stiffness, damping = (units.factor((0, 1, -power)) for power in (2, 1))
            same = KelvinVoigt(stiffness=law.stiffness * stiffness, damping=law.damping * damping)
        plain, _ = run(swinging_point(Units(), law, told), 0.5, Units())
        other, _ = run(swinging_point(units, same, told), 0.5, units)
        assert len(plain.events) >= 1
        assert np.abs(other.q / units.length - plain.q).max() < 1e-5
        assert [e.kind for e in other.events] == [e.kind for e in plain.events]
        for a, b in zip(other.events, plain.events, strict=True):
            assert a.t / units.time == pytest.approx(b.t, abs=1e-6)


def test_scales_follow_the_units():
    """Lengths, times and energies of the record go with the units; a turn of the frame changes them by a little."""
    model = load("pendulum_stop").model
    plain = Simulation(model).scales
    for units in UNITS.values():
        found = Simulation(units.model(model)).scales
        assert found.length == pytest.approx(plain.length * units.length, rel=1e-12)
        assert found.time == pytest.approx(plain.time * units.time, rel=1e-12)
        assert found.energy == pytest.approx(plain.energy * units.factor((2, 1, -2)), rel=1e-12)


@pytest.mark.parametrize("atol", [1e-6, 1e-9, {"length": 1e-6}])
def test_given_tolerances_are_absolute(atol):
    """A number, or one of a mapping by kind, counts in the units of q and v as it stands, be it that of the default,
    which goes by the scales, as a part of them does that is given."""
    model = load("pendulum_stop").model
    for length in (1e-9, 1.0):
        scaled = Units(length=length).model(model)
        weights = Simulation(scaled, "ebdf", rtol=1e-8, atol=atol).workspace.arrays["atol_q"]
        assert math.isclose(weights[0], atol["length"] if isinstance(atol, dict) else atol)
        for part, options in ((1e-9, {}), (1e-6, {"atol": OfScales(1e-6)}), (1e-7, {"atol": 100.0 * OfScales(1e-9)})):
            sim = Simulation(scaled, "ebdf", rtol=1e-8, **options)
            assert math.isclose(sim.workspace.arrays["atol_q"][0], part * sim.assembly.coordinate_scale[0])


def test_a_road_that_goes_on_makes_no_wheel_larger():
    wheel = RigidBody2D(name="wheel", mass=2.0, inertia=0.1, position=(0.1, 0.6))

    def length(*road):
        nodes = tuple(Marker2D(point=(x, 0.0)) for x in road)
        disk = Disk2D(marker=on("wheel"), radius=0.25)
        contact = DiskOnLine2D(name="c", line=Line2D(nodes=nodes), disk=disk, law=NewtonImpact(restitution=0.5))
        return Simulation(Model(bodies=[wheel], contacts=[contact])).scales.length

    assert length(-0.3, 1.0) == length(-0.3, 1.0, 1e3) == 0.6
