"""Whether two convex polyhedra overlap, by the planes that could stand between them."""

import numpy as np
from numpy.typing import NDArray

from .edge_parts import Edged3D, edges_of

Points = NDArray[np.float64]


def apart(a: Edged3D, b: Edged3D, points_a: Points, points_b: Points) -> float:
    """How far the hulls of the places of two shapes are apart along the direction along which they are farthest apart,
    m; negative where they overlap.

    a, b : whose edges these are. points_a, points_b : their places in space, (count, 3).

    Two convex polyhedra that do not overlap have a plane between them that is parallel to a face of one or to an edge
    of each (Gottschalk, Lin, Manocha 1996, OBBTree, SIGGRAPH 1996). All directions across two edges are looked
    at, also of one shape: among them are the normals of its faces.
    """
    ways_a, ways_b = (
        np.array([points[j] - points[i] for i, j in edges_of(shape)])
        for shape, points in ((a, points_a), (b, points_b))
    )
    pairs = ((ways_a, ways_a), (ways_b, ways_b), (ways_a, ways_b))
    across = np.concatenate([np.cross(one[:, None], other[None]).reshape(-1, 3) for one, other in pairs])
    size = np.linalg.norm(across, axis=1)
    longest = max(np.linalg.norm(ways_a, axis=1).max(), np.linalg.norm(ways_b, axis=1).max())
    across = across[size > 1e-9 * longest**2]
    across /= np.linalg.norm(across, axis=1)[:, None]
    on_a, on_b = across @ points_a.T, across @ points_b.T
    return float(np.maximum(on_b.min(axis=1) - on_a.max(axis=1), on_a.min(axis=1) - on_b.max(axis=1)).max())
