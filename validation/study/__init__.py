"""The method study: observed orders, and iterations against achieved error, with verdicts on the papers' claims."""

from .cases import Setting, contenders, order_cases
from .claims import Claim
from .iterations import IterationStudy, iteration_study
from .orders import OrderRow, order_table
from .runs import Run
from .swing import Swing

__all__ = [
    "Claim",
    "IterationStudy",
    "OrderRow",
    "Run",
    "Setting",
    "Swing",
    "contenders",
    "iteration_study",
    "order_cases",
    "order_table",
]
