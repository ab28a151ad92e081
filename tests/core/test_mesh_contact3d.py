"""A sphere on a mesh of triangles: as on half-space and box, over edges, in hollows; its parts; what is refused."""

import math

import numpy as np
import pytest
from contact_points import check_tangent
from helpers import events
from test_contact_tangents3d import GRIP, HARD, HUNT, PEAK
from test_mesh_shapes import cube
from test_tangents import Point, check_levels, check_matrix, draw
from tlismni.core import (
    ContactGroup3D,
    CoulombFriction,
    HalfSpace3D,
    KelvinVoigt,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnHalfSpace3D,
    SphereOnMesh3D,
    TanhFriction,
    TriangleMesh3D,
    TurningFriction,
    contacts_between,
    mesh_parts,
    simulate,
)
from tlismni.core.state.modes import ACTIVE, CLOSED, STICKS

DOWN = (0.0, 0.0, -9.81)
BALL = Sphere3D(marker=Marker3D(body="ball"), radius=0.1)


def plate(size=2.0, fields=3, thick=0.2, bump=None):
    """A plate whose upper side, at z = 0, is of fields x fields squares of two triangles; bump(x, y) lifts it."""
    n, points, faces = fields + 1, [], []
    for z in (0.0, -thick):
        for i in range(n):
            for j in range(n):
                x, y = size * (i / fields - 0.5), size * (j / fields - 0.5)
                points.append((x, y, z + (bump(x, y) if bump and z == 0.0 else 0.0)))
    for top in (True, False):
        base = 0 if top else n * n
        for i in range(fields):
            for j in range(fields):
                a, b, c, d = (base + k for k in (i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1))
                faces += [(a, b, c), (a, c, d)] if top else [(a, c, b), (a, d, c)]
    rim = [i * n for i in range(n)] + [fields * n + j for j in range(1, n)]
    rim += [i * n + fields for i in range(fields - 1, -1, -1)] + list(range(fields - 1, 0, -1))
    for a, b in zip(rim, rim[1:] + rim[:1], strict=True):
        faces += [(a, n * n + a, n * n + b), (a, n * n + b, b)]
    return TriangleMesh3D(marker=Marker3D(), vertices=points, faces=faces)


def ball(**more):
    return RigidBody3D(name="ball", **{"mass": 1.0, "inertia": (4e-3,) * 3, "position": (0.0, 0.0, 0.1)} | more)


def on_mesh(mesh, law, friction=None, **more):
    group = ContactGroup3D(name="g", spheres=[BALL], meshes=[mesh], law=law, friction=friction)
    return Model(gravity=DOWN, bodies=[ball(**more)], groups=[group])


def on_floor(law, friction=None, **more):
    contact = SphereOnHalfSpace3D(name="g", plane=HalfSpace3D(), sphere=BALL, law=law, friction=friction)
    return Model(gravity=DOWN, bodies=[ball(**more)], contacts=[contact])


def test_parts_of_convex_and_hollow_meshes():
    points, faces = cube()
    assert mesh_parts(TriangleMesh3D(marker=Marker3D(), vertices=points, faces=faces)) == (tuple(range(12)),)
    assert len(mesh_parts(plate())) == 1
    hollow = plate(fields=4, thick=1.0, bump=lambda x, y: 0.3 * (x * x + y * y))
    parts = mesh_parts(hollow)
    assert sorted(f for part in parts for f in part) == list(range(len(hollow.faces)))
    # of each part no corner stands before the plane of a triangle
    points = np.array(hollow.vertices)
    for part in parts:
        corners = points[sorted({k for f in part for k in hollow.faces[f]})]
        for f in part:
            a, b, c = points[list(hollow.faces[f])]
            assert ((corners - a) @ np.cross(b - a, c - a)).max() < 1e-9


@pytest.mark.parametrize(
    "law, friction",
    [
        (NewtonImpact(restitution=0.6), CoulombFriction(coefficient=0.2)),
        (KelvinVoigt(stiffness=2e4, damping=20.0), TanhFriction(coefficient=0.2, transition_speed=0.01)),
    ],
    ids=["constraint", "force"],
)
def test_on_a_flat_plate_as_on_the_half_space(law, friction):
    """It bounces, slides and rolls over seams of triangles."""
    start = {"position": (-0.5, -0.41, 0.15), "velocity": (2.0, 1.3, 0.0), "angular_velocity": (3.0, 0.0, 1.0)}
    mesh, floor = (simulate(m, 0.5, rtol=1e-8) for m in (on_mesh(plate(), law, friction, **start),
                                                         on_floor(law, friction, **start)))  # fmt: skip
    for channel in ("x", "y", "z", "vx", "vy", "angular_velocity_x", "angular_velocity_z"):
        assert mesh[f"ball.{channel}"][-1] == pytest.approx(floor[f"ball.{channel}"][-1], abs=2e-7)
    assert [e.kind for e in mesh.events] == [e.kind for e in floor.events]


