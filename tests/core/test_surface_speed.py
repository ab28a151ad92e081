"""Surfaces that move, in the plane: belts that carry, drive and stop what lies on them, in closed form."""

import math

import numpy as np
import pytest
from helpers import G, events, on
from sliders import Belt
from tlismni.core import (
    BrownMcPheeFriction,
    Constant,
    ContactGroup2D,
    CoordinateDriver,
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    DiskOnSegment2D,
    HalfPlane2D,
    Input,
    InputSignal,
    KelvinVoigt,
    LuGreFriction,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    Parameter,
    PointMass2D,
    Polynomial,
    Ramp,
    RigidBody2D,
    Segment2D,
    Simulation,
    Sine,
    Step,
    Table,
    TanhFriction,
    simulate,
    simulate_many,
)
from tlismni.core.contacts.disk_on_box2d import Box2D
from units import Units

MU, STATIC, SPEED, MASS = 0.3, 0.4, 0.9, 2.0
DULL = NewtonImpact(restitution=0.0)
RUBS = CoulombFriction(coefficient=MU, static_coefficient=STATIC)
FAMILY = [("ebdf", {}), ("irk", {}), ("bdf", {}), ("adams", {}), ("hht", {})]


def belt(body="b", speed=SPEED, friction=RUBS, plane=None, radius=0.0, name="belt", law=DULL):
    disk = Disk2D(marker=on(body), radius=radius)
    plane = HalfPlane2D() if plane is None else plane
    return DiskOnHalfPlane2D(name=name, plane=plane, disk=disk, law=law, friction=friction, surface_speed=speed)


def block(speed=SPEED, friction=RUBS, velocity=(0.0, 0.0), **more):
    body = PointMass2D(name="b", mass=MASS, velocity=velocity)
    return Model(bodies=[body], contacts=[belt(speed=speed, friction=friction)], **more)


def check_energy(result, size=1.0):
    """Put in is what is stored and dissipated, to rounding of both."""
    assert np.abs(result["energy.balance"]).max() < 1e-9 * size


# ---- a block that is laid on a belt ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("method", "options"), FAMILY)
@pytest.mark.parametrize("speed", [SPEED, -SPEED])
def test_a_block_is_carried_along(method, options, speed):
    """It gains mu g until it has the belt's speed, and then moves with it."""
    result = simulate(block(speed), 1.0, method, rtol=1e-7, **options)
    (stick,) = events(result, "stick")
    taken, way = SPEED / (MU * G), 0.5 * SPEED**2 / (MU * G)
    assert stick.t == pytest.approx(taken, abs=1e-9)
    assert result["b.vx"][-1] == pytest.approx(speed, abs=1e-9)
    assert result["b.x"][-1] == pytest.approx(math.copysign(way + SPEED * (1.0 - taken), speed), abs=1e-8)
    assert abs(result["belt.sliding_velocity"][-1]) < 1e-12
    # the belt works mu m g over its own way: half goes into the block (HHT integrates its accounts with an error)
    close = 1e-8 if method != "hht" else 1e-6
    assert result["energy.input_work"][-1] == pytest.approx(MASS * SPEED**2, rel=close)
    assert result["belt.dissipation"][-1] == pytest.approx(0.5 * MASS * SPEED**2, rel=close)
    check_energy(result, close / 1e-9)


def test_friction_acts_on_the_sliding_velocity():
    result = simulate(block(), 0.2, t_eval=np.linspace(0.01, 0.19, 10))
    assert result["belt.sliding_velocity"] == pytest.approx(MU * G * result.t - SPEED, abs=1e-9)
    assert result["belt.friction_force"] == pytest.approx(np.full(10, MU * MASS * G), rel=1e-9)
    assert result["b.vx"] == pytest.approx(MU * G * result.t, abs=1e-9)


def test_a_falling_block_is_pulled_by_the_impulse():
    """Friction of the blow is mu times the normal impulse, and the belt's work counts as input."""
    body = PointMass2D(name="b", mass=MASS, position=(0.0, 0.05))
    result = simulate(Model(bodies=[body], contacts=[belt()]), 1.0)
    fall = math.sqrt(2.0 * G * 0.05)
    (blow,) = events(result, "impact")
    assert blow.impulse == pytest.approx(MASS * fall, rel=1e-8)
    speed = MU * fall
    assert blow.energy_loss == pytest.approx(0.5 * MASS * fall**2 + MASS * speed * (SPEED - 0.5 * speed), rel=1e-8)
    (stick,) = events(result, "stick")
    assert stick.t - blow.t == pytest.approx((SPEED - speed) / (MU * G), abs=1e-9)
    check_energy(result, MASS * SPEED**2)


