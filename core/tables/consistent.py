"""Consistent start: positions, velocities, accelerations and multipliers from given q0, v0."""

import logging

import numpy as np
from numpy.typing import NDArray

from ..errors import ConsistencyError
from ..rounding import START_MOVED
from .assembly import Assembly
from .evaluate import evaluate_residuals
from .levels import rate_level
from .partition import prepare
from .projection import bring_to_rest
from .redundancy import RedundantRow, check_rates, find_redundant
from .workspace import Workspace

logger = logging.getLogger(__name__)

START_TOLERANCE = 1e-3
"""How far q0 (relative to the size of the mechanism) and v0 (relative to the speeds) may be moved, by default."""


def make_consistent(
    workspace: Workspace, tolerance: float = START_TOLERANCE, refuse_redundant: bool = False
) -> tuple[RedundantRow, ...]:
    """Move the current q, v onto the constraints by the least change in the M-norm.

    Rows that repeat others are left out of the equations first (unless `refuse_redundant`); returns them.

    Raises
    ------
    ConsistencyError : if the constraints cannot be met, or only by a change larger than `tolerance`; if they contradict
        each other; if the position is singular; names the constraints.
    """
    ws, arrays, assembly = workspace.record, workspace.arrays, workspace.assembly
    n = assembly.n
    redundant = () if refuse_redundant else find_redundant(workspace)
    prepare(workspace)
    evaluate_residuals(ws)
    given = _violations(assembly, workspace.structure.active, arrays["phi"])
    scale_v = assembly.coordinate_scale * rate_level(ws)
    for level, residual, x, scale in (
        ("positions q0", "phi", "q", assembly.coordinate_scale),
        ("velocities v0", "phid", "v", scale_v),
    ):
        before = arrays[x][:n].copy()
        if level.startswith("v"):
            given = _violations(assembly, workspace.structure.active, arrays["phid"])
        ok = bring_to_rest(workspace, residual, x)
        moved = np.abs(arrays[x][:n] - before) / scale
        worst = int(np.argmax(moved)) if n else 0
        if not ok or (n and not moved[worst] <= tolerance):
            detail = (
                f"the nearest consistent ones differ by {moved[worst] * scale[worst]:.3g} in "
                f"{assembly.coordinate_names[worst]}"
                if ok
                else "no consistent ones were found near by"
            )
            raise ConsistencyError(
                f"the given {level} violate the constraints beyond repair: {given}; {detail}, and "
                f"start_tolerance = {tolerance:g} (relative) is allowed. Give consistent values, or raise "
                "start_tolerance."
            )
        if n and moved[worst] > START_MOVED:
            logger.info("%s moved by up to %.3g (relative) to meet the constraints", level, moved[worst])
    check_rates(workspace, redundant)
    if n and workspace.structure.active.size:
        prepare(workspace)
    return redundant


def _violations(assembly: Assembly, active: NDArray[np.int64], residual: NDArray[np.float64]) -> str:
    """The worst violated constraints by name."""
    worst: dict[str, float] = {}
    for row in active:
        name = assembly.row_names[row]
        worst[name] = max(worst.get(name, 0.0), abs(float(residual[row])))
    ordered = sorted(worst.items(), key=lambda item: -item[1])[:5]
    return ", ".join(f"'{name}' by {value:.3g}" for name, value in ordered if value > 0.0) or "none"
