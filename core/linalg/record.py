"""The record of sizes and addresses through which compiled code reaches a factorisation."""

import numpy as np

from ..compiled import types
from ..compiled.jit import record_view

# Returned by `factor`.
OK = 0
NO_PIVOT = 1  # a pivot is zero to rounding, or a value is not finite
REANALYSE = 2  # the pivots fit the values no longer (or `analyze` was never called)
# and by `analyze`, besides
WANT_ROOM = 3  # there is too little: `needs` says how much there must be

# kinds
UNREADY, DENSE, PROGRAM, BY_COLUMNS = range(4)
MATRIX_KINDS = ("unready", "dense", "program", "columns")

# An entry of L may grow by this factor over the largest of its column at analysis, at least over what is 1 once the
# rows are balanced.
MOST_PIVOT_GROWTH = 1e5

LU = np.dtype(
    [
        (name, np.int64)
        for name in (
            "n", "nnz",
            "kind", "ordered", "ready",  # one of the above; 1: the columns have an order; 1: there are pivots
            "functions",   # address of FUNCTION_COUNT machine addresses
            "factor_function", "solve_function",  # those of this kind
            "row", "col", "slot",  # (nnz,) int64: place of each entry, and its position in the source array
            "entry_to",    # (nnz,) uint32: position of each matrix entry in `values`
            "entry_from",  # (nnz,) uint32: its position in the source array
            "index", "index_room",  # memory for all tables of uint32, and how many it can hold
            "values",      # dense: (n, n) rows, then (n,) 1/pivot
                           # sparse: (nl,) L, (nu,) U, (n,) 1/pivot, (n,) largest |L| allowed in the column
            "room",        # its length
            "work",        # (n,) float64
            "row_unit",    # (n,) float64: what brings the rows to one unit, for the choice of pivots
            "col_unit",    # (n,) float64, as row_unit
            "pivots",      # (n,) int64, dense: row of the matrix at each pivot
            # sparse: of the pattern, by columns in the order of the pivots
            "order", "column_start", "column_row", "column_of", "column_slot",
            "perm_r", "wanted",  # (n,) int64: place of each row in the pivot sequence: now, and as just chosen
            "scratch",     # address of (address, numbers) of the scratch of all that is chosen and written down
            "needs",       # (3,) int64: room that `index`, `values` and the scratch must have
            "program_limit",
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

INDEX, VALUES, SCRATCH = range(3)
"""Entries of `needs`."""
PROGRAM_LIMIT = 4
"""The list of operations is written down while it is at most this many times the fill. Measured: 1.2-1.5 times faster
than by columns for chains (1.1 operations an entry), 1.2-1.7 times slower for spring grids (10-30)."""
IN_INDEX = (
    "entry_to", "entry_from", "l_start", "u_start", "l_row", "l_col", "u_row", "u_col", "row_at", "col_at",
    "step_start", "step_to", "step_left", "step_right", "sum_start", "sum_left", "sum_right",
)  # fmt: skip
"""Fields that point into `index`."""
FUNCTION_COUNT = 10
"""factor and solve of each kind, in their order; `analyze_sparse`; one that is free."""
ANALYZE_SPARSE = 8

FACTOR_SIGNATURE = types.int64(LU_TYPE, types.int64)
SOLVE_SIGNATURE = types.void(LU_TYPE, types.int64)

lu_at = record_view(LU_TYPE)
"""lu_at(address): the LU record at `Factorization.address`, for records that store the address of another."""
