"""A disk on a finite segment: geometry, derivatives, rolling off its end, bouncing on its corner, friction."""

import math

import numpy as np
import pytest
from contact_points import ContactPoint, check_derivatives, state_at
from helpers import G, events, on, residuals
from scipy.integrate import quad
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnSegment2D,
    KelvinVoigt,
    LuGreFriction,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    PoissonImpact,
    RigidBody2D,
    Segment2D,
    TanhFriction,
    simulate,
)
from tlismni.core.state.modes import ACTIVE, CLOSED, OPEN

TIGHT = {"rtol": 1e-10, "atol": 1e-12}
LENGTH, RADIUS, HALF = 1.5, 0.3, 0.05
PLATE = RigidBody2D(name="plate", mass=1.3, inertia=0.4)
WHEEL = RigidBody2D(name="wheel", mass=0.7, inertia=0.2)
START = (-0.4, 0.2)
TILT = 0.5
BRISTLES = LuGreFriction(
    coefficient=0.4, static_coefficient=0.6, stribeck_speed=0.5, bristle_stiffness=0.3, bristle_damping=0.2,
    viscous_damping=0.1,
)  # fmt: skip
CASES = {
    "constraint": (NewtonImpact(restitution=0.5), None, CLOSED, 0.0),
    "open": (NewtonImpact(restitution=0.5), None, OPEN, 0.0),
    "force": (KelvinVoigt(stiffness=4.0, damping=0.8), None, ACTIVE, 0.0),
    "sticking": (NewtonImpact(restitution=0.5), CoulombFriction(coefficient=0.4), CLOSED, 0.0),
    "sliding": (NewtonImpact(restitution=0.5), CoulombFriction(coefficient=0.4), CLOSED, -1.0),
    "friction force": (
        KelvinVoigt(stiffness=60.0, damping=0.1), TanhFriction(coefficient=0.4, transition_speed=0.3), ACTIVE, 0.0
    ),
    "bristles": (KelvinVoigt(stiffness=60.0, damping=0.1), BRISTLES, ACTIVE, 0.0),
}  # fmt: skip


def contact(law, friction=None, radius=RADIUS, half=HALF, plate="plate"):
    return DiskOnSegment2D(
        name="c", segment=Segment2D(marker=Marker2D(body=plate, point=START, angle=TILT), length=LENGTH, radius=half),
        disk=Disk2D(marker=on("wheel", 0.1, -0.05), radius=radius), law=law, friction=friction,
    )  # fmt: skip


def placed(x, height, plate=(0.3, -0.2, 0.7), spin=0.4):
    """Coordinates with the disk's centre at (x, height) of the segment's frame."""
    px, py, theta = plate
    c, s = math.cos(theta), math.sin(theta)
    axis = theta + TILT
    cx = px + c * START[0] - s * START[1] + math.cos(axis) * x - math.sin(axis) * height
    cy = py + s * START[0] + c * START[1] + math.sin(axis) * x + math.cos(axis) * height
    bx, by = 0.1 * math.cos(spin) + 0.05 * math.sin(spin), 0.1 * math.sin(spin) - 0.05 * math.cos(spin)
    return np.array([px, py, theta, cx - bx, cy - by, spin])


PLACES = [(0.7, 0.3), (0.7, -0.3), (-0.2, 0.25), (-0.2, -0.2), (LENGTH + 0.2, 0.25), (LENGTH + 0.2, -0.25), (-0.3, 0.0)]


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("case", CASES)
def test_derivatives(case, place):
    law, friction, mode, slide = CASES[case]
    point = ContactPoint(Model(bodies=[PLATE, WHEEL], contacts=[contact(law, friction)]), mode, slide)
    for seed in range(2):
        distances = slice(1) if friction is BRISTLES else slice(None)
        check_derivatives(point, state_at(point, placed(*place), seed), distances=distances)


@pytest.fixture(scope="module")
def sliding():
    law, friction, *_ = CASES["sliding"]
    return ContactPoint(Model(bodies=[PLATE, WHEEL], contacts=[contact(law, friction)]), OPEN)


