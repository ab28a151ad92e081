"""Which rows of joints share loads, and how compliant each of them is relative to the others.

Redundant joints are the limit of equally compliant ones (`compatibility.py`): a displacement is 1 as compliant as
another, and an angle 1/L^2, where L is the length of the model, so that a moment counts as the force that makes it at
this arm. Norms of Euler parameters are no joints: their compliance is 0. Rows that are user-written equations have any
unit, and their compliance is the square of their size.

Two joints can repeat each other only where they are of one mechanism (`mechanisms.py`).
"""

import numpy as np
from numpy.typing import NDArray

from .assembly import Assembly
from .mechanisms import mechanisms

NORM = "e0"
"""Coordinate of a body whose own row is the norm of its Euler parameters."""


def joint_compliance(assembly: Assembly) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Of each row of Phi its relative compliance, and the number of its mechanism, (m + 1,) each."""
    rows, cols = _pattern(assembly)
    compliance = np.ones(assembly.m + 1)
    if assembly.row_scale is not None:
        size = np.where(np.isfinite(assembly.row_scale) & (assembly.row_scale > 0.0), assembly.row_scale, 1.0)
        compliance[: assembly.m] = size**2
    else:
        moves = np.zeros(assembly.m + 1, dtype=bool)
        moves[rows[~assembly.is_angle[cols]]] = True
        compliance[: assembly.m_joints][~moves[: assembly.m_joints]] = 1.0 / assembly.length**2
        known = set(assembly.coordinate_names)
        for row, name in enumerate(assembly.row_names[: assembly.m_joints]):
            if f"{name}.{NORM}" in known:
                compliance[row] = 0.0
    return compliance, mechanisms(assembly.m + 1, assembly.n, rows, cols)


def _pattern(assembly: Assembly) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows of joints and the coordinates that they depend on."""
    parts = [np.zeros((2, 0), dtype=np.int64)]
    for batch in assembly.batches:
        if batch.row.size and len(batch.jacobian_pattern):
            local = np.array(batch.jacobian_pattern, dtype=np.int64)
            parts.append(np.stack([batch.row[:, local[:, 0]].ravel(), batch.coord[:, local[:, 1]].ravel()]))
    rows, cols = np.concatenate(parts, axis=1)
    known = (rows >= 0) & (rows < assembly.m_joints) & (cols < assembly.n)
    return rows[known], cols[known]