@pytest.mark.parametrize(("method", "options"), FAMILY)
def test_stick_and_slip_of_a_block_on_a_spring(method, options):
    """The same cycle as on a driven body that is the belt (`sliders.Belt`)."""
    cycle = Belt()
    model, times = cycle.model(), cycle.times(4)
    own = model.contacts[0].model_copy(update={"surface_speed": cycle.u, "plane": HalfPlane2D()})
    held = Model(bodies=[model.bodies[0]], forces=model.forces, contacts=[own])
    result = simulate(held, times[-1] + 0.01, method, rtol=1e-7, atol=1e-9, **options)
    assert [e.kind for e in result.events[1:]] == ["slip", "stick"] * 2
    assert [e.t for e in result.events[1:]] == pytest.approx(times, abs=1e-4)
    assert result["residual.acceleration"].max() < 1e-8


# ---- speeds over time ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("signal", ["polynomial", "table"])
def test_a_belt_that_starts_too_fast_leaves_the_block_behind(signal):
    """Speed c t^2: it slips as 2 c t exceeds mu_s g, and mu g brings it to the speed V that the belt keeps."""
    c = 1.0
    if signal == "polynomial":
        speed = Polynomial(coefficients=(0.0, 0.0, c))
    else:
        times = np.linspace(0.0, 4.0, 9)
        speed = Table(times=tuple(times), values=tuple(c * times**2))
    result = simulate(block(speed), 3.0, rtol=1e-8, atol=1e-10)
    (slip,) = events(result, "slip")
    onset = STATIC * G / (2.0 * c)
    assert slip.t == pytest.approx(onset, abs=1e-7)
    at = np.interp(3.0, result.t, result["b.vx"])
    assert at == pytest.approx(c * onset**2 + MU * G * (3.0 - onset), rel=1e-6)
    check_energy(result, MASS * 100.0)


def test_a_belt_that_stops_and_reverses():
    """A jump in speed slips at once; the block is braked by mu g, whichever way the belt goes."""
    forth, back, stop = Step(time=0.5, before=SPEED, after=-SPEED), MU * G, 2.0 * SPEED / (MU * G)
    result = simulate(block(forth, velocity=(SPEED, 0.0)), 0.5 + stop + 0.2)
    assert [(e.kind, pytest.approx(e.t, abs=1e-9)) for e in result.events] == [
        ("close", 0.0), ("slip", 0.5), ("stick", 0.5 + stop)
    ]  # fmt: skip
    assert result["b.vx"][-1] == pytest.approx(-SPEED, abs=1e-9)
    assert np.interp(0.6, result.t, result["b.vx"]) == pytest.approx(SPEED - 0.1 * back, abs=1e-9)
    # against the belt's new motion friction works first backwards, then with it: in all nothing but the loss
    assert result["belt.dissipation"][-1] == pytest.approx(0.5 * MASS * (2.0 * SPEED) ** 2, rel=1e-8)
    check_energy(result, MASS * SPEED**2)


def test_a_jump_while_it_slides_turns_friction_round():
    slow = Step(time=0.1, before=SPEED, after=0.0)
    result = simulate(block(slow), 0.5)
    reached = MU * G * 0.1
    (stick,) = events(result, "stick")
    assert stick.t == pytest.approx(0.2, abs=1e-9)
    assert np.interp(0.1, result.t, result["b.vx"]) == pytest.approx(reached, abs=1e-9)
    assert result["b.vx"][-1] == pytest.approx(0.0, abs=1e-12)
    check_energy(result, MASS * SPEED**2)


def test_a_ramp_of_the_speed_that_friction_can_follow():
    ramp = Ramp(start=0.2, duration=0.5, before=0.0, after=1.5)  # 3 m/s2 < mu_s g
    result = simulate(block(ramp), 1.0)
    assert [e.kind for e in result.events] == ["close"]
    assert result["b.x"][-1] == pytest.approx(0.5 * 1.5 * 0.5 + 1.5 * 0.3, abs=1e-8)
    fast = simulate(block(Ramp(start=0.2, duration=0.25, before=0.0, after=1.5)), 1.0)
    assert [e.kind for e in fast.events] == ["close", "slip", "stick"]
    assert fast.events[1].t == pytest.approx(0.2, abs=1e-9)
    assert fast.events[2].t == pytest.approx(0.2 + 1.5 / (MU * G), abs=1e-8)