def contour(u, away=RADIUS + HALF):
    """Place (x, height) and unit normal of the disk's centre at arc length u of the path round the segment."""
    arc = math.pi * away
    u %= 2.0 * LENGTH + 2.0 * arc
    if u < LENGTH:
        return (u, away), (0.0, 1.0)
    if u < LENGTH + arc:
        angle = 0.5 * math.pi - (u - LENGTH) / away
        return (LENGTH + away * math.cos(angle), away * math.sin(angle)), (math.cos(angle), math.sin(angle))
    if u < 2.0 * LENGTH + arc:
        return (2.0 * LENGTH + arc - u, -away), (0.0, -1.0)
    angle = -0.5 * math.pi - (u - 2.0 * LENGTH - arc) / away
    return (away * math.cos(angle), away * math.sin(angle)), (math.cos(angle), math.sin(angle))


def test_gap_is_the_distance_of_the_nearest_point(sliding):
    random = np.random.default_rng(3)
    line = np.linspace(0.0, LENGTH, 4001)
    for _ in range(50):
        x, height = random.uniform(-1.0, LENGTH + 1.0), random.uniform(-1.0, 1.0)
        nearest = np.min(np.hypot(x - line, height))
        gap, _ = sliding.gap(placed(x, height))
        assert gap == pytest.approx(nearest - RADIUS - HALF, abs=1e-6)


def test_sliding_distance_goes_on_along_the_whole_contour(sliding):
    """A disk that does not turn slides by the arc length of its contact point, all round and through every corner."""
    round_trip = 2.0 * LENGTH + 2.0 * math.pi * (RADIUS + HALF)
    along = np.linspace(0.0, round_trip, 1201)
    values = [sliding.slide(placed(*contour(u)[0]))[0] for u in along]
    steps = np.diff(values)
    steps -= round_trip * np.rint(steps / round_trip)
    assert steps == pytest.approx(np.diff(along), abs=1e-12)
    assert np.abs([sliding.gap(placed(*contour(u)[0]))[0] for u in along]).max() < 1e-14


def test_rates_are_those_of_the_material_points_in_touch(sliding):
    """At zero gap: the velocity of the disk's point of contact on the plate's, along the normal and the tangent."""
    random = np.random.default_rng(5)
    for u in np.linspace(0.05, 2.0 * LENGTH + 2.0 * math.pi * (RADIUS + HALF), 40):
        place, local = contour(u)
        q, v = placed(*place), random.uniform(-1.0, 1.0, 6)
        axis = q[2] + TILT
        c, s = math.cos(axis), math.sin(axis)
        n = np.array([c * local[0] - s * local[1], s * local[0] + c * local[1]])
        spin = q[5]
        offset = np.array([0.1 * math.cos(spin) + 0.05 * math.sin(spin), 0.1 * math.sin(spin) - 0.05 * math.cos(spin)])
        touch = q[3:5] + offset - RADIUS * n
        velocities = [
            np.array([v[i] - v[i + 2] * (touch - q[i : i + 2])[1], v[i + 1] + v[i + 2] * (touch - q[i : i + 2])[0]])
            for i in (0, 3)
        ]
        relative = velocities[1] - velocities[0]
        tangent = np.array([n[1], -n[0]])
        assert sliding.gap(q, v)[1] == pytest.approx(relative @ n, abs=1e-13)
        assert sliding.slide(q, v)[1] == pytest.approx(relative @ tangent, abs=1e-13)


# ---- motion ---------------------------------------------------------------------------------------------------------


def ledge(speed, law=None, friction=None, radius=0.2, half=0.0, length=1.0, start=0.7, **parts):
    """A disk that starts `start` along a level ledge from the origin, in touch, moving with `speed` to its end."""
    ball = PointMass2D(name="ball", mass=2.0, position=(start, radius + half), velocity=(speed, 0.0))
    floor = DiskOnSegment2D(
        name="ledge", segment=Segment2D(length=length, radius=half), disk=Disk2D(marker=on("ball"), radius=radius),
        law=law or NewtonImpact(restitution=0.0), friction=friction,
    )  # fmt: skip
    return Model(bodies=[ball], contacts=[floor], gravity=(0.0, -G), **parts)


