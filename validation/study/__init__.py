"""The method study: observed orders, and iterations against achieved error, with verdicts on the papers' claims."""

from .cases import Setting, contenders, order_cases
from .claim_table import ClaimRow, claim_table
from .claims import Claim
from .contact_claim import fourth_claim
from .contact_failure import ContactRow, contact_study
from .coupling import CouplingStudy, coupling_study
from .damping import DampingRow, damping_study, fifth_claim
from .impact_orders import ImpactOrderRow, impact_orders
from .iterations import IterationStudy, iteration_study
from .matrix import MethodMatrix, method_matrix
from .orders import OrderRow, order_table
from .runs import Run
from .stiffness import CASES as STIFFNESS_CASES
from .stiffness import StiffnessRow, stiffness_study
from .swing import Swing

__all__ = [
    "STIFFNESS_CASES",
    "Claim",
    "ClaimRow",
    "ContactRow",
    "CouplingStudy",
    "DampingRow",
    "ImpactOrderRow",
    "IterationStudy",
    "MethodMatrix",
    "OrderRow",
    "Run",
    "Setting",
    "StiffnessRow",
    "Swing",
    "claim_table",
    "contact_study",
    "contenders",
    "coupling_study",
    "damping_study",
    "fifth_claim",
    "fourth_claim",
    "impact_orders",
    "iteration_study",
    "method_matrix",
    "order_cases",
    "order_table",
    "stiffness_study",
]
