"""Steps of impulses, which a run takes where instants crowd: closed forms, ledger, constraints, states.

Most of these put a run into such steps themselves; real crowds are in `test_heap.py` and `test_heap3d.py`.
"""

import math

import numpy as np
import pytest
from numba import njit
from scipy.optimize import nnls
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    Revolute2D,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    Sphere3D,
    SphereOnHalfSpace3D,
    TurningFriction,
    simulate,
)
from tlismni.core.contact_solvers.contact_blocks import WIDE, block_reals, block_wholes, pack_block
from tlismni.core.contact_solvers.row_sweeps import press_apart, sweep_rows
from tlismni.core.events.zeno import SIZE
from tlismni.core.state.modes import CLOSED, STEP_FORCES

G, R = 9.81, 0.1


def in_steps(model, step=None, method="ebdf", **options):
    """A run that goes on in steps of impulses only, for ever."""
    sim = Simulation(model, method, **options)
    sim.advance(0.0)
    clock = sim.clock
    clock.push_step, clock.pushes = step or SIZE * sim.scales.time, 1e9
    clock.pushes_left, clock.pushed_from = 1e9, sim.t_internal
    sim.drive.pending[:] = sim.memory.mode == CLOSED
    return sim


def values(sim):
    return dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))


def ball(v=(0.0, 0.0, 0.0), w=(0.0, 0.0, 0.0), height=0.0, mu=0.3, restitution=0.5, turning=None, mass=2.0):
    body = RigidBody3D(
        name="ball", mass=mass, inertia=(0.4 * mass * R**2,) * 3, position=(0.0, 0.0, height + R), velocity=v,
        angular_velocity=w,
    )  # fmt: skip
    floor = SphereOnHalfSpace3D(
        name="floor", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=R),
        law=NewtonImpact(restitution=restitution), friction=CoulombFriction(coefficient=mu), turning=turning,
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=[floor])


def block(slope, mu):
    """A block with two feet on a slope, in the plane."""
    law = {"law": NewtonImpact(restitution=0.0), "friction": CoulombFriction(coefficient=mu)}
    body = RigidBody2D(name="block", mass=1.0, inertia=0.02, position=(0.0, 0.1))
    feet = [
        DiskOnHalfPlane2D(
            name=f"foot{k}", plane=HalfPlane2D(),
            disk=Disk2D(marker=Marker2D(body="block", point=(x, -0.09)), radius=0.01), **law,
        )
        for k, x in enumerate((-0.2, 0.2))
    ]  # fmt: skip
    return Model(gravity=(G * math.sin(slope), -G * math.cos(slope)), bodies=[body], contacts=feet)


def test_what_rests_stays_where_it_is():
    """The impulse of each step is the weight's: no motion, and the mean force is the floor's."""
    sim = in_steps(ball())
    for t in (0.01, 0.0237, 0.05):
        sim.advance(t)
        now = values(sim)
        assert now["ball.z"] == pytest.approx(R, abs=1e-12)
        assert now["ball.vz"] == pytest.approx(0.0, abs=1e-12)
        assert now["floor.normal_force"] == pytest.approx(2.0 * G, rel=1e-9)
    assert sim.clock.push_step > 0.0
    assert [event.kind for event in sim.events] == ["close"]
    n, newest = sim.assembly.n_extended, sim.method_arrays["history"][sim.method_arrays["ring"][0]]
    assert newest[2 * n : 2 * n + 7] == pytest.approx(np.zeros(7), abs=1e-9)


@pytest.mark.parametrize("mu", [0.3, 0.5])
def test_a_block_on_a_slope_sticks_or_slides(mu):
    """Where it sticks it does not creep; where it slides it does so with g (sin - mu cos)."""
    slope, end = math.atan(0.4), 0.3
    sim = in_steps(block(slope, mu))
    sim.advance(end)
    acceleration = max(G * (math.sin(slope) - mu * math.cos(slope)), 0.0)
    assert values(sim)["block.x"] == pytest.approx(0.5 * acceleration * end**2, abs=1e-10)
    assert values(sim)["block.angle"] == pytest.approx(0.0, abs=1e-10)
    total = sum(values(sim)[f"foot{k}.normal_force"] for k in range(2))
    assert total == pytest.approx(G * math.cos(slope), rel=1e-6)