@pytest.mark.parametrize("half", [0.0, 0.05])
def test_disk_slips_over_the_end_and_falls(half):
    """It goes round the end as a pendulum on its head, and leaves where cos(phi) = 2/3 + v^2/(3 g R)."""
    speed, away = 0.4, 0.2 + half
    result = simulate(ledge(speed, half=half), 1.4, **TIGHT)
    (opened,) = events(result, "open")
    leave = math.acos(2.0 / 3.0 + speed**2 / (3.0 * G * away))
    rate = lambda phi: math.sqrt(speed**2 + 2.0 * G * away * (1.0 - math.cos(phi))) / away  # noqa: E731
    at_end, falling = 0.3 / speed, quad(lambda phi: 1.0 / rate(phi), 0.0, leave, epsabs=1e-13)[0]
    assert opened.t == pytest.approx(at_end + falling, abs=1e-7)
    after = result.t >= opened.t
    t = result.t[after] - at_end - falling
    v = away * rate(leave)
    assert v == pytest.approx(math.sqrt(G * away * math.cos(leave)))
    x = 1.0 + away * math.sin(leave) + v * math.cos(leave) * t
    y = away * math.cos(leave) - v * math.sin(leave) * t - 0.5 * G * t**2
    assert np.abs(result["ball.x"][after] - x).max() < 1e-6
    assert np.abs(result["ball.y"][after] - y).max() < 1e-6
    assert np.abs(result["energy.balance"]).max() < 1e-8
    assert max(residuals(result)) < 1e-9


def test_fast_disk_leaves_at_the_end():
    """With v^2 > g R no force could bend its path round the end: a parabola from there."""
    speed, radius = 2.0, 0.2
    result = simulate(ledge(speed, radius=radius), 1.0, **TIGHT)
    (opened,) = events(result, "open")
    assert opened.t == pytest.approx(0.3 / speed, abs=1e-9)
    after = result.t > opened.t
    fall = radius - 0.5 * G * (result.t[after] - 0.3 / speed) ** 2
    assert result["ball.y"][after] == pytest.approx(fall, abs=1e-8)


@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("law", [NewtonImpact, PoissonImpact])
def test_disk_bounces_on_a_corner(law, restitution):
    """The impulse goes through the corner: v' = v - (1 + e) (v . n) n, n from the corner to the centre."""
    away, phi, speed = 0.25, 0.6, 3.0
    n = np.array([math.sin(phi), math.cos(phi)])
    ball = PointMass2D(name="ball", mass=2.0, position=(1.0 + away * n[0], away * n[1] + speed), velocity=(0.0, -speed))
    floor = DiskOnSegment2D(
        name="ledge", segment=Segment2D(length=1.0, radius=0.05), disk=Disk2D(marker=on("ball"), radius=0.2),
        law=law(restitution=restitution),
    )  # fmt: skip
    result = simulate(Model(bodies=[ball], contacts=[floor], gravity=(0.0, 0.0)), 1.5, **TIGHT)
    (impact,) = events(result, "impact")
    assert impact.t == pytest.approx(1.0, abs=1e-10)
    before = np.array([0.0, -speed])
    after = before - (1.0 + restitution) * (before @ n) * n
    if restitution:
        assert [result["ball.vx"][-1], result["ball.vy"][-1]] == pytest.approx(after, abs=1e-9)
    k = int(np.flatnonzero(result.t > impact.t)[0])
    assert [result["ball.vx"][k], result["ball.vy"][k]] == pytest.approx(after, abs=1e-6)
    assert impact.energy_loss == pytest.approx(0.5 * 2.0 * (1.0 - restitution**2) * (before @ n) ** 2, rel=1e-9)


