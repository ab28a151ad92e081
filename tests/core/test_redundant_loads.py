"""Loads of joints that repeat each other: those of equally compliant joints, in any order and any unit.

A force counts as much as another, and a moment as the force that makes it at the length of the model. The references
are least-squares solutions of the equilibrium of rigid bodies.
"""

import itertools
import logging
import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import (
    Axes,
    CoulombFriction,
    Distance2D,
    Fixed3D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    Prismatic3D,
    Revolute2D,
    Revolute3D,
    RevoluteFriction3D,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    Sphere3D,
    SphereOnHalfSpace3D,
    Spherical3D,
    simulate,
)

G = 9.81
METHODS = ["ebdf", "irk", "bdf", "adams", "hht"]
WIDTH, MASS = 0.8, 20.0
HEIGHTS = {"two": (-0.7, 0.7), "three": (-0.7, 0.1, 0.7)}


@pytest.fixture(autouse=True)
def _quiet():
    """Each of these models is told to be redundant."""
    logging.getLogger("tlismni").setLevel(logging.ERROR)
    yield
    logging.getLogger("tlismni").setLevel(logging.NOTSET)


def door(heights, order, metre=1.0, turning=0.0):
    """A door on hinges along z, its centre of mass beside them; `metre` units of length for a metre."""
    size = metre**2
    body = RigidBody3D(
        name="door",
        mass=MASS,
        inertia=(MASS * 0.09 * size, MASS * 0.09 * size, MASS * 0.0625 * size),
        position=(0.5 * WIDTH * metre, 0.0, 0.0),
        velocity=(0.0, 0.5 * WIDTH * metre * turning, 0.0),
        angular_velocity=(0.0, 0.0, turning),
    )
    hinges = [
        Revolute3D(
            name=f"h{i}",
            a=Marker3D(point=(0.0, 0.0, heights[i] * metre)),
            b=Marker3D(body="door", point=(-0.5 * WIDTH * metre, 0.0, heights[i] * metre)),
        )
        for i in order
    ]
    return Model(gravity=(0.0, 0.0, -G * metre), bodies=[body], joints=hinges)


def least_loads(points, axis, length, force, moment):
    """Forces and moments across `axis` of hinges at `points`, (hinges, 6), the least that give this force and this
    moment about the origin, moments counted at the arm `length`."""
    across = np.linalg.svd(np.array([axis]))[2][1:]
    columns = []
    for point in points:
        for unit in np.eye(3):
            columns.append([*unit, *np.cross(point, unit)])
        columns += [[0.0, 0.0, 0.0, *(length * unit)] for unit in across]
    matrix = np.array(columns).T
    # about the axis the hinges do not hold
    held = np.vstack([np.eye(3, 6), np.hstack([np.zeros((2, 3)), across])])
    shares = np.linalg.lstsq(held @ matrix, held @ np.array([*force, *moment]), rcond=None)[0]
    return np.array([[*part[:3], *(length * part[3:] @ across)] for part in shares.reshape(len(points), 5)])


def loads(result, names, row=-1):
    parts = [f"{kind}_{axis}" for kind in ("force", "torque") for axis in "xyz"]
    return np.array([[result[f"{name}.{part}"][row] for part in parts] for name in names])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("hinges", HEIGHTS)
def test_hinges_of_a_door_that_turns_share_its_weight(hinges, method):
    heights, turning = HEIGHTS[hinges], 2.0
    for order in itertools.islice(itertools.permutations(range(len(heights))), 0, None, 2):
        model = door(heights, order, turning=turning)
        length = Simulation(model).assembly.length
        result = simulate(model, 0.5, method, rtol=1e-9, atol=1e-11)
        angle = result["h0.angle"][-1]
        way = np.array([math.cos(angle), math.sin(angle), 0.0])
        force = np.array([0.0, 0.0, MASS * G]) - MASS * turning**2 * 0.5 * WIDTH * way
        moment = np.cross(0.5 * WIDTH * way, force)
        points = [(0.0, 0.0, height) for height in heights]
        wanted = least_loads(points, (0.0, 0.0, 1.0), length, force, moment)
        found = loads(result, [f"h{i}" for i in range(len(heights))])
        # torques are shown along the axes of the ground's marker
        np.testing.assert_allclose(found, wanted, atol=1e-7 * MASS * G)


@pytest.mark.parametrize("metre", [1e-3, 1e3])
def test_units_do_not_decide_who_carries(metre):
    usual, other = (
        loads(simulate(door(HEIGHTS["three"], range(3), x), 0.01), ["h0", "h1", "h2"]) for x in (1.0, metre)
    )
    np.testing.assert_allclose(other / (metre * np.array([1.0] * 3 + [metre] * 3)), usual, atol=1e-9 * MASS * G)