def test_a_sphere_slides_until_it_rolls():
    """With (5 v + 2 R w x n)/7, which no step changes."""
    v, w = np.array([0.5, -0.2, 0.0]), np.array([3.0, 8.0, 5.0])
    sim = in_steps(ball(tuple(v), tuple(w)))
    sim.advance(0.5)
    rolls = (5.0 * v + 2.0 * R * np.cross(w, [0.0, 0.0, 1.0])) / 7.0
    assert [values(sim)[f"ball.v{axis}"] for axis in "xy"] == pytest.approx(rolls[:2], abs=1e-5)


def test_a_rolling_ball_is_braked_by_turning():
    """By 5/7 rho g/R of its speed, and not back once it is at rest."""
    rolling, v = 5e-3, 0.3
    model = ball((v, 0.0, 0.0), (0.0, v / R, 0.0), turning=TurningFriction(rolling=rolling, spinning=0.0))
    sim, brakes = in_steps(model), 5.0 / 7.0 * rolling / R * G
    sim.advance(0.4)
    assert values(sim)["ball.vx"] == pytest.approx(v - 0.4 * brakes, rel=2e-3)
    sim.advance(1.5)
    assert values(sim)["ball.x"] == pytest.approx(0.5 * v**2 / brakes, rel=5e-3)
    assert abs(values(sim)["ball.vx"]) < 1e-5


@pytest.mark.sampled(1)
@pytest.mark.parametrize("turned", [0.0, 0.7])
def test_a_ball_that_rolling_friction_holds_on_a_slope_does_not_creep(turned):
    """tan(slope) < rho/R: it stays where it is, whichever way it would roll; beyond, it rolls with 5/7 of what is
    left."""
    rolling, end = 5e-3, 0.3
    for slope, moves in ((0.9 * rolling / R, False), (1.3 * rolling / R, True)):
        model = ball(mu=0.5, restitution=0.0, turning=TurningFriction(rolling=rolling, spinning=1e-3))
        flat = G * math.sin(math.atan(slope))
        pull = (flat * math.cos(turned), flat * math.sin(turned), -G * math.cos(math.atan(slope)))
        sim = in_steps(model.model_copy(update={"gravity": pull}))
        sim.advance(end)
        now = values(sim)
        left = 5.0 / 7.0 * (flat - G * math.cos(math.atan(slope)) * rolling / R) if moves else 0.0
        went = math.hypot(now["ball.x"], now["ball.y"])
        assert went == pytest.approx(0.5 * left * end**2, rel=1e-3, abs=1e-13)
        assert math.hypot(now["ball.vx"], now["ball.vy"]) == pytest.approx(left * end, rel=1e-3, abs=1e-12)


def test_an_impact_bounces_and_the_ledger_closes():
    """Newton's law to the step's size, the energy exactly."""
    off = []
    for step in (1e-4, 2e-5):
        sim = in_steps(ball(height=0.2), step)
        before = values(sim)["energy.potential"]
        sim.advance(0.25)
        now, (hit,) = values(sim), [e for e in sim.events if e.kind == "impact"]
        off.append(abs(hit.approach_speed - math.sqrt(2.0 * G * 0.2)))
        assert hit.separation_speed == pytest.approx(0.5 * hit.approach_speed, rel=1e-9)
        assert now["energy.balance"] == pytest.approx(0.0, abs=1e-10)
        energy = now["energy.kinetic"] + now["energy.potential"] + now["energy.impact_loss"]
        assert energy == pytest.approx(before, abs=1e-10)
    assert max(off) < G * 2e-4
    assert off[1] < G * 4e-5


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf", "adams", "hht", "newmark"])
def test_joints_hold_at_all_levels(method):
    """A pendulum that strikes a floor and stays on it."""
    rod = RigidBody2D(name="rod", mass=1.0, inertia=0.02, position=(0.5, 0.0))
    pin = Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="rod", point=(-0.5, 0.0)))
    floor = DiskOnHalfPlane2D(
        name="floor", plane=HalfPlane2D(marker=Marker2D(point=(0.0, -0.4))),
        disk=Disk2D(marker=Marker2D(body="rod", point=(0.5, 0.0)), radius=0.05), law=NewtonImpact(restitution=0.4),
        friction=CoulombFriction(coefficient=0.2),
    )  # fmt: skip
    sim = in_steps(Model(gravity=(0.0, -G), bodies=[rod], joints=[pin], contacts=[floor]), method=method, rtol=1e-9)
    for t in np.linspace(0.05, 1.5, 12):
        sim.advance(float(t))
        now = values(sim)
        assert max(now[f"residual.{level}"] for level in ("position", "velocity", "acceleration")) < 1e-10
    # it rests on the floor, and pin and floor carry it
    assert abs(now["rod.vy"]) < 1e-9
    assert now["floor.normal_force"] == pytest.approx(0.5 * G, rel=0.2)
    assert now["energy.balance"] == pytest.approx(0.0, abs=1e-6)


