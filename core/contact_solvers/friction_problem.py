"""The contact problem with Coulomb friction in the form of de Saxce and Feng (1998), scaled, and its natural map.

With u = W r + q, each contact's forces r and velocities u in the order normal, tangents:

    K* contains u + mu |u_t| e_n  perpendicular to  r in K,    K = {r : |r_t| <= mu r_n}, K* its dual cone.

The problem keeps its form when the velocities of a contact are divided and its forces multiplied by the same number. So
each contact is scaled by the root of its own mobility d_i, the mean of the diagonal of its block of W: then each block
has a mean diagonal of 1, forces and velocities have the same dimension, and the projections need no parameter.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph

Vector = npt.NDArray[np.float64]
Places = npt.NDArray[np.intp]

DENSE_BELOW = 150
"""Rows below which the matrix is dense: a dense factorisation is as quick as a sparse one there."""


@dataclass(frozen=True, eq=False)
class FrictionProblem:
    """A scaled contact problem of n contacts with `tangents` tangents each, p = 1 + tangents rows a contact.

    Attributes
    ----------
    matrix : W scaled, (n p, n p), dense or sparse by rows; dimensionless.
    q : velocities without forces, scaled, (n p,), the root of a power.
    mu : coefficients of friction (n,), dimensionless.
    tangents : 0, 1 or 2; dimensionless.
    root : root of each contact's mobility (n, 1), by which its scaled forces are divided, its scaled velocities
        multiplied.
    size : |q| as given, a velocity; 1 where it is 0.
    """

    matrix: Any
    q: Vector
    mu: Vector
    tangents: int
    root: Vector
    size: float

    def velocities(self, r: Vector) -> Vector:
        """Scaled velocities W r + q, (n p,)."""
        found: Vector = self.matrix @ r + self.q
        return found

    def blocks(self, x: Vector) -> Vector:
        """A view of x with a row for each contact."""
        return x.reshape(len(self.mu), 1 + self.tangents)

    def augmented(self, u: Vector) -> Vector:
        """Velocities u + mu |u_t| e_n of de Saxce and Feng, (n p,)."""
        found = self.blocks(u).copy()
        found[:, 0] += self.mu * lengths(found[:, 1:])
        return found.ravel()

    def projected(self, x: Vector) -> Vector:
        """Nearest points of the friction cones, (n p,)."""
        found, mu = self.blocks(x).copy(), self.mu
        normal, length = found[:, 0].copy(), lengths(found[:, 1:])
        beyond, below = length > mu * normal, mu * length <= -normal
        side = beyond & ~below
        found[side, 0] = (normal[side] + mu[side] * length[side]) / (1.0 + mu[side] ** 2)
        found[side, 1:] *= (mu[side] * found[side, 0] / length[side])[:, None]
        found[below] = 0.0
        return found.ravel()

    def compliant(self, compliance: Vector) -> tuple["FrictionProblem", Vector]:
        """The problem with contacts that give way by a compliance (n,), in parts of their own mobilities; and the
        factors (n p,) by which its scaled forces are multiplied to give those of this problem."""
        factor = np.repeat(1.0 / np.sqrt(1.0 + compliance), 1 + self.tangents)
        added = np.repeat(compliance, 1 + self.tangents)
        if sparse.issparse(self.matrix):
            each, more = (sparse.dia_array((x[None, :], [0]), shape=self.matrix.shape) for x in (factor, added))
            matrix = (each @ (self.matrix + more) @ each).tocsr()
        else:
            matrix = (self.matrix + np.diag(added)) * factor * factor[:, None]
        root = self.root * np.sqrt(1.0 + compliance)[:, None]
        return FrictionProblem(matrix, factor * self.q, self.mu, self.tangents, root, self.size), factor

    def islands(self) -> list[Places]:
        """Numbers of the contacts that act on each other, for each such set; of a dense matrix all are one set."""
        n, rows = len(self.mu), 1 + self.tangents
        if not sparse.issparse(self.matrix):
            return [np.arange(n)]
        by_rows = self.matrix.tocoo()
        near = sparse.coo_array((np.ones(by_rows.nnz), (by_rows.row // rows, by_rows.col // rows)), shape=(n, n))
        count, label = csgraph.connected_components(near.tocsr(), directed=False)
        return np.split(np.argsort(label, kind="stable"), np.bincount(label, minlength=count).cumsum()[:-1])

    def part(self, contacts: Places) -> tuple["FrictionProblem", Places]:
        """The problem of an island, its residual in parts of the whole |q|, and its rows in this one."""
        rows = ((1 + self.tangents) * contacts[:, None] + np.arange(1 + self.tangents)).ravel()
        matrix = self.matrix[rows][:, rows]
        matrix = matrix.toarray() if len(rows) < DENSE_BELOW else matrix
        return replace(self, matrix=matrix, q=self.q[rows], mu=self.mu[contacts], root=self.root[contacts]), rows

    def residual(self, r: Vector, u: Vector | None = None) -> float:
        """|D r - P_K(D r - (u + mu |u_t| e_n))| / |q| in the units as given, D the contacts' mobilities; infinite for
        forces that are no numbers."""
        u = self.velocities(r) if u is None else u
        left = self.root * self.blocks(r - self.projected(r - self.augmented(u)))
        size = float(np.linalg.norm(left)) / self.size
        return size if np.isfinite(size) else np.inf


def lengths(tangential: Vector) -> Vector:
    """Length of each row, (n,)."""
    if tangential.shape[1] == 2:
        return np.hypot(tangential[:, 0], tangential[:, 1])
    return np.abs(tangential).sum(axis=1)


def scaled_problem(w: Any, q: Any, mu: Any, tangents: int, asymmetry: float) -> FrictionProblem:
    """The scaled problem of what a user gives, or a ValueError that says what is wrong with it."""
    if tangents not in (0, 1, 2):
        raise ValueError(f"tangents = {tangents!r}; needed is 0, 1 or 2, the number of tangents of each contact")
    rows = 1 + tangents
    q = _numbers("q", q)
    if q.ndim != 1 or q.size % rows:
        raise ValueError(
            f"q has the shape {q.shape}; needed is ({rows} n,) for n contacts with {tangents} tangents, "
            "in the order normal, tangents of each contact"
        )
    n = q.size // rows
    mu = _numbers("mu", mu)
    if mu.shape not in ((), (n,)):
        raise ValueError(f"mu has the shape {mu.shape}; needed is one number or ({n},), a coefficient for each contact")
    if (mu < 0.0).any():
        raise ValueError(f"mu has the negative coefficient {mu.min()}; needed are coefficients of at least 0")
    mu = np.broadcast_to(mu, (n,)) if tangents else np.zeros(n)
    w = _matrix(w, q.size)
    own = w.diagonal().reshape(n, rows).mean(axis=1)
    if (own < 0.0).any():
        i = int(own.argmin())
        raise ValueError(
            f"W has negative diagonal elements at contact {i}; W must be symmetric and positive semidefinite"
        )
    # one that nothing can move has any scale
    own[own == 0.0] = own.max(initial=0.0) or 1.0
    root = np.sqrt(own)
    each = sparse.dia_array((np.repeat(1.0 / root, rows)[None, :], [0]), shape=w.shape)
    w = (each @ w @ each).tocsr()
    uneven = abs(w - w.T).max() if w.nnz else 0.0
    if uneven > asymmetry:
        raise ValueError(
            f"W differs from its transpose by {uneven:.2g} of the contacts' own mobilities; needed is a symmetric "
            f"matrix, to {asymmetry:g}. Check its order (normal, tangents of each contact), or give a larger "
            "`asymmetry`: W is then used as it is"
        )
    size = float(np.linalg.norm(q))
    matrix = w.toarray() if q.size < DENSE_BELOW else w
    return FrictionProblem(matrix, q / np.repeat(root, rows), np.array(mu), tangents, root[:, None], size or 1.0)


def _numbers(name: str, given: Any) -> Vector:
    found = np.asarray(given, dtype=np.float64)
    if not np.isfinite(found).all():
        raise ValueError(f"{name} has elements that are not finite; needed are numbers")
    return found


def _matrix(w: Any, rows: int) -> Any:
    found = sparse.csr_array(
        w if sparse.issparse(w) else np.atleast_2d(np.asarray(w, dtype=np.float64)), dtype=np.float64
    )
    if rows == 0 and 0 in found.shape:
        return sparse.csr_array((0, 0))
    if found.shape != (rows, rows):
        raise ValueError(f"W has the shape {found.shape}; needed is ({rows}, {rows}), as q has {rows} elements")
    if not np.isfinite(found.data).all():
        raise ValueError("W has elements that are not finite; needed are numbers")
    found.sum_duplicates()
    return found
