"""The method record: history and parameters of an integration formula."""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import address_of, caller
from .workspace_records import WORKSPACE_TYPE

METHOD = np.dtype(
    [
        (name, np.int64)
        for name in (
            "capacity",   # rows of history that are kept
            "history",    # (capacity, row_length) float64, a ring
            "times",      # (capacity,) float64
            "ring",       # (RING_SIZE,) int64: position of the newest row, number of rows, points of a long step
            "parameters", # (8,) float64: alpha, beta, gamma ...; the last three are PREDICTS, CARRIES, ESTIMATE
            "weights",    # (8, WEIGHTS_WIDTH) float64: nodes and coefficients of the present grid; a tableau
            "error",      # (2,) float64: error norm of the last step, order of its estimate
            "choice",     # (CHOICE_SIZE,) float64: steps k of a multistep formula, and what order selection proposes
            "exact",      # 1: samples between steps are projected onto the constraints; 0: shown as they are
        )
    ]
)  # fmt: skip
METHOD_TYPE = types.from_dtype(METHOD)

MAX_NODES = 12
"""Most rows of history that a formula uses."""
WEIGHTS_WIDTH = 13
"""Columns of `weights`."""

RING_SIZE = 3

# columns of `choice`
K = 0  # 0: the formula has no order to choose
NEXT_K = 1  # k that the next step shall take; 0: the same
NEXT_NORM = 2  # error norm that it would have had
CHOICE_SIZE = 3
# columns of `parameters`
PREDICTS = 5
"""1: its error is estimated by the difference from what the history predicts."""
CARRIES = 6
"""1: the formula carries accelerations of its own, `aux`, from step to step."""
ESTIMATE = 7
"""0 with fixed steps, where nobody asks for the error."""

STEP_SIGNATURE = types.int64(WORKSPACE_TYPE, METHOD_TYPE, types.float64)
"""A step: from the newest row of history by h; leaves the new point in the workspace and its error norm."""


call_step = caller(STEP_SIGNATURE)
"""call_step(address, workspace, method, h)."""


def step_address(step: Any) -> int:
    """Machine address of a step function."""
    return address_of(step, STEP_SIGNATURE)
