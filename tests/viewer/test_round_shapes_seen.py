"""Round shapes in space are drawn as what they are."""

import math

import numpy as np
import pytest
from tlismni.core import Ellipsoid3D, Marker3D, Torus3D
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
