"""Loads of contacts that repeat each other: the limit of equally compliant contacts, in any order of the list.

Normal forces of a rigid block are the least that carry it, a linear function of the place of each foot. Static friction
holds as long as some sharing within all cones does, so a block breaks away at mu_s times the whole load.
"""

import itertools

import numpy as np
import pytest
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    AppliedTorque3D,
    Axes,
    Box2D,
    Box3D,
    Constant,
    ContactGroup2D,
    ContactGroup3D,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    PointMass2D,
    PointMass3D,
    Polynomial,
    Prismatic2D,
    Prismatic3D,
    Ramp,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)

G = 9.81
LAW = NewtonImpact(restitution=0.0)


def feet_of(points, friction, body="b"):
    return [
        SphereOnHalfSpace3D(
            name=f"f{i}",
            plane=HalfSpace3D(),
            sphere=Sphere3D(marker=Marker3D(body=body, point=point), radius=0.0),
            law=LAW,
            friction=friction,
        )
        for i, point in points
    ]


def least_loads(points, weight):
    """Least forces that balance the weight in the middle."""
    matrix = np.array([[1.0, x, y] for x, y, _ in points]).T
    return np.linalg.lstsq(matrix, np.array([weight, 0.0, 0.0]), rcond=None)[0]


AREAS = {
    "square": [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)],
    "uneven": [(-0.3, -0.1), (0.2, -0.2), (-0.1, 0.25), (0.25, 0.15), (0.05, 0.02)],
    "rows": [(-0.2, -0.2), (0.0, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.0, 0.2), (0.2, 0.2)],
    "eight": [(0.2 * np.cos(k), 0.3 * np.sin(k) + 0.05) for k in np.arange(8) * 0.8],
}


@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
@pytest.mark.parametrize("area", AREAS)
def test_feet_share_the_weight_linearly_in_place(area, method):
    points = [(x, y, -0.3) for x, y in AREAS[area]]
    wanted = least_loads(points, 3.0 * G)
    assert min(wanted) > 0.0
    orders = [range(len(points)), reversed(range(len(points))), np.random.default_rng(3).permutation(len(points))]
    for order in orders:
        body = RigidBody3D(name="b", mass=3.0, inertia=(0.1, 0.1, 0.08), position=(0.0, 0.0, 0.3))
        feet = feet_of([(int(i), points[int(i)]) for i in order], CoulombFriction(coefficient=0.3))
        result = simulate(Model(gravity=(0, 0, -G), bodies=[body], contacts=feet), 0.2, method=method)
        loads = np.array([result[f"f{i}.normal_force"][-1] for i in range(len(points))])
        np.testing.assert_allclose(loads, wanted, rtol=1e-8)
        friction = [result[f"f{i}.friction_force"][-1] for i in range(len(points))]
        assert np.max(np.abs(friction)) < 1e-8


@pytest.mark.parametrize("count", [2, 3, 5])
def test_planes_in_one_place_carry_equal_parts(count):
    ball = PointMass3D(name="b", mass=2.0, position=(0.0, 0.0, 0.1), velocity=(1.0, 0.0, 0.0))
    contacts = [
        SphereOnHalfSpace3D(
            name=f"f{i}", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="b"), radius=0.1), law=LAW,
            friction=CoulombFriction(coefficient=0.1 * (i + 1)),
        )
        for i in range(count)
    ]  # fmt: skip
    result = simulate(Model(gravity=(0, 0, -G), bodies=[ball], contacts=contacts), 0.05)
    loads = [result[f"f{i}.normal_force"][-1] for i in range(count)]
    np.testing.assert_allclose(loads, 2.0 * G / count, rtol=1e-10)
    # each brakes with its own coefficient
    braking = G * sum(0.1 * (i + 1) for i in range(count)) / count
    assert result["b.vx"][-1] == pytest.approx(1.0 - braking * 0.05, abs=1e-8)


