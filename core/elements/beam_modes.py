"""Modes of a straight Euler-Bernoulli beam: eigenmodes and static shapes of a Hermite finite element model.

Deflection w and stretch u are both cubic Hermite between the nodes, with w, w' (u, u') as nodal unknowns, and all
integrals are those of Gauss's formula, which is exact for them. An eigenfrequency converges with the power 4 of the
element length.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..rounding import ON_NODE

Array = NDArray[np.float64]
BoundaryConditions = Literal["cantilever", "simply_supported", "free"]
GAUSS_POINTS = 4
DEPENDENT = 1e-6
"""Part of a static shape (in the norm of its energy) that the modes before it must leave, else it is one of theirs."""


@dataclass(frozen=True)
class Grid:
    """Nodes of the finite elements and the points and weights of the integrals."""

    nodes: Array
    points: Array
    weights: Array

    def shape(self, s: Array, derivative: int) -> Array:
        """Hermite's functions or their derivatives (0, 1, 2) at s (k,), as (k, unknowns)."""
        x = np.atleast_1d(s)
        e = np.clip(np.searchsorted(self.nodes, x, side="right") - 1, 0, len(self.nodes) - 2)
        h = self.nodes[e + 1] - self.nodes[e]
        z = (x - self.nodes[e]) / h
        values = (
            (1 - 3 * z**2 + 2 * z**3, h * (z - 2 * z**2 + z**3), 3 * z**2 - 2 * z**3, h * (z**3 - z**2)),
            ((6 * z**2 - 6 * z) / h, 1 - 4 * z + 3 * z**2, (6 * z - 6 * z**2) / h, 3 * z**2 - 2 * z),
            ((12 * z - 6) / h**2, (6 * z - 4) / h, (6 - 12 * z) / h**2, (6 * z - 2) / h),
        )[derivative]
        full = np.zeros((len(x), 2 * len(self.nodes)))
        rows = np.arange(len(x))
        for k, value in enumerate(values):
            full[rows, 2 * e + k] = value
        return full


def make_grid(length: float, elements: int, special: Sequence[float]) -> Grid:
    """`elements` equal elements, with nodes moved to or put at the `special` points."""
    nodes, h = np.linspace(0.0, length, elements + 1), length / elements
    for s in special:
        k = int(np.argmin(np.abs(nodes - s)))
        if abs(nodes[k] - s) <= 0.25 * h and 0 < k < len(nodes) - 1:
            nodes[k] = s
        elif abs(nodes[k] - s) > ON_NODE * length:
            nodes = np.sort(np.append(nodes, s))
    z, w = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    half = 0.5 * np.diff(nodes)
    points = (nodes[:-1, None] + half[:, None] * (z + 1.0)).ravel()
    return Grid(nodes, points, (half[:, None] * w).ravel())


