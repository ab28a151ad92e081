"""Several contacts of one body at once: supports that repeat each other, tilting, corners, wedges."""

import math

import numpy as np
import pytest
from helpers import G, events, on
from sliders import PLASTIC, foot, kinds
from tlismni.core import (
    AppliedForce2D,
    Constant,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PoissonImpact,
    Ramp,
    Revolute2D,
    RigidBody2D,
    Simulation,
    Sine,
    simulate,
)
from tlismni.core.compiled.jit import compiled
from tlismni.core.event_detection.repivoting import orientation
from tlismni.core.stage.joints import evaluate_joints
from tlismni.core.state.modes import CLOSED, IDLE

WIDTH, HEIGHT, MASS = 0.4, 0.6, 3.0


def block(feet=2, mu=0.3, static=None, law=PLASTIC, force=None, at=0.0, drop=0.0, speed=0.0, mass=MASS):
    """A box with so many feet below; `force` (a signal) acts along the floor at the height `at` of the box."""
    inertia = mass * (WIDTH**2 + HEIGHT**2) / 12.0
    body = RigidBody2D(name="b", mass=mass, inertia=inertia, position=(0.0, 0.5 * HEIGHT + drop), velocity=(speed, 0.0))
    places = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, feet) if feet > 1 else [0.0]
    contacts = [foot(f"f{i}", "b", x, -0.5 * HEIGHT, mu, static, law=law) for i, x in enumerate(places)]
    forces = [] if force is None else [AppliedForce2D(name="p", marker=on("b", 0.0, at - 0.5 * HEIGHT), force_x=force)]
    return Model(bodies=[body], forces=forces, contacts=contacts)


def total(result, what, feet):
    return sum(result[f"f{i}.{what}"] for i in range(feet))


# ---- supports -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("feet", [2, 3, 4])
@pytest.mark.parametrize("mu", [None, 0.3])
def test_block_stands_on_its_feet(feet, mu):
    result = simulate(block(feet, mu), 1.0)
    assert {kind for kind, _ in kinds(result)} == {"close"}
    assert total(result, "normal_force", feet)[1:] == pytest.approx(MASS * G, rel=1e-12)
    moment = sum(x * result[f"f{i}.normal_force"][-1] for i, x in enumerate(np.linspace(-1.0, 1.0, feet)))
    assert abs(moment) < 1e-10
    assert all(result[f"f{i}.normal_force"].min() >= 0.0 for i in range(feet))
    assert np.abs(result.q - result.q[0]).max() < 1e-14


@pytest.mark.parametrize("feet", [2, 3, 4])
@pytest.mark.parametrize("static", [None, 0.45])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_block_on_feet_slips_where_all_of_them_together_reach_their_limit(feet, static, sign):
    """Forces on redundant feet are not unique, but the motion is: it begins at F = mu_s m g."""
    mu = 0.3
    force = Ramp(start=0.1, duration=1.0, after=sign * 20.0)
    result = simulate(block(feet, mu, static, force=force, at=0.2), 1.0, rtol=1e-9)
    limit = (static or mu) * MASS * G
    start = 0.1 + limit / 20.0
    slips = events(result, "slip")
    assert len(slips) >= 1 and not events(result, "stick", "open")
    assert [e.t for e in slips] == pytest.approx([start] * len(slips), abs=1e-9)
    before = (result.t > 0.0) & (result.t < slips[0].t)
    applied = sign * 20.0 * np.maximum(result.t - 0.1, 0.0)
    assert total(result, "friction_force", feet)[before] == pytest.approx(-applied[before], abs=1e-9)
    for i in range(feet):
        limits = (static or mu) * result[f"f{i}.normal_force"]
        assert np.all(np.abs(result[f"f{i}.friction_force"]) <= limits * (1.0 + 1e-9) + 1e-9)
    t = 1.0 - start
    speed = ((limit - mu * MASS * G) * t + 10.0 * t * t) / MASS
    assert result["b.vx"][-1] == pytest.approx(sign * speed, rel=1e-8)


@pytest.mark.parametrize("feet", [2, 3])
def test_sticking_feet_share_a_force_that_swings(feet):
    """Far beyond what one foot could hold, to and fro, below what all of them hold together: nothing moves."""
    force = Sine(amplitude=0.98 * 0.45 * MASS * G, angular_frequency=7.0)
    result = simulate(block(feet, 0.3, 0.45, force=force, at=0.1), 3.0, rtol=1e-8, max_step=0.02)
    assert not events(result, "slip", "stick", "open")
    assert np.abs(result["b.x"]).max() < 1e-12
    swing = 0.98 * 0.45 * MASS * G * np.sin(7.0 * result.t[1:])
    assert total(result, "friction_force", feet)[1:] == pytest.approx(-swing, abs=1e-9)