CROSS = [(0.2, 0.0, -0.05), (-0.2, 0.0, -0.05), (0.0, 0.05, -0.05), (0.0, -0.05, -0.05)]
ORDERS = list(itertools.permutations(range(4)))[::5]


def cross(order, spin, forces=()):
    body = RigidBody3D(
        name="c", mass=1.0, inertia=(0.02,) * 3, position=(0.0, 0.0, 0.05), angular_velocity=(0.0, 0.0, spin)
    )
    feet = feet_of([(i, CROSS[i]) for i in order], CoulombFriction(coefficient=0.3), body="c")
    return Model(gravity=(0, 0, -G), bodies=[body], contacts=feet, forces=list(forces))


@pytest.mark.parametrize("order", ORDERS)
def test_spinning_cross_stops_as_its_feet_share_the_weight(order):
    # each foot carries m g/4 at the arms 0.2 and 0.05 m
    braking = 0.3 * 1.0 * G * 0.125 / 0.02
    times = np.linspace(0.0, 0.7, 15)
    result = simulate(cross(order, 10.0), 0.7, t_eval=times, rtol=1e-9)
    np.testing.assert_allclose(result["c.angular_velocity_z"], np.maximum(10.0 - braking * times, 0.0), atol=1e-6)
    np.testing.assert_allclose([result[f"f{k}.normal_force"][3] for k in range(4)], G / 4.0, rtol=1e-8)


@pytest.mark.parametrize("order", ORDERS)
def test_cross_breaks_away_once_all_feet_are_at_their_limit(order):
    torque = AppliedTorque3D(name="t", marker=Marker3D(body="c"), torque_z=Polynomial(coefficients=[0.0, 0.4]))
    result = simulate(cross(order, 0.0, [torque]), 1.2, rtol=1e-9)
    slips = [event.t for event in result.events if event.kind == "slip"]
    starts = 0.3 * G * 0.125 / 0.4
    np.testing.assert_allclose(slips, [starts] * len(slips), rtol=1e-6)
    # from there on J w' = 0.4 (t - t0)
    np.testing.assert_allclose(result["c.angular_velocity_z"][-1], 0.4 * (1.2 - starts) ** 2 / (2.0 * 0.02), rtol=1e-5)


FEET = {"three": [(-0.2, -0.2), (0.2, -0.2), (0.0, 0.2)], "four": AREAS["square"], "six": AREAS["rows"]}


def pushed_block(feet, static, way):
    friction = CoulombFriction(coefficient=0.3, static_coefficient=static)
    inertia = (3.0 * (0.4**2 + 0.6**2) / 12, 3.0 * (0.4**2 + 0.6**2) / 12, 3.0 * 2 * 0.4**2 / 12)
    body = RigidBody3D(name="b", mass=3.0, inertia=inertia, position=(0.0, 0.0, 0.3))
    push = AppliedForce3D(
        name="p",
        marker=Marker3D(body="b", point=(0.0, 0.0, -0.1)),
        force_x=Ramp(start=0.1, duration=1.0, after=20.0 * way[0]),
        force_y=Ramp(start=0.1, duration=1.0, after=20.0 * way[1]),
    )
    contacts = feet_of([(i, (x, y, -0.3)) for i, (x, y) in enumerate(FEET[feet])], friction)
    return Model(bodies=[body], forces=[push], contacts=contacts, gravity=(0, 0, -G))


ALONG, ASKEW = (1.0, 0.0), (0.6, 0.8)


# pushed askew, feet come to their limits one after another, in seconds: as they are, and with static friction of four
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("feet", "static", "way"),
    [
        pytest.param(
            feet,
            static,
            way,
            marks=[pytest.mark.full] if static == 0.45 and way == ASKEW and feet != "four" else [],
            id=f"{feet} feet, {static}, {'along' if way == ALONG else 'askew'}",
        )
        for feet, static, way in itertools.product(FEET, (0.3, 0.45), (ALONG, ASKEW))
    ],
)
def test_block_breaks_away_at_the_static_friction_of_its_whole_load(feet, static, way):
    result = simulate(pushed_block(feet, static, way), 1.0, rtol=1e-9)
    starts = 0.1 + static * 3.0 * G / 20.0
    slips = [event.t for event in result.events if event.kind == "slip"]
    np.testing.assert_allclose(slips, [starts] * len(slips), rtol=1e-6)
    after = 1.0 - starts
    wanted = ((static - 0.3) * 3.0 * G * after + 10.0 * after**2) / 3.0
    along = result["b.vx"][-1] * way[0] + result["b.vy"][-1] * way[1]
    assert along == pytest.approx(wanted, rel=1e-6)


