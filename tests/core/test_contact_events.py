"""Contact as a constraint: starts, ends, releases, sequences, grazing."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, ball_over_floor, events, floor_contact, on, residuals
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Constant,
    CoordinateDriver,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    EquationSystem,
    Flores,
    GapContact,
    HalfPlane2D,
    Hertz,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Prismatic2D,
    Ramp,
    RigidBody2D,
    Sine,
    Step,
    simulate,
)

METHODS = ("ebdf", "bdf", "irk", "hht", "newmark")
PLASTIC, ELASTIC, HALF = (NewtonImpact(restitution=e) for e in (0.0, 1.0, 0.5))
FALL = math.sqrt(2.0 / G)


def wall(x, angle, name, law, body="ball"):
    """A half-plane through (x, 0) with its normal at angle + 90 degrees."""
    plane = HalfPlane2D(marker=Marker2D(point=(x, 0.0), angle=angle))
    return DiskOnHalfPlane2D(name=name, plane=plane, disk=Disk2D(marker=on(body)), law=law)


# ---- starts and ends --------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_start_in_touch_with_approach_is_an_impact_at_the_start(method):
    result = simulate(ball_over_floor(HALF, height=0.0, speed=-2.0), 0.1, method)
    first = result.events[0]
    assert (first.kind, first.t) == ("impact", 0.0)
    assert first.approach_speed == pytest.approx(2.0) and first.impulse == pytest.approx(3.0)
    assert result["ball.vy"][0] == pytest.approx(-2.0)
    assert result["ball.y"][-1] == pytest.approx(0.1 - 0.5 * G * 0.01, abs=1e-7)


def test_start_in_touch_moving_away_is_no_event():
    result = simulate(ball_over_floor(HALF, height=0.0, speed=1.0), 0.1)
    assert not result.events
    assert result["ball.y"][-1] == pytest.approx(0.1 - 0.5 * G * 0.01, abs=1e-7)


def test_start_at_rest_on_the_floor_is_a_closed_contact():
    result = simulate(ball_over_floor(HALF, height=0.0, mass=3.0), 1.0)
    assert [(event.kind, event.t) for event in result.events] == [("close", 0.0)]
    assert np.abs(result["ball.y"]).max() < 1e-15
    assert result["floor.normal_force"][1:] == pytest.approx(3.0 * G, rel=1e-13)


def test_start_in_touch_without_being_pressed_stays_open():
    result = simulate(ball_over_floor(HALF, height=0.0, gravity=0.0), 1.0)
    assert not events(result, "close", "impact")
    assert result["floor.normal_force"].max() == 0.0


def test_start_in_touch_with_a_force_law():
    law = Hertz(stiffness=1e4)
    result = simulate(ball_over_floor(law, height=0.0, speed=-1.0, gravity=0.0), 0.2, rtol=1e-9, atol=1e-12)
    assert [event.kind for event in result.events] == ["close", "open"]
    assert result.events[0].t == 0.0
    assert result["ball.vy"][-1] == pytest.approx(1.0, rel=1e-7)


@pytest.mark.parametrize("beyond", [-1e-9, 0.0, 1e-9])
@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_impact_at_the_very_end(method, beyond):
    result = simulate(ball_over_floor(HALF), FALL + beyond, method)
    assert result.t[-1] == FALL + beyond
    assert result["floor.gap"].min() > -1e-14
    impacts = events(result, "impact")
    assert len(impacts) == {-1e-9: 0, 1e-9: 1}.get(beyond, len(impacts)) <= 1
    if impacts:
        assert impacts[0].t <= result.t[-1]
        assert impacts[0].t == pytest.approx(FALL, abs=1e-11)


def test_samples_at_the_impact_time_itself_belong_to_one_side():
    result = simulate(ball_over_floor(HALF), 1.0, t_eval=[0.2, FALL, 0.6])
    assert result["ball.y"][1] == pytest.approx(0.0, abs=1e-10)
    speed = math.sqrt(2.0 * G)
    assert min(abs(result["ball.vy"][1] + speed), abs(result["ball.vy"][1] - 0.5 * speed)) < 1e-9


def test_contact_that_never_closes():
    result = simulate(ball_over_floor(HALF, height=10.0), 1.0)
    assert not result.events
    assert result["floor.normal_force"].max() == 0.0 and result["floor.in_contact"].max() == 0.0
    assert result["floor.gap"] == pytest.approx(10.0 - 0.5 * G * result.t**2, abs=1e-7)


# ---- persistent contact and release --------------------------------------------------------------------


def lifted(force, law=HALF, mass=2.0):
    pull = AppliedForce2D(name="pull", marker=on("ball"), force_y=force)
    return ball_over_floor(law, height=0.0, mass=mass, forces=[pull])


@pytest.mark.parametrize("method", METHODS)
def test_contact_opens_when_the_lifting_force_crosses_the_weight(method):
    rate, mass, start = 40.0, 2.0, 0.1
    model = lifted(Ramp(start=start, duration=1.0, before=0.0, after=rate), mass=mass)
    tight = {"rtol": 1e-6, "atol": 1e-9} if method in ("hht", "newmark") else {"rtol": 1e-10, "atol": 1e-13}
    result = simulate(model, 0.9, method, **tight)
    (opened,) = events(result, "open")
    release = start + mass * G / rate
    assert opened.t == pytest.approx(release, abs=1e-9)
    after = result.t > release
    bound = 1e-5 if method in ("hht", "newmark") else 1e-9
    assert np.abs(result["ball.y"][after] - rate / mass * (result.t[after] - release) ** 3 / 6.0).max() < bound
    before = (result.t > start) & (result.t < release)
    force = mass * G - rate * (result.t - start)
    assert np.abs(result["floor.normal_force"] - force)[before].max() < 1e-9
    assert result["floor.normal_force"].min() >= -1e-9 and result["floor.gap"].min() > -1e-13
    assert np.all(result["floor.normal_force"][after][1:] == 0.0)


def test_contact_opens_at_once_when_the_force_steps_over_the_weight():
    result = simulate(lifted(Step(time=0.3, before=0.0, after=30.0)), 0.8, rtol=1e-9, atol=1e-12)
    (opened,) = events(result, "open")
    assert opened.t == pytest.approx(0.3, abs=1e-12)
    assert result["ball.y"][-1] == pytest.approx(0.5 * (15.0 - G) * 0.25, abs=1e-9)
    assert result["floor.normal_force"].min() >= 0.0


def test_periodic_force_lifts_and_drops_the_mass():
    """Each lift begins where m g = A sin(w t) on the rise, from rest; the flight is known in closed form."""
    amplitude, w, mass = 60.0, 8.0, 2.0
    result = simulate(lifted(Sine(amplitude=amplitude, angular_frequency=w), PLASTIC, mass), 1.5, rtol=1e-9, atol=1e-12)
    first, lift = events(result, "impact")[0], events(result, "open")[0]
    t0 = math.asin(mass * G / amplitude) / w
    assert lift.t == pytest.approx(t0, abs=1e-9)

    def height(t):
        b = amplitude / (mass * w)
        return b * (math.cos(w * t0) * (t - t0) - (math.sin(w * t) - math.sin(w * t0)) / w) - 0.5 * G * (t - t0) ** 2

    assert height(first.t) == pytest.approx(0.0, abs=1e-8)
    assert result["floor.gap"].min() > -1e-12 and result["floor.normal_force"].min() > -1e-9
    assert max(residuals(result)) < 1e-10
    assert np.abs(result["energy.balance"]).max() < 1e-7 * result["energy.kinetic"].max()


@pytest.mark.parametrize("angle", [0.4, -0.9])
def test_plastic_impact_on_a_slope_keeps_the_tangential_speed(angle):
    """After e = 0 the ball slides down the smooth slope: force m g cos(angle)."""
    plane = HalfPlane2D(marker=Marker2D(point=(0.0, -1.0), angle=angle))
    contact = DiskOnHalfPlane2D(name="slope", plane=plane, disk=Disk2D(marker=on("ball")), law=PLASTIC)
    model = Model(bodies=[PointMass2D(name="ball", mass=1.5)], contacts=[contact])
    result = simulate(model, 1.0, rtol=1e-9, atol=1e-12)
    assert [event.kind for event in result.events] == ["impact", "close"]
    hit = result.events[0]
    assert hit.t == pytest.approx(FALL, abs=1e-9)
    speed = math.sqrt(2.0 * G)
    assert hit.approach_speed == pytest.approx(speed * math.cos(angle), rel=1e-9)
    after = result.t > hit.t
    assert result["slope.normal_force"][after] == pytest.approx(1.5 * G * math.cos(angle), rel=1e-9)
    along = math.cos(angle) * result["ball.vx"] + math.sin(angle) * result["ball.vy"]
    expected = -speed * math.sin(angle) - G * math.sin(angle) * (result.t - hit.t)
    assert np.abs(along - expected)[after].max() < 1e-8
    assert np.abs(result["slope.gap"][after]).max() < 1e-12


def test_ball_leaves_a_round_bump_where_its_centripetal_force_fails():
    """Sliding from rest near the top of a smooth circle it leaves at cos(angle) = 2/3 of the start's height."""
    bump = DiskOnDisk2D(name="bump", a=Disk2D(marker=GROUND, radius=1.0), b=Disk2D(marker=on("ball")), law=HALF)
    start = 0.2
    body = PointMass2D(name="ball", mass=0.7, position=(math.sin(start), math.cos(start)))
    result = simulate(Model(bodies=[body], contacts=[bump]), 1.5, rtol=1e-10, atol=1e-12)
    (opened,) = events(result, "open")
    k = np.searchsorted(result.t, opened.t)
    assert result["ball.y"][k] == pytest.approx(2.0 / 3.0 * math.cos(start), abs=1e-8)
    closed = result.t[1:] < opened.t
    y = result["ball.y"][1:][closed]
    force = 0.7 * G * (3.0 * y - 2.0 * math.cos(start))
    assert np.abs(result["bump.normal_force"][1:][closed] - force).max() < 1e-7