@pytest.mark.parametrize("method", METHODS)
def test_supports_of_a_beam_carry_a_linear_function_of_their_place(method):
    beam = RigidBody2D(name="beam", mass=2.0, inertia=0.1)
    places = [-1.0, 0.5, 1.0]
    joints = [Revolute2D(name="left", a=Marker2D(point=(-1.0, 0.0)), b=Marker2D(body="beam", point=(-1.0, 0.0)))]
    joints += [
        Distance2D(name=name, a=Marker2D(point=(x, -1.0)), b=Marker2D(body="beam", point=(x, 0.0)), length=1.0)
        for name, x in (("middle", 0.5), ("right", 1.0))
    ]
    wanted = np.linalg.lstsq(np.array([np.ones(3), places]), np.array([2.0 * G, 0.0]), rcond=None)[0]
    for order in itertools.permutations(joints):
        result = simulate(Model(bodies=[beam], joints=order), 0.1, method)
        found = [result["left.force_y"][-1], -result["middle.tension"][-1], -result["right.tension"][-1]]
        np.testing.assert_allclose(np.abs(found), wanted, rtol=1e-9)


def test_mechanisms_that_only_the_ground_connects_do_not_share():
    """Two doors: each as if it were alone, also where the other one is light."""
    one = door(HEIGHTS["two"], range(2))
    alone = loads(simulate(one, 0.01), ["h0", "h1"])
    second = door(HEIGHTS["two"], range(2))
    light = second.bodies[0].model_copy(update={"name": "light", "mass": 0.1 * MASS})
    hinges = [
        hinge.model_copy(update={"name": f"l{i}", "b": hinge.b.model_copy(update={"body": "light"})})
        for i, hinge in enumerate(second.joints)
    ]
    both = simulate(one.model_copy(update={"bodies": (*one.bodies, light), "joints": (*one.joints, *hinges)}), 0.01)
    np.testing.assert_allclose(loads(both, ["h0", "h1"]), alone, atol=1e-9 * MASS * G)
    np.testing.assert_allclose(loads(both, ["l0", "l1"]), 0.1 * alone, atol=1e-9 * MASS * G)


@pytest.mark.parametrize("method", METHODS)
def test_guides_of_a_carriage_carry_half_each(method):
    """Among the rows left out is the norm of the Euler parameters, which carries nothing."""
    frame = Axes(z=(1.0, 0.0, 0.0))
    carriage = RigidBody3D(name="carriage", mass=2.0, inertia=(0.1, 0.1, 0.1), velocity=(1.0, 0.0, 0.0))
    guides = [
        Prismatic3D(name=f"g{k}", a=Marker3D(point=place, attitude=frame), b=carriage.marker_at(place, frame))
        for k, place in enumerate(((0.0, 0.3, 0.0), (0.0, -0.3, 0.0)))
    ]
    result = simulate(Model(bodies=[carriage], joints=guides, gravity=(0.0, 0.0, -G)), 0.3, method)
    assert any(found.of_body for found in result.redundant)
    assert result["carriage.x"][-1] == pytest.approx(0.3, abs=1e-9)
    first, second = loads(result, ["g0", "g1"])
    # along the axes of the guide: its y and x are across
    assert np.linalg.norm(first[:3] + second[:3]) == pytest.approx(2.0 * G, rel=1e-9)
    np.testing.assert_allclose(first[:3], second[:3], atol=1e-9)
    # equal forces at both sides leave no moment
    np.testing.assert_allclose([first[3:], second[3:]], 0.0, atol=1e-9)


@pytest.mark.parametrize("order", list(itertools.permutations(range(3)))[::2])
def test_joints_are_rigid_beside_contacts(order):
    """A table of two halves that three redundant joints hold together: its feet carry what those of one block do."""
    points = [(-0.4, -0.2), (0.4, -0.2), (-0.3, 0.2), (0.5, 0.25)]
    halves = [
        RigidBody3D(name=name, mass=mass, inertia=(0.1, 0.1, 0.1), position=(x, 0.0, 0.3))
        for name, mass, x in (("left", 1.0, -0.25), ("right", 3.0, 0.25))
    ]
    kinds = [Fixed3D, Spherical3D, Fixed3D]
    joints = [
        kinds[i](
            name=f"j{i}",
            a=Marker3D(body="left", point=(0.25, y, 0.0)),
            b=Marker3D(body="right", point=(-0.25, y, 0.0)),
        )
        for i, y in ((k, (-0.1, 0.0, 0.15)[k]) for k in order)
    ]
    feet = [
        SphereOnHalfSpace3D(
            name=f"f{i}",
            plane=HalfSpace3D(),
            sphere=Sphere3D(
                marker=Marker3D(body="left" if x < 0.0 else "right", point=(x - (-0.25 if x < 0.0 else 0.25), y, -0.3)),
                radius=0.0,
            ),
            law=NewtonImpact(restitution=0.0),
            friction=CoulombFriction(coefficient=0.3),
        )
        for i, (x, y) in enumerate(points)
    ]
    model = Model(gravity=(0.0, 0.0, -G), bodies=halves, joints=joints, contacts=feet)
    result = simulate(model, 0.1)
    matrix = np.array([[1.0, x, y] for x, y in points]).T
    wanted = np.linalg.lstsq(matrix, G * np.array([4.0, 0.5, 0.0]), rcond=None)[0]
    found = np.array([result[f"f{i}.normal_force"][-1] for i in range(4)])
    np.testing.assert_allclose(found, wanted, rtol=1e-8)
    # what the joints carry across holds the left half
    carried = sum(loads(result, [f"j{i}"])[0, :3] for i in range(3))
    assert abs(carried[2]) == pytest.approx(abs(G - found[0] - found[2]), rel=1e-7)


