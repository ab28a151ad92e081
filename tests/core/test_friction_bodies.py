"""Friction between bodies that move and turn: gears, planks, collisions; symmetries and units."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, events, on
from scipy.optimize import brentq
from sliders import PLASTIC, foot, kinds
from tlismni.core import (
    AppliedTorque2D,
    Constant,
    CoordinateContact,
    CoordinateDriver,
    CoordinateTerm,
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    HalfPlane2D,
    LinearSystem,
    Model,
    NewtonImpact,
    PointMass2D,
    PoissonImpact,
    Polynomial,
    Revolute2D,
    RigidBody2D,
    SpringDamper2D,
    simulate,
)


def pair(mu, law=PLASTIC, radii=(0.3, 0.1)):
    """Contact of disks a and b."""
    a, b = (Disk2D(marker=on(name), radius=radius) for name, radius in zip("ab", radii, strict=True))
    return DiskOnDisk2D(name="c", a=a, b=b, law=law, friction=CoulombFriction(coefficient=mu))


def momenta(result, bodies, masses, inertias):
    """Linear and angular momentum of free planar bodies, each (N,)."""
    px = py = angular = 0.0
    for name, m, inertia in zip(bodies, masses, inertias, strict=True):
        vx, vy = result[f"{name}.vx"], result[f"{name}.vy"]
        px, py = px + m * vx, py + m * vy
        angular = angular + m * (result[f"{name}.x"] * vy - result[f"{name}.y"] * vx)
        angular = angular + inertia * result[f"{name}.angular_velocity"]
    return px, py, angular


# ---- disks on disks -------------------------------------------------------------------------------------------------


def gears(mu, torque):
    """Disk a turns on the ground; disk b lies on it, led upright, and presses with its weight."""
    bodies = [
        RigidBody2D(name="a", mass=3.0, inertia=0.2),
        RigidBody2D(name="b", mass=2.0, inertia=0.05, position=(0.0, 0.4)),
    ]
    lead = CoordinateDriver(name="lead", body="b", coordinate="x", motion=Constant(value=0.0))
    return Model(
        bodies=bodies,
        joints=[Revolute2D(name="pin", a=GROUND, b=on("a")), lead],
        forces=[AppliedTorque2D(name="drive", body="a", torque=Constant(value=torque))],
        contacts=[pair(mu)],
    )


def test_friction_gear_keeps_its_ratio_over_several_turns():
    """J_a w_a' = M - F R_a, J_b w_b' = -F R_b, R_a w_a = -R_b w_b; sticks if F < mu m g."""
    torque = 0.9
    result = simulate(gears(0.5, torque), 10.0, rtol=1e-9)
    assert kinds(result) == [("close", "c")]
    reduced = 0.2 + 0.05 * 9.0
    assert result["a.angle"][-1] == pytest.approx(0.5 * torque / reduced * 100.0, rel=1e-9)
    assert result["b.angle"][-1] < -10.0 * 2.0 * math.pi
    assert 0.1 * result["b.angle"] == pytest.approx(-0.3 * result["a.angle"], abs=1e-10)
    assert np.abs(result["c.friction_force"][1:]) == pytest.approx(0.05 * 3.0 * torque / reduced / 0.1, rel=1e-9)


def test_friction_gear_slips_beyond_its_limit():
    mu, torque = 0.1, 3.0
    force = mu * 2.0 * G
    result = simulate(gears(mu, torque), 2.0, rtol=1e-9)
    assert result["a.angular_velocity"][-1] == pytest.approx((torque - 0.3 * force) / 0.2 * 2.0, rel=1e-9)
    assert result["b.angular_velocity"][-1] == pytest.approx(-0.1 * force / 0.05 * 2.0, rel=1e-9)
    assert np.abs(result["energy.balance"]).max() < 1e-10 * result["energy.kinetic"].max()


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("slip", [0.0, 4.0])
def test_planet_rolls_round_a_fixed_sun(sense, slip):
    """Held by a spring, disk b rolls round the fixed disk a: R_b theta' = (R_a + R_b) phi', over several turns in
    which the sliding distance jumps by its period. With slip at first m r phi' + J theta'/R_b is kept."""
    m, inertia, stiffness, rate, r, small = 2.0, 0.01, 300.0, sense * 2.0, 0.4, 0.1
    spin = r / small * rate + slip
    planet = RigidBody2D(
        name="b", mass=m, inertia=inertia, position=(0.0, r), velocity=(-r * rate, 0.0), angular_velocity=spin
    )
    spring = SpringDamper2D(name="s", a=GROUND, b=on("b"), stiffness=stiffness, damping=0.0, natural_length=0.2)
    contact = DiskOnDisk2D(
        name="c", a=Disk2D(marker=GROUND, radius=0.3), b=Disk2D(marker=on("b"), radius=small), law=PLASTIC,
        friction=CoulombFriction(coefficient=0.2),
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[planet], forces=[spring], contacts=[contact]), 12.0, rtol=1e-10)
    assert kinds(result) == [("close", "c")] + ([("stick", "c")] if slip else [])
    # m r phi'' = -F, J theta'' = F R_b
    final = (m * r * rate + inertia * spin / small) / (m * r + inertia * r / small**2)
    rolls = result.t > (result.events[-1].t if slip else 0.0)
    phi = np.unwrap(np.arctan2(-result["b.x"], result["b.y"]))
    assert np.abs(phi[-1]) > 3.0 * 2.0 * math.pi
    phi_rate = result["b.angular_velocity"] * small / r
    assert phi_rate[rolls] == pytest.approx(final, rel=1e-8)
    turned = small * (result["b.angle"] - result["b.angle"][rolls][0])
    assert turned[rolls] == pytest.approx(r * (phi - phi[rolls][0])[rolls], abs=1e-9)
    assert np.abs(result["energy.balance"]).max() < 1e-8


# ---- Newton's third law ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.4), PoissonImpact(restitution=0.4), PLASTIC])
@pytest.mark.parametrize("mu", [0.05, 0.3, 2.0])
def test_collision_of_spinning_disks_keeps_all_momenta(law, mu):
    """Two free disks strike obliquely with friction. Along the tangent |P_T| <= mu P_N: it either stops the sliding
    (two fifths, say, of it are taken by the spins) or is mu P_N."""
    m, inertia, radii = (2.0, 0.7), (0.05, 0.002), (0.3, 0.1)
    bodies = [
        RigidBody2D(name="a", mass=m[0], inertia=inertia[0], velocity=(1.0, 0.1), angular_velocity=3.0),
        RigidBody2D(
            name="b", mass=m[1], inertia=inertia[1], position=(1.0, 0.25), velocity=(-0.5, 0.0), angular_velocity=-5.0
        ),
    ]
    result = simulate(Model(gravity=(0.0, 0.0), bodies=bodies, contacts=[pair(mu, law)]), 1.0, rtol=1e-9)
    (hit,) = events(result, "impact")
    for values in momenta(result, "ab", m, inertia):
        assert values == pytest.approx(values[0], abs=1e-12)
    tangential = 1.0 / m[0] + 1.0 / m[1] + radii[0] ** 2 / inertia[0] + radii[1] ** 2 / inertia[1]
    before = result["c.sliding_velocity"][result.t == hit.t][0]
    wanted = -before / tangential
    limit = mu * hit.impulse
    assert hit.friction_impulse == pytest.approx(math.copysign(min(limit, abs(wanted)), wanted), rel=1e-8)
    assert hit.impulse == pytest.approx((1.0 + law.restitution) * hit.approach_speed / (1.0 / m[0] + 1.0 / m[1]))
    assert hit.energy_loss > 0.0 and np.abs(result["energy.balance"]).max() < 1e-12


def test_block_on_a_free_plank_shares_its_momentum():
    """A block slides on a plank that slides on a smooth floor, until both move as one: v = m u/(m + M) after
    t = u M/(mu g (m + M))."""
    m, plank_mass, u, mu = 1.0, 3.0, 2.0, 0.25
    bodies = [
        PointMass2D(name="b", mass=m, velocity=(u, 0.0)),
        RigidBody2D(name="plank", mass=plank_mass, inertia=4.0),
    ]
    feet = [foot(f"f{i}", "plank", x, mu=None) for i, x in enumerate((-2.0, 2.0))]
    result = simulate(
        Model(bodies=bodies, contacts=[*feet, foot("c", "b", mu=mu, plane=HalfPlane2D(marker=on("plank")))]),
        1.5, rtol=1e-9,
    )  # fmt: skip
    (stick,) = events(result, "stick")
    assert stick.t == pytest.approx(u * plank_mass / (mu * G * (m + plank_mass)), abs=1e-9)
    assert m * result["b.vx"] + plank_mass * result["plank.vx"] == pytest.approx(m * u, rel=1e-12)
    assert result["b.vx"][-1] == pytest.approx(m * u / (m + plank_mass), rel=1e-10)
    assert result["f0.normal_force"][1:] + result["f1.normal_force"][1:] == pytest.approx((m + plank_mass) * G)
    assert np.abs(result["energy.balance"]).max() < 1e-12


# ---- planes that move and turn --------------------------------------------------------------------------------------


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("place", [0.6, -0.6])
def test_block_on_a_plank_that_is_tilted_slips_at_the_angle_of_friction(sense, place):
    """The plank turns with w: at rest on it at a distance r of the axis, N = m g cos and F = m (g sin - r w^2)."""
    rate, mu = 0.5 * sense, 0.4
    plank = RigidBody2D(name="plank", mass=5.0, inertia=2.0, angular_velocity=rate)
    turn = [
        CoordinateDriver(name="turn", body="plank", coordinate="angle", motion=Polynomial(coefficients=(0.0, rate))),
        Revolute2D(name="pin", a=GROUND, b=on("plank")),
    ]
    block = PointMass2D(name="b", mass=1.5, position=(place, 0.0), velocity=(0.0, place * rate))
    contact = foot("c", "b", mu=mu, plane=HalfPlane2D(marker=on("plank")))
    result = simulate(Model(bodies=[plank, block], joints=turn, contacts=[contact]), 2.0, rtol=1e-9)

    def excess(t, sign):
        angle = rate * t
        return sign * (G * math.sin(angle) - place * rate**2) - mu * G * math.cos(angle)

    slip = brentq(excess, 0.0, 1.5, args=(sense,), xtol=1e-15)
    assert kinds(result)[:2] == [("close", "c"), ("slip", "c")]
    assert result.events[1].t == pytest.approx(slip, abs=1e-9)
    sticks = (result.t > 0.0) & (result.t < slip)
    angle = rate * result.t[sticks]
    assert result["c.normal_force"][sticks] == pytest.approx(1.5 * G * np.cos(angle), rel=1e-9)
    assert result["c.friction_force"][sticks] == pytest.approx(1.5 * (G * np.sin(angle) - place * rate**2), rel=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_block_in_a_drum_is_left_behind_when_the_drum_speeds_up():
    """A block on the inside of a drum, without gravity: w = 2 + 6 t^2 takes F = m r w' along against N = m r w^2."""
    r, alpha, mu, start = 0.5, 2.0, 0.5, 2.0
    drum = RigidBody2D(name="drum", mass=5.0, inertia=2.0, angular_velocity=start)
    turn = [
        CoordinateDriver(
            name="turn", body="drum", coordinate="angle", motion=Polynomial(coefficients=(0.0, start, 0.0, alpha))
        ),
        Revolute2D(name="pin", a=GROUND, b=on("drum")),
    ]
    block = PointMass2D(name="b", mass=1.5, position=(0.0, -r), velocity=(r * start, 0.0))
    # the wall below the axis, its normal towards the axis
    wall = HalfPlane2D(marker=on("drum", 0.0, -r))
    model = Model(gravity=(0.0, 0.0), bodies=[drum, block], joints=turn, contacts=[foot("c", "b", mu=mu, plane=wall)])
    result = simulate(model, 1.0, rtol=1e-9)
    slip = brentq(lambda t: 6.0 * alpha * t - mu * (start + 3.0 * alpha * t * t) ** 2, 0.0, 0.35)
    assert kinds(result)[:2] == [("close", "c"), ("slip", "c")]
    assert result.events[1].t == pytest.approx(slip, abs=1e-9)


