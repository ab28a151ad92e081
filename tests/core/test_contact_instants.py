"""Instants that are easily missed: accumulation, the ends of a run, grazing; and very many impacts in a row."""

import math
import tracemalloc

import numpy as np
import pytest
from helpers import G, ball_over_floor, events, on
from sliders import foot, kinds
from tlismni.core import (
    CoordinateDriver,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    PoissonImpact,
    Polynomial,
    RigidBody2D,
    Simulation,
    simulate,
)

FALL = math.sqrt(2.0 / G)


# ---- accumulation ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("e", [0.2, 0.6, 0.85])
@pytest.mark.parametrize("law", [NewtonImpact, PoissonImpact])
def test_bounces_end_in_rest_at_their_accumulation_point(e, law):
    """t = sqrt(2 h/g) (1 + e)/(1 - e), but for the bounces that the rest rule drops."""
    result = simulate(ball_over_floor(law(restitution=e)), 20.0 * FALL, rtol=1e-9)
    (rest,) = events(result, "rest")
    dropped = 2.0 * 1e-6 * math.sqrt(2.0 * G) / (G * (1.0 - e))
    exact = FALL * (1.0 + e) / (1.0 - e)
    assert exact - dropped * (1.0 + 1e-6) <= rest.t <= exact
    # the losses of all impacts are all of the energy
    assert sum(hit.energy_loss for hit in events(result, "impact")) == pytest.approx(G, rel=1e-9)
    assert result["ball.y"][-1] == pytest.approx(0.0, abs=1e-14)


def test_accumulation_on_a_slope_ends_in_sliding():
    """Bouncing down a slope with friction: at rest across the slope, it slides on with g (sin - mu cos)."""
    angle, mu, e = 0.5, 0.1, 0.4
    c, s = math.cos(angle), math.sin(angle)
    body = PointMass2D(name="b", mass=2.0, position=(-0.3 * s, 0.3 * c))
    plane = HalfPlane2D(marker=Marker2D(angle=angle))
    model = Model(bodies=[body], contacts=[foot("c", "b", mu=mu, plane=plane, law=NewtonImpact(restitution=e))])
    result = simulate(model, 2.0, rtol=1e-9)
    fall = math.sqrt(2.0 * 0.3 / (G * c))
    (rest,) = events(result, "rest")
    assert rest.t == pytest.approx(fall * (1.0 + e) / (1.0 - e), abs=2e-6)
    late = result.t > rest.t
    down = -c * result["b.ax"] - s * result["b.ay"]
    assert down[late] == pytest.approx(G * (s - mu * c), rel=1e-9)
    # each impact's friction is mu P too: the speed along the slope is that of sliding all the time
    speed = -c * result["b.vx"] - s * result["b.vy"]
    assert speed[-1] == pytest.approx(G * (s - mu * c) * 2.0, rel=1e-6)


def test_two_balls_accumulate_between_floor_and_each_other():
    """A ball falls on one that lies: impacts of both contacts accumulate at one time, and both lie still after."""
    bodies = [
        PointMass2D(name="low", mass=2.0, position=(0.0, 0.1)),
        PointMass2D(name="top", mass=1.0, position=(0.0, 0.5)),
    ]
    law = NewtonImpact(restitution=0.5)
    pair = DiskOnDisk2D(
        name="pair", a=Disk2D(marker=on("low"), radius=0.1), b=Disk2D(marker=on("top"), radius=0.1), law=law
    )
    guide = [
        CoordinateDriver(name=f"g{b}", body=b, coordinate="x", motion=Polynomial(coefficients=(0.0,)))
        for b in ("low", "top")
    ]
    model = Model(bodies=bodies, joints=guide, contacts=[foot("c", "low", mu=None, radius=0.1, law=law), pair])
    result = simulate(model, 3.0, rtol=1e-9)
    late = result.t > 2.0
    assert result["c.normal_force"][late] == pytest.approx(3.0 * G, rel=1e-9)
    assert result["pair.normal_force"][late] == pytest.approx(G, rel=1e-9)
    assert result["c.gap"].min() > -1e-12 and result["pair.gap"].min() > -1e-12
    assert np.all(np.diff(result["energy.impact_loss"]) >= -1e-15)


# ---- the ends of a run ----------------------------------------------------------------------------------------------


def test_impact_at_the_start_and_at_the_end():
    up = math.sqrt(2.0 * G) * 0.5
    law = NewtonImpact(restitution=0.5)
    first = simulate(ball_over_floor(law, height=0.0, speed=-2.0 * up), 0.05)
    assert [e.t for e in first.events] == [0.0] and first.events[0].separation_speed == pytest.approx(up)
    # an impact in the last instant belongs to the run, and the run ends there
    end = math.sqrt(2.0 / 8.0)
    last = simulate(ball_over_floor(law, gravity=8.0), end, rtol=1e-9)
    assert last.t[-1] == end
    assert all(abs(e.t - end) < 1e-12 for e in last.events) and len(last.events) <= 1
    on_from_there = simulate(ball_over_floor(law, gravity=8.0), end + 1e-9, rtol=1e-9)
    assert [e.t for e in on_from_there.events] == pytest.approx([end], abs=1e-12)