# ---- several contacts ----------------------------------------------------------------------------------


def test_two_walls_in_turn():
    """Between two walls without gravity: speeds shrink by e at each, times are sums of L / (u e^k)."""
    e, u = 0.8, 2.0
    law = NewtonImpact(restitution=e)
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[PointMass2D(name="ball", mass=1.0, position=(0.5, 0.0), velocity=(u, 0.3))],
        contacts=[wall(0.0, -math.pi / 2, "left", law), wall(1.0, math.pi / 2, "right", law)],
    )
    result = simulate(model, 4.0)
    times = [0.25 + sum(1.0 / (u * e**j) for j in range(1, k + 1)) for k in range(8)]
    times = [t for t in times if t < 4.0]
    assert len(times) >= 4
    assert [event.contact for event in result.events] == ["right", "left"] * (len(times) // 2) + ["right"] * (
        len(times) % 2
    )
    assert [event.t for event in result.events] == pytest.approx(times, abs=1e-10)
    assert np.abs(result["ball.vy"] - 0.3).max() < 1e-9


def test_corner_of_floor_and_wall_hit_at_the_same_time():
    """Perpendicular impacts do not feel each other."""
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[PointMass2D(name="ball", mass=1.0, position=(-1.0, 1.0), velocity=(2.0, -2.0))],
        contacts=[floor_contact(HALF), wall(0.0, math.pi / 2, "wall", HALF)],
    )
    result = simulate(model, 1.0)
    assert sorted(event.contact for event in result.events) == ["floor", "wall"]
    assert [event.t for event in result.events] == pytest.approx([0.5, 0.5], abs=1e-9)
    assert result.v[-1] == pytest.approx([-1.0, 1.0], abs=1e-9)


