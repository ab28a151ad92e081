"""Partition into dependent and independent coordinates, and the preparation of a structure's factorisations."""

import numpy as np
from numpy.typing import NDArray

from ..errors import ConsistencyError
from ..linalg import SingularMatrixError, pivot_rows
from .evaluate import evaluate_residuals, evaluate_tangent
from .records import ANALYSES, FACTOR_AGE, FIRST_SENSITIVITY, PARTITIONS, SENSITIVITY
from .workspace import Workspace

RANK_TOLERANCE = 1e-9
"""A constraint row whose remainder after elimination is smaller than this (relative) repeats others."""


def choose_dependent(workspace: Workspace) -> NDArray[np.int64]:
    """Dependent coordinates (m_act,) at the current point; Phi_q must have been evaluated.

    Columns are scaled by the size of their coordinates, so that units do not choose.

    Raises
    ------
    ConsistencyError : if constraints are redundant; names them and what they repeat.
    """
    assembly, active = workspace.assembly, workspace.structure.active
    rows, cols, values = workspace.jacobian()
    order = np.lexsort((cols, rows))
    indptr = np.searchsorted(rows[order], np.arange(len(active) + 1))
    pivots = pivot_rows(
        len(active), assembly.n, indptr, cols[order], values[order], assembly.coordinate_scale, RANK_TOLERANCE
    )
    if len(pivots.redundant):
        phi = workspace.arrays["phi"]
        lines = []
        for row, others in zip(pivots.redundant, pivots.depends_on, strict=True):
            name = assembly.row_names[active[row]]
            repeated = sorted({assembly.row_names[active[k]] for k in others})
            because = f"repeats what {', '.join(repeated)} say" if repeated else "constrains nothing"
            violated = abs(phi[active[row]]) > 1e-8
            kind = "contradicts" if violated and repeated else "is redundant:"
            lines.append(
                f"'{name}' contradicts {', '.join(repeated)} (violation {phi[active[row]]:.3g})"
                if kind == "contradicts"
                else f"'{name}' is redundant: it {because}"
            )
        raise ConsistencyError(
            f"the {len(active)} constraint equations have rank {pivots.rank} in this configuration: "
            + "; ".join(dict.fromkeys(lines))
            + ". Remove the redundant joint or free it in the repeated direction, or start elsewhere if the "
            "position is singular."
        )
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
    counters = workspace.arrays["counters"]
    counters[PARTITIONS] += 1
    counters[ANALYSES] += 1
    for factorization in (structure.kkt, structure.kkt_query, structure.lu_d):
        if factorization is None or factorization.n == 0:
            continue
        try:
            factorization.analyze(values)
        except SingularMatrixError as error:
            raise ConsistencyError(
                f"the system matrix is singular in this configuration ({error}): some coordinate has neither mass "
                "nor a constraint, or a value is not finite"
            ) from error
    workspace.arrays["rate"][FACTOR_AGE] = -1.0
    workspace.arrays["rate"][SENSITIVITY] = 0.0
    workspace.arrays["rate"][FIRST_SENSITIVITY] = -1.0
