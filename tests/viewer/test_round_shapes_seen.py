"""Round shapes and meshes in space are drawn as what they are."""

import math

import numpy as np
import pytest
from tlismni.core import (
    ContactGroup3D,
    Ellipsoid3D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnMesh3D,
    Torus3D,
    TriangleMesh3D,
)
from tlismni.viewer.build import scene_of_start
from tlismni.viewer.space.rounds import lowest, smooth_mesh

ON = Marker3D(body="b")


@pytest.mark.parametrize(
    "shape, volume",
    [
        (Ellipsoid3D(marker=ON, half_axes=(0.3, 0.4, 0.6)), 4.0 / 3.0 * math.pi * 0.3 * 0.4 * 0.6),
        # the hull of a torus: pi R^2 2 r, pi^2 r^2 R round its outside, and the ball's 4/3 pi r^3
        (
            Torus3D(marker=ON, radius=0.5, rim_radius=0.1),
            math.pi * 0.25 * 0.2 + math.pi**2 * 0.01 * 0.5 + 4.0 / 3.0 * math.pi * 0.001,
        ),
    ],
)
def test_the_surface_encloses_the_shape(shape, volume):
    mesh = smooth_mesh(shape)
    corners = mesh.vertices[mesh.triangles]
    found = np.linalg.det(corners).sum() / 6.0
    assert found == pytest.approx(volume, rel=0.02)
    assert found < volume  # the corners lie on it


def test_the_point_that_touches():
    shape = Ellipsoid3D(marker=ON, half_axes=(0.3, 0.4, 0.6))
    up = np.array([[0.0, 0.0, 1.0]])
    assert lowest(shape, np.eye(3)[None], up) == pytest.approx(np.array([[0.0, 0.0, -0.6]]))


CORNERS = tuple((x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5))
SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4))
HOLLOW = (
    *(t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))), (1, 5, 8), (5, 7, 8), (7, 3, 8), (3, 1, 8),
)  # fmt: skip
"""A cube whose upper side is sunk to its middle: a sixth of it is missing."""


@pytest.mark.parametrize("single", [True, False], ids=["a contact", "a group"])
@pytest.mark.parametrize("on", ["ground", "base"])
def test_a_hollow_mesh_is_seen_as_such(on, single):
    """Once, wherever it is, and not as its hull, whose hollow nothing could fall into."""
    mesh = TriangleMesh3D(marker=Marker3D(body=on), vertices=(*CORNERS, (0.0, 0.0, 0.0)), faces=HOLLOW)
    ball = Sphere3D(marker=Marker3D(body="ball"), radius=0.1)
    bodies = [RigidBody3D(name="ball", mass=1.0, inertia=(4e-3,) * 3, position=(0.0, 0.0, 1.0))]
    if on == "base":
        bodies.append(RigidBody3D(name="base", mass=9.0, inertia=(1.0, 1.0, 1.0)))
    law = NewtonImpact(restitution=0.5)
    if single:
        model = Model(bodies=bodies, contacts=[SphereOnMesh3D(name="c", mesh=mesh, sphere=ball, law=law)])
    else:
        model = Model(bodies=bodies, groups=[ContactGroup3D(name="g", spheres=[ball], meshes=[mesh], law=law)])
    scene = scene_of_start(model)
    frames = [frame.name for frame in scene.frames]
    volumes = [
        np.linalg.det(solid.mesh.vertices[solid.mesh.triangles]).sum() / 6.0
        for solid in scene.solids
        if frames[solid.frame] == on
    ]
    assert volumes == pytest.approx([5.0 / 6.0])