@pytest.mark.parametrize("e", [0.0, 0.4, 1.0])
def test_two_disks_collide_head_on(e):
    m1, m2, u = 1.0, 3.0, 2.0
    contact = DiskOnDisk2D(
        name="c", a=Disk2D(marker=on("a"), radius=0.2), b=Disk2D(marker=on("b"), radius=0.3),
        law=NewtonImpact(restitution=e),
    )  # fmt: skip
    bodies = [
        PointMass2D(name="a", mass=m1, velocity=(u, 0.0)),
        PointMass2D(name="b", mass=m2, position=(1.5, 0.0)),
    ]
    result = simulate(Model(gravity=(0.0, 0.0), bodies=bodies, contacts=[contact]), 1.0)
    hit = result.events[0]
    m = m1 * m2 / (m1 + m2)
    assert hit.t == pytest.approx(0.5, abs=1e-9)
    assert hit.impulse == pytest.approx(m * (1.0 + e) * u, rel=1e-9)
    assert hit.energy_loss == pytest.approx(0.5 * m * (1.0 - e**2) * u**2, rel=1e-9, abs=1e-15)
    assert result["a.vx"][-1] == pytest.approx(u - hit.impulse / m1, abs=1e-9)
    assert result["b.vx"][-1] == pytest.approx(hit.impulse / m2, abs=1e-9)
    kinds = [event.kind for event in result.events]
    assert kinds == ["impact"]  # also for e = 0: nothing presses the disks together