def test_a_state_within_the_steps_goes_on_alike():
    """Bit for bit, from bytes; and it says that it is within them."""
    sim = in_steps(ball((0.3, 0.1, 0.0), (5.0, 0.0, 2.0), turning=TurningFriction(rolling=1e-3, spinning=1e-3)))
    sim.advance(0.02)
    state = sim.state()
    sim.advance(0.06)
    later = sim.values()
    sim.restore(state)
    assert sim.clock.push_step > 0.0
    sim.advance(0.06)
    assert np.array_equal(later, sim.values())
    for k in range(STEP_FORCES):
        sim.restore(state)
        sim.memory.step_force[0, k] += 1.0
        assert sim.state() != state


def test_output_times_change_nothing():
    """Steps do not end at them."""
    start = ball((0.3, 0.1, 0.0), (5.0, 0.0, 2.0), height=0.01)
    one, other = in_steps(start), in_steps(start)
    for t in np.linspace(0.0, 0.1, 77)[1:]:
        one.advance(float(t))
    other.advance(0.1)
    assert np.array_equal(one.values(), other.values())


def test_units_do_not_matter():
    """Of length, mass and time: the same motion in steps that are parts of the model's own time."""
    small = in_steps(ball((0.3, 0.0, 0.0), height=0.02))
    small.advance(0.2)
    factor = 1000.0  # millimetres
    body = RigidBody3D(
        name="ball", mass=2.0, inertia=(0.4 * 2.0 * (factor * R) ** 2,) * 3,
        position=(0.0, 0.0, factor * (0.02 + R)), velocity=(factor * 0.3, 0.0, 0.0),
    )  # fmt: skip
    floor = SphereOnHalfSpace3D(
        name="floor", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=factor * R),
        law=NewtonImpact(restitution=0.5), friction=CoulombFriction(coefficient=0.3),
    )  # fmt: skip
    large = in_steps(Model(gravity=(0.0, 0.0, -factor * G), bodies=[body], contacts=[floor]))
    large.advance(0.2)
    assert large.clock.push_step == pytest.approx(small.clock.push_step, rel=1e-12)
    assert values(large)["ball.x"] == pytest.approx(factor * values(small)["ball.x"], rel=1e-9)
    assert values(large)["ball.vx"] == pytest.approx(factor * values(small)["ball.vx"], rel=1e-9)


@njit
def _packed(count, n, directions, responses, wholes, reals):
    """Blocks of contacts whose rows are normals, first tangents and so on, each with all coordinates."""
    at, place, every, rows = 2 * count, 0, np.arange(n), len(directions) // count
    for i in range(count):
        gradients, motions = np.zeros((WIDE, n)), np.zeros((n, WIDE))
        for k in range(rows):
            gradients[k], motions[:, k] = directions[k * count + i], responses[k * count + i]
        at, place = pack_block(i, count, at, place, gradients, every, n, motions, every, n, wholes, reals)


def _room(count, n):
    return np.empty(block_wholes(count, 2 * n), np.int64), np.empty(block_reals(count, 2 * n))


@njit
def _swept(count, tangents, turns, rows, n, directions, responses, wholes, reals, masses, off, arms, p, x, tolerance):
    _packed(count, n, directions, responses, wholes, reals)
    return sweep_rows(
        count, tangents, turns, rows, n, wholes, reals, masses, off, arms, p, x, np.empty(2 * (rows + n)), tolerance,
        100_000,
    )  # fmt: skip


@njit
def _pressed(count, n, directions, responses, wholes, reals, masses, gaps, p, x, work):
    _packed(count, n, directions, responses, wholes, reals)
    return press_apart(count, count, n, wholes, reals, masses, gaps, p, x, work, 1e-12, 200)