def test_a_driver_that_strikes_does_not_pull_the_block_along():
    """At one instant a belt starts, and a driver elsewhere jumps in rate: the block slips as if the latter were not."""
    other = PointMass2D(name="other", mass=1.0, position=(0.0, 5.0))
    drives = [
        CoordinateDriver(name="x", body="other", coordinate="x", motion=Ramp(start=0.5, duration=1.0, after=2.0)),
        CoordinateDriver(name="y", body="other", coordinate="y", motion=Constant(value=5.0)),
    ]
    alone = block(Step(time=0.5, before=0.0, after=SPEED))
    both = Model(bodies=[*alone.bodies, other], joints=drives, contacts=alone.contacts)
    result = simulate(both, 1.2)
    taken = SPEED / (MU * G)
    assert result["b.x"][-1] == pytest.approx(0.5 * SPEED * taken + SPEED * (0.7 - taken), abs=1e-8)
    (stick,) = events(result, "stick")
    assert stick.t == pytest.approx(0.5 + taken, abs=1e-9)
    check_energy(result, MASS * SPEED**2)


def test_a_swinging_belt_carries_what_friction_can_hold():
    """A sine: the block follows A sin(w t) while A w < mu_s g; x = A (1 - cos(w t))/w."""
    w, amplitude = 6.0, 0.6
    result = simulate(block(Sine(amplitude=amplitude, angular_frequency=w)), 2.0, rtol=1e-9, atol=1e-11)
    assert [e.kind for e in result.events] == ["close"]
    assert result["b.x"] == pytest.approx(amplitude * (1.0 - np.cos(w * result.t)) / w, abs=1e-7)
    check_energy(result, 1e3)


@pytest.mark.parametrize(("method", "order"), [("hht", 2), ("irk", 5), ("ebdf", 5), ("bdf", 3), ("adams", 4)])
def test_the_place_of_what_sticks_is_found_to_the_order(method, order):
    w, amplitude, errors = 6.0, 0.6, []
    for h in (0.04, 0.02, 0.01):
        result = simulate(block(Sine(amplitude=amplitude, angular_frequency=w)), 1.0, method, step=h)
        exact = amplitude * (1.0 - np.cos(w * result.t)) / w
        errors.append(np.abs(result["b.x"] - exact).max())
    assert np.log2(np.array(errors[:2]) / errors[1:]) == pytest.approx([order] * 2, abs=0.35)


def test_an_input_is_the_speed():
    model = block(InputSignal(channel="speed"), inputs=[Input(name="speed", unit="m/s", start=0.0)])
    sim = Simulation(model)
    names = [channel.name for channel in sim.channels]

    def at(t, speed=None):
        sim.advance(t)
        found = dict(zip(names, sim.values(), strict=True))
        if speed is not None:
            sim.set_inputs({"speed": speed})
        return found

    assert at(0.2, SPEED)["b.vx"] == pytest.approx(0.0, abs=1e-12)
    assert at(0.3)["b.vx"] == pytest.approx(MU * G * 0.1, abs=1e-9)
    assert at(1.0, 0.0)["b.vx"] == pytest.approx(SPEED, abs=1e-9)
    last = at(1.1)
    assert last["b.vx"] == pytest.approx(SPEED - MU * G * 0.1, abs=1e-9)
    assert abs(last["energy.balance"]) < 1e-9


# ---- inclined, two belts, rolling ------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [0.2, 0.35, 0.5])
def test_an_inclined_belt_carries_up_to_the_angle_of_friction(angle):
    """Up a slope a block gains g (mu cos - sin); where that is negative it slides down."""
    plane = HalfPlane2D(marker=Marker2D(angle=angle))
    up = Model(bodies=[PointMass2D(name="b", mass=MASS)], contacts=[belt(plane=plane)])
    result = simulate(up, 1.0)
    gains = G * (MU * math.cos(angle) - math.sin(angle))
    along = result["b.vx"][-1] * math.cos(angle) + result["b.vy"][-1] * math.sin(angle)
    if gains > 0.0:
        assert events(result, "stick")[0].t == pytest.approx(SPEED / gains, abs=1e-8)
        assert along == pytest.approx(SPEED, abs=1e-9)
    else:
        assert not events(result, "stick")
        assert along == pytest.approx(gains, abs=1e-8)
    check_energy(result, 100.0)