@dataclass(frozen=True)
class Direction:
    """Bending or stretching as a finite element model: stiffness and mass, free unknowns, rigid motions."""

    stiffness: Array
    mass: Array
    free: NDArray[np.intp]
    rigid: Array
    """(unknowns, rigid motions)."""

    def eigenmodes(self, count: int) -> Array:
        """The first `count` elastic modes of unit modal mass, (unknowns, count).

        Of M x = mu (K + sigma M) x the wanted modes have the largest mu, so that they are the accurate ones.
        """
        from scipy.linalg import eigh

        index = np.ix_(self.free, self.free)
        k, m, rigid = self.stiffness[index], self.mass[index], self.rigid.shape[1]
        if count > len(self.free) - rigid:
            raise ModelError(
                f"{count} modes of a finite element model with {len(self.free)} unknowns: give more elements"
            )
        shift = np.trace(k) / np.trace(m) / len(self.free) ** 4 if rigid else 0.0
        mu, x = eigh(m, k + shift * m)
        found = np.zeros((len(self.mass), count))
        found[self.free] = (x / np.sqrt(mu))[:, ::-1][:, rigid : rigid + count]
        return found

    def static(self, load: Array) -> Array:
        """The shape under `load` (unknowns,); without supports under the load and the inertia that balances it."""
        balanced, rigid, free = load, self.rigid, self.free
        if rigid.shape[1]:
            momentum = self.mass @ rigid
            own = rigid.T @ momentum
            balanced = load - momentum @ np.linalg.solve(own, rigid.T @ load)
            held = [0, len(load) - 2][: rigid.shape[1]]
            free = np.setdiff1d(free, held)
        x = np.zeros(len(load))
        x[free] = np.linalg.solve(self.stiffness[np.ix_(free, free)], balanced[free])
        if rigid.shape[1]:
            x -= rigid @ np.linalg.solve(own, momentum.T @ x)
        return x

    def reduce(self, count: int, loads: Sequence[Array]) -> tuple[Array, Array]:
        """`count` eigenmodes and one more mode for each load, (unknowns, modes), orthogonal in mass and stiffness and
        of unit modal mass; with them their angular frequencies squared.

        Raises
        ------
        ModelError : if the shapes under the loads depend on each other or on the modes.
        """
        modes = self.eigenmodes(count)
        rest = np.zeros((len(self.mass), 0))
        for load in loads:
            x = self.static(load)
            whole = x @ self.stiffness @ x
            for _ in range(2):  # twice, against rounding
                x = x - modes @ (modes.T @ (self.mass @ x))
                x = x - rest @ (rest.T @ (self.stiffness @ x))
            energy = x @ self.stiffness @ x
            if energy <= DEPENDENT**2 * whole or whole == 0.0:
                raise ModelError(
                    "the static shape of an attachment is a sum of the modes and of the attachments before it: leave "
                    "it out, or take fewer modes"
                )
            rest = np.column_stack([rest, x / np.sqrt(energy)])
        mu, y = np.linalg.eigh(rest.T @ self.mass @ rest)
        squares = np.append(np.einsum("ik,ij,jk->k", modes, self.stiffness, modes), 1.0 / mu[::-1])
        return np.column_stack([modes, rest @ (y / np.sqrt(mu))[:, ::-1]]), squares


def bending(
    grid: Grid, stiffness: float, density: float, rotary: float, boundary: BoundaryConditions, origin: float
) -> Direction:
    """Bending with EI (N m^2), mass per length (kg/m) and rotary inertia per length (kg m)."""
    last = 2 * len(grid.nodes) - 2
    held = {"cantilever": [0, 1], "simply_supported": [0, last], "free": []}[boundary]
    n0, n1, n2 = (grid.shape(grid.points, k) for k in range(3))
    w = grid.weights[:, None]
    mass = density * n0.T @ (w * n0) + rotary * n1.T @ (w * n1)
    rigid = np.zeros((last + 2, 2 if boundary == "free" else 0))
    if boundary == "free":
        rigid[0::2, 0], rigid[0::2, 1], rigid[1::2, 1] = 1.0, grid.nodes - origin, 1.0
    return Direction(stiffness * n2.T @ (w * n2), mass, np.setdiff1d(np.arange(last + 2, dtype=np.intp), held), rigid)


def stretching(grid: Grid, stiffness: float, density: float, boundary: BoundaryConditions) -> Direction:
    """Stretching with EA (N) and mass per length (kg/m); held at the root but for a free beam."""
    unknowns = 2 * len(grid.nodes)
    n0, n1 = grid.shape(grid.points, 0), grid.shape(grid.points, 1)
    w = grid.weights[:, None]
    rigid = np.zeros((unknowns, 1 if boundary == "free" else 0))
    if boundary == "free":
        rigid[0::2, 0] = 1.0
    free = np.arange(0 if boundary == "free" else 1, unknowns, dtype=np.intp)
    return Direction(stiffness * n1.T @ (w * n1), density * n0.T @ (w * n0), free, rigid)