@pytest.mark.parametrize("law", [PLASTIC, NewtonImpact(restitution=0.4), PoissonImpact(restitution=0.4)])
@pytest.mark.parametrize("feet", [2, 3])
def test_block_falls_flat_on_its_feet(law, feet):
    drop = 0.3
    result = simulate(block(feet, 0.3, law=law, drop=drop), 1.2, rtol=1e-9)
    fall = math.sqrt(2.0 * drop / G)
    first = [e for e in events(result, "impact") if e.t == result.events[0].t]
    assert first[0].t == pytest.approx(fall, abs=1e-9)
    assert sum(e.impulse for e in first) == pytest.approx((1.0 + law.restitution) * MASS * G * fall, rel=1e-9)
    assert sum(e.energy_loss for e in first) == pytest.approx((1.0 - law.restitution**2) * MASS * G * drop, rel=1e-9)
    assert np.abs(result["b.angle"]).max() < 1e-9 and np.abs(result["b.x"]).max() < 1e-12
    e = law.restitution
    rest = fall * (1.0 + 2.0 * e / (1.0 - e))
    ends = events(result, "close", "rest")
    assert ends[-1].t == pytest.approx(rest, abs=1e-5)
    late = result.t > ends[-1].t
    assert total(result, "normal_force", feet)[late] == pytest.approx(MASS * G, rel=1e-9)
    assert np.abs(result["energy.balance"]).max() < 1e-9


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("feet", [2, 3])
def test_pushed_block_tilts_over_its_edge(feet, sign):
    """It turns about its edge from F h = m g b/2 on; friction is large enough. Loads are linear along three feet: the
    rear one has none from two thirds of that on, and the middle one from there on."""
    at = 0.5
    force = Ramp(start=0.0, duration=1.0, after=sign * 20.0)
    result = simulate(block(feet, 0.9, force=force, at=at), 0.8, rtol=1e-9)
    tip = 0.5 * WIDTH * MASS * G / at / 20.0
    rear, edge = ("f0", f"f{feet - 1}") if sign > 0.0 else (f"f{feet - 1}", "f0")
    opened = {e.contact: e.t for e in events(result, "open")}
    assert len(opened) == len(events(result, "open")) == feet - 1
    assert opened[rear] == pytest.approx(tip if feet == 2 else 2.0 * tip / 3.0, abs=1e-8)
    assert max(opened.values()) == pytest.approx(tip, abs=1e-8)
    before = (result.t > 0.0) & (result.t < tip)
    load = np.abs(20.0 * result.t[before])
    by_two = (0.5 if feet == 2 else 1.0 / 3.0) * MASS * G + load * at / WIDTH
    linear = load <= (feet == 2 or 2.0 / 3.0) * 20.0 * tip
    assert result[f"{edge}.normal_force"][before][linear] == pytest.approx(by_two[linear], rel=1e-9)
    assert sign * result["b.angle"][-1] < -1e-3
    late = result.t > tip + 1e-6
    assert np.abs(result[f"{edge}.gap"][late]).max() < 1e-12
    assert result[f"{rear}.gap"][-1] > 0.0
    assert np.abs(result["energy.balance"]).max() < 1e-8


def test_pushed_block_turns_about_its_edge_as_a_pendulum():
    """J w' = F h(angle) - m g b(angle): the same as a rod on a pin, integrated with a pin in place of the edge."""
    push = Ramp(start=0.0, duration=1.0, after=20.0)
    free = simulate(block(2, 0.9, force=push, at=0.5), 0.9, rtol=1e-10, atol=1e-12)
    tip = events(free, "open")[0].t
    inertia = MASS * (WIDTH**2 + HEIGHT**2) / 12.0
    body = RigidBody2D(name="b", mass=MASS, inertia=inertia, position=(0.0, 0.5 * HEIGHT))
    pin = Revolute2D(name="pin", a=Marker2D(point=(0.5 * WIDTH, 0.0)), b=on("b", 0.5 * WIDTH, -0.5 * HEIGHT))
    late = Ramp(start=-tip, duration=1.0, after=20.0)
    pinned = Model(
        bodies=[body], joints=[pin], forces=[AppliedForce2D(name="p", marker=on("b", 0.0, 0.2), force_x=late)]
    )
    result = simulate(pinned, 0.9 - tip, rtol=1e-10, atol=1e-12)
    assert free.q[-1] == pytest.approx(result.q[-1], abs=1e-8)
    assert free["f1.normal_force"][-1] == pytest.approx(result["pin.force_y"][-1], rel=1e-6)
    assert free["f1.friction_force"][-1] == pytest.approx(result["pin.force_x"][-1], rel=1e-6)


