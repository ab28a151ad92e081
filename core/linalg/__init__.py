"""Linear solver for square matrices of one pattern and changing values, for use inside compiled loops."""

from .analyze import analyze, follow
from .determinant import determinant_sign
from .errors import SingularMatrixError
from .factorization import DENSE_LIMIT, Factorization, Matrix
from .record import LU, LU_TYPE, NO_PIVOT, OK, REANALYSE, lu_at
from .row_pivoting import RowPivots, independent_columns, pivot_rows
from .solve import factor, solve

__all__ = [
    "DENSE_LIMIT",
    "LU",
    "LU_TYPE",
    "NO_PIVOT",
    "OK",
    "REANALYSE",
    "Factorization",
    "Matrix",
    "RowPivots",
    "SingularMatrixError",
    "analyze",
    "determinant_sign",
    "factor",
    "follow",
    "independent_columns",
    "lu_at",
    "pivot_rows",
    "solve",
]