def test_a_ball_rolls_over_the_edge_of_a_box():
    """On the edge it turns about it: without slip and loss, energy and the distance from the edge stay."""
    points, faces = cube()
    box = TriangleMesh3D(marker=Marker3D(), vertices=points, faces=faces)
    top, side = 0.05, 0.15
    start = {
        "position": (side - 0.01, 0.0, top + 0.1), "velocity": (0.3, 0.0, 0.0), "angular_velocity": (0.0, 3.0, 0.0)
    }  # fmt: skip
    model = on_mesh(box, NewtonImpact(restitution=0.0), CoulombFriction(coefficient=2.0), **start)
    result = simulate(model, 0.15, rtol=1e-8)
    x, z = result["ball.x"], result["ball.z"]
    on_edge = (x > side + 1e-3) & (result["g_ball_ground.in_contact"] > 0.5)
    assert on_edge.sum() > 5
    assert np.hypot(x - side, z - top)[on_edge] == pytest.approx(0.1, abs=1e-8)
    energy = result["energy.kinetic"] + 9.81 * z
    assert np.abs(energy - energy[0])[on_edge].max() < 1e-5
    # seen about the edge it turns as a ball that rolls: 7/5 m R^2 w^2/2 = m g R (1 - cos)
    speed = np.hypot(result["ball.vx"], result["ball.vz"])[on_edge]
    fall = top + 0.1 - z[on_edge]
    assert speed**2 == pytest.approx(0.3**2 + 10.0 / 7.0 * 9.81 * fall, rel=1e-4)


def in_hollow(law, friction):
    """A ball that falls into a pyramid upside down, of six triangles; its rolling ends by a small arm."""
    hollow = plate(size=2.0, fields=2, thick=1.0, bump=lambda x, y: -0.5 if x == y == 0.0 else 0.0)
    group = ContactGroup3D(
        name="g", spheres=[BALL], meshes=[hollow], law=law, friction=friction,
        turning=TurningFriction(rolling=5e-3, spinning=2e-3),
    )  # fmt: skip
    return Model(gravity=DOWN, bodies=[ball(position=(0.02, 0.03, -0.2))], groups=[group])


def test_it_rests_in_a_hollow_on_two_triangles():
    """Two steep ones face each other, whose normals are 1/sqrt(1.5) upwards: they share its weight."""
    model = in_hollow(KelvinVoigt(stiffness=2e4, damping=200.0), TanhFriction(coefficient=0.5, transition_speed=0.01))
    result = simulate(model, 3.0, rtol=1e-6)
    forces = sorted(result[f"{c.name}.normal_force"][-1] for c in model.contacts)
    assert len(forces) == 6 and forces[:4] == [0.0] * 4
    assert forces[4:] == pytest.approx([0.5 * 9.81 * np.sqrt(1.5)] * 2, rel=1e-4)
    assert result["energy.kinetic"][-1] < 1e-12
    assert np.abs(result["energy.balance"]).max() < 1e-5


def test_it_comes_to_rest_in_a_hollow_as_constraints():
    model = in_hollow(NewtonImpact(restitution=0.2), CoulombFriction(coefficient=0.5))
    result = simulate(model, 3.0, rtol=1e-6)
    assert result["energy.kinetic"][-1] < 1e-12
    assert np.abs(result["energy.balance"]).max() < 1e-6
    gaps = np.array([result[f"{c.name}.gap"] for c in model.contacts])
    assert gaps.min() > -1e-9
    assert sum(result[f"{c.name}.in_contact"][-1] > 0.5 for c in model.contacts) >= 2
    assert events(result, "impact") and events(result, "rest")


TILT = Marker3D(body="box", point=(0.1, -0.1, 0.05), attitude=RotationVector(vector=(0.2, -0.3, 0.4)))
WHERE = {"a face": (0.1, 0.0, 0.4), "an edge": (0.55, 0.0, 0.45), "a corner": (0.55, 0.55, 0.5)}


