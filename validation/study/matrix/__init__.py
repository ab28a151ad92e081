"""Every method on every scenario: cost at equal error, error at equal cost, and why a pair has no figure."""

from .records import MatrixRun, Pair, ReferenceFigures
from .runner import MethodMatrix, Sweep, method_matrix

__all__ = ["MatrixRun", "MethodMatrix", "Pair", "ReferenceFigures", "Sweep", "method_matrix"]
