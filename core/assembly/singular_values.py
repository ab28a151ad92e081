"""Singular values of the scaled constraint Jacobian: how near a singular position is, and across which directions.

Few of them are asked for, the smallest ones, at many points in a row. Small mechanisms take all values of the dense
matrix, larger ones those few from sparse factors.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..linalg.smallest_singular import smallest_singular
from ..state.workspace_records import convergence_of
from .evaluate import evaluate_residuals, evaluate_tangent
from .mechanisms import mechanisms
from .workspace import Workspace

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats = NDArray[np.float64]

DENSE_ROWS = 240
"""Rows up to which all singular values of the dense matrix cost less than a few of the sparse one. Measured."""
FEW = 0.25
"""Part of all singular values beyond which the dense matrix costs less, too."""
DIRECTIONS = 32
"""So many are looked for in the sparse matrix; where more matter, as in a row of loops that turn alike, all are."""


class Block(NamedTuple):
    """Part of a Jacobian that shares no coordinate with the rest.

    Attributes
    ----------
    rows : (r,), ascending.
    cols : coordinates that they depend on, (c,), ascending.
    matrix : (r, c).
    """

    rows: NDArray[np.int64]
    cols: NDArray[np.int64]
    matrix: Floats


class ScaledJacobian:
    """Phi_q of the active rows as last evaluated: columns times the coordinates' scales, rows divided by their largest
    entry.

    Attributes
    ----------
    row_size : (m,), the largest entry of each row before that; 1 for a row of zeros.
    """

    def __init__(self, workspace: Workspace) -> None:
        rows, cols, values = workspace.jacobian()
        self.rows, self.cols = rows.copy(), cols.copy()  # the structure's own change with it
        self.shape = len(workspace.structure.active), workspace.assembly.n
        values = values * workspace.assembly.coordinate_scale[cols]
        size = np.zeros(self.shape[0])
        np.maximum.at(size, self.rows, np.abs(values))
        self.row_size = np.where(size > 0.0, size, 1.0)
        self.values = values / self.row_size[self.rows]

    @property
    def matrix(self) -> Floats:
        """The dense matrix (m, n)."""
        matrix = np.zeros(self.shape)
        matrix[self.rows, self.cols] = self.values
        return matrix

    @property
    def blocks(self) -> list[Block]:
        """The matrix by mechanisms."""
        if self.shape[0] == 0:
            return []
        number = mechanisms(*self.shape, self.rows, self.cols)
        order, by_row = np.argsort(number[self.rows], kind="stable"), np.argsort(number, kind="stable")
        of_entries = number[self.rows][order]
        found = []
        for rows in np.split(by_row, np.flatnonzero(np.diff(number[by_row])) + 1):
            ends = np.searchsorted(of_entries, [number[rows[0]], number[rows[0]] + 1])
            entries = order[ends[0] : ends[1]]
            cols, local = np.unique(self.cols[entries], return_inverse=True)
            matrix = np.zeros((len(rows), len(cols)))
            matrix[np.searchsorted(rows, self.rows[entries]), local] = self.values[entries]
            found.append(Block(rows, cols, matrix))
        return found

    @property
    def sparse(self) -> "csr_array":
        """The same matrix by its entries."""
        # importing scipy costs more than most runs: only who needs it pays
        from scipy.sparse import csr_array

        return csr_array((self.values, (self.rows, self.cols)), shape=self.shape)


class AllRows:
    """Context in which no row is left out; its value is the scaled Jacobian."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace, self.dropped = workspace, workspace.dropped

    def __enter__(self) -> ScaledJacobian:
        # engaging another structure forgets the conditions measured in the present one
        self.rate = self.workspace.arrays["rate"].copy()
        self.workspace.drop(frozenset())
        evaluate(self.workspace)
        return ScaledJacobian(self.workspace)

    def __exit__(self, *_: object) -> None:
        self.workspace.drop(self.dropped)
        convergence_of(self.rate).factor_age = -1.0
        self.workspace.arrays["rate"][:] = self.rate
        evaluate(self.workspace)


def evaluate(workspace: Workspace) -> None:
    """Residuals and Phi_q at the current point."""
    evaluate_residuals(workspace.record)
    evaluate_tangent(workspace.record, 0.0, 0.0)


def least_singular_value(workspace: Workspace) -> float:
    """Least singular value of Phi_q at the current point, rows and columns scaled, that is zero at singular positions
    only: not one of those that redundant rows make zero. 1 without constraints."""
    jacobian, rank = _scaled_jacobian(workspace)
    return least_of(jacobian, rank) if rank else 1.0


def least_of(jacobian: ScaledJacobian, rank: int) -> float:
    """The `rank`-th of its singular values in descending order."""
    found = _smallest(jacobian, jacobian.shape[0] - rank + 1)
    if found is None:
        values = [np.linalg.svd(block.matrix, compute_uv=False) for block in jacobian.blocks]
        return float(np.sort(np.concatenate(values))[::-1][rank - 1])
    return float(found[0][0])


def singular_directions(workspace: Workspace, matter: float = np.inf) -> tuple[Floats, Floats]:
    """Singular values of that matrix but those that redundant rows make zero, in descending order, and the directions
    (values, n) in which the constraints hold the coordinates by them, as parts of the coordinates' scales: all whose
    value is below `matter`, and what more is found with them."""
    jacobian, rank = _scaled_jacobian(workspace)
    found = _smallest(jacobian, jacobian.shape[0] - rank + DIRECTIONS) if matter < np.inf else None
    if found is not None and found[0][0] >= matter:
        return found[0][:DIRECTIONS], found[1][:DIRECTIONS]
    parts, directions = [np.zeros(0)], [np.zeros((0, jacobian.shape[1]))]
    for block in jacobian.blocks:
        _, values, local = np.linalg.svd(block.matrix, full_matrices=False)
        whole = np.zeros((len(values), jacobian.shape[1]))
        whole[:, block.cols] = local
        parts.append(values)
        directions.append(whole)
    values = np.concatenate(parts)
    order = np.argsort(-values, kind="stable")[:rank]
    return values[order], np.concatenate(directions)[order]


def _smallest(jacobian: ScaledJacobian, count: int) -> tuple[Floats, Floats] | None:
    """That many of the smallest singular values with their directions; None where the dense matrix costs less."""
    m, n = jacobian.shape
    if m <= DENSE_ROWS or m > n or count > FEW * m:
        return None
    return smallest_singular(jacobian.sparse, count)


def _scaled_jacobian(workspace: Workspace) -> tuple[ScaledJacobian, int]:
    """The matrix, with redundant rows, and its rank away from singular positions."""
    left_out = len(workspace.dropped)
    if left_out:
        with AllRows(workspace) as jacobian:
            return jacobian, jacobian.shape[0] - left_out
    evaluate(workspace)
    jacobian = ScaledJacobian(workspace)
    return jacobian, jacobian.shape[0]
