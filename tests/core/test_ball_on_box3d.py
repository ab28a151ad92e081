"""Spheres on boxes and convex polyhedra, sharp and rounded; shapes that are said to pass through each other."""

import numpy as np
import pytest
from contact_points import check_in_space
from test_contact_tangents3d import GRIP, HARD, HUNT, PEAK
from test_mesh_contact3d import TILT, WHERE, states
from test_tangents import Point
from tlismni.core import (
    Box2D,
    Box3D,
    Capsule3D,
    ContactGroup2D,
    ContactGroup3D,
    ConvexPolyhedron3D,
    CoulombFriction,
    Cylinder3D,
    Ellipsoid3D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    RotationVector,
    Segment2D,
    Sphere3D,
    SphereOnMesh3D,
    contacts_between,
    simulate,
)

SIZE = (0.6, 0.5, 0.4)
R = 0.1
BALL = Sphere3D(marker=Marker3D(body="ball"), radius=R)
HALF = 0.5 * np.array(SIZE)


def shape(kind, marker=None, rounding=0.04):
    """The same box, from outside: by its size, by its corners, and with round edges."""
    on = Marker3D() if marker is None else marker
    box = Box3D(marker=on, size=SIZE)
    if kind == "box":
        return box
    less = 0.0 if kind == "hull" else rounding
    corners = (box.places() - less * np.sign(box.places())).tolist()
    return ConvexPolyhedron3D(marker=on, vertices=[tuple(corner) for corner in corners], radius=less)


def body(name="ball", **more):
    return RigidBody3D(name=name, **{"mass": 1.0, "inertia": (4e-3,) * 3} | more)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("kind", ["box", "hull", "round"])
def test_on_each_face_as_on_a_half_space(kind, axis, side):
    """It bounces, slides and rolls."""
    normal, along = side * np.eye(3)[axis], np.roll(np.eye(3)[axis], 1)
    start = {
        "position": tuple((HALF[axis] + 0.15) * normal - 0.1 * along), "velocity": tuple(0.5 * along),
        "angular_velocity": tuple(2.0 * along + normal),
    }  # fmt: skip
    law, friction = NewtonImpact(restitution=0.5), CoulombFriction(coefficient=0.3)
    plane = HalfSpace3D(marker=Marker3D().model_copy(update={
        "point": tuple(HALF[axis] * normal),
        "attitude": RotationVector(vector=(0.0, 0.0, 0.0)) if axis == 2 and side > 0.0 else _turned(normal),
    }))  # fmt: skip
    ends = []
    for ground in (shape(kind), plane):
        contacts = contacts_between("g", [BALL], [ground], law=law, friction=friction)
        assert len(contacts) == 1
        result = simulate(
            Model(gravity=tuple(-9.81 * normal), bodies=[body(**start)], contacts=contacts), 0.4, rtol=1e-8
        )
        ends.append([result[f"ball.{name}"][-1] for name in ("x", "y", "z", "vx", "vy", "vz", "angular_velocity_x")])
        assert np.abs(result["energy.balance"]).max() < 1e-7
    assert ends[0] == pytest.approx(ends[1], abs=2e-7)


def _turned(normal):
    x, y, z = normal
    return (
        RotationVector(vector=(np.pi, 0.0, 0.0))
        if z
        else RotationVector(vector=tuple(np.pi / 2 * np.array((-y, x, 0))))
    )


@pytest.mark.parametrize("kind", ["box", "hull", "round"])
def test_the_gap_is_the_distance(kind):
    """Of a box |max(|x| - half, 0)|, in a frame that is moved."""
    on = Marker3D(point=(0.3, -0.2, 0.5), attitude=RotationVector(vector=(0.4, -0.7, 0.2)))
    contacts = contacts_between("g", [BALL], [shape(kind, on)], law=HARD)
    point = Point(Model(bodies=[body()], contacts=contacts))
    row, q, none = point.workspace.assembly.contacts[0].row, point.workspace.assembly.q0.copy(), np.zeros(point.n)
    core, less = HALF - (0.04 if kind == "round" else 0.0), 0.04 if kind == "round" else 0.0
    rng = np.random.default_rng(0)
    for place in rng.uniform(-0.8, 0.8, (200, 3)):
        out = np.maximum(np.abs(place) - core, 0.0)
        if not out.any():
            continue
        q[:3] = np.array(on.point) + on.axes() @ place
        gap = point.at(0.0, q, none, none, np.zeros(point.m))[1][row]
        assert gap == pytest.approx(np.linalg.norm(out) - less - R, abs=1e-12)


def falling(where, law, friction=None):
    """A box with round edges and a ball near one of its faces, edges or corners, both free."""
    size = 2.5 * np.array((0.3, 0.2, 0.1))
    corners = [tuple(x) for x in (Box3D(marker=TILT, size=tuple(size)).places()).tolist()]
    hull = ConvexPolyhedron3D(marker=TILT, vertices=corners, radius=0.07)
    sphere = Sphere3D(marker=Marker3D(body="ball", point=(0.05, 0.0, 0.02)), radius=0.53)
    bodies = [RigidBody3D(name="box", mass=1.3, inertia=(0.4, 0.5, 0.7)), body(position=WHERE[where], mass=0.7)]
    return Model(bodies=bodies, contacts=contacts_between("c", [hull], [sphere], law=law, friction=friction))


