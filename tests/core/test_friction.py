"""Coulomb friction of one contact against closed forms: sliding, rolling, sticking, and the times of the changes."""

import math

import numpy as np
import pytest
from helpers import G, events
from scipy.optimize import brentq
from sliders import Belt, foot, kinds, roller, slider
from tlismni.core import Constant, HalfPlane2D, Marker2D, Model, NewtonImpact, Ramp, RigidBody2D, Sine, simulate

MU = 0.3


def balanced(result, tolerance=1e-12):
    """The ledger holds, relative to the energies in play."""
    level = max(1e-3, *(np.abs(result[f"energy.{name}"]).max() for name in ("kinetic", "potential", "dissipation")))
    return np.abs(result["energy.balance"]).max() < tolerance * level


# ---- sliding to rest ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [1.5, -1.5, 1e-3, 40.0])
def test_sliding_block_comes_to_rest(speed):
    stop, way = abs(speed) / (MU * G), 0.5 * speed * abs(speed) / (MU * G)
    result = simulate(slider(speed), 2.0 * stop, rtol=1e-9)
    assert kinds(result) == [("close", "c"), ("stick", "c")]
    assert result.events[1].t == pytest.approx(stop, abs=1e-9)
    slides, late = (result.t > 0.0) & (result.t < result.events[1].t), result.t > result.events[1].t
    # free of curvature, steps grow fivefold one after the other, and with them what rounding has left in the older rows
    assert result["b.x"][late] == pytest.approx(way, rel=1e-12 if abs(speed) < 10.0 else 4e-12)
    assert np.abs(result["b.vx"][late]).max() < 1e-14 * abs(speed)
    assert np.abs(result["c.sliding_velocity"][late]).max() < 1e-14 * abs(speed)
    assert result["c.friction_force"][slides] == pytest.approx(-math.copysign(MU * 2.0 * G, speed), rel=1e-12)
    assert np.abs(result["c.friction_force"][-1]) < 1e-12
    # friction takes all of the kinetic energy
    assert result["c.dissipation"][-1] == pytest.approx(speed**2, rel=1e-10)
    assert balanced(result)


def test_block_without_friction_never_stops():
    result = simulate(slider(1.5, mu=0.0), 1.0)
    assert kinds(result) == [("close", "c")]
    assert result["b.vx"][-1] == pytest.approx(1.5, rel=1e-14)


@pytest.mark.parametrize("factor", [0.5, 0.4, 1.0])
@pytest.mark.parametrize("speed, rate", [(1.5, 0.0), (0.0, 30.0), (1.5, 25.0), (1.5, -40.0), (-1.0, -5.0)])
def test_sliding_disk_begins_to_roll(factor, speed, rate):
    """v' = -mu g s, R w' = -mu g s/factor: the point of contact stops at |v + R w|/(mu g (1 + 1/factor)); a disk
    (1/2) rolls with 2/3 of its speed, a sphere (2/5) with 5/7; enough back-spin brings it back."""
    radius = 0.1
    slip = speed + radius * rate
    start = abs(slip) / (MU * G * (1.0 + 1.0 / factor))
    final = speed - math.copysign(MU * G * start, slip)
    result = simulate(roller(speed, rate, factor), 2.0 * start, rtol=1e-9)
    assert kinds(result) == [("close", "c"), ("stick", "c")]
    assert result.events[1].t == pytest.approx(start, abs=1e-9)
    late = result.t > result.events[1].t
    assert result["b.vx"][late] == pytest.approx(final, abs=1e-12)
    assert result["b.angular_velocity"][late] == pytest.approx(-final / radius, abs=1e-11)
    assert balanced(result)


def test_disk_with_spin_that_bounces():
    """Each impact takes at most mu P along the floor; the spin feeds the motion along it until it rolls."""
    e, radius, mass, rate = 0.5, 0.1, 2.0, 60.0
    result = simulate(roller(0.0, rate, 0.5, height=0.5, law=NewtonImpact(restitution=e)), 1.0, rtol=1e-9)
    first, second = events(result, "impact")[:2]
    impulse = mass * (1.0 + e) * math.sqrt(2.0 * G * 0.5)
    assert first.impulse == pytest.approx(impulse, rel=1e-9)
    # it would take m R w/3 to roll: more than mu P
    assert MU * impulse < mass * radius * rate / 3.0
    assert first.friction_impulse == pytest.approx(-MU * impulse, rel=1e-9)
    left = radius * rate - 3.0 * MU * impulse / mass
    assert second.friction_impulse == pytest.approx(-min(MU * e * impulse, mass * left / 3.0), rel=1e-8)
    slip = radius * rate
    gone = 0.5 * mass * (1.0 - e**2) * 2.0 * G * 0.5 + MU * impulse * 0.5 * (slip + left)
    assert first.energy_loss == pytest.approx(gone, rel=1e-9)
    assert balanced(result)


