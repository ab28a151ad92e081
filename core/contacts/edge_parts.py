"""Edges of boxes, convex polyhedra and capsules, sorted so that no two edges of one face are alike.

Where two convex bodies touch, the places lie in one face of each (or in an edge, a corner of it). So of all pairs of an
edge of one sort with an edge of another one touches at a time, and the nearest of them is enough: bodies of n and m
edges have not n m contacts, but as many as pairs of sorts, 16 for two boxes.
"""

from functools import lru_cache

import numpy as np

from .cornered3d import Box3D, Capsule3D, ConvexPolyhedron3D
from .hull_faces import faces_of
from .mesh_parts import flat_edges

Edged3D = Box3D | ConvexPolyhedron3D | Capsule3D
Edge = tuple[int, int]
MOST_SEARCHED = 40
"""Edges; of more, sorts are taken as they come, and may be a few more than needed."""
MOST_TRIES = 20_000


@lru_cache(maxsize=1024)
def edges_of(shape: Edged3D) -> tuple[Edge, ...]:
    """Numbers of the places at both ends of each edge; of a capsule its axis.

    Raises
    ------
    ModelError : for a polyhedron whose vertices lie in one plane.
    """
    if isinstance(shape, Capsule3D):
        return ((1, 0),)
    return tuple(sorted(_faces_at_edges(shape)))


@lru_cache(maxsize=1024)
def edge_sorts(shape: Edged3D) -> tuple[tuple[int, ...], ...]:
    """Numbers of the edges of each sort."""
    edges = edges_of(shape)
    if isinstance(shape, Capsule3D):
        return ((0,),)
    at = _faces_at_edges(shape)
    beside = [[k for k, other in enumerate(edges) if k != i and at[edge] & at[other]] for i, edge in enumerate(edges)]
    sorts = _sorted_edges(beside)
    return tuple(tuple(k for k, sort in enumerate(sorts) if sort == wanted) for wanted in range(max(sorts) + 1))


def _faces_at_edges(shape: Box3D | ConvexPolyhedron3D) -> dict[Edge, frozenset[int]]:
    """The two faces at each edge; triangles that meet at a flat edge are one face."""
    mesh = faces_of(shape)
    flat, owner = flat_edges(mesh.vertices, mesh.faces), {}
    for f, (a, b, c) in enumerate(mesh.faces):
        for k, edge in enumerate(((a, b), (b, c), (c, a))):
            owner[edge] = f, bool(flat[f, k])
    face = list(range(len(mesh.faces)))
    for (i, j), (f, is_flat) in owner.items():
        if is_flat:
            one, other = face[f], face[owner[j, i][0]]
            face = [one if number == other else number for number in face]
    return {
        (i, j): frozenset((face[f], face[owner[j, i][0]]))
        for (i, j), (f, is_flat) in owner.items()
        if i < j and not is_flat
    }


def _sorted_edges(beside: list[list[int]]) -> list[int]:
    """A sort for each edge, none that an edge beside it has, of as few sorts as a short search finds."""
    if len(beside) <= MOST_SEARCHED:
        for count in range(3, 8):
            tries = [MOST_TRIES]
            found = [-1] * len(beside)
            if _search(beside, count, found, tries):
                return found
    found = [-1] * len(beside)
    for k in range(len(beside)):
        found[k] = min(set(range(len(beside))) - {found[i] for i in beside[k]})
    return found


def _search(beside: list[list[int]], count: int, found: list[int], tries: list[int]) -> bool:
    """Fill `found` with sorts below `count`; of the edges that are left the one with the least choice is next."""
    left = [k for k, sort in enumerate(found) if sort < 0]
    if not left:
        return True
    if tries[0] <= 0:
        return False
    tries[0] -= 1
    choices = {k: sorted(set(range(count)) - {found[i] for i in beside[k]}) for k in left}
    k = min(left, key=lambda edge: (len(choices[edge]), edge))
    used = int(np.max(found)) + 1
    for sort in choices[k]:
        if sort > used:
            break  # all that have not been used yet are alike
        found[k] = sort
        if _search(beside, count, found, tries):
            return True
        found[k] = -1
    return False
