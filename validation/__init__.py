"""Validation: any model rerun in exudyn, cross-check metrics with verdicts, reports.

exudyn, matplotlib and jinja2 are imported only by the functions that need them.
"""

from .cases import Case, cases
from .catalogue import CatalogueCheck, Outcome, crosscheck_all, run_case
from .comparisons.common import Row
from .crosscheck import CrossCheck, crosscheck
from .errors import ExudynFailed, ExudynUnavailable, NotTranslatable
from .exchange import as_cables
from .exudyn_import import exudyn_available
from .exudyn_model import build_exudyn_model
from .exudyn_run import ExudynResult, ExudynSettings, run_exudyn

__all__ = [
    "Case",
    "CatalogueCheck",
    "CrossCheck",
    "ExudynFailed",
    "ExudynResult",
    "ExudynSettings",
    "ExudynUnavailable",
    "NotTranslatable",
    "Outcome",
    "Row",
    "as_cables",
    "build_exudyn_model",
    "cases",
    "crosscheck",
    "crosscheck_all",
    "exudyn_available",
    "run_case",
    "run_exudyn",
]