# ---- slopes ---------------------------------------------------------------------------------------------------------


def slope_block(angle, mu, static, feet, speed=0.0):
    """A point on a slope, or a block on several feet."""
    c, s, height = math.cos(angle), math.sin(angle), 0.05
    plane = HalfPlane2D(marker=Marker2D(angle=angle))
    if feet == 1:
        return slider(speed, mu, static, angle=angle)
    body = RigidBody2D(
        name="b",
        mass=2.0,
        inertia=0.01,
        position=(-height * s, height * c),
        angle=angle,
        velocity=(speed * c, speed * s),
    )
    contacts = [
        foot(f"c{i}", "b", x, -height, mu, static, plane=plane) for i, x in enumerate(np.linspace(-0.1, 0.1, feet))
    ]
    return Model(bodies=[body], contacts=contacts)


def along(result, angle):
    x, y = result["b.x"] - result["b.x"][0], result["b.y"] - result["b.y"][0]
    return math.cos(angle) * x + math.sin(angle) * y


@pytest.mark.parametrize("feet", [1, 2, 3])
def test_block_on_a_slope_stays_below_the_angle_of_friction(feet):
    angle = math.atan(MU) - 1e-6
    result = simulate(slope_block(angle, MU, None, feet), 1.0)
    assert {kind for kind, _ in kinds(result)} == {"close"}
    assert np.abs(along(result, angle)).max() < 1e-14
    forces = sum(result[name][-1] for name in result.channels if name.endswith("friction_force"))
    assert forces == pytest.approx(2.0 * G * math.sin(angle), rel=1e-12)
    pressing = sum(result[name][-1] for name in result.channels if name.endswith("normal_force"))
    assert pressing == pytest.approx(2.0 * G * math.cos(angle), rel=1e-12)


@pytest.mark.parametrize("feet", [1, 2, 3])
@pytest.mark.parametrize("excess", [1e-6, 0.2])
def test_block_on_a_slope_slides_above_the_angle_of_friction(feet, excess):
    angle = math.atan(MU) + excess
    result = simulate(slope_block(angle, MU, None, feet), 1.0, rtol=1e-9)
    assert {kind for kind, _ in kinds(result)} == {"close"}
    acceleration = G * (math.sin(angle) - MU * math.cos(angle))
    assert along(result, angle) == pytest.approx(-0.5 * acceleration * result.t**2, abs=1e-11)
    assert balanced(result)


@pytest.mark.parametrize("feet", [1, 2])
def test_static_friction_holds_what_kinetic_friction_would_not(feet):
    """Thrown up a slope between the two angles of friction it stops and stays; thrown down it does not stop."""
    angle, mu, static = math.atan(0.4), 0.3, 0.5
    up = simulate(slope_block(angle, mu, static, feet, 1.0), 1.0, rtol=1e-9)
    brake = G * (math.sin(angle) + mu * math.cos(angle))
    assert [e.t for e in events(up, "stick")] == pytest.approx([1.0 / brake] * feet, abs=1e-9)
    assert not events(up, "slip", "open")
    assert along(up, angle)[-1] == pytest.approx(0.5 / brake, rel=1e-10)
    down = simulate(slope_block(angle, mu, static, feet, -1.0), 1.0, rtol=1e-9)
    assert not events(down, "stick", "slip", "open")
    drive = G * (math.sin(angle) - mu * math.cos(angle))
    assert along(down, angle)[-1] == pytest.approx(-1.0 - 0.5 * drive, rel=1e-9)


@pytest.mark.parametrize("feet", [1, 2])
def test_block_thrown_up_a_steep_slope_comes_back(feet):
    """At the top it is at rest for no time: the friction turns round."""
    angle, mu = math.atan(0.6), 0.3
    result = simulate(slope_block(angle, mu, None, feet, 1.0), 1.0, rtol=1e-9)
    brake, drive = (G * (math.sin(angle) + sign * mu * math.cos(angle)) for sign in (1.0, -1.0))
    top = 1.0 / brake
    assert [e.t for e in events(result, "slip")] == pytest.approx([top] * feet, abs=1e-9)
    assert not events(result, "stick")
    assert along(result, angle)[-1] == pytest.approx(0.5 / brake - 0.5 * drive * (1.0 - top) ** 2, rel=1e-8)
    assert balanced(result)


# ---- forces that grow and swing -------------------------------------------------------------------------------------


@pytest.mark.parametrize("part", [0.999999, -0.999999, 0.0, 0.5])
def test_sticking_contact_holds_exactly_the_force_below_its_limit(part):
    force = part * 0.5 * 2.0 * G
    result = simulate(slider(mu=0.3, static=0.5, push=Constant(value=force)), 1.0)
    assert kinds(result) == [("close", "c")]
    assert result["c.friction_force"][1:] == pytest.approx(-force, rel=1e-14, abs=1e-14)
    assert np.abs(result["b.x"]).max() == 0.0