@pytest.mark.parametrize("where", WHERE)
def test_tangents_and_levels_with_round_edges(where):
    check_in_space(falling(where, HARD), falling(where, HUNT, PEAK), falling(where, HARD, GRIP), states)


def test_a_free_box_is_hit_at_a_corner_without_loss():
    """Momentum, angular momentum and energy stay."""
    box = shape("box", Marker3D(body="box"))
    bodies = [
        RigidBody3D(name="box", mass=2.0, inertia=(0.07, 0.09, 0.1), attitude=RotationVector(vector=(0.3, 0.2, -0.4))),
        body(position=(0.5, 0.42, 0.44), velocity=(-1.0, -0.8, -0.9)),
    ]
    model = Model(
        gravity=(0, 0, 0),
        bodies=bodies,
        contacts=contacts_between("g", [box], [BALL], law=NewtonImpact(restitution=1.0)),
    )
    result = simulate(model, 0.6, rtol=1e-9)
    (hit,) = [event for event in result.events if event.kind == "impact"]
    assert hit.impulse > 0.1 and abs(hit.energy_loss) < 1e-9
    kinetic = result["energy.kinetic"]
    assert np.abs(kinetic - kinetic[0]).max() < 1e-7
    for axis in "xyz":
        momentum = 2.0 * result[f"box.v{axis}"] + result[f"ball.v{axis}"]
        assert np.abs(momentum - momentum[0]).max() < 1e-9


def test_a_group_of_balls_a_box_and_a_floor(tmp_path):
    """The ball lies on the box, the box on the floor."""
    bodies = [
        RigidBody3D(name="box", mass=2.0, inertia=(0.07, 0.09, 0.1), position=(0.0, 0.0, HALF[2])),
        body(position=(0.05, 0.02, 0.6)),
    ]
    group = ContactGroup3D(
        name="g", spheres=[BALL], boxes=[shape("box", Marker3D(body="box"))], half_spaces=[HalfSpace3D()],
        law=NewtonImpact(restitution=0.2, rest_ratio=1e-3), friction=CoulombFriction(coefficient=0.4),
    )  # fmt: skip
    model = Model(gravity=(0.0, 0.0, -9.81), bodies=bodies, groups=[group])
    assert len(model.contacts) == 1 + 8 + 1
    model.save(tmp_path / "m.json")
    assert Model.load(tmp_path / "m.json") == model
    plain = Model(bodies=bodies, contacts=model.contacts)
    assert Model.model_validate_json(plain.model_dump_json()) == plain
    assert any(isinstance(contact, SphereOnMesh3D) for contact in plain.contacts)
    result = simulate(model, 1.0)
    assert result["ball.z"][-1] == pytest.approx(2.0 * HALF[2] + R, abs=1e-9)
    assert result["energy.kinetic"][-1] < 1e-12


# ---- what has no contact --------------------------------------------------------------------------------------------


def test_pairs_without_contact_pass_through_each_other_where_that_is_said(tmp_path):
    bodies = [
        RigidBody3D(name=name, mass=1.0, inertia=(0.01,) * 3, position=(0.0, 0.0, 1.0)) for name in ("egg", "pill")
    ]
    shapes = {
        "smooth": [Ellipsoid3D(marker=Marker3D(body="egg"), half_axes=(0.1, 0.2, 0.3))],
        "capsules": [Capsule3D(marker=Marker3D(body="pill"), length=0.2, radius=0.1)],
        "half_spaces": [HalfSpace3D()],
    }
    with pytest.raises(ModelError, match=r'have no contact.*pass_through=\[\("Capsule3D", "Ellipsoid3D"\)\]'):
        Model(bodies=bodies, groups=[ContactGroup3D(name="g", law=HARD, **shapes)])
    group = ContactGroup3D(name="g", law=HARD, pass_through=[("Ellipsoid3D", "Capsule3D")], **shapes)
    model = Model(bodies=bodies, groups=[group])
    assert len(model.contacts) == 3
    model.save(tmp_path / "m.json")
    assert Model.load(tmp_path / "m.json") == model
    with pytest.raises(ModelError, match=r"'Cylinder3D' pass through others, but has no such shape: it has Capsule3D"):
        Model(bodies=bodies, groups=[group.model_copy(update={"pass_through": (("Cylinder3D", "Capsule3D"),)})])
    flat = ContactGroup2D(
        name="g", law=HARD, boxes=[Box2D(marker=Marker2D(body="b"), width=1.0, height=1.0)],
        half_planes=[HalfPlane2D()], segments=[Segment2D(marker=Marker2D(), length=1.0)],
    )  # fmt: skip
    with pytest.raises(ModelError, match="thin box, or let them pass"):
        flat.contacts()
    assert len(flat.model_copy(update={"pass_through": (("Box2D", "Segment2D"),)}).contacts()) == 4


def test_a_plate_without_thickness_and_boxes_on_cylinders_are_refused():
    plate = ConvexPolyhedron3D(marker=Marker3D(), vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    with pytest.raises(ModelError, match="lie in one plane"):
        contacts_between("g", [plate], [BALL], law=HARD)
    with pytest.raises(ModelError, match="Box3D on 'ground' and a Cylinder3D on 'b' have no contact"):
        contacts_between("g", [shape("box")], [Cylinder3D(marker=Marker3D(body="b"), radius=1.0, length=1.0)], law=HARD)