# ---- corners and wedges ---------------------------------------------------------------------------------------------


def wall(name, body, x=0.0, y=0.0, at=0.0, mu=None, law=PLASTIC, angle=0.5 * math.pi):
    """Contact of a point of `body` with a wall through (at, 0); with angle pi/2 the wall is on the right."""
    return foot(name, body, x, y, mu, plane=HalfPlane2D(marker=Marker2D(point=(at, 0.0), angle=angle)), law=law)


@pytest.mark.parametrize("mu", [None, 0.2])
def test_box_pushed_into_a_corner(mu):
    """Two feet on the floor, two points at the wall: the wall takes what the floor's friction does not."""
    model = block(2, mu, force=Constant(value=15.0), at=0.3)
    corner = [wall(f"w{i}", "b", 0.5 * WIDTH, y, at=0.5 * WIDTH, mu=mu) for i, y in enumerate((-0.2, 0.2))]
    result = simulate(model.model_copy(update={"contacts": (*model.contacts, *corner)}), 1.0)
    assert not events(result, "open", "slip", "stick")
    assert np.abs(result.q - result.q[0]).max() < 1e-13
    floor, side = total(result, "normal_force", 2)[-1], sum(result[f"w{i}.normal_force"][-1] for i in range(2))
    up, along = 0.0, 0.0
    if mu:
        up, along = sum(result[f"w{i}.friction_force"][-1] for i in range(2)), total(result, "friction_force", 2)[-1]
        for name in ("f0", "f1", "w0", "w1"):
            assert abs(result[f"{name}.friction_force"][-1]) <= mu * result[f"{name}.normal_force"][-1] * (1.0 + 1e-9)
    assert 15.0 + along == pytest.approx(side, rel=1e-10)
    assert floor + up == pytest.approx(MASS * G, rel=1e-10)


def test_a_tall_block_that_slides_trips_over_its_front_foot():
    """Friction of mu = 2.5 presses its front foot into the floor: no accelerations exist, and the foot stops at once,
    with the angular momentum about it kept and what the stop has taken in the account."""
    half, height, speed = 0.2, 1.0, 5.0
    inertia = (half**2 + height**2) / 3.0
    body = RigidBody2D(name="b", mass=1.0, inertia=inertia, position=(0.0, height), velocity=(speed, 0.0))
    contacts = [foot(name, "b", x, -height, 2.5) for name, x in (("front", half), ("rear", -half))]
    result = simulate(Model(gravity=(0.0, -G), bodies=[body], contacts=contacts), 0.01)
    about_foot = inertia + half**2 + height**2
    lost = 0.5 * speed**2 - 0.5 * (height * speed) ** 2 / about_foot
    (stop,) = events(result, "impact")
    assert stop.contact == "front" and stop.energy_loss == pytest.approx(lost, rel=1e-9)
    assert result["energy.impact_loss"][-1] == pytest.approx(lost, rel=1e-9)
    assert np.abs(result["energy.balance"]).max() < 1e-9


@pytest.mark.parametrize("angle", [0.3, 0.7])
def test_disk_in_a_smooth_wedge_presses_both_sides(angle):
    """N = m g/(2 cos(angle)) on each side of a symmetric wedge."""
    radius, mass = 0.2, 1.5
    body = RigidBody2D(name="b", mass=mass, inertia=0.02, position=(0.0, radius / math.cos(angle)))
    sides = [
        foot(name, "b", mu=None, radius=radius, plane=HalfPlane2D(marker=Marker2D(angle=turn)))
        for name, turn in (("left", -angle), ("right", angle))
    ]
    result = simulate(Model(bodies=[body], contacts=sides), 1.0)
    for name in ("left", "right"):
        assert result[f"{name}.normal_force"][1:] == pytest.approx(mass * G / (2.0 * math.cos(angle)), rel=1e-12)
    assert np.abs(result.q - result.q[0]).max() < 1e-13


