"""Gear2D against closed forms: reduced inertia, tooth and pin forces, planetary trains that go round many times."""

import math

import numpy as np
import pytest
from helpers import GROUND, on
from tlismni.core import AppliedTorque2D, Constant, Gear2D, Model, ModelError, Revolute2D, RigidBody2D, simulate

LEVELS = ("residual.position", "residual.velocity", "residual.acceleration")


def wheel(name, inertia, x=0.0, mass=2.0, **more):
    return RigidBody2D(name=name, mass=mass, inertia=inertia, position=(x, 0.0), **more)


def pin(body, x=0.0, to="ground"):
    return Revolute2D(name=f"pin_{body}", a=on(to, x, 0.0), b=on(body))


def pair(radius_a, radius_b, torque=3.0, angles=(0.0, 0.0)):
    """Two wheels on pins in the ground; the torque drives the first one."""
    apart = abs(radius_a + radius_b)
    return Model(
        gravity=(0.0, 0.0),
        bodies=[wheel("a", 0.4, angle=angles[0]), wheel("b", 0.9, apart, angle=angles[1])],
        joints=[
            pin("a"), pin("b", apart), Gear2D(name="gear", a=on("a"), b=on("b"), radius_a=radius_a, radius_b=radius_b)
        ],
        forces=[AppliedTorque2D(name="drive", body="a", torque=Constant(value=torque))],
    )  # fmt: skip


def check_sound(result):
    """Constraints hold at all levels, and nothing is lost."""
    for level in LEVELS:
        assert np.abs(result[level]).max() < 1e-8
    assert np.abs(result["energy.balance"]).max() < 1e-7 * max(np.abs(result["energy.kinetic"]).max(), 1.0)


# outer teeth, inner teeth of either wheel; angles of several turns at the start change nothing
@pytest.mark.parametrize("radii", [(0.3, 0.5), (0.2, -0.7), (-0.9, 0.25)])
@pytest.mark.parametrize("angles", [(0.0, 0.0), (40.0, -3.5)])
def test_torque_on_a_pair_turns_its_reduced_inertia(radii, angles):
    ra, rb = radii
    result = simulate(pair(ra, rb, angles=angles), 2.0, rtol=1e-9, atol=1e-11)
    ratio = -ra / rb
    growth = 3.0 / (0.4 + ratio**2 * 0.9)
    t = result.t
    assert result["a.angle"] - angles[0] == pytest.approx(0.5 * growth * t**2, abs=1e-8)
    assert result["b.angle"] - angles[1] == pytest.approx(0.5 * ratio * growth * t**2, abs=1e-8)
    # each wheel alone: J alpha = torque - radius x tooth force
    tooth = result["gear.tooth_force"]
    assert 3.0 - ra * tooth == pytest.approx(np.full_like(t, 0.4 * growth), rel=1e-8)
    assert -rb * tooth == pytest.approx(np.full_like(t, 0.9 * ratio * growth), rel=1e-8)
    # the centres stand still, so the pins take the force between the teeth
    assert np.hypot(result["pin_b.force_x"], result["pin_b.force_y"]) == pytest.approx(np.abs(tooth), rel=1e-8)
    assert result["pin_a.force_y"] == pytest.approx(-result["pin_b.force_y"], rel=1e-8)
    check_sound(result)


def planetary(sun_torque, sun=0.2, planet=0.15):
    """Sun, carrier and planet in a ring that is fixed."""
    ring, arm = sun + 2.0 * planet, sun + planet
    return Model(
        gravity=(0.0, 0.0),
        bodies=[wheel("sun", 0.1), wheel("carrier", 0.3), wheel("planet", 0.02, arm, mass=1.5)],
        joints=[
            pin("sun"), pin("carrier"), pin("planet", arm, to="carrier"),
            Gear2D(name="inner", a=on("sun"), b=on("planet"), radius_a=sun, radius_b=planet),
            Gear2D(name="outer", a=GROUND, b=on("planet"), radius_a=-ring, radius_b=planet),
        ],
        forces=[AppliedTorque2D(name="drive", body="sun", torque=Constant(value=sun_torque))],
    )  # fmt: skip


def test_planetary_train_has_willis_ratio_through_many_turns():
    sun, planet = 0.2, 0.15
    result = simulate(planetary(1.0, sun, planet), 20.0, rtol=1e-9, atol=1e-10)
    arm = sun + planet
    carrier = result["carrier.angle"]
    assert carrier[-1] > 4.0 * 2.0 * math.pi
    assert result["sun.angle"] == pytest.approx(2.0 * arm / sun * carrier, abs=1e-7)
    assert result["planet.angle"] == pytest.approx(-arm / planet * carrier, abs=1e-7)
    # kinetic energy in the sun's speed: the carrier turns sun/(2 arm) as fast, the planet sun/(2 planet)
    at_sun = 0.1 + (0.3 + 1.5 * arm**2) * (sun / (2.0 * arm)) ** 2 + 0.02 * (sun / (2.0 * planet)) ** 2
    assert result["sun.angle"] == pytest.approx(0.5 / at_sun * result.t**2, abs=1e-6)
    check_sound(result)


def test_weight_of_a_planet_drives_the_train():
    """A planet that rolls on a fixed sun: a pendulum with the reduced inertia (m + J/r^2) L^2, once over the top."""
    arm, radius, mass, inertia = 0.5, 0.2, 2.0, 0.05
    model = Model(
        bodies=[
            wheel("carrier", 1e-3, mass=1e-3, angular_velocity=0.1 / arm),
            RigidBody2D(name="planet", mass=mass, inertia=inertia, position=(0.0, arm), velocity=(-0.1, 0.0),
                        angular_velocity=0.1 / radius),
        ],
        joints=[
            pin("carrier"), Revolute2D(name="pin_planet", a=on("carrier", 0.0, arm), b=on("planet")),
            Gear2D(name="gear", a=GROUND, b=on("planet"), radius_a=arm - radius, radius_b=radius),
        ],
    )  # fmt: skip
    result = simulate(model, 6.0, rtol=1e-10, atol=1e-12)
    turned = result["carrier.angle"]
    assert abs(turned[-1]) > 2.0 * math.pi
    inertia_at_pin = 1e-3 + (mass + inertia / radius**2) * arm**2
    speed = 0.1 / arm
    drop = mass * 9.81 * arm * (1.0 - np.cos(turned))
    rate = result["carrier.angular_velocity"]
    assert 0.5 * inertia_at_pin * rate**2 == pytest.approx(0.5 * inertia_at_pin * speed**2 + drop, abs=1e-6)
    check_sound(result)


@pytest.mark.parametrize("radii", [(0.0, 1.0), (0.5, -0.5), (-1.0, -0.5)])
def test_radii_that_make_no_pair_are_refused(radii):
    with pytest.raises(ModelError, match="no gear pair"):
        pair(*radii)


def test_gears_that_do_not_meet_are_refused():
    model = Model(
        bodies=[wheel("a", 1.0), wheel("b", 1.0, 1.0)],
        joints=[Gear2D(name="gear", a=on("a"), b=on("b"), radius_a=0.3, radius_b=0.5)],
    )
    with pytest.raises(ModelError, match=r"start 1 m apart.*need 0.8 m"):
        simulate(model, 0.1)
    with pytest.raises(ModelError, match="both wheels are on 'a'"):
        Gear2D(name="gear", a=on("a"), b=on("a", 1.0), radius_a=0.3, radius_b=0.7)