def test_force_contact_keeps_its_energy_over_the_end():
    """A spring contact between face and corner: force and gap go on, energy is kept."""
    result = simulate(ledge(0.4, KelvinVoigt(stiffness=1e5, damping=0.0)), 1.3, **TIGHT)
    assert result.events[0].kind == "close"
    assert result["ball.y"][-1] < 0.0
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_disk_falls_on_the_back_from_below():
    """Thrown up against the underside it bounces down again."""
    ball = PointMass2D(name="ball", mass=1.0, position=(0.5, -1.2), velocity=(0.0, 2.0))
    roof = DiskOnSegment2D(
        name="roof", segment=Segment2D(length=1.0), disk=Disk2D(marker=on("ball"), radius=0.2),
        law=NewtonImpact(restitution=1.0),
    )  # fmt: skip
    result = simulate(Model(bodies=[ball], contacts=[roof], gravity=(0.0, 0.0)), 1.0, **TIGHT)
    (impact,) = events(result, "impact")
    assert impact.t == pytest.approx(0.5, abs=1e-12)
    assert result["ball.vy"][-1] == pytest.approx(-2.0, rel=1e-12)


# ---- friction -------------------------------------------------------------------------------------------------------


def test_friction_along_the_face_brakes_and_holds():
    mu, speed = 0.3, 1.0
    result = simulate(ledge(speed, friction=CoulombFriction(coefficient=mu), start=0.2), 0.6, **TIGHT)
    stop = speed / (mu * G)
    (stuck,) = events(result, "stick")
    assert stuck.t == pytest.approx(stop, abs=1e-9)
    t = np.minimum(result.t, stop)
    assert result["ball.x"] == pytest.approx(0.2 + speed * t - 0.5 * mu * G * t**2, abs=1e-9)
    assert np.abs(result["energy.balance"]).max() < 1e-9


def wheel_on_ledge(speed, friction, law=None, radius=0.2):
    """A homogeneous wheel that rolls to the end of the ledge."""
    wheel = RigidBody2D(
        name="wheel", mass=2.0, inertia=0.5 * 2.0 * radius**2, position=(0.8, radius), velocity=(speed, 0.0),
        angular_velocity=-speed / radius,
    )  # fmt: skip
    floor = DiskOnSegment2D(
        name="ledge", segment=Segment2D(length=1.0), disk=Disk2D(marker=on("wheel"), radius=radius),
        law=law or NewtonImpact(restitution=0.0), friction=friction,
    )  # fmt: skip
    return Model(bodies=[wheel], contacts=[floor], gravity=(0.0, -G))


def test_wheel_rolls_over_the_end_without_slip():
    """Rolling round the corner: 3/4 v^2 grows by the fall of the centre; it slips before it leaves."""
    speed, radius = 0.4, 0.2
    result = simulate(wheel_on_ledge(speed, CoulombFriction(coefficient=2.0)), 1.2, **TIGHT)
    slip, opened = events(result, "slip")[0], events(result, "open")[0]
    assert 0.5 < slip.t < opened.t
    rolling = (result.t > 0.5) & (result.t < slip.t)
    assert rolling.sum() > 10
    drop = radius - result["wheel.y"][rolling]
    v2 = result["wheel.vx"][rolling] ** 2 + result["wheel.vy"][rolling] ** 2
    assert v2 == pytest.approx(speed**2 + 4.0 / 3.0 * G * drop, rel=1e-8)
    assert v2 == pytest.approx((radius * result["wheel.angular_velocity"][rolling]) ** 2, rel=1e-8)
    assert np.abs(result["ledge.sliding_velocity"][result.t < slip.t]).max() < 1e-9
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_regularised_friction_keeps_the_balance_over_the_end():
    law = KelvinVoigt(stiffness=1e5, damping=50.0)
    friction = TanhFriction(coefficient=0.5, transition_speed=1e-2)
    result = simulate(wheel_on_ledge(0.4, friction, law), 1.2, rtol=1e-8, atol=1e-11)
    assert result["wheel.y"][-1] < 0.0
    assert np.abs(result["energy.balance"]).max() < 1e-6
    spun = 0.5 * 2.0 * 0.2**2 * result["wheel.angular_velocity"]
    assert abs(spun[-1]) > abs(spun[0])


# ---- the record -----------------------------------------------------------------------------------------------------


def test_a_point_on_a_line_without_thickness_is_refused():
    with pytest.raises(ModelError, match="both 0"):
        contact(NewtonImpact(restitution=0.5), radius=0.0, half=0.0)


def test_json_round_trip():
    model = ledge(0.3, friction=CoulombFriction(coefficient=0.3), half=0.02)
    assert Model.from_json(model.to_json()) == model
