"""Convex polyhedra and capsules in space, and groups of shapes there."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    Box3D,
    Capsule3D,
    ContactGroup3D,
    ConvexPolyhedron3D,
    CoulombFriction,
    Ellipsoid3D,
    HalfSpace3D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    contacts_between,
    simulate,
)

G = 9.81


def body(name="stone", height=0.5, **more):
    return RigidBody3D(name=name, mass=1.0, inertia=(0.01, 0.012, 0.015), position=(0.0, 0.0, height), **more)


def on_floor(shape, stone, t_end, restitution=0.0, **more):
    floor = contacts_between("floor", [HalfSpace3D()], [shape], law=NewtonImpact(restitution=restitution), **more)
    model = Model(bodies=[stone], contacts=floor, gravity=(0.0, 0.0, -G))
    return model, simulate(model, t_end, rtol=1e-9, atol=1e-11)


def test_points_within_the_hull_are_left_out():
    corners = Box3D(marker=Marker3D(body="stone"), size=(0.2, 0.3, 0.4)).places().tolist()
    hull = ConvexPolyhedron3D(marker=Marker3D(body="stone"), vertices=[*corners, (0.0, 0.0, 0.0), (0.05, 0.1, -0.1)])
    assert hull.places().tolist() == corners


def test_a_plate_and_a_rod_keep_all_their_points():
    plate = [(0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (-0.1, 0.0, 0.0)]
    assert len(ConvexPolyhedron3D(marker=Marker3D(body="stone"), vertices=plate).corners()) == 3
    assert len(ConvexPolyhedron3D(marker=Marker3D(body="stone"), vertices=plate[::2]).corners()) == 2


def test_a_polyhedron_of_a_boxes_corners_moves_as_the_box():
    stone = body(attitude=Axes(z=(0.3, 0.2, 1.0)), angular_velocity=(1.0, -0.5, 0.3))
    box = Box3D(marker=Marker3D(body="stone"), size=(0.3, 0.2, 0.1))
    hull = ConvexPolyhedron3D(marker=Marker3D(body="stone"), vertices=[tuple(x) for x in box.places().tolist()])
    runs = [on_floor(shape, stone, 0.6, restitution=0.3)[1] for shape in (box, hull)]
    assert [event.t for event in runs[0].events] == [event.t for event in runs[1].events]
    assert runs[0]["stone.z"][-1] == runs[1]["stone.z"][-1]


def test_a_rounded_tetrahedron_comes_to_rest_on_three_of_its_corners():
    side, radius = 0.2, 0.02
    base = [(side * math.cos(a), side * math.sin(a), -0.1) for a in (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)]
    hull = ConvexPolyhedron3D(marker=Marker3D(body="stone"), vertices=[*base, (0.0, 0.0, 0.3)], radius=radius)
    stone = body(height=0.2, attitude=Axes(z=(0.1, 0.05, 1.0)))
    _, result = on_floor(hull, stone, 3.0, friction=CoulombFriction(coefficient=0.5))
    assert result["stone.z"][-1] == pytest.approx(0.1 + radius, abs=1e-9)
    assert result["energy.kinetic"][-1] < 1e-12
    forces = sum(result[f"floor_ground_stone_{k}.normal_force"][-1] for k in range(1, 5))
    assert forces == pytest.approx(G, rel=1e-8)


def test_a_capsule_falls_upright_as_a_sphere_does_and_lies_at_its_radius():
    capsule = Capsule3D(marker=Marker3D(body="stone"), length=0.3, radius=0.05)
    model, result = on_floor(capsule, body(), 0.28, restitution=0.5)
    assert len(model.contacts) == 2
    assert result.events[0].t == pytest.approx(math.sqrt(2.0 * (0.5 - 0.15 - 0.05) / G), abs=1e-12)
    across = body(attitude=Axes(z=(1.0, 0.0, 0.02)))
    _, result = on_floor(capsule, across, 2.0, friction=CoulombFriction(coefficient=0.4))
    assert result["stone.z"][-1] == pytest.approx(0.05, abs=1e-9)


def test_a_group_in_space_makes_its_contacts_and_comes_back_from_a_file(tmp_path):
    law = NewtonImpact(restitution=0.2)
    bodies = [body("a", 0.2), body("b", 0.5), body("c", 0.3).model_copy(update={"position": (1.0, 0.0, 0.3)})]
    group = ContactGroup3D(
        name="heap", spheres=[Sphere3D(marker=Marker3D(body=name), radius=0.1) for name in "ab"],
        boxes=[Box3D(marker=Marker3D(body="c"), size=(0.1, 0.1, 0.1))], half_spaces=[HalfSpace3D()], law=law,
        except_bodies=[("a", "c"), ("b", "c")],
    )  # fmt: skip
    model = Model(bodies=bodies, groups=[group], gravity=(0.0, 0.0, -G))
    assert len(model.contacts) == 1 + 2 + 8
    model.save(tmp_path / "heap.json")
    assert Model.load(tmp_path / "heap.json") == model
    changed = model.with_parameters({"heap.law.restitution": 0.6})
    assert {contact.law.restitution for contact in changed.contacts} == {0.6}
    result = simulate(model, 0.5)
    assert min(result[f"{contact.name}.gap"].min() for contact in model.contacts) > -1e-9
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.all(np.diff(total) < 1e-6 * total[0])


def test_what_cannot_be_is_refused():
    with pytest.raises(ModelError, match=r"1 vertices are no polyhedron"):
        ConvexPolyhedron3D(marker=Marker3D(body="stone"), vertices=[(0.0, 0.0, 0.0)])
    with pytest.raises(ModelError, match=r"vertex \(1.0, 0.0, 0.0\) is given twice"):
        ConvexPolyhedron3D(marker=Marker3D(body="stone"), vertices=[(1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)])
    box = Box3D(marker=Marker3D(body="stone"), size=(0.3, 0.2, 0.1))
    egg = Ellipsoid3D(marker=Marker3D(body="other"), half_axes=(1.0, 1.0, 1.0))
    with pytest.raises(ModelError, match=r"Box3D on 'stone' and an Ellipsoid3D on 'other' have no contact"):
        contacts_between("g", [box], [egg], law=NewtonImpact(restitution=0.0))
    with pytest.raises(ModelError, match="radius"):
        Capsule3D(marker=Marker3D(body="stone"), length=0.3, radius=0.0)
