"""Partition into dependent and independent coordinates, and the preparation of a structure's factorisations."""

import numpy as np
from numpy.typing import NDArray

from ..errors import ConsistencyError
from ..linalg import RowPivots, SingularMatrixError, pivot_rows
from ..rounding import CONTRADICTION, RANK_TOLERANCE
from ..state.workspace_records import convergence_of, counters_of
from .condition_probe import set_probe
from .evaluate import evaluate_residuals, evaluate_tangent
from .levels import position_level
from .redundant_reactions import share_load
from .workspace import Workspace


def pivots_of(workspace: Workspace, tolerance: float = RANK_TOLERANCE) -> RowPivots:
    """Independent columns and redundant rows among the active ones; Phi_q must have been evaluated.

    Columns are scaled by the size of their coordinates, so that units do not choose.
    """
    active = workspace.structure.active
    if len(active) == 0:
        none = np.zeros(0, dtype=np.int64)
        return RowPivots(none, 0, none, [])
    rows, cols, values = workspace.jacobian()
    indptr = np.searchsorted(rows, np.arange(len(active) + 1))
    check = not np.isfinite(values).all()  # which says what is wrong; all else holds by itself
    scale = workspace.arrays["scale"]
    return pivot_rows(len(active), workspace.assembly.n, indptr, cols, values, scale, tolerance, check)


def what_repeats(workspace: Workspace, pivots: RowPivots) -> str:
    """Each redundant row, and what it repeats or contradicts."""
    assembly, active = workspace.assembly, workspace.structure.active
    phi, row_scale = workspace.arrays["phi"], workspace.arrays["row_scale"]
    most, lines = CONTRADICTION * position_level(workspace.record), []
    for row, others in zip(pivots.redundant, pivots.depends_on, strict=True):
        name = assembly.row_names[active[row]]
        repeated = sorted({assembly.row_names[active[k]] for k in others})
        because = f"repeats what {', '.join(repeated)} say" if repeated else "constrains nothing"
        violated = abs(phi[active[row]]) > most * row_scale[active[row]]
        lines.append(
            f"'{name}' contradicts {', '.join(repeated)} (violation {phi[active[row]]:.3g})"
            if violated and repeated
            else f"'{name}' is redundant: it {because}"
        )
    return "; ".join(dict.fromkeys(lines))


def redundancy_error(workspace: Workspace, pivots: RowPivots) -> ConsistencyError:
    """The refusal of rows that repeat or contradict others."""
    return ConsistencyError(
        f"the {len(workspace.structure.active)} constraint equations have rank {pivots.rank} in this configuration: "
        + what_repeats(workspace, pivots)
        + ". Remove the redundant joint or free it in the repeated direction, or start elsewhere if the "
        "position is singular."
    )


def choose_dependent(workspace: Workspace) -> NDArray[np.int64]:
    """Dependent coordinates (m_act,) at the current point; Phi_q must have been evaluated.

    Raises
    ------
    ConsistencyError : if active constraints are redundant; names them and what they repeat.
    """
    pivots = pivots_of(workspace)
    if len(pivots.redundant):
        raise redundancy_error(workspace, pivots)
    return np.asarray(pivots.pivot_column, dtype=np.int64)


def prepare(workspace: Workspace) -> None:
    """New partition and new orderings for the structure, at the workspace's current point.

    Raises
    ------
    ConsistencyError : for redundant constraints, or a mass matrix that is singular on the constraints.
    """
    evaluate_residuals(workspace.record)
    evaluate_tangent(workspace.record, 0.0, 0.0)
    workspace.set_partition(choose_dependent(workspace))
    structure, values = workspace.structure, workspace.arrays["values"]
    counters = counters_of(workspace.arrays["counters"])
    counters.partitions += 1
    counters.analyses += 1
    for factorization in (structure.kkt, structure.lu_d, structure.lu_p):
        if factorization is None or factorization.n == 0:
            continue
        try:
            factorization.analyze(values)
        except SingularMatrixError as error:
            raise ConsistencyError(
                f"the system matrix is singular in this configuration ({error}): some coordinate has neither mass "
                "nor a constraint, or a value is not finite"
            ) from error
    if structure.n_implied and not bool(share_load(workspace.record)):
        raise ConsistencyError(
            "the system matrix is singular in this configuration once rows that repeat each other share the load"
        )
    structure.kkt_query.follow(structure.kkt)
    set_probe(workspace.record)
    rate = convergence_of(workspace.arrays["rate"])
    rate.factor_age, rate.sensitivity, rate.first_sensitivity = -1.0, 0.0, -1.0
