"""Surfaces that solids are made of: of size 1 about the origin, along z, to be stretched; equal ones are made once."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ...core.contacts.mesh_parts import normals_of

Floats = NDArray[np.float64]
AROUND = 24
"""Sides of what is round."""
TURNS, WIRE = 9, 0.16
"""Of a coil: its turns, and the radius of its wire in parts of its own."""
DARK = 0.80
"""Of the darker fields of what turns without being seen to turn."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles. V vertices, T triangles."""

    vertices: Floats
    """(V, 3)."""
    normals: Floats
    """(V, 3), unit."""
    triangles: NDArray[np.int64]
    """(T, 3), counter-clockwise seen from outside."""
    shades: Floats | None = field(default=None)
    """(V,): by how much a vertex is darker than the solid's colour; None: nowhere."""


def grid_mesh(places: Floats, normals: Floats, shades: Floats | None = None) -> Mesh:
    """A surface from a grid of places (N, M, 3); with `shades` (N-1, M-1), every field has corners of its own."""
    n, m = places.shape[:2]
    k = np.arange(n * m).reshape(n, m)
    quads = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    vertices, normal = places.reshape(-1, 3), normals.reshape(-1, 3)
    if shades is not None:
        vertices, normal = vertices[quads.ravel()], normal[quads.ravel()]
        quads = np.arange(quads.size).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    corners = vertices[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return Mesh(vertices, normal, triangles[area > 1e-14], None if shades is None else np.repeat(shades.ravel(), 4))


def joined(*meshes: Mesh) -> Mesh:
    """Several surfaces as one."""
    shift = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    shaded = any(mesh.shades is not None for mesh in meshes)
    shades = [np.ones(len(mesh.vertices)) if mesh.shades is None else mesh.shades for mesh in meshes]
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.triangles + by for mesh, by in zip(meshes, shift.tolist(), strict=True)]),
        np.concatenate(shades) if shaded else None,
    )


@cache
def ball() -> Mesh:
    """Radius 1, its eighths in two shades, so that it is seen to turn."""
    up, around = np.meshgrid(
        np.linspace(math.pi, 0.0, AROUND // 2 + 1), np.linspace(0.0, 2.0 * math.pi, AROUND + 1), indexing="ij"
    )
    places = np.stack([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), np.cos(up)], axis=-1)
    row, column = np.meshgrid(np.arange(AROUND // 2), np.arange(AROUND), indexing="ij")
    dark = (row * 4 // AROUND + column * 4 // AROUND) % 2 == 0
    return _outward(grid_mesh(places, places, np.where(dark, DARK, 1.0)))


@cache
def cylinder(marked: bool = False) -> Mesh:
    """Radius 1, z from -0.5 to 0.5; `marked`: with quarters in two shades."""
    angle = np.linspace(0.0, 2.0 * math.pi, AROUND + 1)
    ring = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    shift = np.array([0.0, 0.0, 0.5])
    quarter = np.where(np.arange(AROUND) * 4 // AROUND % 2 == 0, DARK, 1.0)[None] if marked else None
    side = grid_mesh(np.stack([ring - shift, ring + shift]), np.stack([ring, ring]), quarter)
    caps = []
    for sign in (1.0, -1.0):
        middle, normal = np.tile(sign * shift, (AROUND + 1, 1)), np.tile([0.0, 0.0, sign], (AROUND + 1, 1))
        caps.append(grid_mesh(np.stack([middle, ring + sign * shift]), np.stack([normal, normal]), quarter))
    return _outward(joined(side, *caps))


@cache
def box() -> Mesh:
    """Edges of length 1."""
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    return hull(tuple(corners))


@cache
def hull(points: tuple[tuple[float, float, float], ...]) -> Mesh:
    """The convex hull of points, with flat faces."""
    from scipy.spatial import ConvexHull  # scipy takes long to import

    found = ConvexHull(np.array(points))
    vertices = found.points[found.simplices].reshape(-1, 3)
    normals = np.repeat(found.equations[:, :3], 3, axis=0)
    return _outward(Mesh(vertices, normals, np.arange(len(vertices)).reshape(-1, 3)))


@cache
def surface(points: tuple[tuple[float, float, float], ...], faces: tuple[tuple[int, int, int], ...]) -> Mesh:
    """A closed surface of triangles as it is, hollows too, with flat faces."""
    places, triangles = np.array(points), np.array(faces)
    normals = np.repeat(normals_of(places, triangles), 3, axis=0)
    return Mesh(places[triangles].reshape(-1, 3), normals, np.arange(3 * len(triangles)).reshape(-1, 3))


@cache
def coil() -> Mesh:
    """A helical spring: radius 1, z from 0 to 1, with straight ends on its axis."""
    angle = np.linspace(0.0, 2.0 * math.pi * TURNS, TURNS * 14 + 1)
    height = np.linspace(0.12, 0.88, len(angle))
    grow = np.minimum(1.0, np.minimum(angle, angle[::-1]) / math.pi)
    line = np.stack([grow * np.cos(angle), grow * np.sin(angle), height], axis=1)
    return tube(np.concatenate([[[0.0, 0.0, 0.0]], line, [[0.0, 0.0, 1.0]]]), (WIRE, WIRE, 0.03))


def tube(line: Floats, radius: Sequence[float], sides: int = 6) -> Mesh:
    """A wire along a line (N, 3); `radius` along x, y and z."""
    angle = np.linspace(0.0, 2.0 * math.pi, sides + 1)
    ahead = np.gradient(line, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    out = np.where(np.abs(ahead[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(ahead, out)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(ahead, first)
    normals = np.cos(angle)[None, :, None] * first[:, None] + np.sin(angle)[None, :, None] * second[:, None]
    return _outward(grid_mesh(line[:, None] + np.array(radius) * normals, normals))


def checkered(cells_x: int, cells_y: int) -> Mesh:
    """A plate from -0.5 to 0.5 in x and y, at z = 0, seen from above, in fields of two shades."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, cells_x + 1), np.linspace(-0.5, 0.5, cells_y + 1), indexing="ij")
    places, normals = np.stack([x, y, 0.0 * x], axis=-1), np.zeros((cells_x + 1, cells_y + 1, 3))
    normals[..., 2] = 1.0
    i, j = np.meshgrid(np.arange(cells_x), np.arange(cells_y), indexing="ij")
    return _outward(grid_mesh(places, normals, np.where((i + j) % 2 == 0, 0.93, 1.0)))


def _outward(mesh: Mesh) -> Mesh:
    """The same triangles, all counter-clockwise seen from where their normals point."""
    corner = mesh.vertices[mesh.triangles]
    facing = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    inward = np.sum(facing * mesh.normals[mesh.triangles].sum(axis=1), axis=1) < 0.0
    triangles = np.where(inward[:, None], mesh.triangles[:, ::-1], mesh.triangles)
    return Mesh(mesh.vertices, mesh.normals, triangles, mesh.shades)
