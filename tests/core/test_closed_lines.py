"""Closed lines: nothing tells where they begin, and a cam of many corners is the smooth cam that it stands for."""

import math

import numpy as np
import pytest
from contact_points import ContactPoint, check_derivatives, state_at
from helpers import on, residuals
from test_line_contact import BODIES, CASES, HALF, RADIUS, turned
from tlismni.core import (
    CoordinateDriver,
    Disk2D,
    DiskOnLine2D,
    KelvinVoigt,
    Line2D,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    Polynomial,
    Prismatic2D,
    RigidBody2D,
    SpringDamper2D,
    TanhFriction,
    simulate,
)
from tlismni.core.contacts.disk_on_line import make_pieces

CORNERS = (on("a", -0.2, 0.1), on("p"), on("b", -0.2, 0.3), on("b", 0.3, 1.9), Marker2D(point=(0.4, 2.1)))
"""Of a ring whose nodes are on bodies that move against each other."""
Q = np.array([0.25, -0.15, 0.2, 1.15, 0.35, 2.3, 0.05, 0.45])


def ring(first, case, rounding=0.6):
    """The ring that begins at corner `first`."""
    law, friction, _ = CASES[case]
    corners = CORNERS[first:] + CORNERS[:first]
    return DiskOnLine2D(
        name="c", line=Line2D(nodes=(*corners, corners[0]), radius=HALF, rounding=rounding), law=law, friction=friction,
        disk=Disk2D(marker=on("wheel", 0.1, -0.05), radius=RADIUS),
    )  # fmt: skip


def point_of(first, case, mode, rounding=0.6):
    return ContactPoint(Model(bodies=BODIES, contacts=[ring(first, case, rounding)]), mode)


def coordinates(centre, spin=0.4):
    return np.array([*Q, *(np.asarray(centre) - turned(spin, 0.1, -0.05)), spin])


@pytest.mark.parametrize("rounding", [0.6, 1.0])
def test_it_is_the_same_wherever_it_begins(rounding):
    """Gap, its rate and the sliding velocity, for disks inside and outside, beside every corner and every side."""
    points = [point_of(first, "friction force", 0.0, rounding) for first in range(len(CORNERS))]
    random = np.random.default_rng(5)
    for _ in range(60):
        q, v = coordinates(random.uniform((-1.0, -1.0), (3.5, 3.0))), random.uniform(-1.0, 1.0, 11)
        assert [p.gap(q, v) for p in points[1:]] == [pytest.approx(points[0].gap(q, v), abs=1e-13)] * 4
        assert [p.slide(q, v)[1] for p in points[1:]] == pytest.approx([points[0].slide(q, v)[1]] * 4, abs=1e-12)


def corner_place(k, height):
    """Centre at `height` inside (or, negative, outside) the ring beside the middle of the arc at corner k."""
    nodes = np.array([
        Q[:2] + turned(Q[2], -0.2, 0.1), Q[3:5], Q[5:7] + turned(Q[7], -0.2, 0.3), Q[5:7] + turned(Q[7], 0.3, 1.9),
        (0.4, 2.1),
    ])  # fmt: skip
    a, b, c = nodes[k - 1], nodes[k], nodes[(k + 1) % 5]
    inward = (a - 2.0 * b + c) / np.hypot(*(a - 2.0 * b + c))
    return b + 0.6 / 8.0 * (a - 2.0 * b + c) + height * inward


@pytest.mark.parametrize("case", CASES)
def test_derivatives_at_the_corner_where_it_begins(case):
    point = point_of(0, case, CASES[case][2])
    check_derivatives(
        point, state_at(point, coordinates(corner_place(0, -0.25)), 1), tolerance=1e-6, distances=slice(1)
    )


def test_gap_and_gradient_go_on_round_the_corner_where_it_begins():
    point, units = point_of(0, "force", 0.0), np.eye(11)
    gradients = []
    for angle in np.linspace(0.0, 2.0 * np.pi, 1200):
        q = coordinates(corner_place(0, -0.25) + 0.1 * np.array([math.cos(angle), math.sin(angle)]))
        gradients.append([point.gap(q, v)[1] for v in units])
    assert np.abs(np.diff(gradients, axis=0)).max() < 0.02