def test_feet_at_their_limit_stay_within_their_cones():
    result = simulate(pushed_block("four", 0.45, (0.6, 0.8)), 0.75, rtol=1e-9)
    ratios = np.array([result[f"f{i}.friction_force"] / result[f"f{i}.normal_force"] for i in range(4)])
    assert ratios.max() <= 0.45 * (1.0 + 2e-6)
    # some have been at their limits for long before the block breaks away
    assert np.sum(ratios[:, -1] > 0.45 * (1.0 - 1e-6)) >= 2


@pytest.mark.parametrize("wall", ["pad", "half-space"])
@pytest.mark.parametrize("apart", [0.0, 1e-4])
def test_box_between_two_pads_is_held(wall, apart):
    """20 N and mu 0.3 on both sides hold 12 N, and the box weighs 4.9 N."""
    sideways = Axes(z=(0, 1, 0), x=(1, 0, 0))
    bodies = [
        RigidBody3D(name="box", mass=0.5, inertia=(3e-4,) * 3),
        RigidBody3D(name="pad", mass=0.1, inertia=(1e-4,) * 3, position=(0.0, 0.04 + apart, 0.0)),
    ]
    boxes = [
        Box3D(marker=Marker3D(body="box"), size=(0.06,) * 3, edge_radius=0.001),
        Box3D(marker=Marker3D(body="pad"), size=(0.04, 0.02, 0.04)),
    ]
    spaces = []
    if wall == "pad":
        boxes.append(Box3D(marker=Marker3D(point=(0.0, -0.04, 0.0)), size=(0.04, 0.02, 0.04)))
    else:
        spaces.append(HalfSpace3D(marker=Marker3D(point=(0.0, -0.03, 0.0), attitude=sideways)))
    group = ContactGroup3D(
        name="t",
        boxes=boxes,
        half_spaces=spaces,
        law=LAW,
        friction=CoulombFriction(coefficient=0.3),
        except_bodies=[("pad", "ground")],
    )
    model = Model(
        gravity=(0, 0, -G),
        bodies=bodies,
        joints=[Prismatic3D(name="s", a=Marker3D(attitude=sideways), b=Marker3D(body="pad", attitude=sideways))],
        forces=[AppliedForce3D(name="f", marker=Marker3D(body="pad"), force_y=Constant(value=-20.0))],
        groups=[group],
    )
    result = simulate(model, 0.3)
    # it falls only until the pad has come
    fall = 0.5 * G * 2.0 * apart * 0.1 / 20.0 * 1.5
    assert abs(result["box.z"][-1]) <= fall + 1e-9
    assert abs(result["box.vz"][-1]) < 1e-9
    assert max(abs(result[f"box.e{k}"][-1]) for k in (1, 2, 3)) < 1e-6
    forces = [result[name][-1] for name in result.channels if name.endswith("normal_force")]
    # where it has fallen a little, the pads press beside its middle
    np.testing.assert_allclose([f for f in forces if f > 1e-6], 5.0, rtol=1e-6 + 10.0 * apart)


def test_states_of_feet_at_their_limit_go_on_with_the_same_bits():
    model = pushed_block("four", 0.45, (0.6, 0.8))
    one, other = Simulation(model), Simulation(model)
    one.advance(0.65)
    other.restore(one.state())
    for t in (0.7, 0.8, 0.9):
        one.advance(t)
        other.advance(t)
        assert one.state() == other.state()