def test_one_that_static_friction_holds_is_carried_up():
    """mu < tan(angle) < mu_s: with the belt's speed from the start it stays on it."""
    angle = math.atan(0.35)
    plane = HalfPlane2D(marker=Marker2D(angle=angle))
    start = (SPEED * math.cos(angle), SPEED * math.sin(angle))
    carried = Model(bodies=[PointMass2D(name="b", mass=MASS, velocity=start)], contacts=[belt(plane=plane)])
    result = simulate(carried, 1.0)
    assert [e.kind for e in result.events] == ["close"]
    assert result["b.y"][-1] == pytest.approx(SPEED * math.sin(angle), abs=1e-8)
    # the belt lifts it
    assert result["energy.input_work"][-1] == pytest.approx(MASS * G * result["b.y"][-1], rel=1e-8)


def test_two_belts_under_one_block():
    """Both pull with mu N: the loads follow from force and moment balance, h above the belts."""
    half, height, left, right = 0.4, 0.3, 0.5, 0.2
    body = RigidBody2D(name="b", mass=MASS, inertia=0.1, position=(0.0, height))
    feet = [
        DiskOnHalfPlane2D(
            name=name, plane=HalfPlane2D(), disk=Disk2D(marker=on("b", x, -height)), law=DULL,
            friction=CoulombFriction(coefficient=mu), surface_speed=speed,
        )
        for name, x, mu, speed in (("left", -half, left, 5.0), ("right", half, right, -3.0))
    ]  # fmt: skip
    result = simulate(Model(bodies=[body], contacts=feet), 0.1)
    # N_l + N_r = m g, half (N_r - N_l) + height (left N_l - right N_r) = 0
    loads = np.linalg.solve([[1.0, 1.0], [height * left - half, half - height * right]], [MASS * G, 0.0])
    found = [result["left.normal_force"][-1], result["right.normal_force"][-1]]
    assert found == pytest.approx(loads, rel=1e-9)
    assert result["b.ax"][-1] == pytest.approx((left * loads[0] - right * loads[1]) / MASS, rel=1e-9)
    assert abs(result["b.angle"][-1]) < 1e-12
    check_energy(result, 100.0)


def test_belts_against_each_other_hold_a_block_that_slides_on_both():
    """Equal belts that run apart: the block stays, and both only heat it."""
    body = RigidBody2D(name="b", mass=MASS, inertia=0.1, position=(0.0, 0.3))
    feet = [
        belt("b", speed, name=name).model_copy(update={"disk": Disk2D(marker=on("b", x, -0.3))})
        for name, x, speed in (("left", -0.4, -2.0), ("right", 0.4, 2.0))
    ]
    result = simulate(Model(bodies=[body], contacts=feet), 1.0)
    assert abs(result["b.x"][-1]) < 1e-12
    heat = MU * MASS * G * 2.0
    assert result["energy.input_work"][-1] == pytest.approx(heat, rel=1e-9)
    assert sum(result[f"{n}.dissipation"][-1] for n in ("left", "right")) == pytest.approx(heat, rel=1e-9)


@pytest.mark.parametrize("speed", [Constant(value=SPEED), Sine(amplitude=SPEED, angular_frequency=5.0, phase=0.3)])
def test_a_block_that_a_driver_holds_is_rubbed(speed):
    """The driver feels mu N along the belt at all times, and nothing else."""
    drive = CoordinateDriver(name="hold", body="b", coordinate="x", motion=Constant(value=0.0))
    held = Model(bodies=[PointMass2D(name="b", mass=MASS)], joints=[drive], contacts=[belt(speed=speed)])
    result = simulate(held, 1.0, rtol=1e-9, atol=1e-11)
    along = np.array([float(speed(float(t))) for t in result.t])
    clear = np.abs(along) > 1e-3
    found = result["belt.friction_force"][clear]
    assert found == pytest.approx(MU * MASS * G * np.sign(along[clear]), rel=1e-9)
    assert np.abs(result["hold.reaction"][clear]) == pytest.approx(MU * MASS * G, rel=1e-9)
    assert result["energy.input_work"] == pytest.approx(result["belt.dissipation"], abs=1e-9)


