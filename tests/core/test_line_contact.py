"""A disk on a deformable line: geometry, derivatives, passing from piece to piece, moving nodes, impulses, friction."""

import math

import numpy as np
import pytest
from contact_points import ContactPoint, check_derivatives, state_at
from helpers import G, events, on, residuals
from tlismni.core import (
    CoordinateDriver,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    DiskOnLine2D,
    DiskOnSegment2D,
    HalfPlane2D,
    KelvinVoigt,
    Line2D,
    LuGreFriction,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Prismatic2D,
    RigidBody2D,
    Segment2D,
    Sine,
    SpringDamper2D,
    TanhFriction,
    simulate,
)
from tlismni.core.contacts.disk_on_line import make_pieces
from tlismni.core.state.modes import ACTIVE, CLOSED, OPEN

TIGHT = {"rtol": 1e-10, "atol": 1e-12}
RADIUS, HALF = 0.3, 0.05
CASES = {
    "constraint": (NewtonImpact(restitution=0.5), None, CLOSED),
    "open": (NewtonImpact(restitution=0.5), None, OPEN),
    "force": (KelvinVoigt(stiffness=4.0, damping=0.8), None, ACTIVE),
    "friction force": (
        KelvinVoigt(stiffness=60.0, damping=0.1), TanhFriction(coefficient=0.4, transition_speed=0.3), ACTIVE
    ),
    "bristles": (
        KelvinVoigt(stiffness=60.0, damping=0.1),
        LuGreFriction(coefficient=0.4, static_coefficient=0.6, stribeck_speed=0.5, bristle_stiffness=0.3,
                      bristle_damping=0.2, viscous_damping=0.1),
        ACTIVE,
    ),
}  # fmt: skip

# nodes on rigid bodies away from their centres, on a point mass, and on the ground; two of them on one body
BODIES = [
    RigidBody2D(name="a", mass=1.3, inertia=0.4, position=(0.2, -0.1)),
    PointMass2D(name="p", mass=0.5, position=(1.1, 0.3)),
    RigidBody2D(name="b", mass=0.8, inertia=0.3, position=(2.2, 0.1), angle=0.3),
    RigidBody2D(name="wheel", mass=0.7, inertia=0.2, position=(1.0, 1.0)),
]
NODES = (on("a", -0.2, 0.1), on("p"), on("b", -0.2, 0.3), on("b", 0.4, -0.1), Marker2D(point=(3.5, 0.2)))


def contact(law, friction=None, nodes=NODES, half=HALF, rounding=0.6):
    return DiskOnLine2D(
        name="c", line=Line2D(nodes=nodes, radius=half, rounding=rounding), law=law, friction=friction,
        disk=Disk2D(marker=on("wheel", 0.1, -0.05), radius=RADIUS),
    )  # fmt: skip


Q = np.array([0.25, -0.15, 0.2, 1.15, 0.35, 2.3, 0.05, 0.45])
"""Coordinates of the nodes' bodies, away from the start."""


def turned(angle, x, y):
    return np.array([math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y])