def test_oblique_collision_changes_the_normal_velocities_alone():
    law = NewtonImpact(restitution=0.7)
    contact = DiskOnDisk2D(
        name="c", a=Disk2D(marker=on("a"), radius=0.5), b=Disk2D(marker=on("b"), radius=0.5), law=law
    )
    bodies = [
        PointMass2D(name="a", mass=1.0, velocity=(1.0, 0.0)),
        PointMass2D(name="b", mass=1.0, position=(2.0, 0.6)),
    ]
    result = simulate(Model(gravity=(0.0, 0.0), bodies=bodies, contacts=[contact]), 3.0)
    normal, tangent = np.array([0.8, 0.6]), np.array([-0.6, 0.8])
    assert result.events[0].t == pytest.approx(1.2, abs=1e-9)
    va, vb = result.v[-1][:2], result.v[-1][2:]
    assert va @ tangent == pytest.approx(-0.6, abs=1e-9) and vb @ tangent == pytest.approx(0.0, abs=1e-9)
    assert (vb - va) @ normal == pytest.approx(0.7 * 0.8, abs=1e-9)
    assert va + vb == pytest.approx([1.0, 0.0], abs=1e-9)


def test_impact_on_a_lying_body_passes_its_impulse_to_the_floor():
    """A ball falls on a block that lies on the floor: the block stays, the floor takes the impulse too."""
    block = RigidBody2D(name="block", mass=5.0, inertia=1.0)
    ball = PointMass2D(name="ball", mass=1.0, position=(0.0, 1.0))
    contacts = [
        floor_contact(HALF, body="block"),
        DiskOnHalfPlane2D(name="top", plane=HalfPlane2D(marker=on("block")), disk=Disk2D(marker=on("ball")), law=HALF),
    ]
    guide = Prismatic2D(name="guide", a=on("ground", angle=math.pi / 2), b=on("block"))
    result = simulate(Model(bodies=[block, ball], joints=[guide], contacts=contacts), 0.7)
    (hit, *_) = events(result, "impact")
    assert hit.contact == "top"
    assert hit.impulse == pytest.approx(1.5 * math.sqrt(2.0 * G), rel=1e-9)
    assert np.abs(result["block.y"]).max() < 1e-13
    assert result["ball.vy"][result.t == hit.t][-1] == pytest.approx(0.5 * math.sqrt(2.0 * G), rel=1e-9)
    resting = result.t > 0.0
    assert result["floor.normal_force"][resting] == pytest.approx(5.0 * G, rel=1e-9)
    assert result["floor.impulse"][-1] == pytest.approx(5.0 * G * 0.7 + hit.impulse, rel=1e-9)


def test_impact_never_pulls_at_another_contact():
    """A plank lies on two supports and is struck on its overhang: it turns about the near support, the far one lets
    go. Turning about the support at distance d of the centre it has the effective mass (J + m d^2)/l^2 at the ball."""
    e, inertia, d, lever = 0.5, 1.0 / 3.0, 0.4, 0.6
    feet = [
        DiskOnHalfPlane2D(name=name, plane=HalfPlane2D(), disk=Disk2D(marker=on("plank", x)), law=PLASTIC)
        for name, x in (("far", -0.6), ("near", d))
    ]
    top = DiskOnHalfPlane2D(
        name="top", plane=HalfPlane2D(marker=on("plank")), disk=Disk2D(marker=on("ball")), law=HALF
    )  # fmt: skip
    bodies = [
        RigidBody2D(name="plank", mass=1.0, inertia=inertia),
        PointMass2D(name="ball", mass=1.0, position=(d + lever, 0.5)),
    ]
    result = simulate(Model(bodies=bodies, contacts=[*feet, top]), 0.33, rtol=1e-8, atol=1e-10)
    hit = next(event for event in result.events if event.contact == "top")
    reduced = 1.0 / (1.0 + lever**2 / (inertia + d**2))
    assert hit.impulse == pytest.approx((1.0 + e) * math.sqrt(G) * reduced, rel=1e-7)
    assert [event.contact for event in events(result, "open")] == ["far"]
    assert result["far.gap"][-1] > 0.0 and np.abs(result["near.gap"]).max() < 1e-12
    for name in ("far", "near", "top"):
        assert np.all(np.diff(result[f"{name}.impulse"]) > -1e-12)


