"""Reduced bodies for tests: clouds of point masses that modes move, whose matrices are sums."""

import numpy as np


def moments(mass, places, modes):
    """Fields of a ReducedBody3D of point masses (N,) at `places` (N, 3) that modes (n, N, 3) move."""
    return plain({
        "mass": mass.sum(),
        "first_moment": mass @ places,
        "second_moment": np.einsum("a,ai,aj->ij", mass, places, places),
        "modal_first_moment": np.einsum("a,kai->ki", mass, modes),
        "modal_moment": np.einsum("a,ai,kaj->kij", mass, places, modes),
        "modal_second_moment": np.einsum("a,kai,laj->klij", mass, modes, modes),
    })  # fmt: skip


def plain(fields):
    """Arrays as lists."""
    return {
        name: value.tolist() if isinstance(value, np.ndarray | np.generic) else value for name, value in fields.items()
    }


def cloud(seed, points, modes):
    """Masses (N,), places (N, 3) and mode shapes (n, N, 3)."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.1, 0.5, points), rng.normal(size=(points, 3)), 0.5 * rng.normal(size=(modes, points, 3))


def points_with_modes(seed, points, modes):
    """Fields of a body of random points, with an interface that turns and one at a point alone."""
    mass, places, shapes = cloud(seed, points, modes)
    rng = np.random.default_rng(seed + 1)
    ends = (
        {"name": "turning", "point": places[0], "shape": shapes[:, 0], "rotation": 0.3 * rng.normal(size=(modes, 3))},
        {"name": "node", "point": places[1], "shape": shapes[:, 1]},
    )
    root = rng.normal(size=(modes, modes))
    stiffness = root @ root.T + 3.0 * np.eye(modes)
    fields = {"stiffness": 0.5 * (stiffness + stiffness.T), "interfaces": [plain(end) for end in ends]}
    return {**moments(mass, places, shapes), **plain(fields)}