@pytest.mark.parametrize(("gyration", "part"), [(0.5, 1.0 / 3.0), (0.4, 2.0 / 7.0)], ids=["disk", "ball"])
def test_what_rolls_takes_a_part_of_the_speed(gyration, part):
    """I = k m r^2: it rolls with v = k/(1 + k) V, from t = k/(1 + k) V/(mu g) on."""
    r = 0.2
    body = RigidBody2D(name="b", mass=MASS, inertia=gyration * MASS * r * r, position=(0.0, r))
    result = simulate(Model(bodies=[body], contacts=[belt(radius=r)]), 0.5)
    (stick,) = events(result, "stick")
    assert stick.t == pytest.approx(part * SPEED / (MU * G), abs=1e-9)
    assert result["b.vx"][-1] == pytest.approx(part * SPEED, abs=1e-9)
    assert result["b.angular_velocity"][-1] == pytest.approx((SPEED - part * SPEED) / r, abs=1e-8)
    check_energy(result, MASS * SPEED**2)


# ---- shapes that end, bodies that carry ------------------------------------------------------------------------------


def test_a_box_tips_over_the_end_of_a_belt():
    """On two feet: it lies on the belt until the front one is at the end roller, and goes down round it."""
    length, r, half, height = 1.0, 0.05, 0.2, 0.1
    segment = Segment2D(marker=Marker2D(), length=length, radius=r)
    body = RigidBody2D(
        name="b", mass=MASS, inertia=0.05, position=(0.5, r + height), velocity=(SPEED, 0.0)
    )  # fmt: skip
    feet = [
        DiskOnSegment2D(
            name=name, segment=segment, disk=Disk2D(marker=on("b", x, -height + 0.01), radius=0.01), law=DULL,
            friction=RUBS, surface_speed=SPEED,
        )
        for name, x in (("rear", -half), ("front", half))
    ]  # fmt: skip
    result = simulate(Model(bodies=[body], contacts=feet), 1.0, rtol=1e-9, atol=1e-11)
    # the front foot is at the end
    before = result.t < (length - 0.5 - half) / SPEED - 1e-3
    assert np.abs(result["b.angle"][before]).max() < 1e-12
    assert result["b.x"][before] == pytest.approx(0.5 + SPEED * result.t[before], abs=1e-9)
    assert result["b.angle"][-1] < -0.5 and result["b.y"][-1] < 0.0
    check_energy(result, 100.0)


def test_a_box_on_a_belt_with_sharp_ends():
    """A belt that is a box: the block's corners leave it, the belt's edge goes on carrying its bottom."""
    shapes = {"boxes": [Box2D(marker=Marker2D(point=(0.0, -0.1)), width=2.0, height=0.2),
                        Box2D(marker=on("b"), width=0.4, height=0.2)]}  # fmt: skip
    group = ContactGroup2D(name="g", **shapes, law=DULL, friction=RUBS, surface_speed=SPEED, surface_body="ground")
    body = RigidBody2D(name="b", mass=MASS, inertia=0.05, position=(0.0, 0.1))
    result = simulate(Model(bodies=[body], groups=[group]), 1.6, rtol=1e-9, atol=1e-11)
    taken = SPEED / (MU * G)
    over = taken + (1.0 - 0.5 * SPEED * taken) / SPEED  # its centre is over the edge
    still = result.t < over - 1e-3
    assert np.abs(result["b.angle"][still]).max() < 1e-9
    at = np.interp(over, result.t, result["b.x"])
    assert at == pytest.approx(1.0, abs=1e-3)
    assert result["b.angle"][-1] < -0.2
    check_energy(result, 100.0)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("speed", np.linspace(0.5, 1.5, 8))
def test_a_corner_leaves_the_edge_of_a_belt_in_no_time(speed):
    """The force of the rear corner, which hardly slides, jumps where the edge begins: the run gets over that."""
    shapes = {"boxes": [Box2D(marker=Marker2D(point=(0.0, -0.1)), width=2.0, height=0.2),
                        Box2D(marker=on("b"), width=0.4, height=0.2)]}  # fmt: skip
    group = ContactGroup2D(name="g", **shapes, law=DULL, friction=RUBS, surface_speed=speed, surface_body="ground")
    body = RigidBody2D(name="b", mass=MASS, inertia=0.05, position=(0.4, 0.1), velocity=(speed, 0.0))
    result = simulate(Model(bodies=[body], groups=[group]), 0.6 / speed + 0.5)
    assert result["b.y"][-1] < 0.0 and not result["g_ground_b_3.in_contact"][-1]
    assert np.abs(result["energy.balance"]).max() < 1e-4


