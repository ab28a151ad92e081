"""Surfaces of smooth convex shapes, from their support functions."""

import math

import numpy as np

from ...core.contacts.support3d import SmoothShape3D
from ..scene import Floats
from .meshes import Mesh, grid_mesh

ROWS, ROUND = 25, 49
POLE = 1e-4
"""rad: the directions of a disk's faces themselves reach no one point."""


def smooth_mesh(shape: SmoothShape3D) -> Mesh:
    """The points that a shape reaches in directions all round; flat ends are closed."""
    places, normals = np.zeros((ROWS + 2, ROUND, 3)), np.zeros((ROWS + 2, ROUND, 3))
    for i, down in enumerate(np.linspace(POLE, math.pi - POLE, ROWS)):
        for j, turn in enumerate(np.linspace(0.0, 2.0 * math.pi, ROUND)):
            direction = (math.sin(down) * math.cos(turn), math.sin(down) * math.sin(turn), math.cos(down))
            places[i + 1, j], normals[i + 1, j] = shape.support(direction)[1:4], direction
    for end, beside in ((0, 1), (-1, -2)):
        places[end], normals[end] = places[beside, :-1].mean(axis=0), normals[beside]
    return grid_mesh(places, normals)


def lowest(shape: SmoothShape3D, axes: Floats, normal: Floats) -> Floats:
    """Places (F, 3) from the marker of the points that reach farthest against the normals (F, 3), the marker's axes
    being (F, 3, 3)."""
    local = -np.einsum("fij,fi->fj", axes, normal)
    return np.einsum("fij,fj->fi", axes, np.array([shape.support(tuple(d))[1:4] for d in local.tolist()]))
