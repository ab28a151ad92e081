"""Meshes of triangles: read from files, checked, with their mass and inertia; they touch half-spaces."""

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    Box3D,
    ContactGroup3D,
    HalfSpace3D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    TriangleMesh3D,
    contacts_between,
    read_mesh,
    simulate,
)

ON = Marker3D(body="b")
SIZE = (0.3, 0.2, 0.1)


def cube(size=SIZE):
    """A box's corners and triangles: each face as two."""
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    points = [tuple(a * b for a, b in zip(corner, size, strict=True)) for corner in corners]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def test_mass_and_inertia_are_those_of_the_box():
    points, faces = cube()
    # as seen from a corner, and elsewhere: the centre is found, and the inertia about it stays
    moved = [(x + 1.0, y - 2.0, z + 0.5) for x, y, z in points]
    mass, centre, inertia = TriangleMesh3D(marker=ON, vertices=moved, faces=faces).solid(500.0)
    a, b, c = SIZE
    assert mass == pytest.approx(500.0 * a * b * c, rel=1e-13)
    assert centre == pytest.approx([1.0, -2.0, 0.5], rel=1e-12)
    box = mass / 12.0 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    assert inertia == pytest.approx(np.diag(box), abs=1e-12)


def test_a_mesh_of_a_box_makes_the_contacts_of_the_box():
    points, faces = cube()
    mesh, box = TriangleMesh3D(marker=ON, vertices=points, faces=faces), Box3D(marker=ON, size=SIZE)
    assert sorted(mesh.places().tolist()) == sorted(box.places().tolist())
    law = NewtonImpact(restitution=0.3)
    made = contacts_between("floor", [HalfSpace3D()], [mesh], law=law)
    assert len(made) == 8
    stone = RigidBody3D(
        name="b", mass=1.0, inertia=(0.01, 0.012, 0.015), position=(0.0, 0.0, 0.3), attitude=Axes(z=(0.3, 0.2, 1.0))
    )
    group = ContactGroup3D(name="floor", meshes=[mesh], half_spaces=[HalfSpace3D()], law=law)
    model = Model(bodies=[stone], groups=[group], gravity=(0.0, 0.0, -9.81))
    flat = Model(
        bodies=[stone], contacts=contacts_between("floor", [HalfSpace3D()], [box], law=law), gravity=(0.0, 0.0, -9.81)
    )
    one, other = (simulate(m, 0.4, rtol=1e-9, atol=1e-11) for m in (model, flat))
    assert one["b.z"][-1] == pytest.approx(other["b.z"][-1], abs=1e-9)
    assert Model.model_validate_json(model.model_dump_json()) == model


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_a_file_is_read(tmp_path, suffix):
    trimesh = pytest.importorskip("trimesh")
    points, faces = cube()
    file = tmp_path / f"box.{suffix}"
    trimesh.Trimesh(np.array(points) * 1000.0, faces).export(file)
    mesh = read_mesh(file, ON, scale=1e-3)
    assert len(mesh.vertices) == 8 and len(mesh.faces) == 12
    assert mesh.volume() == pytest.approx(0.006, rel=1e-6)  # STL carries single precision


def test_what_is_no_body_is_refused(tmp_path):
    points, faces = cube()

    def mesh(faces, points=points):
        return TriangleMesh3D(marker=ON, vertices=points, faces=faces)

    with pytest.raises(ModelError, match="the mesh has holes: 3 edges"):
        mesh(faces[1:])
    with pytest.raises(ModelError, match=r"normals of the mesh point inwards .*-0.006"):
        mesh([(a, c, b) for a, b, c in faces])
    a, b, c = faces[3]
    with pytest.raises(ModelError, match="the normal of one of them is inverted"):
        mesh([*faces[:3], (a, c, b), *faces[4:]])
    with pytest.raises(ModelError, match="has no area"):
        mesh([*faces, (0, 1, 1)])
    with pytest.raises(ModelError, match="names vertex 8"):
        mesh([*faces[:-1], (0, 1, 8)])
    with pytest.raises(ModelError, match="enclose nothing"):
        mesh(faces[:3])
    pytest.importorskip("trimesh")
    (tmp_path / "bad.stl").write_text("no mesh")
    with pytest.raises(ModelError, match=r"cannot be read|no triangles"):
        read_mesh(tmp_path / "bad.stl", ON)