def problem(seed, count, n, blocks):
    """Directions, the motions of unit impulses along them, and rates."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(blocks * count, n)) * (rng.random((blocks * count, n)) < 0.5)
    directions[np.arange(blocks * count), rng.integers(0, n, blocks * count)] += 1.0
    mass = rng.uniform(0.5, 2.0, n)
    responses = directions / mass
    return directions, responses, (directions * responses).sum(axis=1), rng.normal(size=blocks * count)


def meets_its_circle(force, rate, limit):
    """Force (k, count) is within its circle, opposes the rates (k, count), and lets nothing move below it."""
    size, speed = np.sqrt((force**2).sum(axis=0)), np.sqrt((rate**2).sum(axis=0))
    assert (size - limit).max() < 1e-10
    assert np.abs((limit - size) * speed).max() < 1e-8
    assert np.abs((force * rate).sum(axis=0) + size * speed).max() < 1e-8


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("turns", [False, True])
def test_sweeps_meet_the_conditions_of_contact(seed, turns):
    """None approaches, none pulls, friction is within its circle, opposes what slides, and lets nothing slide below
    it; torques against rolling and spinning likewise."""
    count, n, blocks = 6, 24, 6 if turns else 3
    directions, responses, masses, off = problem(seed, count, n, blocks)
    arms = np.repeat([np.inf, 0.3, 0.3, 0.2, 0.2, 0.1][:blocks], count)
    p, x, blank = np.zeros(blocks * count), np.zeros(n), _room(count, n)
    _swept(count, 2, turns, blocks * count, n, directions, responses, *blank, masses, off, arms, p, x, 1e-14)
    rate, p = (off + directions @ x).reshape(blocks, count), p.reshape(blocks, count)
    assert x == pytest.approx(responses.T @ p.ravel(), abs=1e-11)
    assert rate[0].min() > -1e-10
    assert p[0].min() >= 0.0
    assert np.abs(rate[0] * p[0]).max() < 1e-9
    meets_its_circle(p[1:3], rate[1:3], 0.3 * p[0])
    if turns:
        meets_its_circle(p[3:5], rate[3:5], 0.2 * p[0])
        meets_its_circle(p[5:], rate[5:], 0.1 * p[0])


def test_sweeps_of_a_long_pile_need_extrapolation():
    """60 blocks on one another, from no impulses: plain sweeps are 3e4."""
    count = n = 60
    directions = np.vstack([np.eye(n) - np.eye(n, k=-1), np.zeros((count, n))])  # normals, and no tangents
    p, x = np.zeros(2 * count), np.zeros(n)
    masses, off, arms = (directions**2).sum(axis=1), -(directions @ np.ones(n)), np.zeros(2 * count)
    used, _ = _swept(
        count, 1, False, 2 * count, n, directions, directions, *_room(count, n), masses, off, arms, p, x, 1e-9
    )
    assert p[:count] == pytest.approx(np.arange(count, 0, -1), rel=1e-6)
    assert used < 4000


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("count", [3, 40])
def test_overlaps_are_closed_by_the_least_motion(seed, count):
    """The motion of least M-norm with no gap below zero: its dual is a least-squares problem with p >= 0. With 40
    gaps of 24 coordinates many repeat others."""
    n = 24
    directions, responses, masses, gaps = problem(100 + seed, count, n, 1)
    directions, gaps = np.abs(directions), 0.01 * gaps
    responses = directions * responses.max() / max(responses.max(), 1e-300)
    masses = (directions * responses).sum(axis=1)
    p, x = np.zeros(count), np.zeros(n)
    found = _pressed(count, n, directions, responses, *_room(count, n), masses, gaps, p, x, np.zeros(3 * count + n))
    assert found
    assert (gaps + directions @ x).min() > -1e-11
    assert np.abs(p * (gaps + directions @ x)).max() < 1e-10
    # min |y|^2, D y >= -gaps, as a problem with p >= 0 (Lawson and Hanson 1974, chapter 23)
    scaled = directions * np.sqrt((responses / np.where(directions != 0.0, directions, 1.0)).max())
    u, _ = nnls(np.vstack([scaled.T, -gaps]), np.append(np.zeros(n), 1.0))
    r = np.vstack([scaled.T, -gaps]) @ u - np.append(np.zeros(n), 1.0)
    assert 0.5 * p @ (directions @ responses.T) @ p == pytest.approx(0.5 * (r[:n] / r[n]) @ (r[:n] / r[n]), rel=1e-6)


def test_no_crowd_no_steps_of_impulses():
    """Few contacts never crowd: bounces that accumulate are all made."""
    result = simulate(ball(height=0.2, restitution=0.9), 6.0, "ebdf")
    assert len([e for e in result.events if e.kind == "impact"]) > 20
    assert result["floor.gap"].min() > -1e-12