# ---- contacts between coordinates -----------------------------------------------------------------------------------


def test_contact_between_coordinates_slides_and_sticks():
    """Coordinates u (along) and w (across), m u'' = -mu F sgn u', w pressed by a force: stops after m u0/(mu F)."""
    system = LinearSystem(
        name="s", coordinates=("u", "w"), mass=((2.0, 0.0), (0.0, 0.5)), force=(0.0, -6.0), velocity=(1.2, 0.0)
    )
    contact = CoordinateContact(
        name="c", terms=(CoordinateTerm(body="s", coordinate="w"),),
        slide=(CoordinateTerm(body="s", coordinate="u", factor=1.0),), law=PLASTIC,
        friction=CoulombFriction(coefficient=0.25),
    )  # fmt: skip
    result = simulate(Model(bodies=[system], contacts=[contact]), 2.5, rtol=1e-9)
    assert kinds(result) == [("close", "c"), ("stick", "c")]
    assert result.events[1].t == pytest.approx(2.0 * 1.2 / (0.25 * 6.0), abs=1e-9)
    assert result["s.u"][-1] == pytest.approx(0.5 * 1.2 * 1.6, rel=1e-10)
    assert result["c.normal_force"][-1] == pytest.approx(6.0, rel=1e-12)


# ---- symmetries -----------------------------------------------------------------------------------------------------