@pytest.mark.parametrize("rest_ratio", [1e-6, 0.9])
def test_contact_that_lets_go_in_a_blow_first_tried_as_resting_has_its_event(rest_ratio):
    """A bar turns about its tip on the floor onto a peg near its middle (a < J/(m l)), so that the blow lifts the tip;
    a torque lifts the bar off the peg, so that the blow is no rest. rest_ratio 0.9 tries rest first.

    The free bar's rates after the blow: dv_c = P/m, dw = P a/J with the gap rate at the peg reversed by e = 1/2.
    """
    m, inertia, a, rate, torque, drop = 1.0, 1.0, 0.1, -1.0, 5.0, 0.01
    bar = RigidBody2D(
        name="bar", mass=m, inertia=inertia, position=(1.0, 0.0), velocity=(0.0, rate), angular_velocity=rate
    )
    law = NewtonImpact(restitution=0.5, rest_ratio=rest_ratio)
    peg = HalfPlane2D(marker=Marker2D(point=(0.0, -drop)))
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[bar],
        forces=[AppliedTorque2D(name="lift", body="bar", torque=Constant(value=torque))],
        contacts=[
            DiskOnHalfPlane2D(name="tip", plane=HalfPlane2D(), disk=Disk2D(marker=on("bar", -1.0)), law=law),
            DiskOnHalfPlane2D(name="peg", plane=peg, disk=Disk2D(marker=on("bar", a)), law=law),
        ],
    )
    result = simulate(model, 0.05, rtol=1e-9, atol=1e-12)
    assert [(e.kind, e.contact) for e in result.events] == [("close", "tip"), ("impact", "peg"), ("open", "tip")]
    _, blow, release = result.events
    assert release.t == blow.t
    impulse = 1.5 * blow.approach_speed / (1.0 / m + a * a / inertia)
    assert blow.impulse == pytest.approx(impulse, rel=1e-3)  # the bar is nearly level
    assert release.separation_speed == pytest.approx(impulse * (1.0 / m - a / inertia), rel=1e-3)
    assert not result["tip.in_contact"][-1] and result["tip.gap"][-1] > 0.0
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_ball_on_ball_on_floor_come_to_rest():
    """Two balls, one above the other, e = 0.5: both lie still at the end, floor under both weights. They are led
    upright: freely, one on top of the other would roll off."""
    bodies = [
        PointMass2D(name="low", mass=2.0, position=(0.0, 0.7)),
        PointMass2D(name="high", mass=1.0, position=(0.0, 1.5)),
    ]
    contacts = [
        floor_contact(HALF, body="low", radius=0.2),
        DiskOnDisk2D(
            name="pair", a=Disk2D(marker=on("low"), radius=0.2), b=Disk2D(marker=on("high"), radius=0.2), law=HALF
        ),
    ]
    upright = [
        CoordinateDriver(name=f"{body}_guide", body=body, coordinate="x", motion=Constant(value=0.0))
        for body in ("low", "high")
    ]
    result = simulate(Model(bodies=bodies, joints=upright, contacts=contacts), 4.0)
    assert result["floor.normal_force"][-1] == pytest.approx(3.0 * G, rel=1e-9)
    assert result["pair.normal_force"][-1] == pytest.approx(G, rel=1e-9)
    assert np.abs(result.v[-1]).max() < 1e-10
    assert result["low.y"][-1] == pytest.approx(0.2, abs=1e-10)
    assert result["high.y"][-1] == pytest.approx(0.6, abs=1e-10)
    assert result["floor.gap"].min() > -1e-12 and result["pair.gap"].min() > -1e-12
    assert np.all(np.diff(result["energy.impact_loss"]) >= -1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-7 * G


# ---- grazing ---------------------------------------------------------------------------------------------


def thrown_at_ceiling(clearance, law=HALF, speed=4.0):
    """Thrown upwards at a ceiling that lies `clearance` above the top of the flight."""
    top = speed**2 / (2.0 * G)
    ceiling = HalfPlane2D(marker=Marker2D(point=(0.0, top + clearance), angle=math.pi))
    contact = DiskOnHalfPlane2D(name="ceiling", plane=ceiling, disk=Disk2D(marker=on("ball")), law=law)
    return Model(bodies=[PointMass2D(name="ball", mass=1.0, velocity=(0.3, speed))], contacts=[contact])


@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("method", ["irk", "ebdf", "newmark"])
def test_graze_inside_one_large_step_is_not_stepped_over(method, depth):
    """The gap is negative for sqrt(8 depth / g) only, in the middle of a step of 0.5 s."""
    result = simulate(thrown_at_ceiling(-depth), 0.7, method, step=0.5, rtol=1e-6)
    (hit,) = events(result, "impact")
    approach = math.sqrt(2.0 * G * depth)
    assert hit.t == pytest.approx((4.0 - approach) / G, abs=1e-9)
    assert hit.approach_speed == pytest.approx(approach, rel=1e-4)
    assert hit.separation_speed == pytest.approx(0.5 * approach, rel=1e-4)
    assert result["ceiling.gap"].min() > -1e-12


@pytest.mark.parametrize("clearance", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("method", ["irk", "ebdf", "newmark"])
def test_near_miss_is_no_event(method, clearance):
    result = simulate(thrown_at_ceiling(clearance), 0.7, method, step=0.5)
    assert not result.events
    assert result["ball.y"][-1] == pytest.approx(4.0 * 0.7 - 0.5 * G * 0.49, abs=1e-9)


@pytest.mark.parametrize("depth", [1e-2, 1e-5])
def test_graze_with_a_force_law_is_found(depth):
    model = thrown_at_ceiling(-depth, Flores(stiffness=1e6, restitution=0.5))
    result = simulate(model, 0.7, "irk", max_step=0.5, rtol=1e-8, atol=1e-12)
    kinds = [event.kind for event in result.events]
    assert kinds[:2] == ["close", "open"]
    assert result.events[0].approach_speed == pytest.approx(math.sqrt(2.0 * G * depth), rel=1e-4)


def test_gap_of_user_equations_bounces_like_the_element():
    system = EquationSystem(
        mass=np.eye(1), force=np.array([-G]), q0=[1.0], v0=[0.0],
        contacts=[GapContact("floor", lambda t, q: q[0], NewtonImpact(restitution=0.8))],
    )  # fmt: skip
    result = simulate(system, 2.5)
    times = [event.t for event in events(result, "impact")]
    expected = [FALL * (1.0 + 2.0 * sum(0.8**k for k in range(1, n))) for n in range(1, len(times) + 1)]
    assert len(times) >= 4
    assert times == pytest.approx(expected, abs=1e-10)


def test_moving_floor_of_user_equations_throws_the_ball():
    """A floor that rises with u: the impact reverses the velocity relative to it."""
    u, e = 0.7, 0.6
    system = EquationSystem(
        mass=np.eye(1), force=np.array([-G]), q0=[1.0], v0=[0.0],
        contacts=[GapContact("floor", lambda t, q: q[0] - u * t, NewtonImpact(restitution=e))],
    )  # fmt: skip
    result = simulate(system, 0.6)
    (hit, *_) = events(result, "impact")
    t = (-u + math.sqrt(u**2 + 2.0 * G)) / G
    assert hit.t == pytest.approx(t, abs=1e-10)
    assert hit.approach_speed == pytest.approx(G * t + u, rel=1e-9)
    k = np.flatnonzero(result.t == hit.t)[-1]
    assert result.v[k, 0] == pytest.approx(u + e * (G * t + u), rel=1e-9)
