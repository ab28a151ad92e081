"""Where the laws of contact end: energy that an impact law creates, Painleve's paradox, contacts that cannot move."""

import logging
import math

import numpy as np
import pytest
from helpers import GROUND, G, events, on
from sliders import PLASTIC, foot
from tlismni.core import (
    CoordinateDriver,
    Disk2D,
    DiskOnDisk2D,
    Model,
    NewtonImpact,
    PointMass2D,
    PoissonImpact,
    Polynomial,
    RigidBody2D,
    Simulation,
    SimulationError,
    TanhFriction,
    simulate,
)
from tlismni.core.contacts.contact2d import DiskOnHalfPlane2D, HalfPlane2D
from tlismni.core.laws import Hertz


def rod(angle, velocity=(0.0, 0.0), rate=0.0, mu=0.4, law=PLASTIC, name="tip", gravity=G, contact=None):
    """A rod of length 2 and mass 1 whose lower end is at the origin, at `angle` from the floor."""
    c, s = math.cos(angle), math.sin(angle)
    body = RigidBody2D(
        name="rod", mass=1.0, inertia=1.0 / 3.0, position=(c, s), angle=angle, velocity=velocity, angular_velocity=rate
    )
    return Model(gravity=(0.0, -gravity), bodies=[body], contacts=[contact or foot(name, "rod", -1.0, mu=mu, law=law)])


def sliding_rod(angle, speed, rate=0.0, mu=0.4, **parts):
    """The same, its lower end sliding along the floor with `speed`."""
    c, s = math.cos(angle), math.sin(angle)
    return rod(angle, (speed - rate * s, rate * c), rate, mu, **parts)


def critical(angle):
    """Smallest mu at which the friction of a tip that slides towards its foot lifts no more: A_nn = mu |A_nt| with
    A_nn = 1 + 3 cos^2, A_nt = 3 sin cos (m = l = 1, J = 1/3)."""
    c, s = math.cos(angle), math.sin(angle)
    return (1.0 + 3.0 * c * c) / (3.0 * s * c)


# ---- energy ---------------------------------------------------------------------------------------------------------

KANE = {"angle": 0.84, "velocity": (0.13, -0.61), "rate": 0.89, "mu": 0.45}


def kinetic(v):
    return 0.5 * (v[0] ** 2 + v[1] ** 2 + v[2] ** 2 / 3.0)


def test_newtons_law_with_friction_may_create_energy_and_says_so(caplog):
    """A slanting rod strikes with its tip (after Kane and Levinson 1985): friction turns the sliding round, and e is
    asked of the normal velocity alone."""
    with caplog.at_level(logging.WARNING, logger="tlismni"):
        result = simulate(rod(law=NewtonImpact(restitution=0.95), **KANE), 1e-6)
    (hit,) = events(result, "impact")
    before = kinetic((*KANE["velocity"], KANE["rate"]))
    gain = kinetic(result.v[-1]) - before
    assert gain > 0.2 * before
    assert hit.energy_loss == pytest.approx(-gain, rel=1e-4)
    assert hit.separation_speed == pytest.approx(0.95 * hit.approach_speed, rel=1e-12)
    (said,) = [record.getMessage() for record in caplog.records if "raises the energy" in record.getMessage()]
    assert "'tip' (NewtonImpact)" in said and "PoissonImpact" in said
    assert f"{gain:.2g}"[:3] in said
    assert np.abs(result["energy.balance"]).max() < 1e-12


def test_poissons_law_creates_none_in_the_same_impact(caplog):
    with caplog.at_level(logging.WARNING, logger="tlismni"):
        result = simulate(rod(law=PoissonImpact(restitution=0.95), **KANE), 1e-6)
    (hit,) = events(result, "impact")
    assert hit.energy_loss > 0.0
    assert not caplog.records


@pytest.mark.sampled(1)
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_poissons_law_never_gains_over_random_blows_of_a_rod(e):
    rng = np.random.default_rng(3)
    for _ in range(60):
        angle, mu = rng.uniform(0.1, 1.5), rng.uniform(0.0, 1.5)
        velocity, rate = (rng.normal(), -abs(rng.normal())), rng.normal()
        if velocity[1] - rate * math.cos(angle) > -1e-3:
            continue
        sim = Simulation(rod(angle, velocity, rate, mu, PoissonImpact(restitution=e), gravity=0.0))
        (hit,) = [event for event in sim.events if event.kind == "impact"]
        assert hit.energy_loss >= -1e-12
        assert abs(hit.friction_impulse) <= mu * hit.impulse * (1.0 + 1e-9)


def test_newtons_law_without_friction_never_warns(caplog):
    with caplog.at_level(logging.WARNING, logger="tlismni"):
        result = simulate(rod(**{**KANE, "mu": None}, law=NewtonImpact(restitution=0.95)), 1e-6)
    assert events(result, "impact")[0].energy_loss > 0.0
    assert not caplog.records


# ---- Painleve -------------------------------------------------------------------------------------------------------


def test_the_critical_coefficient_is_four_thirds():
    angles = np.linspace(0.01, 1.56, 4000)
    assert min(critical(a) for a in angles) == pytest.approx(4.0 / 3.0, rel=1e-6)
    assert critical(math.atan(2.0)) == pytest.approx(4.0 / 3.0, rel=1e-14)