def test_run_stopped_at_an_impact_goes_on_as_if_it_had_not_stopped():
    law = NewtonImpact(restitution=0.5)
    end = math.sqrt(2.0 / 8.0)
    sim = Simulation(ball_over_floor(law, gravity=8.0), rtol=1e-9)
    for t in (end, math.nextafter(end, 1.0), end + 1e-12, 1.2):
        sim.advance(t)
    assert [e.t for e in sim.events if e.kind == "impact"] == pytest.approx([end, 2.0 * end], abs=1e-10)


def test_sliding_that_ends_where_the_run_ends():
    stop = 1.5 / (0.3 * G)
    body = PointMass2D(name="b", mass=2.0, velocity=(1.5, 0.0))
    model = Model(bodies=[body], contacts=[foot("c", "b")])
    result = simulate(model, stop, rtol=1e-9)
    assert result["b.vx"][-1] == pytest.approx(0.0, abs=1e-12)
    assert kinds(simulate(model, stop + 1e-6, rtol=1e-9))[-1] == ("stick", "c")


# ---- grazing --------------------------------------------------------------------------------------------------------


def under_ceiling(depth, speed=4.0, law=None):
    """Thrown up at a ceiling that lies `depth` below the top of the flight."""
    top = speed**2 / (2.0 * G)
    ceiling = HalfPlane2D(marker=Marker2D(point=(0.0, top - depth), angle=math.pi))
    contact = DiskOnHalfPlane2D(
        name="c", plane=ceiling, disk=Disk2D(marker=on("b")), law=law or NewtonImpact(restitution=0.5)
    )
    return Model(bodies=[PointMass2D(name="b", mass=1.0, velocity=(0.3, speed))], contacts=[contact])


@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9])
def test_near_grazing_impacts_are_found_in_steps_far_longer_than_they_last(method, depth):
    result = simulate(under_ceiling(depth), 0.7, method, step=0.35, rtol=1e-9)
    (hit,) = events(result, "impact")
    approach = math.sqrt(2.0 * G * depth)
    assert hit.t == pytest.approx((4.0 - approach) / G, abs=1e-8)
    assert hit.approach_speed == pytest.approx(approach, rel=1e-3)
    assert result["c.gap"].min() > -1e-13


@pytest.mark.parametrize("method, options", [("irk", {"step": 0.35}), ("ebdf", {}), ("newmark", {"step": 0.35})])
def test_a_gap_that_just_touches_is_a_graze_or_nothing(method, options):
    """The extremum of the gap lies inside a step and is zero to rounding: no impact (but for what rounding of more than
    the gap's makes of it), and the motion goes on."""
    found = []
    for depth in np.arange(-4, 9) * 2e-16:
        result = simulate(under_ceiling(depth), 0.7, method, **options)
        found += [event.kind for event in result.events]
        assert all(event.approach_speed < 1e-6 for event in result.events)
        assert all(event.t == pytest.approx(4.0 / G, abs=1e-6) for event in result.events)
        assert result["b.y"][-1] == pytest.approx(2.8 - 0.5 * G * 0.49, abs=1e-6)
    assert found.count("graze") > 3 * found.count("impact")


def test_touch_of_a_driven_body_is_a_graze():
    """A table rises to a ball that hangs still, and sinks: the gap is 0.1 (1 - t)^2."""
    table = RigidBody2D(name="table", mass=1.0, inertia=1.0, position=(0.0, -0.1), velocity=(0.0, 0.2))
    motions = {"x": (0.0,), "y": (-0.1, 0.2, -0.1), "angle": (0.0,)}
    drive = [
        CoordinateDriver(name=f"d{name}", body="table", coordinate=name, motion=Polynomial(coefficients=c))
        for name, c in motions.items()
    ]
    ball = PointMass2D(name="ball", mass=1.0)
    contact = foot("c", "ball", mu=None, plane=HalfPlane2D(marker=on("table")), law=NewtonImpact(restitution=0.5))
    model = Model(gravity=(0.0, 0.0), bodies=[table, ball], joints=drive, contacts=[contact])
    for method in ("irk", "ebdf"):
        result = simulate(model, 2.0, method, max_step=0.3, rtol=1e-9)
        assert {event.kind for event in result.events} <= {"graze"}
        assert np.abs(result["ball.y"]).max() < 1e-6


# ---- very many impacts ----------------------------------------------------------------------------------------------

BOUNCES = 10_000


def test_ten_thousand_elastic_bounces():
    """Bounce n at (2 n - 1) sqrt(2 h/g): errors grow as sums of rounding do; memory with the list of events only."""
    sim = Simulation(ball_over_floor(NewtonImpact(restitution=1.0)), "irk", rtol=1e-8)
    sim.advance(200.0 * FALL)
    structures = len(sim.workspace.slots)
    tracemalloc.start()
    sim.advance(400.0 * FALL)
    before, _ = tracemalloc.get_traced_memory()
    sim.advance(800.0 * FALL)
    growth = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert growth < 200 * 1000
    sim.advance((2 * BOUNCES - 0.5) * FALL)
    times = np.array([e.t for e in sim.events])
    n = np.arange(1, BOUNCES + 1)
    assert len(times) == BOUNCES
    # an error of one bounce in its speed, eps, is one in the time of all that follow: eps n^1.5 if they are independent
    errors = np.abs(times / FALL - (2.0 * n - 1.0))
    assert np.all(errors <= 5e-15 * n**1.5)
    assert np.ptp([e.separation_speed for e in sim.events]) < 1e-13 * math.sqrt(2.0 * G)
    assert len(sim.workspace.slots) == structures <= 3
    assert not sim.samples