def test_a_vehicle_on_tracks():
    """Its own surface goes clockwise round its feet, to the left below: it drives to the right."""
    body = RigidBody2D(name="b", mass=MASS, inertia=0.1, position=(0.0, 0.2))
    feet = [
        DiskOnHalfPlane2D(
            name=name, plane=HalfPlane2D(), disk=Disk2D(marker=on("b", x, -0.1), radius=0.1), law=DULL, friction=RUBS,
            surface_speed=SPEED,
        )
        for name, x in (("rear", -0.4), ("front", 0.4))
    ]  # fmt: skip
    result = simulate(Model(bodies=[body], contacts=feet), 1.0)
    assert events(result, "stick")[-1].t == pytest.approx(SPEED / (MU * G), abs=1e-8)
    assert result["b.vx"][-1] == pytest.approx(SPEED, abs=1e-9)


def test_a_drum_that_only_seems_to_turn():
    """A disk on a fixed disk whose surface goes round: as on one that turns."""

    def model(turns):
        r = RigidBody2D(name="b", mass=1.0, inertia=0.02, position=(0.3 * math.sin(0.1), 0.3 * math.cos(0.1)))
        drum = RigidBody2D(name="drum", mass=1.0, inertia=1.0, angular_velocity=-4.0 if turns else 0.0)
        drives = [
            CoordinateDriver(name=c, body="drum", coordinate=c, motion=Polynomial(coefficients=(0.0, rate)))
            for c, rate in (("x", 0.0), ("y", 0.0), ("angle", -4.0 if turns else 0.0))
        ]
        contact = DiskOnDisk2D(
            name="c", a=Disk2D(marker=on("drum"), radius=0.2), b=Disk2D(marker=on("b"), radius=0.1), law=DULL,
            friction=RUBS, surface_speed=0.0 if turns else 0.8,
        )  # fmt: skip
        return Model(bodies=[drum, r], joints=drives, contacts=[contact])

    times = np.linspace(0.0, 0.5, 11)
    one, other = (simulate(model(turns), 0.5, rtol=1e-9, atol=1e-11, t_eval=times) for turns in (True, False))
    for channel in ("b.x", "b.y", "b.angle", "c.normal_force", "c.friction_force", "c.dissipation"):
        assert one[channel] == pytest.approx(other[channel], abs=1e-6)
    assert [e.kind for e in one.events] == [e.kind for e in other.events]


def test_a_belt_on_a_carriage_pushes_the_carriage_back():
    """No force from outside: momentum is kept, and both end with the belt's speed between them."""
    carriage = RigidBody2D(name="carriage", mass=6.0, inertia=1.0)
    guide = [
        CoordinateDriver(name=c, body="carriage", coordinate=c, motion=Constant(value=0.0)) for c in ("y", "angle")
    ]
    contact = belt(plane=HalfPlane2D(marker=on("carriage")))
    body = PointMass2D(name="b", mass=MASS)
    result = simulate(Model(bodies=[carriage, body], joints=guide, contacts=[contact]), 1.0)
    assert result["b.vx"][-1] == pytest.approx(SPEED * 6.0 / 8.0, abs=1e-9)
    assert result["carriage.vx"][-1] == pytest.approx(-SPEED * 2.0 / 8.0, abs=1e-9)
    assert result["energy.input_work"][-1] == pytest.approx(2.0 * result["energy.kinetic"][-1], rel=1e-8)
    check_energy(result, 10.0)


# ---- laws of force ---------------------------------------------------------------------------------------------------

SOFT = KelvinVoigt(stiffness=1e4, damping=200.0)


def pressed(friction, speed=SPEED):
    """A block that lies in a soft belt from the start."""
    body = PointMass2D(name="b", mass=MASS, position=(0.0, -MASS * G / 1e4))
    return Model(bodies=[body], contacts=[belt(speed=speed, friction=friction, law=SOFT)])