def test_ends_that_only_meet_do_not_close_it():
    """Nodes at one place on two bodies are two nodes."""
    law, *_ = CASES["force"]
    nodes = (on("a"), on("p"), on("b"), Marker2D(point=(0.2, -0.1)))
    assert not Line2D(nodes=nodes).closed
    with pytest.raises(ModelError, match="turns by 180 degrees at node 1"):
        disk = Disk2D(marker=on("wheel"), radius=0.1)
        there_and_back = Line2D(nodes=(on("a"), on("p"), on("a")))
        Model(bodies=BODIES, contacts=[DiskOnLine2D(name="c", line=there_and_back, disk=disk, law=law)]).assemble()


@pytest.mark.parametrize("rounding", [0.5, 1.0])
def test_curvature_changes_once_at_a_joint(rounding):
    """Where two pieces of different curvature meet both are as near as the other, within sqrt(rounding): the gap's
    second rate must not change from one to the other at random there."""
    nodes = tuple(Marker2D(point=p) for p in ((0.0, 0.0), (1.0, 0.0), (1.6, -0.9), (0.3, -1.3), (0.0, 0.0)))
    line = DiskOnLine2D(
        name="c", line=Line2D(nodes=nodes, rounding=rounding), disk=Disk2D(marker=on("wheel"), radius=0.1),
        law=NewtonImpact(restitution=0.0),
    )  # fmt: skip
    point = ContactPoint(Model(bodies=[BODIES[-1]], contacts=[line]), 0.0)
    pieces, places = make_pieces(4, rounding, closed=True), np.array([node.point for node in nodes[:-1]])
    for piece in pieces:
        _, b, c = piece.control(places)
        ahead = (c - b) / np.hypot(*(c - b))
        v, seen = np.array([*ahead, 0.0]), []
        for s in np.linspace(-1e-8, 1e-8, 401):
            q = np.array([*(c + s * ahead + 0.1 * np.array([-ahead[1], ahead[0]])), 0.0])
            seen.append(point.at(0.0, q, v, np.zeros(3), np.zeros(1))[3][0])
        jumps = np.abs(np.diff(seen)) > 1e-3
        assert np.count_nonzero(jumps) == 1, "one change, at the joint itself"


# ---- a cam and its follower -----------------------------------------------------------------------------------------

CIRCLE, OFFSET, ROLLER, SPEED, COUNT = 0.1, 0.02, 0.03, 10.0, 48


def cam(law, begin=0.0, roller=ROLLER, rounding=1.0, friction=None, lift=0.0, start=0.0):
    """An eccentric disk of COUNT nodes turns steadily under a roller that a spring presses on it.

    begin : angle of the first node on the cam; only its position on the list, if it is a multiple of 2 pi/COUNT.
    """
    angles = begin + np.linspace(0.0, 2.0 * np.pi, COUNT + 1)
    nodes = [on("cam", OFFSET + CIRCLE * math.cos(p), CIRCLE * math.sin(p)) for p in angles]
    y, _, _ = analytic(0.0, roller, start)
    bodies = [
        RigidBody2D(name="cam", mass=1.0, inertia=0.01, angle=start, angular_velocity=SPEED),
        RigidBody2D(name="roller", mass=0.5, inertia=1e-3, position=(0.0, float(y) + lift)),
    ]
    upright = Marker2D(angle=0.5 * math.pi)
    drive = Polynomial(coefficients=(start, SPEED))
    joints = [
        CoordinateDriver(name="drive_x", body="cam", coordinate="x", motion=Polynomial(coefficients=(0.0,))),
        CoordinateDriver(name="drive_y", body="cam", coordinate="y", motion=Polynomial(coefficients=(0.0,))),
        CoordinateDriver(name="turn", body="cam", coordinate="angle", motion=drive),
        Prismatic2D(name="guide", a=upright, b=on("roller", angle=0.5 * math.pi)),
    ]
    spring = SpringDamper2D(name="spring", a=Marker2D(point=(0.0, 1.0)), b=on("roller"), stiffness=200.0,
                            natural_length=1.0)  # fmt: skip
    line = DiskOnLine2D(
        name="c", line=Line2D(nodes=nodes, rounding=rounding), disk=Disk2D(marker=on("roller"), radius=roller),
        law=law, friction=friction,
    )  # fmt: skip
    return Model(bodies=bodies, joints=joints, forces=[spring], contacts=[line])