LEVER, BESIDE, APART, INERTIA = 0.5, 0.15, 0.4, 0.08
COEFFICIENT, RADIUS = 0.3, 0.05


def pendulum_on_two_bearings(angle, rate):
    """A pendulum about y, beside the middle of its two bearings, each with friction that follows its force."""
    c, s = math.cos(angle), math.sin(angle)
    axes = Axes(z=(0.0, 1.0, 0.0), x=(1.0, 0.0, 0.0))
    place = np.array([LEVER * s, BESIDE, -LEVER * c])
    turning = np.array([0.0, -rate, 0.0])
    bar = RigidBody3D(
        name="bar",
        mass=2.0,
        inertia=(0.05, INERTIA, 0.04),
        position=tuple(place),
        attitude=Axes(x=(c, 0.0, s), z=(-s, 0.0, c)),
        velocity=tuple(np.cross(turning, place)),
        angular_velocity=tuple(turning),
    )
    joints, forces = [], []
    for i, y in enumerate((-APART, APART)):
        ends = {
            "a": Marker3D(point=(0.0, y, 0.0), attitude=axes),
            "b": Marker3D(body="bar", point=(0.0, y - BESIDE, LEVER), attitude=axes),
        }
        joints.append(Revolute3D(name=f"h{i}", **ends))
        friction = {"joint": f"h{i}", "coefficient": COEFFICIENT, "radius": RADIUS}
        forces.append(RevoluteFriction3D(name=f"f{i}", **ends, **friction))
    return Model(gravity=(0.0, 0.0, -G), bodies=[bar], joints=joints, forces=forces)


@cache
def swing_on_two_bearings():
    """Rate and the bearings' forces at 0.3 s: an integration of theta'' with the least forces at each instant."""
    length = Simulation(pendulum_on_two_bearings(0.5, 8.0)).assembly.length

    def forces(theta, rate, change):
        c, s = math.cos(theta), math.sin(theta)
        place = np.array([LEVER * s, 0.0, -LEVER * c])
        force = 2.0 * (change * np.array([LEVER * c, 0.0, LEVER * s]) - rate**2 * place + np.array([0.0, 0.0, G]))
        moment = np.cross(place + np.array([0.0, BESIDE, 0.0]), force)
        shares = least_loads([(0.0, -APART, 0.0), (0.0, APART, 0.0)], (0.0, 1.0, 0.0), length, force, moment)
        return np.linalg.norm(shares[:, :3], axis=1)

    def acceleration(theta, rate):
        inertia, change = INERTIA + 2.0 * LEVER**2, 0.0
        for _ in range(60):
            braking, before = COEFFICIENT * RADIUS * np.sum(forces(theta, rate, change)), change
            change = (-2.0 * G * LEVER * math.sin(theta) - math.copysign(braking, rate)) / inertia
            if abs(change - before) <= 1e-14 * abs(change):
                break
        return change

    known = solve_ivp(lambda t, y: [y[1], acceleration(*y)], (0.0, 0.3), [0.5, 8.0], rtol=1e-11, atol=1e-12)
    theta, rate = known.y[:, -1]
    return rate, forces(theta, rate, acceleration(theta, rate))


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("method", "error"), [("ebdf", 1e-7), ("irk", 1e-7), ("bdf", 2e-6), ("hht", 5e-5)])
def test_friction_of_redundant_bearings_follows_their_shares(method, error):
    rate, forces = swing_on_two_bearings()
    result = simulate(pendulum_on_two_bearings(0.5, 8.0), 0.3, method, rtol=1e-9, atol=1e-11)
    assert -result["bar.angular_velocity_y"][-1] == pytest.approx(rate, abs=error)
    found = np.linalg.norm(loads(result, ["h0", "h1"])[:, :3], axis=1)
    np.testing.assert_allclose(found, forces, atol=20.0 * error)
