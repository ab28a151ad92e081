"""Parts of a mesh of triangles, each of which a sphere touches at one place.

The nearest point of a convex surface is one, and moves without a jump as a sphere rolls over faces, edges and corners.
So triangles are put together as long as they are one: the corners of a part lie behind the planes of its triangles and
of those that it meets at edges that stand out, between whose planes a sphere can come. At edges that go in, a sphere
touches both triangles and never the edge. A convex mesh is one part; of a hollow each triangle is.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

FLAT_EDGE = 1e-9
"""Of the mesh's size: by so little a corner may stand out of a plane in which it counts as lying."""

Points = tuple[tuple[float, float, float], ...]
Faces = tuple[tuple[int, int, int], ...]


@lru_cache(maxsize=1024)
def parts_of(vertices: Points, faces: Faces) -> tuple[tuple[int, ...], ...]:
    """Numbers of the triangles of each part."""
    points, triangles = np.array(vertices), np.array(faces)
    behind = _behind(points, triangles)
    beside = _beside(faces, behind)
    parts, taken = [], np.zeros(len(faces), dtype=bool)
    for seed in range(len(faces)):
        if not taken[seed]:
            parts.append(_grow(seed, triangles, behind, beside, taken))
    return tuple(parts)


def normals_of(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Outward unit normals (triangles, 3)."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    return np.asarray(across / np.linalg.norm(across, axis=1, keepdims=True))


def flat_edges(vertices: Points, faces: Faces) -> NDArray[np.bool_]:
    """Whether the edge behind corner k of each triangle lies flat, or goes in: (triangles, 3). No sphere touches it."""
    points, triangles = np.array(vertices), np.array(faces)
    tolerance = FLAT_EDGE * float(np.ptp(points, axis=0).max())
    owner = _owners(faces)
    normals, found = normals_of(points, triangles), np.zeros((len(faces), 3), dtype=bool)
    for f, (a, b, c) in enumerate(faces):
        for k, (i, j) in enumerate(((a, b), (b, c), (c, a))):
            far = _third(faces[owner[j, i]], i, j)
            found[f, k] = normals[f] @ (points[far] - points[a]) >= -tolerance
    return found


def _owners(faces: Faces) -> dict[tuple[int, int], int]:
    """The triangle that goes along each directed edge."""
    return {edge: f for f, (a, b, c) in enumerate(faces) for edge in ((a, b), (b, c), (c, a))}


def _third(face: tuple[int, int, int], i: int, j: int) -> int:
    return next(k for k in face if k not in (i, j))


def _behind(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which corners lie behind, or in, the plane of each triangle (triangles, corners)."""
    tolerance = FLAT_EDGE * float(np.ptp(points, axis=0).max())
    normals = normals_of(points, triangles)
    planes = np.einsum("fi,fi->f", normals, points[triangles[:, 0]])
    return np.asarray(normals @ points.T - planes[:, None] <= tolerance)


def _beside(faces: Faces, behind: NDArray[np.bool_]) -> list[list[int]]:
    """The neighbours of each triangle across edges that stand out or are flat."""
    owner = _owners(faces)
    found: list[list[int]] = [[] for _ in faces]
    for (i, j), f in owner.items():
        other = owner[j, i]
        if behind[f, _third(faces[other], i, j)]:
            found[f].append(other)
    return found


def _grow(
    seed: int, triangles: NDArray[np.int64], behind: NDArray[np.bool_], beside: list[list[int]],
    taken: NDArray[np.bool_],
) -> tuple[int, ...]:  # fmt: skip
    """The part that grows from a triangle over those that are not taken."""
    part, corners, guards = [seed], set(triangles[seed].tolist()), {seed, *beside[seed]}
    taken[seed] = True
    asked, refused = list(beside[seed]), {seed}
    while asked:
        f = asked.pop()
        if taken[f] or f in refused:
            continue
        new, more = set(triangles[f].tolist()) - corners, {f, *beside[f]} - guards
        whole = [*corners, *new]
        if behind[np.ix_(list(more), whole)].all() and behind[np.ix_(list(guards), list(new))].all():
            part.append(f)
            taken[f] = True
            corners |= new
            guards |= more
            asked += beside[f]
        else:
            refused.add(f)
    return tuple(sorted(part))