def tumble(length=1.0, mass=1.0, time=1.0, mirror=1.0):
    """A spinning disk falls on a rough floor beside another that lies there, in other units or in the mirror."""
    speed, inertia = length / time, mass * length**2

    def disk(name, m, x, y, vx, rate, radius):
        return RigidBody2D(
            name=name, mass=m * mass, inertia=0.5 * m * radius**2 * inertia, position=(mirror * x * length, y * length),
            velocity=(mirror * vx * speed, 0.0), angular_velocity=mirror * rate / time,
        )  # fmt: skip

    law = NewtonImpact(restitution=0.3)
    ends = {"law": law, "friction": CoulombFriction(coefficient=0.3, static_coefficient=0.4)}
    marks = {name: Disk2D(marker=on(name), radius=r * length) for name, r in (("a", 0.2), ("b", 0.1))}
    contacts = [
        DiskOnDisk2D(name="knock", a=marks["a"], b=marks["b"], **ends),
        foot("fa", "a", radius=0.2 * length, mu=0.3, static=0.4, law=law),
        foot("fb", "b", radius=0.1 * length, mu=0.3, static=0.4, law=law),
    ]
    bodies = [disk("a", 2.0, 0.0, 0.2, 0.0, 0.0, 0.2), disk("b", 1.0, -0.3, 0.45, 0.8, -30.0, 0.1)]
    return Model(gravity=(0.0, -G * length / time**2), bodies=bodies, contacts=contacts)


