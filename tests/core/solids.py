"""Convex shapes for tests of their contacts, and how far they are apart, found without any of their contacts."""

import numpy as np
from scipy.optimize import nnls
from tlismni.core import Box3D, Capsule3D, ConvexPolyhedron3D, Marker3D, RigidBody3D, RotationVector
from tlismni.core.contacts.edges3d import ROUND
from tlismni.core.model.attitude import rotation_matrix

EULER = ("e0", "e1", "e2", "e3")


def random_shape(rng, body, kind, radius=1e-3):
    """A box, a polyhedron or a capsule, somewhere on its body; radius 0: a sharp box."""
    marker = Marker3D(
        body=body,
        point=tuple(rng.uniform(-0.03, 0.03, 3)),
        attitude=RotationVector(vector=tuple(rng.uniform(-1.0, 1.0, 3))),
    )
    if kind == "box":
        return Box3D(marker=marker, size=tuple(rng.uniform(0.1, 0.6, 3)), edge_radius=radius)
    if kind == "capsule":
        return Capsule3D(marker=marker, length=float(rng.uniform(0.1, 0.5)), radius=10.0 * radius)
    points = rng.normal(size=(rng.integers(4, 12), 3))
    points *= rng.uniform(0.6, 1.0, (len(points), 1)) / np.linalg.norm(points, axis=1, keepdims=True)
    points = points * (0.3, 0.2, 0.25)
    return ConvexPolyhedron3D(marker=marker, vertices=[tuple(point) for point in points.tolist()], radius=radius)


def uniform_box(name, size, mass=1.0, **more):
    """The body of a box of uniform density."""
    x, y, z = (mass / 12.0 * side**2 for side in size)
    return RigidBody3D(name=name, mass=mass, inertia=(y + z, x + z, x + y), **more)


def hull_distance(a, b):
    """Of the hulls of two sets of points (count, 3), m: the shortest of their differences is found by least squares
    with weights >= 0, whose sum is drawn to 1."""
    away = (a[:, None] - b[None]).reshape(-1, 3)
    weights, _ = nnls(np.vstack((away.T, np.ones(len(away)))), np.array((0.0, 0.0, 0.0, 1.0)), maxiter=5000)
    return float(np.linalg.norm(away.T @ weights / weights.sum()))


def rounded(a, b):
    """Two shapes as they touch each other: boxes without any radius are a little round."""
    if a.rounding() + b.rounding() > 0.0:
        return a, b
    return tuple(
        shape.model_copy(update={"edge_radius": ROUND * min(shape.size)}) if isinstance(shape, Box3D) else shape
        for shape in (a, b)
    )


def placed(shape, point, euler):
    """Places of a shape on a body that stands there, (count, 3)."""
    on_body = np.array(shape.marker.point) + shape.places() @ shape.marker.axes().T
    return np.array(point) + on_body @ rotation_matrix(euler).T


def clearance(result, a, b):
    """The distance of two shapes at each sample of a run, less their radii, m."""
    a, b = rounded(a, b)
    names = [shape.marker.body for shape in (a, b)]
    stands = [
        (
            np.column_stack([result[f"{name}.{axis}"] for axis in "xyz"]),
            np.column_stack([result[f"{name}.{part}"] for part in EULER]),
        )
        if name != "ground"
        else (np.zeros((len(result.t), 3)), np.tile((1.0, 0.0, 0.0, 0.0), (len(result.t), 1)))
        for name in names
    ]
    return np.array(
        [
            hull_distance(placed(a, stands[0][0][k], stands[0][1][k]), placed(b, stands[1][0][k], stands[1][1][k]))
            for k in range(len(result.t))
        ]
    ) - (a.rounding() + b.rounding())