STEEP, GROOVE_MU = np.radians(35.0), 0.5
SIN, COS = np.sin(STEEP), np.cos(STEEP)
TURNING_LIMIT = GROOVE_MU / (COS * (1.0 + GROOVE_MU**2))
"""Torque about the groove's axis by weight and radius, with which the ball slides on both of its sides."""


def ball_in_groove(torque, swapped=False, along=0.0):
    """A ball of 1 kg and 0.1 m between two planes that are steeper than their friction."""
    body = RigidBody3D(
        name="b", mass=1.0, inertia=(4e-3,) * 3, position=(0, 0, 0.1 / COS),
        velocity=(along, 0, 0), angular_velocity=(0, along / (0.1 * COS), 0),
    )  # fmt: skip
    sides = [
        SphereOnHalfSpace3D(
            name=name,
            plane=HalfSpace3D(marker=Marker3D(attitude=Axes(z=(0, side * SIN, COS), x=(1, 0, 0)))),
            sphere=Sphere3D(marker=Marker3D(body="b"), radius=0.1),
            law=LAW,
            friction=CoulombFriction(coefficient=GROOVE_MU),
        )
        for name, side in (("left", 1.0), ("right", -1.0))
    ]
    load = AppliedTorque3D(name="t", marker=Marker3D(body="b"), torque_x=torque)
    return Model(
        gravity=(0, 0, -G), bodies=[body], forces=[load], contacts=sides[::-1] if swapped else sides
    )  # fmt: skip


def groove_forces(torque):
    """(normal forces, friction) of least norm: half the sums and differences of both sides, whose one unknown, the sum
    of friction, is held by the cone of the side that carries more."""
    less = abs(torque) / 0.1
    both = (GROOVE_MU * G / COS + less * (GROOVE_MU / np.tan(STEEP) - 1.0)) / (1.0 + GROOVE_MU * np.tan(STEEP))
    normal = (G - both * SIN) / COS
    one, other = (normal + less / np.tan(STEEP)) / 2.0, (normal - less / np.tan(STEEP)) / 2.0
    return (one, other), ((both + less) / 2.0, abs(both - less) / 2.0)


@pytest.mark.sampled(7)
@pytest.mark.parametrize("method", ["ebdf", "irk"])
@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("part", [0.0, 0.01, 0.6, -0.6, 0.99])
def test_ball_is_held_in_a_groove_by_friction_at_its_limit(part, swapped, method):
    """Sides that are steeper than friction squeeze the ball as far as their cones allow; one side gives what balances
    the torque. Without torque both are at their limit, and neither may slide."""
    torque = part * TURNING_LIMIT * G * 0.1
    result = simulate(ball_in_groove(Constant(value=torque), swapped), 0.3, method=method)
    normals, friction = groove_forces(torque)
    names = ("left", "right") if torque >= 0.0 else ("right", "left")
    tolerance = 3e-6 if part == 0.0 else 1e-8
    for name, normal, size in zip(names, normals, friction, strict=True):
        np.testing.assert_allclose(result[f"{name}.normal_force"][1:], normal, rtol=tolerance)
        np.testing.assert_allclose(result[f"{name}.friction_force"][1:], size, rtol=tolerance)
    assert np.max(np.abs(result.v)) < 1e-12
    assert not [event for event in result.events if event.kind in ("slip", "open", "impact")]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_ball_turns_in_a_groove_once_both_sides_slide(sign):
    torque = Ramp(start=0.1, duration=1.0, after=sign * 2.0 * TURNING_LIMIT * G * 0.1)
    result = simulate(ball_in_groove(torque), 0.8, rtol=1e-9)
    slips = [event.t for event in result.events if event.kind == "slip"]
    np.testing.assert_allclose(slips, [0.6, 0.6], rtol=1e-6)
    # then the surplus of torque turns it
    wanted = sign * TURNING_LIMIT * G * 0.1 * 2.0 * 0.2**2 / 2.0 / 4e-3
    assert result["b.angular_velocity_x"][-1] == pytest.approx(wanted, rel=1e-6)