@pytest.mark.parametrize("angle", [0.7, 1.1, 1.4])
def test_sliding_rod_beyond_the_critical_coefficient_is_refused_at_the_start(angle):
    with pytest.raises(SimulationError, match=r"'tip', t = 0 s: Painleve's paradox.*mu = .*smaller.*regularised"):
        simulate(sliding_rod(angle, -5.0, mu=critical(angle) + 1e-3), 0.1)
    # below it, and sliding away from its foot, it moves
    simulate(sliding_rod(angle, -5.0, mu=critical(angle) - 1e-2), 1e-3)
    result = simulate(sliding_rod(angle, 5.0, mu=critical(angle) + 1.0), 1e-2)
    assert result.events[0].kind == "close"


@pytest.mark.parametrize("below", [1e-7, 1e-12])
def test_sliding_rod_just_below_the_critical_coefficient_is_refused_by_name(below):
    """Forces exist, but are the weight divided by what rounding may have left: 3.6e7 N for 1 kg at 1e-7."""
    with pytest.raises(SimulationError, match=r"'tip', t = 0 s: Painleve's paradox"):
        simulate(sliding_rod(0.7, -5.0, mu=critical(0.7) * (1.0 - below)), 1e-3)


@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
def test_sliding_rod_that_turns_into_the_critical_angle_is_stopped_by_name(method):
    """Raised by its rate, it reaches the angle at which mu = 1.6 is critical while it still slides: N grows without
    bound (dynamic jamming; Genot and Brogliato 1999)."""
    with pytest.raises(SimulationError, match=r"'tip'.*Painleve's paradox.*mu = 1\.6") as caught:
        simulate(sliding_rod(0.6, -10.0, 1.0, 1.6), 2.0, method, rtol=1e-8)
    assert caught.value.loop == "contact"
    partial = caught.value.partial
    assert critical(partial["rod.angle"][-1]) == pytest.approx(1.6, rel=1e-2)
    assert partial["tip.normal_force"].max() > 10.0 * partial["tip.normal_force"][1]
    assert partial["tip.friction_force"][-1] == pytest.approx(1.6 * partial["tip.normal_force"][-1], rel=1e-9)


def test_a_force_law_with_regularised_friction_goes_through():
    """What the message recommends."""
    depth = (0.25 * G / 1e7) ** (2.0 / 3.0)
    contact = DiskOnHalfPlane2D(
        name="tip", plane=HalfPlane2D(), disk=Disk2D(marker=on("rod", -1.0)), law=Hertz(stiffness=1e7),
        friction=TanhFriction(coefficient=1.6, transition_speed=1e-3),
    )  # fmt: skip
    model = sliding_rod(0.6, -10.0, 1.0, contact=contact)
    body = model.bodies[0].model_copy(update={"position": (math.cos(0.6), math.sin(0.6) - depth)})
    result = simulate(model.model_copy(update={"bodies": (body,)}), 0.3, rtol=1e-7)
    assert result["rod.angle"][-1] > 1.0
    assert np.all(result["tip.friction_force"] * result["tip.sliding_velocity"] <= 0.0)
    assert np.abs(result["energy.balance"]).max() < 1e-4


def test_a_rod_that_lands_in_the_critical_region_sticks_or_bounces():
    """An impact has a solution there: the frictional impulse stops the tip."""
    angle = 1.1
    model = rod(angle, (-1.0, -0.5), 0.0, mu=2.0, law=PoissonImpact(restitution=0.0))
    result = simulate(model, 1e-3)
    assert events(result, "impact")[0].energy_loss > 0.0
    assert result["tip.sliding_velocity"][-1] == pytest.approx(0.0, abs=0.05)


# ---- nothing can move -----------------------------------------------------------------------------------------------


def test_a_driven_body_that_runs_into_the_floor_is_refused_by_name():
    body = RigidBody2D(name="ram", mass=1.0, inertia=1.0, position=(0.0, 0.5), velocity=(0.0, -1.0))
    drive = [
        CoordinateDriver(name="down", body="ram", coordinate="y", motion=Polynomial(coefficients=(0.5, -1.0))),
        *(
            CoordinateDriver(name=name, body="ram", coordinate=name, motion=Polynomial(coefficients=(0.0,)))
            for name in ("x", "angle")
        ),
    ]
    for mu in (None, 0.3):
        model = Model(bodies=[body], joints=drive, contacts=[foot("bed", "ram", mu=mu)])
        with pytest.raises(SimulationError, match=r"'bed', t = 0\.5 s.*hold both shapes.*force instead") as caught:
            simulate(model, 1.0)
        assert caught.value.loop == "impact" and caught.value.partial.t[-1] == pytest.approx(0.5)


def test_a_contact_between_two_held_bodies_that_only_touch_does_no_harm():
    """Driven along each other at a distance of zero there is nothing to resolve until they approach."""
    body = RigidBody2D(name="b", mass=1.0, inertia=1.0, position=(2.0, 0.0))
    hold = [
        CoordinateDriver(name=name, body="b", coordinate=name, motion=Polynomial(coefficients=(x,)))
        for name, x in (("x", 2.0), ("y", 0.0), ("angle", 0.0))
    ]
    ball = PointMass2D(name="ball", mass=1.0, position=(0.0, 5.0))
    apart = DiskOnDisk2D(
        name="c", a=Disk2D(marker=GROUND, radius=0.5), b=Disk2D(marker=on("b"), radius=0.5), law=PLASTIC
    )
    result = simulate(Model(bodies=[body, ball], joints=hold, contacts=[apart]), 0.5)
    assert not result.events