@pytest.mark.parametrize("mu", [0.1, 0.5])
def test_spinning_disk_in_a_wedge_is_braked_by_both_sides(mu):
    """Sliding on both sides of a symmetric wedge: balance along and across gives N_l and N_r; the spin stops."""
    angle, radius, mass, rate = 0.6, 0.2, 1.5, -30.0
    inertia = 0.5 * mass * radius**2
    body = RigidBody2D(
        name="b", mass=mass, inertia=inertia, position=(0.0, radius / math.cos(angle)), angular_velocity=rate
    )
    sides = [
        foot(name, "b", mu=mu, radius=radius, plane=HalfPlane2D(marker=Marker2D(angle=turn)))
        for name, turn in (("left", -angle), ("right", angle))
    ]
    s, c = math.sin(angle), math.cos(angle)
    # normals (s, c), (-s, c); friction mu N along (c, -s), (c, s): the disk turns clockwise
    left, right = np.linalg.solve([[s + mu * c, -s + mu * c], [c - mu * s, c + mu * s]], [0.0, mass * G])
    assert left > 0.0 and right > 0.0
    result = simulate(Model(bodies=[body], contacts=sides), 0.05, rtol=1e-9)
    assert result["left.normal_force"][-1] == pytest.approx(left, rel=1e-9)
    assert result["right.normal_force"][-1] == pytest.approx(right, rel=1e-9)
    assert result["b.angular_velocity"][-1] == pytest.approx(rate + mu * (left + right) * radius / inertia * 0.05)
    stop = -rate * inertia / (mu * (left + right) * radius)
    result = simulate(Model(bodies=[body], contacts=sides), stop + 0.1, rtol=1e-9)
    stops = events(result, "stick")
    assert [e.t for e in stops] == pytest.approx([stop] * 2, abs=1e-9)
    assert np.abs(result.v[-1]).max() < 1e-12


# ---- constant shares of contacts that others hold -------------------------------------------------------------------


@compiled
def side(ws):
    return orientation(ws)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("ratio", [0.3, -30.0, 30.0])
def test_constant_share_of_a_held_contact_is_no_jam(ratio):
    """A box on two steps, pushed until the foot with less load is at its friction limit, and a block that slides:
    whatever constant share of its normal force the held foot carries, the determinant that tells a jam has the sign
    that it has without, and the state its bits."""
    step = HalfPlane2D(marker=Marker2D(point=(0.0, HEIGHT)))
    inertia = MASS * (WIDTH**2 + HEIGHT**2) / 12.0
    bodies = [
        RigidBody2D(name="b", mass=MASS, inertia=inertia, position=(0.0, 0.5 * HEIGHT)),
        RigidBody2D(name="s", mass=MASS, inertia=inertia, position=(2.0, 0.5 * HEIGHT), velocity=(1.0, 0.0)),
    ]
    feet = [
        foot("low", "b", -0.5 * WIDTH, -0.5 * HEIGHT, 0.3),
        foot("high", "b", 0.5 * WIDTH, 0.5 * HEIGHT, 0.3, plane=step),
        foot("slides", "s", -0.5 * WIDTH, -0.5 * HEIGHT, 0.3),
        foot("too", "s", 0.5 * WIDTH, -0.5 * HEIGHT, 0.3),
    ]
    push = AppliedForce2D(name="p", marker=on("b", 0.0, 0.1), force_x=Constant(value=0.28 * MASS * G))
    sim = Simulation(Model(bodies=bodies, contacts=feet, forces=[push]))
    sim.advance(1e-3)
    ws, memory = sim.workspace, sim.memory
    held = np.flatnonzero((memory.mode == CLOSED) & (memory.slide_mode == IDLE))
    assert list(held) in ([0], [1]) and all(np.abs(memory.slide_mode[2:]) == 1.0)
    with_share, signs, n = [], [], sim.assembly.n + ws.structure.m_act
    for share in (0.0, ratio):
        memory.friction_ratio[held] = share
        before = memory.tobytes()
        signs.append(side(ws.record))
        assert memory.tobytes() == before
        evaluate_joints(ws.record)
        matrix = np.zeros((n, n))
        matrix[ws.structure.rows, ws.structure.cols] = ws.arrays["values"][: ws.structure.nnz]
        with_share.append(np.linalg.slogdet(matrix)[0])
    assert signs[0] == signs[1] == with_share[0]
    # the line between the feet: a share that points beyond it turns the sign of the matrix that holds it
    assert with_share[1] == with_share[0] * np.sign(1.0 - ratio * HEIGHT / WIDTH)