def test_ball_that_rolls_along_a_groove_keeps_its_energy():
    """It rolls about the line through both contacts, R cos(35 deg) below its middle."""
    result = simulate(ball_in_groove(Constant(value=0.0), along=0.4), 1.0)
    assert result["b.x"][-1] == pytest.approx(0.4, abs=1e-6)
    assert np.max(np.abs(result["energy.kinetic"] / result["energy.kinetic"][0] - 1.0)) < 1e-9
    assert np.max(np.abs(result["b.angular_velocity_z"])) < 1e-9
    assert result.stats["partitions"] < 20


# ---- in the plane ---------------------------------------------------------------------------------------------------

LINES = {"three": (-0.3, 0.0, 0.3), "four uneven": (-0.3, -0.1, 0.05, 0.25), "eight": tuple(np.linspace(-0.4, 0.3, 8))}


def planar_block(places, order, friction, force=None, at=0.0, speed=0.0):
    """A block of 3 kg whose centre is 0.3 m above feet at `places`."""
    feet = [
        DiskOnHalfPlane2D(
            name=f"f{i}",
            plane=HalfPlane2D(),
            disk=Disk2D(marker=Marker2D(body="b", point=(places[i], -0.3))),
            law=LAW,
            friction=friction,
        )
        for i in order
    ]
    body = RigidBody2D(name="b", mass=3.0, inertia=0.1, position=(0.0, 0.3), velocity=(speed, 0.0))
    push = AppliedForce2D(name="p", marker=Marker2D(body="b", point=(0.0, at)), force_x=force) if force else None
    return Model(bodies=[body], contacts=feet, forces=[push] if push else [])


def orders_of(count):
    return [list(range(count)), list(range(count))[::-1], [int(i) for i in np.random.default_rng(5).permutation(count)]]


@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
@pytest.mark.parametrize("places", LINES.values(), ids=LINES)
def test_feet_in_a_line_share_the_weight_linearly(places, method):
    wanted = np.linalg.lstsq(np.array([np.ones(len(places)), places]), np.array([3.0 * G, 0.0]), rcond=None)[0]
    for order in orders_of(len(places)):
        result = simulate(planar_block(places, order, CoulombFriction(coefficient=0.3)), 0.2, method=method)
        loads = [result[f"f{i}.normal_force"][-1] for i in range(len(places))]
        np.testing.assert_allclose(loads, wanted, rtol=1e-8)
        assert np.max(np.abs(result.v)) < 1e-12


@pytest.mark.sampled(6)
@pytest.mark.parametrize("static", [0.3, 0.45])
@pytest.mark.parametrize("at", [0.0, -0.2, 0.1])
@pytest.mark.parametrize("places", LINES.values(), ids=LINES)
def test_block_in_the_plane_breaks_away_at_the_static_friction_of_its_whole_load(places, at, static):
    friction = CoulombFriction(coefficient=0.3, static_coefficient=static)
    force, starts = Ramp(start=0.1, duration=1.0, after=20.0), 0.1 + static * 3.0 * G / 20.0
    for order in orders_of(len(places)):
        result = simulate(planar_block(places, order, friction, force, at), 1.0, rtol=1e-9)
        slips = {event.contact: event.t for event in result.events if event.kind == "slip"}
        np.testing.assert_allclose(list(slips.values()), starts, rtol=1e-6)
        after = 1.0 - starts
        wanted = ((static - 0.3) * 3.0 * G * after + 10.0 * after**2) / 3.0
        assert result["b.vx"][-1] == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("places", LINES.values(), ids=LINES)
