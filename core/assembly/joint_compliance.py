"""Which rows of joints share loads, and how compliant each of them is relative to the others.

Redundant joints are the limit of compliant ones (`redundant_reactions.py`): a displacement has the relative
compliance c of its joint, 1 unless the model gives another, and an angle c/L^2, where L is the length of the model,
so that a moment counts as the force that makes it at this arm. Norms of Euler parameters are no joints: their
compliance is 0. Rows that are user-written equations have any unit, and their compliance is the square of their size.

Two joints can repeat each other only where they are of one mechanism (`mechanisms.py`).
"""

import numpy as np
from numpy.typing import NDArray

from .assembly import Assembly
from .mechanisms import mechanisms
from .numbers import given_compliance

NORM = "e0"
"""Coordinate of a body whose own row is the norm of its Euler parameters."""


def joint_compliance(assembly: Assembly) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Of each row of Phi its relative compliance, and the number of its mechanism, (m + 1,) each."""
    rows, cols = _pattern(assembly)
    compliance, m_joints = given_compliance(assembly), assembly.m_joints
    if assembly.row_scale is not None:
        size = assembly.row_scale[:m_joints]
        compliance[:m_joints] = np.where(np.isfinite(size) & (size > 0.0), size, 1.0) ** 2
    else:
        moves = np.zeros(assembly.m + 1, dtype=bool)
        moves[rows[~assembly.is_angle[cols]]] = True
        compliance[:m_joints][~moves[:m_joints]] /= assembly.length**2
        known = set(assembly.coordinate_names)
        for row, name in enumerate(assembly.row_names[:m_joints]):
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