def test_a_regularised_law_in_closed_form():
    """F = mu N tanh(u/v): sinh(u/v) = sinh(V/v) exp(-mu g t/v), u what is left of sliding."""
    v = 0.3
    result = simulate(pressed(TanhFriction(coefficient=MU, transition_speed=v)), 1.0, rtol=1e-10, atol=1e-12)
    left = v * np.arcsinh(math.sinh(SPEED / v) * np.exp(-MU * G * result.t / v))
    assert result["b.vx"] == pytest.approx(SPEED - left, abs=1e-7)
    check_energy(result, 10.0)


@pytest.mark.parametrize(
    "friction",
    [
        TanhFriction(coefficient=MU, transition_speed=1e-3),
        BrownMcPheeFriction(coefficient=MU, static_coefficient=MU, transition_speed=1e-3),
        LuGreFriction(
            bristle_stiffness=1e5, bristle_damping=300.0, viscous_damping=0.0, coefficient=MU, static_coefficient=MU,
            stribeck_speed=0.1,
        ),
    ],
    ids=["Tanh", "BrownMcPhee", "LuGre"],
)  # fmt: skip
def test_forces_tend_to_the_constraint(friction):
    result = simulate(pressed(friction), 1.0, rtol=1e-8, atol=1e-10)
    taken = SPEED / (MU * G)
    assert result["b.vx"][-1] == pytest.approx(SPEED, abs=1e-6)
    assert result["b.x"][-1] == pytest.approx(0.5 * SPEED * taken + SPEED * (1.0 - taken), rel=5e-3)
    assert result["energy.input_work"][-1] == pytest.approx(MASS * SPEED**2, rel=5e-3)
    assert np.abs(result["energy.balance"]).max() < 1e-6


# ---- units, data, refusals -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", [Units(length=1e3), Units(length=1e-3, mass=1e3), Units(time=1e3)])
def test_other_units_make_no_difference(units):
    model = block(Step(time=0.5, before=SPEED, after=-SPEED))
    one, other = simulate(model, 1.5), simulate(units.model(model), 1.5 * units.time)
    assert [e.kind for e in one.events] == [e.kind for e in other.events]
    assert [e.t * units.time for e in one.events] == pytest.approx([e.t for e in other.events], rel=1e-9)
    assert other["b.x"][-1] == pytest.approx(units.length * one["b.x"][-1], rel=1e-8)


def test_a_model_with_a_belt_is_data():
    model = block(Sine(amplitude=0.2, angular_frequency=3.0))
    assert Model.model_validate_json(model.model_dump_json()) == model
    assert block().contacts[0].surface_speed == SPEED


@pytest.mark.parametrize("method", ["baumgarte", "hht_i3", "hht_ggl", "generalized_alpha"])
def test_comparison_methods_refuse_speeds_that_jump(method):
    with pytest.raises(ModelError, match=r"may jump, and method .* take a method of the family"):
        simulate(block(Step(time=0.5, before=SPEED, after=-SPEED)), 1.0, method)


def test_the_speed_is_a_parameter():
    wanted = [Parameter(name="v", unit="m/s", targets=("belt.surface_speed",))]
    model = block(parameters=wanted)
    assert model.with_parameters({"v": -0.5}).contacts[0].surface_speed == -0.5
    speeds = np.array([0.5, -0.2, 0.0])
    runs = simulate_many(model, {"v": speeds}, 1.0, channels=["b.vx"])
    assert runs["b.vx"] == pytest.approx(speeds, abs=1e-9)


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ModelError, match=r"has a surface_speed, but without friction"):
        belt(friction=None)
    for wrong in (math.nan, "fast", (1.0, 0.0)):
        with pytest.raises(ModelError, match="surface_speed"):
            belt(speed=wrong)
    box = {"boxes": [Box2D(marker=on("b"), width=0.4, height=0.2)], "half_planes": [HalfPlane2D()]}
    for wrong in ({"surface_speed": 1.0}, {"surface_body": "ground"}):
        with pytest.raises(ModelError, match=r"surface_speed .* surface_body"):
            ContactGroup2D(name="g", **box, law=DULL, friction=RUBS, **wrong).contacts()
    with pytest.raises(ModelError, match="no contact of 'belt'"):
        ContactGroup2D(name="g", **box, law=DULL, friction=RUBS, surface_speed=1.0, surface_body="belt").contacts()