def history(result, length=1.0, mass=1.0, time=1.0, mirror=1.0):
    """Impacts that are not the last of a sequence (which of these is taken for rest depends on rounding), and the end,
    in the units of the first model."""
    large = [e for e in events(result, "impact") if e.impulse > 0.02 * mass * length / time]
    x = [result[f"{b}.{c}"][-1] / length for b in "ab" for c in ("x", "y")]
    return [e.contact for e in large], np.array([e.t / time for e in large]), np.array(x) * [mirror, 1.0, mirror, 1.0]


END = 1.2


@pytest.mark.parametrize("units", [(1e3, 1e3, 1e3), (1e2, 1e3, 1.0), (1e-1, 1e-3, 1e-2), (1.0, 1e6, 1.0)])
def test_units_do_not_matter(units):
    """m, kg, s against mm, g, ms and others; tolerances in the same units. What counts as rest is 1e-12 of the largest
    coordinate, or of 1 m where that is more: of the last bounces not all are the same."""
    length, _, time = units
    options = {"rtol": 1e-10, "method": "irk"}
    names, times, ends = history(simulate(tumble(), END, atol=1e-12, **options))
    speed = length / time
    atol = {"length": 1e-12 * length, "speed": 1e-12 * speed, "angle": 1e-12, "angular_speed": 1e-12 / time}
    names_2, times_2, ends_2 = history(simulate(tumble(*units), END * time, atol=atol, **options), *units)
    assert len(names) > 8 and names_2 == names
    assert times_2 == pytest.approx(times, abs=1e-8)
    assert ends_2 == pytest.approx(ends, abs=1e-6)


def test_the_mirror_image_moves_as_the_mirror_shows():
    one, other = simulate(tumble(), END, rtol=1e-9), simulate(tumble(mirror=-1.0), END, rtol=1e-9)
    names, times, ends = history(one)
    names_2, times_2, ends_2 = history(other, mirror=-1.0)
    assert names_2 == names
    assert times_2 == pytest.approx(times, abs=1e-9)
    assert ends_2 == pytest.approx(ends, abs=1e-9)
    assert {e.kind for e in one.events} >= {"impact", "close", "stick"}
    assert np.abs(one["energy.balance"]).max() < 1e-9