def drawn(nodes, rounding=0.6, parts=400):
    """Points of the line (pieces, parts + 1, 2) for given places of its nodes, and their tangents."""
    points, tangents = [], []
    t = np.linspace(0.0, 1.0, parts + 1)[:, None]
    for piece in make_pieces(len(nodes), rounding):
        a, b, c = piece.control(nodes)
        points.append((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t**2 * c)
        tangents.append(2 * (1 - t) * (b - a) + 2 * t * (c - b))
    return np.array(points), np.array(tangents)


def node_places(q=Q):
    a, p, b = q[:3], q[3:5], q[5:8]
    return np.array([
        a[:2] + turned(a[2], -0.2, 0.1), p, b[:2] + turned(b[2], -0.2, 0.3), b[:2] + turned(b[2], 0.4, -0.1), (3.5, 0.2)
    ])  # fmt: skip


def with_wheel(centre, spin=0.4, q=Q):
    """All coordinates with the disk's centre at `centre`."""
    return np.array([*q, *(np.asarray(centre) - turned(spin, 0.1, -0.05)), spin])


def beside(piece, part, height, side=1.0, q=Q):
    """Centre of a disk at `height` over a point of the line, on its left (1) or right (-1)."""
    points, tangents = drawn(node_places(q))
    k = round(part * 400)
    direction = tangents[piece, k] / np.hypot(*tangents[piece, k])
    return points[piece, k] + side * height * np.array([-direction[1], direction[0]])


PLACES = {
    "first straight": beside(0, 0.6, 0.33),
    "first vertex, hollow": beside(1, 0.4, 0.2),
    "first vertex, outside": beside(1, 0.6, 0.2, -1.0),
    "middle straight": beside(2, 0.5, 0.33, -1.0),
    "last vertex": beside(5, 0.3, 0.3),
    "before the line": beside(0, 0.0, 0.15) + np.array([-0.2, 0.02]),
    "behind the line": beside(6, 1.0, -0.2) + np.array([0.25, 0.04]),
}  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("case", CASES)
def test_derivatives(case, place):
    law, friction, mode = CASES[case]
    point = ContactPoint(Model(bodies=BODIES, contacts=[contact(law, friction)]), mode)
    check_derivatives(point, state_at(point, with_wheel(PLACES[place]), 1), tolerance=1e-6, distances=slice(1))


@pytest.fixture(scope="module")
def sliding():
    law, friction, *_ = CASES["friction force"]
    return ContactPoint(Model(bodies=BODIES, contacts=[contact(law, friction)]), OPEN)


def test_gap_is_the_distance_of_the_nearest_point(sliding):
    random, line = np.random.default_rng(3), drawn(node_places(), parts=4000)[0].reshape(-1, 2)
    for _ in range(50):
        centre = random.uniform((-0.7, -1.0), (4.2, 1.2))
        gap, _ = sliding.gap(with_wheel(centre))
        assert gap == pytest.approx(np.min(np.hypot(*(centre - line).T)) - RADIUS - HALF, abs=1e-5)


def test_line_is_drawn_through_the_segments_and_touches_them():
    nodes = np.array([(0.0, 0.0), (1.0, 0.2), (2.0, -0.1), (2.5, 0.4)])
    points, tangents = drawn(nodes, 0.6)
    assert np.array_equal(points[0, 0], nodes[0]) and points[-1, -1] == pytest.approx(nodes[-1])
    assert points[1:, 0] == pytest.approx(points[:-1, -1])  # piece by piece
    unit = tangents / np.linalg.norm(tangents, axis=-1, keepdims=True)
    assert unit[1:, 0] == pytest.approx(unit[:-1, -1])
    for k in range(3):
        assert points[2 * k, 200] == pytest.approx(0.5 * (points[2 * k, 0] + points[2 * k, -1]))
    assert points[1, 200] == pytest.approx(nodes[1] + 0.6 / 8.0 * (nodes[0] - 2.0 * nodes[1] + nodes[2]))


def test_gap_and_its_gradient_go_on_from_piece_to_piece(sliding):
    """Along a path over the line, on both sides: no jump beyond what the path's step makes."""
    for side in (1.0, -1.0):
        path = [beside(p, u, 0.25, side) for p in range(7) for u in np.linspace(0.0, 1.0, 401)]
        gaps, slopes, before = [], [], None
        for centre in path:
            gaps.append(sliding.gap(with_wheel(centre))[0])
            directions = [sliding.gap(with_wheel(centre), v)[1] for v in np.eye(11)]
            if before is not None:
                slopes.append(np.max(np.abs(np.array(directions) - before)))
            before = np.array(directions)
        assert np.abs(np.diff(gaps)).max() < 1e-6
        assert max(slopes) < 0.02


def test_rates_are_those_of_the_material_points_in_touch():
    """On a line that moves as a rigid body, at zero gap: velocity of the disk's point of contact on the line's."""
    nodes = tuple(on("plate", x, y) for x, y in ((0.0, 0.0), (0.8, 0.1), (1.5, -0.3), (2.2, 0.0)))
    plate = RigidBody2D(name="plate", mass=1.0, inertia=1.0)
    law, friction, _ = CASES["friction force"]
    line = contact(law, friction, nodes)
    point = ContactPoint(Model(bodies=[plate, BODIES[-1]], contacts=[line]), OPEN)
    random, body = np.random.default_rng(2), np.array([0.3, -0.2, 0.9])
    shape = np.array([node.point for node in nodes])
    places = body[:2] + np.array([turned(body[2], *node) for node in shape])
    points, tangents = drawn(places)
    for piece in range(5):
        for k in (0, 130, 399):
            for side in (1.0, -1.0):
                axis = tangents[piece, k] / np.hypot(*tangents[piece, k])
                n = side * np.array([-axis[1], axis[0]])
                centre = points[piece, k] + (RADIUS + HALF) * n
                q, v = with_wheel(centre, q=body), random.uniform(-1.0, 1.0, 6)
                touch = centre - RADIUS * n
                velocity = [
                    v[i : i + 2] + v[i + 2] * np.array([-(touch - q[i : i + 2])[1], (touch - q[i : i + 2])[0]])
                    for i in (0, 3)
                ]
                relative = velocity[1] - velocity[0]
                assert point.gap(q)[0] == pytest.approx(0.0, abs=1e-13)
                assert point.gap(q, v)[1] == pytest.approx(relative @ n, abs=1e-12)
                assert point.slide(q, v)[1] == pytest.approx(relative @ np.array([n[1], -n[0]]), abs=1e-12)


def test_line_of_two_nodes_on_one_body_is_a_segment():
    """Gap and both rates, on both sides and round both ends."""
    length, tilt, start = 1.5, 0.5, (-0.4, 0.2)
    law, friction, _ = CASES["friction force"]
    plate, disk = (
        RigidBody2D(name="plate", mass=1.3, inertia=0.4),
        Disk2D(marker=on("wheel", 0.1, -0.05), radius=RADIUS),
    )
    segment = DiskOnSegment2D(
        name="c", segment=Segment2D(marker=Marker2D(body="plate", point=start, angle=tilt), length=length, radius=HALF),
        disk=disk, law=law, friction=friction,
    )  # fmt: skip
    end = (start[0] + length * math.cos(tilt), start[1] + length * math.sin(tilt))
    line = contact(law, friction, (on("plate", *start), on("plate", *end)))
    bodies = [plate, BODIES[-1]]
    one, other = (ContactPoint(Model(bodies=bodies, contacts=[c]), OPEN) for c in (segment, line))
    random = np.random.default_rng(7)
    for _ in range(60):
        v = random.uniform(-1.0, 1.0, 6)
        body = np.array([*random.uniform(-1.0, 1.0, 2), random.uniform(-9.0, 9.0)])
        middle = body[:2] + turned(body[2], 0.25, 0.55)
        q = with_wheel(middle + random.uniform(-1.3, 1.3, 2), random.uniform(-3.0, 3.0), body)
        assert one.gap(q, v) == pytest.approx(other.gap(q, v), abs=1e-13)
        assert one.slide(q, v)[1] == pytest.approx(other.slide(q, v)[1], abs=1e-12)


# ---- motion ---------------------------------------------------------------------------------------------------------


SPRING = KelvinVoigt(stiffness=5e3, damping=4.0)
RUB = TanhFriction(coefficient=0.2, transition_speed=0.05)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("law, friction", [(NewtonImpact(restitution=0.6), None), (SPRING, None), (SPRING, RUB)])
def test_straight_line_is_a_half_plane(law, friction):
    """A thrown wheel that bounces, slides and rolls over six segments of different lengths: the same motion."""
    wheel = RigidBody2D(name="wheel", mass=2.0, inertia=0.1, position=(0.1, 0.6), velocity=(3.3, 0.0))
    disk = Disk2D(marker=on("wheel"), radius=0.25)
    nodes = tuple(Marker2D(point=(x, 0.0)) for x in (-0.2, 0.5, 1.4, 1.9, 3.0, 3.3, 6.0))
    line = DiskOnLine2D(name="c", line=Line2D(nodes=nodes), disk=disk, law=law, friction=friction)
    plane = DiskOnHalfPlane2D(name="c", plane=HalfPlane2D(), disk=disk, law=law, friction=friction)
    # Tanh's steep start makes much of rounding in steps that are long beside it
    step, grid = 1e-3 if friction is None else 1e-4, np.linspace(0.0, 1.5, 151)
    results = [
        simulate(Model(bodies=[wheel], contacts=[c]), 1.5, step=step, newton_tolerance=1e-14, t_eval=grid)
        for c in (plane, line)
    ]
    first, second = ([(event.kind, event.t) for event in result.events] for result in results)
    assert len(first) > 3 and [kind for kind, _ in first] == [kind for kind, _ in second]
    assert [t for _, t in first] == pytest.approx([t for _, t in second], abs=1e-9)
    assert results[1]["wheel.x"][-1] > 3.3
    for name in ("wheel.x", "wheel.y", "wheel.angle", "c.gap"):
        assert results[0][name] == pytest.approx(results[1][name], abs=1e-12), name


def test_disk_on_a_driven_node():
    """Over a vertex that is driven up and down it moves by 1 - rounding/4 of the drive; that gives the force."""
    away, rounding, amplitude, w = 0.25, 0.5, 0.05, 6.0
    nodes = (Marker2D(point=(-1.0, 0.0)), on("node"), Marker2D(point=(1.0, 0.0)))
    bodies = [
        PointMass2D(name="node", mass=1.0, velocity=(0.0, amplitude * w)),
        PointMass2D(name="ball", mass=2.0, position=(0.0, away), velocity=(0.0, (1 - rounding / 4) * amplitude * w)),
    ]
    drivers = [
        CoordinateDriver(name="up", body="node", coordinate="y", motion=Sine(amplitude=amplitude, angular_frequency=w)),
        CoordinateDriver(name="hold", body="node", coordinate="x", motion=Sine(amplitude=0.0, angular_frequency=1.0)),
    ]
    line = DiskOnLine2D(
        name="c", line=Line2D(nodes=nodes, rounding=rounding), disk=Disk2D(marker=on("ball"), radius=away),
        law=NewtonImpact(restitution=0.0),
    )  # fmt: skip
    result = simulate(Model(bodies=bodies, joints=drivers, contacts=[line], gravity=(0.0, -G)), 0.7, **TIGHT)
    share = 1.0 - rounding / 4.0
    assert result["ball.y"] == pytest.approx(away + share * amplitude * np.sin(w * result.t), abs=1e-9)
    assert np.abs(result["ball.x"]).max() < 1e-9
    force = 2.0 * (G - share * amplitude * w**2 * np.sin(w * result.t))
    assert result["c.normal_force"][1:] == pytest.approx(force[1:], abs=1e-6)
    assert max(residuals(result)) < 1e-9


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_impact_on_a_line_of_free_masses(restitution):
    """The impulse P (1/m + sum w_k^2/m_k) = (1 + e) v, shared by the nodes with their weights; momentum is kept."""
    masses, x, radius, speed = (1.0, 0.4, 2.0, 0.7), 1.3, 0.2, 2.0
    bodies = [PointMass2D(name=f"n{k}", mass=mass, position=(float(k), 0.0)) for k, mass in enumerate(masses)]
    bodies.append(PointMass2D(name="ball", mass=0.5, position=(x, radius + 0.1), velocity=(0.0, -speed)))
    line = DiskOnLine2D(
        name="c", line=Line2D(nodes=tuple(on(f"n{k}") for k in range(4)), rounding=0.5),
        disk=Disk2D(marker=on("ball"), radius=radius), law=NewtonImpact(restitution=restitution),
    )  # fmt: skip
    result = simulate(Model(bodies=bodies, contacts=[line], gravity=(0.0, 0.0)), 0.06, **TIGHT)
    weights = np.array([0.0, 1.0 - (x - 1.0), x - 1.0, 0.0])  # x is on the straight part of its segment
    inverse = 1.0 / 0.5 + np.sum(weights**2 / np.array(masses))
    (impact,) = events(result, "impact")
    assert impact.impulse == pytest.approx((1.0 + restitution) * speed / inverse, rel=1e-10)
    k = int(np.flatnonzero(result.t >= impact.t)[1])
    for i, mass in enumerate(masses):
        assert result[f"n{i}.vy"][k] == pytest.approx(-weights[i] * impact.impulse / mass, abs=1e-9)
    assert result["ball.vy"][k] == pytest.approx(-speed + impact.impulse / 0.5, abs=1e-9)
    assert impact.energy_loss == pytest.approx(0.5 * (1.0 - restitution**2) * speed**2 / inverse, rel=1e-9, abs=1e-12)


def rope(law, friction=None, count=7, **ball):
    """A ball on a sagging rope of point masses, springs between them, its ends on the ground."""
    x = np.linspace(0.0, 2.0, count)
    y = -0.25 * (1.0 - (x - 1.0) ** 2)
    names = [f"n{k}" for k in range(1, count - 1)]
    bodies = [PointMass2D(name=f"n{k}", mass=0.5, position=(x[k], y[k])) for k in range(1, count - 1)]
    nodes = [Marker2D(point=(x[0], y[0])), *(on(name) for name in names), Marker2D(point=(x[-1], y[-1]))]
    lengths = np.hypot(np.diff(x), np.diff(y))
    springs = [
        SpringDamper2D(
            name=f"s{k}", a=nodes[k], b=nodes[k + 1], stiffness=2e3, damping=2.0, natural_length=0.98 * lengths[k]
        )
        for k in range(count - 1)
    ]
    wheel = RigidBody2D(**{"name": "ball", "mass": 1.0, "inertia": 0.005, "position": (0.45, 0.05), **ball})
    line = DiskOnLine2D(
        name="c", line=Line2D(nodes=tuple(nodes), rounding=1.0), disk=Disk2D(marker=on("ball"), radius=0.1),
        law=law, friction=friction,
    )  # fmt: skip
    return Model(bodies=[*bodies, wheel], forces=springs, contacts=[line], gravity=(0.0, -G))


@pytest.mark.parametrize(
    "law, friction",
    [
        (NewtonImpact(restitution=0.3), None),
        (KelvinVoigt(stiffness=2e4, damping=20.0), TanhFriction(coefficient=0.3, transition_speed=0.05)),
    ],
)
def test_ball_on_a_rope_keeps_the_balance(law, friction):
    """It falls on the rope and rolls over its nodes, on the hollow side."""
    result = simulate(rope(law, friction), 1.0, rtol=1e-8, atol=1e-10)
    assert result["ball.x"].max() - result["ball.x"].min() > 0.5
    assert np.abs(result["energy.balance"]).max() < 1e-5
    assert result["c.gap"].min() > (-1e-10 if isinstance(law, NewtonImpact) else -0.02)
    if isinstance(law, NewtonImpact):
        assert max(residuals(result)) < 1e-8


BENT = np.array([(x, 0.1 * x * (x - 4.0)) for x in np.linspace(0.0, 4.0, 9)])


def hollow(law):
    """A ball of radius 0.2 that slides down a bent line."""
    nodes = tuple(Marker2D(point=tuple(place)) for place in BENT)
    ball = PointMass2D(name="ball", mass=1.0, position=(0.12, 0.25), velocity=(0.5, 0.0))
    disk = Disk2D(marker=on("ball"), radius=0.2)
    line = DiskOnLine2D(name="c", line=Line2D(nodes=nodes, rounding=1.0), disk=disk, law=law)
    return Model(bodies=[ball], contacts=[line], gravity=(0.0, -G))


def test_force_goes_on_from_piece_to_piece():
    """Over the nodes of a bent line a force law's force does not jump at all."""
    result = simulate(hollow(KelvinVoigt(stiffness=1e4, damping=200.0)), 1.2, rtol=1e-8, max_step=1e-4)
    pressed = (result.t > 0.3) & (result["ball.x"] < 3.5)
    force = result["c.normal_force"][pressed]
    assert result["ball.x"][pressed].max() > 2.0
    assert np.abs(np.diff(force)).max() < 0.02 * force.max()


def test_constraint_force_jumps_with_the_curvature_alone():
    """N = m (g n_y + v^2 kappa) along the whole line, with kappa = k/(1 - r k) of the path of the disk's centre beside
    a line of curvature k: at the borders of the pieces it jumps by m v^2 d kappa."""
    result = simulate(hollow(NewtonImpact(restitution=0.0)), 1.2, rtol=1e-8)
    points, tangents = drawn(BENT, 1.0)
    length = np.linalg.norm(tangents, axis=-1)
    normals = np.stack([-tangents[..., 1], tangents[..., 0]], axis=-1) / length[..., None]
    bend = 400.0 * (tangents[:, 1:2] - tangents[:, :1])  # of a quadratic: constant
    curve = (tangents[..., 0] * bend[..., 1] - tangents[..., 1] * bend[..., 0]) / length**3
    path, centres = curve / (1.0 - 0.2 * curve), points + 0.2 * normals
    close = next(e.t for e in events(result, "close"))
    resting = result.t > close
    x, force = result["ball.x"][resting], result["c.normal_force"][resting]
    square = (result["ball.vx"] ** 2 + result["ball.vy"] ** 2)[resting]
    piece = np.searchsorted(centres[:, -1, 0], x)
    exact = [
        G * np.interp(place, centres[p, :, 0], normals[p, :, 1]) + v2 * np.interp(place, centres[p, :, 0], path[p])
        for place, v2, p in zip(x, square, piece, strict=True)
    ]
    assert np.abs(force - exact).max() < 1e-6 * force.max()
    jumps = path[1:, 0] - path[:-1, -1]
    assert len(set(piece)) >= 5 and np.abs(jumps[piece[0] : piece[-1]]).max() > 0.1  # the first: from straight to bent


# ---- the record -----------------------------------------------------------------------------------------------------


def test_json_round_trip():
    model = rope(SPRING, RUB)
    assert Model.from_json(model.to_json()) == model


@pytest.mark.parametrize(
    "change, text",
    [
        ({"half": 0.0, "radius": 0.0}, "both 0"),
        ({"nodes": (on("wheel"), on("a"))}, "carries a node"),
        ({"nodes": (on("a"),)}, "at least 2"),
        ({"nodes": (on("a"), on("a"), on("p"))}, "same place"),
        ({"nodes": (Marker2D(), Marker2D(point=(1.0, 0.0)), Marker2D(point=(0.0, 0.01)))}, "turns by"),
        ({"rounding": 0.0}, "greater than 0"),
        ({"friction": CoulombFriction(coefficient=0.3)}, "cannot be held"),
    ],
)
def test_lines_that_cannot_be_are_refused(change, text):
    given = {"nodes": NODES, "half": HALF, "radius": RADIUS, "rounding": 0.5, **change}
    with pytest.raises(ModelError, match=text):
        line = DiskOnLine2D(
            name="c", line=Line2D(nodes=given["nodes"], radius=given["half"], rounding=given["rounding"]),
            disk=Disk2D(marker=on("wheel"), radius=given["radius"]), law=NewtonImpact(restitution=0.0),
            friction=given.get("friction"),
        )  # fmt: skip
        Model(bodies=BODIES, contacts=[line]).assemble()


def test_body_on_a_slide_that_carries_nodes():
    """Nodes on a carriage: the line is a part of it, and momentum along the slide is kept in an impact."""
    carriage = RigidBody2D(name="cart", mass=3.0, inertia=1.0)
    ball = PointMass2D(name="ball", mass=1.0, position=(0.3, 0.8))
    slide = Prismatic2D(name="slide", a=Marker2D(), b=on("cart"))
    nodes = (on("cart", -1.0, 0.2), on("cart", 0.0, 0.0), on("cart", 1.0, 0.2))
    line = DiskOnLine2D(
        name="c", line=Line2D(nodes=nodes, rounding=1.0), disk=Disk2D(marker=on("ball"), radius=0.1),
        law=NewtonImpact(restitution=0.5),
    )  # fmt: skip
    model = Model(bodies=[carriage, ball], joints=[slide], contacts=[line], gravity=(0.0, -G))
    result = simulate(model, 1.0, rtol=1e-8, atol=1e-10)
    assert events(result, "impact")
    assert np.abs(3.0 * result["cart.vx"] + result["ball.vx"]).max() < 1e-7
    assert np.abs(result["energy.balance"]).max() < 1e-6
