"""Every method on every scenario: cost at equal error, error at equal cost, and why a pair has no figure."""

from .measure import QUICK, Sweep
from .records import MatrixRun, Pair, ReferenceFigures
from .runner import MethodMatrix, method_matrix

__all__ = ["QUICK", "MatrixRun", "MethodMatrix", "Pair", "ReferenceFigures", "Sweep", "method_matrix"]
