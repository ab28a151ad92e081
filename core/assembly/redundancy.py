"""Redundant constraints: rows of Phi that repeat what others say wherever the mechanism can go.

They are left out of the equations that are solved and checked all the same. At a singular position rows depend on one
another too, but only there: a small finite motion along the other constraints tells the two apart, since it violates
such a row at second order and leaves a redundant one at zero.

The motion does not tell the multipliers of redundant constraints (Garcia de Jalon and Bayo 1994, Kinematic and Dynamic
Simulation of Multibody Systems, 3.4, leave rows out by pivoting as well). They are those of compliant joints
(`redundant_reactions.py`).
"""

import logging
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import ConsistencyError
from ..rounding import CONTRADICTION, START_RANK
from ..state.workspace_records import convergence_of
from .evaluate import evaluate_residuals, evaluate_tangent
from .levels import position_level, rate_level
from .partition import pivots_of, prepare, redundancy_error
from .projection import bring_to_rest
from .singular_values import AllRows, ScaledJacobian, evaluate
from .workspace import Workspace

logger = logging.getLogger(__name__)

MOVES = 5
"""Pseudo-random motions that a redundant row must survive."""
MOVE_SIZES = (2e-2, 2e-3, 2e-4)
"""Their size relative to the coordinates' scales: the next smaller if the constraints cannot be met there."""
WORSE = 0.5
"""Rows are chosen anew when the least singular value of those kept is so much smaller than it could be."""
LARGEST_CHOICE = 4_000_000
"""Entries of the dense Jacobian up to which rows are chosen anew during a run."""


@dataclass(frozen=True)
class RedundantRow:
    """A constraint equation that is left out of the equations because others imply it.

    Attributes
    ----------
    constraint : name of the joint (of user-written equations: constraint[k]).
    row : which of its equations, from 0.
    repeats : names of the constraints that imply it.
    of_body : whether it is the norm of a body's Euler parameters, which is no joint's.
    """

    constraint: str
    row: int
    repeats: tuple[str, ...]
    of_body: bool = False

    @property
    def equation(self) -> str:
        """Which equation it is, in words."""
        if self.of_body:
            return f"the norm of the Euler parameters of '{self.constraint}'"
        return f"row {self.row} of '{self.constraint}'"


def find_redundant(workspace: Workspace) -> tuple[RedundantRow, ...]:
    """Leave redundant rows of joints out of the structure, at a start q that need not meet the constraints yet.

    Raises
    ------
    ConsistencyError : for rows that contradict others, that constrain nothing, or that depend on others only here.
    """
    arrays, n = workspace.arrays, workspace.assembly.n
    evaluate(workspace)
    active = workspace.structure.active
    if len(active) == 0:
        return ()
    phi = arrays["phi"][active]
    scaled = ScaledJacobian(workspace)
    violation = float(np.max(np.abs(phi) / scaled.row_size, initial=0.0))
    # off the constraints, rows that repeat others seem to be independent, by about as much as they are violated
    doubtful = pivots_of(workspace, min(max(START_RANK, 30.0 * violation), 0.03)).redundant
    if len(doubtful) == 0:
        return ()
    start = arrays["q"][:n].copy()
    try:
        workspace.drop(frozenset(int(row) for row in active[doubtful]))
        prepare(workspace)
        met = bring_to_rest(workspace, "phi", "q")
        workspace.drop(frozenset())
        if not met:
            return ()
        evaluate(workspace)
        pivots = pivots_of(workspace, START_RANK)
        if len(pivots.redundant) == 0:
            return ()
        rows = active[pivots.redundant]
        most = CONTRADICTION * position_level(workspace.record)
        if np.any(np.abs(arrays["phi"][rows]) > most * arrays["row_scale"][rows]):
            raise redundancy_error(workspace, pivots)
        singular = _only_here(workspace, pivots.redundant)
        if singular:
            raise ConsistencyError(_singular_text(workspace, singular))
        if any(len(others) == 0 for others in pivots.depends_on):
            raise redundancy_error(workspace, pivots)
        workspace.drop(frozenset(int(row) for row in active[pivots.redundant]))
        choose_rows(workspace)
        found = describe(workspace)
    finally:
        arrays["q"][:n] = start
        evaluate_residuals(workspace.record)
    logger.warning(
        "%s; these rows are left out of the equations but checked. The motion does not tell how these joints share "
        "their loads: they do as if all were equally compliant, or as their `compliance` says",
        "; ".join(f"{r.equation} repeats what {', '.join(r.repeats)} say" for r in found),
    )
    return found


def check_rates(workspace: Workspace, redundant: tuple[RedundantRow, ...]) -> None:
    """Redundant rows must hold at velocity level too. Raises ConsistencyError: names those that do not."""
    arrays = workspace.arrays
    most = CONTRADICTION * rate_level(workspace.record)
    for row, found in zip(workspace.structure.redundant, redundant, strict=True):
        if not abs(arrays["phid"][row]) <= most * arrays["row_scale"][row]:
            raise ConsistencyError(
                f"'{found.constraint}' contradicts {', '.join(found.repeats)} at velocity level (violation "
                f"{arrays['phid'][row]:.3g}): drivers that hold the same coordinate must move alike"
            )