def test_friction_of_feet_that_slide_follows_their_loads(places):
    """Braked by mu N on each foot, the load shifts forwards, linearly in place."""
    moment = 0.3 * 0.3 * 3.0 * G
    wanted = np.linalg.lstsq(np.array([np.ones(len(places)), places]), np.array([3.0 * G, moment]), rcond=None)[0]
    assert wanted.min() > 0.0
    for order in orders_of(len(places)):
        model = planar_block(places, order, CoulombFriction(coefficient=0.3), speed=2.0)
        result = simulate(model, 0.3, t_eval=[0.0, 0.1, 0.2, 0.3])
        for i, load in enumerate(wanted):
            np.testing.assert_allclose(result[f"f{i}.normal_force"][1:], load, rtol=1e-8)
            np.testing.assert_allclose(result[f"f{i}.friction_force"][1:], -0.3 * load, rtol=1e-8)


def test_blocks_on_a_roof_stick_until_the_pull_is_that_of_a_rope_over_both_slopes():
    """Two blocks joined by a rod over the ridge; where both pulls are equal, no friction is needed, and it may not be
    decided in turns for ever. They slide at 10 ((1 + mu)/(1 - mu))^2 N (slopes of 45 degrees)."""
    mu, half = 0.3, 0.5 * np.sqrt(0.5)
    down = {"l": (-1e-16, -1.0), "r": (1e-16, -1.0)}
    bodies = [PointMass2D(name=name, mass=0.02, position=(x, half)) for name, x in (("l", -half), ("r", half))]
    slopes = [
        DiskOnHalfPlane2D(
            name=f"c{name}",
            plane=HalfPlane2D(marker=Marker2D(point=(x, half), angle=angle)),
            disk=Disk2D(marker=Marker2D(body=name)),
            law=LAW,
            friction=CoulombFriction(coefficient=mu),
        )
        for name, x, angle in (("l", -half, np.pi / 4), ("r", half, -np.pi / 4))
    ]
    rod = Distance2D(name="rod", a=Marker2D(body="l"), b=Marker2D(body="r"), length=2.0 * half)
    pulls = [
        AppliedForce2D(
            name=f"p{name}",
            marker=Marker2D(body=name),
            force_x=Polynomial(coefficients=[10.0 * x, rate * x]),
            force_y=Polynomial(coefficients=[10.0 * y, rate * y]),
        )
        for (name, (x, y)), rate in zip(down.items(), (0.0, 1.0), strict=True)
    ]
    slides = 10.0 * ((1.0 + mu) / (1.0 - mu)) ** 2 - 10.0
    result = simulate(Model(gravity=(0, 0), bodies=bodies, joints=[rod], forces=pulls, contacts=slopes), 1.001 * slides)
    assert [event.t for event in result.events if event.kind == "slip"] == pytest.approx([slides] * 2, rel=1e-6)


def test_box_between_two_pads_in_the_plane_is_held():
    """20 N and mu 0.3 on both sides hold 12 N, and the box weighs 4.9 N."""
    bodies = [
        RigidBody2D(name="box", mass=0.5, inertia=3e-4),
        RigidBody2D(name="pad", mass=0.1, inertia=1e-4, position=(0.04, 0.0)),
    ]
    boxes = [
        Box2D(marker=Marker2D(body="box"), width=0.06, height=0.06),
        Box2D(marker=Marker2D(body="pad"), width=0.02, height=0.04),
        Box2D(marker=Marker2D(point=(-0.04, 0.0)), width=0.02, height=0.04),
    ]
    group = ContactGroup2D(
        name="t", boxes=boxes, law=LAW, friction=CoulombFriction(coefficient=0.3), except_bodies=[("pad", "ground")]
    )
    model = Model(
        bodies=bodies,
        joints=[Prismatic2D(name="s", a=Marker2D(), b=Marker2D(body="pad"))],
        forces=[AppliedForce2D(name="f", marker=Marker2D(body="pad"), force_x=Constant(value=-20.0))],
        groups=[group],
    )
    result = simulate(model, 0.3)
    assert max(abs(result["box.y"][-1]), abs(result["box.angle"][-1])) < 1e-9
    forces = np.array([result[name][-1] for name in result.channels if name.endswith("normal_force")])
    np.testing.assert_allclose(forces[forces > 1e-6], 10.0, rtol=1e-8)