@pytest.mark.parametrize("static", [None, 0.5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_growing_force_makes_it_slip_at_the_limit(static, sign):
    limit = (static or MU) * 2.0 * G
    push = Ramp(start=0.2, duration=1.0, after=sign * 20.0)
    result = simulate(slider(static=static, push=push), 1.1, rtol=1e-9)
    slip = 0.2 + limit / 20.0
    assert kinds(result) == [("close", "c"), ("slip", "c")]
    assert result.events[1].t == pytest.approx(slip, abs=1e-9)
    t = 1.1 - slip
    speed = (limit - MU * 2.0 * G) / 2.0 * t + 20.0 * t * t / 4.0
    assert result["b.vx"][-1] == pytest.approx(sign * speed, rel=1e-9)
    assert balanced(result)


def test_swinging_force_makes_it_slip_and_stick_in_turn():
    """F = A sin(w t), mu N < A: slips where F = mu N, stops where its impulse is used up, sticks until F = -mu N."""
    amplitude, w, mass, mu = 9.0, 2.0, 2.0, 0.3
    limit = mu * mass * G
    begin = math.asin(limit / amplitude) / w

    def speed(t):
        return amplitude / w * (math.cos(w * begin) - math.cos(w * t)) - limit * (t - begin)

    end = brentq(speed, begin + 0.2, begin + 2.0, xtol=1e-15)
    assert abs(amplitude * math.sin(w * end)) < limit
    half = math.pi / w
    expected = [(begin + i * half, end + i * half) for i in range(6)]
    push = Sine(amplitude=amplitude, angular_frequency=w)
    result = simulate(slider(mu=mu, push=push, mass=mass), 6.5 * half, rtol=1e-10, atol=1e-12)
    assert [e.kind for e in result.events[1:]] == ["slip", "stick"] * 6 + ["slip"]
    assert [e.t for e in result.events[1:-1]] == pytest.approx([t for pair in expected for t in pair], abs=1e-9)
    assert balanced(result, 1e-8)


def test_swinging_force_beyond_all_friction_turns_it_without_rest():
    """mu N much smaller than A: at each reversal the force is beyond the limit, so that it slips on."""
    push = Sine(amplitude=40.0, angular_frequency=2.0, phase=0.5 * math.pi)
    result = simulate(slider(mu=0.1, push=push), 6.0, rtol=1e-9)
    reversals = events(result, "slip")
    assert len(reversals) >= 3 and not events(result, "stick")
    for event in reversals:
        k = np.flatnonzero(result.t == event.t)
        assert np.abs(result["b.vx"][k]).max() < 1e-12
        assert result["c.friction_force"][k[0]] == pytest.approx(-result["c.friction_force"][k[-1]], rel=1e-9)
    assert np.all(result["c.friction_force"] * result["b.vx"] <= 1e-12)


# ---- stick-slip on a belt -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [0.3, -0.3, 0.05, 3.0])
def test_stick_slip_on_a_belt(speed):
    belt = Belt(speed)
    times = belt.times(12)
    result = simulate(belt.model(), times[-1] + 1e-3, rtol=1e-11, atol=1e-13)
    assert [e.kind for e in result.events[1:]] == ["slip", "stick"] * 6
    assert [e.t for e in result.events[1:]] == pytest.approx(times, abs=1e-9)
    # a phase of slipping and one of sticking between
    slips = (result.t > times[0]) & (result.t < times[1])
    assert result["b.x"][slips] == pytest.approx(belt.position(result.t[slips] - times[0]), abs=1e-9)
    sticks = (result.t > times[1] + 1e-9) & (result.t < times[2] - 1e-9)
    assert result["b.vx"][sticks] == pytest.approx(speed, rel=1e-12)
    assert np.abs(result["c.sliding_velocity"][sticks]).max() < 1e-13
    assert balanced(result, 1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_oscillator_on_a_belt_at_rest_loses_the_same_in_each_half_swing(sign):
    """The amplitude falls by 2 mu N/k in each half swing; it stops at the first turn within mu N/k of the middle."""
    belt = Belt(0.0, static=0.3)
    start = sign * 9.3 * belt.slide
    result = simulate(belt.model(start, 0.0), 10.0 * math.pi / belt.w, rtol=1e-10, atol=1e-13)
    turns = result.events[1:]
    assert [e.kind for e in turns] == ["slip"] * 4 + ["stick"]
    assert [e.t for e in turns] == pytest.approx(math.pi / belt.w * np.arange(1, 6), abs=1e-8)
    assert result["b.x"][-1] == pytest.approx(-sign * (9.3 - 10.0) * belt.slide, rel=1e-8)
    assert balanced(result, 1e-9)
