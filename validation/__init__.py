"""Validation: any model rerun in exudyn, cross-check metrics with verdicts, reports.

exudyn, matplotlib and jinja2 are imported only by the functions that need them.
"""

from .comparisons.common import Row
from .crosscheck import CrossCheck, crosscheck
from .errors import ExudynFailed, ExudynUnavailable, NotTranslatable
from .exudyn_import import exudyn_available
from .exudyn_model import build_exudyn_model
from .exudyn_run import ExudynResult, ExudynSettings, run_exudyn

__all__ = [
    "CrossCheck",
    "ExudynFailed",
    "ExudynResult",
    "ExudynSettings",
    "ExudynUnavailable",
    "NotTranslatable",
    "Row",
    "build_exudyn_model",
    "crosscheck",
    "exudyn_available",
    "run_exudyn",
]