def falling(where, law, friction=None):
    points, faces = cube()
    mesh = TriangleMesh3D(marker=TILT, vertices=(2.5 * np.array(points)).tolist(), faces=faces)
    sphere = Sphere3D(marker=Marker3D(body="ball", point=(0.05, 0.0, 0.02)), radius=0.6)
    bodies = [RigidBody3D(name="box", mass=1.3, inertia=(0.4, 0.5, 0.7)), ball(position=WHERE[where], mass=0.7)]
    contact = SphereOnMesh3D(name="c", mesh=mesh, sphere=sphere, law=law, friction=friction)
    return Model(bodies=bodies, contacts=[contact])


def states(point):
    for seed in range(3):
        state = draw(point, seed)
        state[1] = point.workspace.assembly.q0 + 0.1 * (state[1] - point.workspace.assembly.q0)
        yield state


@pytest.mark.parametrize("where", WHERE)
def test_tangents_and_levels(where):
    point = Point(falling(where, HARD), CLOSED)
    for state in states(point):
        check_matrix(point, state, h=1e-3)
        check_levels(point, state, 1e-3)


@pytest.mark.parametrize("where", WHERE)
def test_tangents_of_friction(where):
    rubbing, sticking = Point(falling(where, HUNT, PEAK), ACTIVE), Point(falling(where, HARD, GRIP))
    sticking.workspace.engage(frozenset({0}), frozenset(), frozenset({0, 1}))
    sticking.remember(("mode", "slide_mode", "tangent_angle", "tangent_axis"), (CLOSED, STICKS, 0.7, 2))
    for point in (rubbing, sticking):
        for state in states(point):
            check_tangent(point, state)


def test_what_cannot_touch_is_refused():
    points, faces = cube()
    mesh, law = TriangleMesh3D(marker=Marker3D(), vertices=points, faces=faces), NewtonImpact(restitution=0.5)
    with pytest.raises(ModelError, match="no normal"):
        SphereOnMesh3D(name="c", mesh=mesh, sphere=Sphere3D(marker=Marker3D(body="ball")), law=law)
    with pytest.raises(ModelError, match="numbered from 0"):
        SphereOnMesh3D(name="c", mesh=mesh, sphere=BALL, part=1, law=law)
    made = contacts_between("g", [BALL], [mesh], law=law)
    assert len(made) == 1 and isinstance(made[0], SphereOnMesh3D)
    assert math.isclose(made[0].extent(), 0.1)
    model = Model(gravity=DOWN, bodies=[ball()], contacts=made)
    assert Model.model_validate_json(model.model_dump_json()) == model


def from_triangle(y, a, b, c):
    """Distance of y from a triangle, by its plane and its edges."""
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n)
    foot = y - n * (n @ (y - a))
    edges = ((a, b), (b, c), (c, a))
    if all(np.cross(q - p, foot - p) @ n >= 0.0 for p, q in edges):
        return abs(n @ (y - a))
    ends = [p + np.clip((y - p) @ (q - p) / ((q - p) @ (q - p)), 0.0, 1.0) * (q - p) for p, q in edges]
    return min(np.linalg.norm(y - end) for end in ends)


def hilly(x, y):
    return 0.25 * math.sin(3.0 * x) * math.cos(2.0 * y)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("bump", [None, hilly], ids=["flat", "hilly"])
def test_the_least_gap_is_the_distance_from_the_surface(bump):
    """Over, beside and under a plate with hills and hollows, of which each convex part is a contact."""
    mesh = plate(fields=4, thick=0.6, bump=bump)
    model = on_mesh(mesh, HARD)
    point, corners = Point(model), np.array(mesh.vertices)[np.array(mesh.faces)]
    rows = [contact.row for contact in point.workspace.assembly.contacts]
    q, none, rng = point.workspace.assembly.q0.copy(), np.zeros(point.n), np.random.default_rng(0)
    for place in rng.uniform((-1.4, -1.4, -0.9), (1.4, 1.4, 0.7), (300, 3)):
        if abs(place[0]) < 1.0 and abs(place[1]) < 1.0 and -0.6 < place[2] < 0.25:
            continue  # perhaps within
        q[:3] = place
        gaps = point.at(0.0, q, none, none, np.zeros(point.m))[1][rows]
        distance = min(from_triangle(place, *triangle) for triangle in corners)
        assert gaps.min() == pytest.approx(distance - 0.1, abs=1e-12)