def describe(workspace: Workspace) -> tuple[RedundantRow, ...]:
    """The rows left out of the present structure, and what they repeat at the current point."""
    dropped = np.array(sorted(workspace.dropped), dtype=np.int64)
    names = workspace.assembly.row_names
    with AllRows(workspace) as scaled:
        rows = workspace.structure.active
        repeats: dict[int, set[str]] = {}
        for block in scaled.blocks:
            out = np.isin(rows[block.rows], dropped)
            if not np.any(out):
                continue
            factors, *_ = np.linalg.lstsq(block.matrix[~out].T, block.matrix[out].T, rcond=None)
            kept = rows[block.rows[~out]]
            for j, row in enumerate(rows[block.rows[out]]):
                repeats[int(row)] = {names[k] for k in kept[np.abs(factors[:, j]) > 1e-7]}
    found = []
    for row in dropped:
        # its other rows may take part, but what matters are the other joints
        repeated = (repeats[int(row)] - {names[row]}) or repeats[int(row)]
        name, number = names[row], int(row - names.index(names[row]))
        of_body = f"{name}.e0" in workspace.assembly.coordinate_names
        found.append(RedundantRow(name, number, tuple(sorted(repeated)), of_body))
    return tuple(found)


def choose_rows(workspace: Workspace) -> bool:
    """Choose anew which rows are left out if those kept are much worse conditioned at the current point than others of
    the same number would be; True if that has changed."""
    dropped = workspace.dropped
    if not dropped:
        return False
    if workspace.assembly.rate_rows:
        return False  # a velocity-level row does not say what one with a position form says
    # importing scipy costs more than most runs: only who needs it pays
    from scipy.linalg import qr

    better: set[int] = set()
    with AllRows(workspace) as scaled:
        active = workspace.structure.active
        for block in scaled.blocks:
            joints = active[block.rows] < workspace.assembly.m_joints
            rows, matrix = active[block.rows][joints], block.matrix[joints]
            out = np.isin(rows, sorted(dropped))
            if matrix.size > LARGEST_CHOICE or not np.any(out):
                better |= set(rows[out].tolist())
                continue
            order = qr(matrix.T, mode="r", pivoting=True)[1][: np.sum(~out)]
            worse = _least_singular_value(matrix[~out]) < WORSE * _least_singular_value(matrix[order])
            better |= set((np.delete(rows, order) if worse else rows[out]).tolist())
    if better != dropped:
        least = convergence_of(workspace.arrays["rate"]).least_condition
        workspace.drop(frozenset(better))
        # the same constraints, said by other rows: how far they are from a singular position is judged as before
        convergence_of(workspace.arrays["rate"]).least_condition = least
        evaluate_residuals(workspace.record)
        evaluate_tangent(workspace.record, 0.0, 0.0)
    return better != dropped


def _least_singular_value(matrix: NDArray[np.float64]) -> float:
    return float(np.linalg.svd(matrix, compute_uv=False)[-1]) if matrix.size else 1.0


def _only_here(workspace: Workspace, redundant: NDArray[np.int64]) -> list[int]:
    """Those of the redundant rows (positions among the active ones) that small motions along the others violate."""
    arrays, scale, n = workspace.arrays, workspace.assembly.coordinate_scale, workspace.assembly.n
    scaled = ScaledJacobian(workspace)
    active = workspace.structure.active
    size = scaled.row_size[redundant]
    parts = [np.zeros((0, n))]
    for block in scaled.blocks:
        out = np.isin(block.rows, redundant)
        if np.any(out):
            _, values, directions = np.linalg.svd(block.matrix[~out], full_matrices=True)
            local = directions[int(np.sum(values > START_RANK)) :]
            parts.append(np.zeros((len(local), n)))
            parts[-1][:, block.cols] = local
    free = np.concatenate(parts)
    if len(free) == 0:
        return []
    here = arrays["q"][:n].copy()
    found: set[int] = set()
    workspace.drop(frozenset(int(row) for row in active[redundant]))
    try:
        prepare(workspace)
        for k in range(MOVES):
            weights = np.modf(0.6180339887498949 * (k + 1) * (np.arange(len(free)) + 1.0))[0] - 0.5
            motion = weights @ free
            motion /= np.max(np.abs(motion))
            for length in MOVE_SIZES:
                arrays["q"][:n] = here + length * scale * motion
                evaluate_residuals(workspace.record)
                if bring_to_rest(workspace, "phi", "q"):
                    violated = np.abs(arrays["phi"][active[redundant]]) / size > max(1e-4 * length**2, 1e-11)
                    found |= {int(row) for row in redundant[violated]}
                    break
    finally:
        arrays["q"][:n] = here
        workspace.drop(frozenset())
        evaluate(workspace)
    return sorted(found)


def _singular_text(workspace: Workspace, rows: list[int]) -> str:
    names = workspace.assembly.row_names
    active = workspace.structure.active
    scaled = ScaledJacobian(workspace)
    others = np.delete(np.arange(len(active)), rows)
    factors, *_ = np.linalg.lstsq(scaled.matrix[others].T, scaled.matrix[rows].T, rcond=None)
    dependent = {names[active[row]] for row in rows}
    dependent |= {names[active[k]] for k in others[np.max(np.abs(factors), axis=1, initial=0.0) > 1e-7]}
    return (
        f"the start is a singular position: only here, {', '.join(repr(name) for name in sorted(dependent))} depend "
        "on one another, and the mechanism can go on in more than one way (a linkage with all its bars in line). "
        "Positions do not say which. Start a little before or behind this position, on the branch that is meant, "
        "with the velocity that leads through it"
    )
