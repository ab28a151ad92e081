"""The record of sizes and addresses through which compiled code reaches a factorisation."""

import numpy as np

from ..compiled import types
from ..compiled.jit import record_view

# Returned by `factor`.
OK = 0
NO_PIVOT = 1  # a pivot is zero to rounding, or a value is not finite
REANALYSE = 2  # the pivots fit the values no longer (or `analyze` was never called)
# and by `analyze`, besides
WANT_ANALYSIS = 3  # of the pivots in `wanted`, which has not been made yet
WANT_ROOM = 4  # for the choice of pivots
WANT_VALUES = 5  # room for the factors

# An entry of L may grow by this factor over the largest of its column at analysis, at least over what is 1 once the
# rows are balanced.
GROWTH = 1e5

LU = np.dtype(
    [
        (name, np.int64)
        for name in (
            "n", "nnz",
            "factor_function", "solve_function",  # machine addresses: dense, program or columns
            "entry_to",    # (nnz,) uint32: position of each matrix entry in `values`
            "entry_from",  # (nnz,) uint32: its position in the source array
            "values",      # dense: (n, n) rows, then (n,) 1/pivot
                           # sparse: (nl,) L, (nu,) U, (n,) 1/pivot, (n,) largest |L| allowed in the column
            "room",        # sparse: length of `values`
            "work",        # (n,) float64
            "row_unit",    # (n,) float64: what brings the rows to one unit, for the choice of dense pivots
            "pivots",      # (n,) int64, dense: row of the matrix at each pivot
            # sparse: of the pattern, by columns in the order of the pivots
            "order", "column_start", "column_row", "column_of", "column_slot",
            "col_unit",    # (n,) float64, as row_unit
            "known", "n_known",            # (MOST_ANALYSES,) int64 addresses of ANALYSIS records, (1,) int64
            "analysis",                    # address of the present one; 0: none
            "wants",                       # what `analyze` has asked for; 0: nothing
            "wanted",                      # (n,) int64: place of each row in the pivot sequence
            "choice_work", "choice_room",  # scratch of `choice.py`
            # sparse, of the analysis: L (unit diagonal) and U by columns; U is stored divided by its columns' pivots
            "nl", "nu",
            "l_start", "u_start",                # (n + 1,) uint32
            "l_row", "l_col", "u_row", "u_col",  # (nl,), (nu,) uint32, rows ascending in each column
            "row_at", "col_at",                  # (n,) uint32: row and column of the matrix at each pivot
            # PROGRAM: values[to] -= values[left] * values[right], then the sums of the pivots
            "n_steps", "n_sums",
            "step_start", "step_to", "step_left", "step_right",  # (n + 1,), (n_steps,) uint32
            "sum_start", "sum_left", "sum_right",                # (n + 1,), (n_sums,) uint32
        )
    ]
)  # fmt: skip

LU_TYPE = types.from_dtype(LU)

OF_ANALYSIS = (
    "factor_function", "solve_function", "nl", "nu", "l_start", "u_start", "l_row", "l_col", "u_row", "u_col",
    "row_at", "col_at", "entry_to", "entry_from", "n_steps", "n_sums", "step_start", "step_to", "step_left",
    "step_right", "sum_start", "sum_left", "sum_right",
)  # fmt: skip
"""Fields of LU that an analysis sets."""
ANALYSIS = np.dtype([(name, np.int64) for name in ("perm_r", "size", *OF_ANALYSIS)])
"""Place of each row in the pivot sequence (n,) int64, numbers that are stored, and what LU takes over."""
ANALYSIS_TYPE = types.from_dtype(ANALYSIS)
analysis_at = record_view(ANALYSIS_TYPE)
MOST_ANALYSES = 64
"""Kept for one pattern in a run, and shared among runs."""

FACTOR_SIGNATURE = types.int64(LU_TYPE, types.int64)
SOLVE_SIGNATURE = types.void(LU_TYPE, types.int64)

lu_at = record_view(LU_TYPE)
"""lu_at(address): the LU record at `Factorization.address`, for records that store the address of another."""