def analytic(t, roller=ROLLER, start=0.0):
    """Height, velocity and force of the roller on the circle that the nodes stand for: its centre turns at OFFSET, and
    the roller's is at the sum of the radii from it; the force acts along the line between them."""
    p, reach = start + SPEED * np.asarray(t), CIRCLE * math.cos(math.pi / COUNT) + roller
    s, c = OFFSET * np.sin(p), OFFSET * np.cos(p)
    root = np.sqrt(reach**2 - c**2)
    y, rate = s + root, c + c * s / root
    second = -s + (c**2 - s**2) / root - (c * s) ** 2 / root**3
    force = 0.5 * (9.81 + SPEED**2 * second) + 200.0 * y
    return y, SPEED * rate, force * reach / root


def node_angle(k):
    return 2.0 * math.pi * k / COUNT


def test_cam_of_many_turns_is_the_eccentric_circle():
    """Six turns on a constraint: motion and force of the closed form, to what 48 nodes leave of a circle."""
    turn = 2.0 * math.pi / SPEED
    grid = np.linspace(0.1, 0.1 + 5.0 * turn, 251)
    result = simulate(cam(NewtonImpact(restitution=0.0), lift=1e-5), grid[-1], rtol=1e-7, t_eval=grid)
    y, rate, force = analytic(grid)
    assert result["roller.y"] == pytest.approx(y, abs=1e-6)
    assert result["roller.vy"] == pytest.approx(rate, abs=1e-4)
    # the force feels the curvature, which varies by 1.3 % along each arc
    assert result["c.normal_force"] == pytest.approx(force, rel=0.02)
    # over full turns that comes to nothing
    impulse = result["c.impulse"][-1] - result["c.impulse"][0]
    assert impulse == pytest.approx(5.0 * turn * np.mean(force[1:]), rel=1e-4)
    assert [event.kind for event in result.events] == ["impact", "close"]
    assert max(residuals(result)) < 1e-9


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "law, friction",
    [
        (NewtonImpact(restitution=0.4), None),
        (KelvinVoigt(stiffness=2e5, damping=20.0), TanhFriction(coefficient=0.2, transition_speed=0.05)),
    ],
)
def test_motion_does_not_depend_on_where_the_line_begins(law, friction):
    """Thrown on the cam: the same blows and the same course, with the first node anywhere on the list."""
    grid, runs = np.linspace(0.0, 1.4, 141), []
    for k in (0, 13, 31):
        model = cam(law, node_angle(k), friction=friction, lift=0.001)
        runs.append(simulate(model, 1.4, rtol=1e-9, atol=1e-12, t_eval=grid))
    first, *others = runs
    assert len(first.events) > 3
    for other in others:
        assert [event.kind for event in other.events] == [event.kind for event in first.events]
        assert [event.t for event in other.events] == pytest.approx([event.t for event in first.events], abs=1e-6)
        assert other["roller.y"] == pytest.approx(first["roller.y"], abs=1e-7)
        assert other.stats["steps"] < 1.1 * first.stats["steps"]


def test_small_roller_passes_where_the_line_begins():
    """A roller much smaller than the corner that the unrounded line would have there: no lift-off, no impact."""
    start = 0.5 * math.pi - 0.06  # the first node comes by after 0.006 s
    model = cam(NewtonImpact(restitution=0.0), roller=2e-4, rounding=0.5, start=start, lift=1e-5)
    result = simulate(model, 0.012)
    assert [event.kind for event in result.events] == ["impact", "close"]
    assert result["c.normal_force"][-1] > 0.0
