"""Where two runs can be compared point by point: away from the events, which exudyn has early or late."""

from collections.abc import Sequence

import numpy as np

from ...core import Event
from ..exudyn_run import ExudynResult

FARTHEST = 0.02
"""Part of the run by which exudyn's contact may begin or end off our event."""


def away_from(t: np.ndarray, events: Sequence[Event], runs: Sequence[ExudynResult], margin: float) -> np.ndarray:
    """Where no event is near: there exudyn's contact takes its time, comes early or late; the constraint takes none."""
    if not events:
        return np.ones(len(t), dtype=bool)
    apart = np.full(len(t), np.inf)
    for event in events:
        near, width = np.abs(t - event.t), margin + _shift(event, runs)
        # contacts that take no time leave out nothing but their instants
        apart = np.minimum(apart, near / width if width > 0.0 else np.where(near > 0.0, np.inf, 0.0))
    kept = apart > 1.0
    return kept if kept.any() else apart >= apart.max()


def _shift(event: Event, runs: Sequence[ExudynResult]) -> float:
    """How far from our event exudyn's contact begins or ends, s; 0 for what its gap does not show."""
    gap = f"{event.contact}.gap"
    if event.kind not in ("impact", "close", "open") or gap not in runs[0].channels:
        return 0.0
    found = []
    for run in runs:
        changes = run.t[np.flatnonzero(np.diff(run[gap] < 0.0))]
        near = np.abs(changes - event.t)
        found.append(float(near.min(initial=FARTHEST * run.t[-1])))
    return min(max(found), FARTHEST * float(runs[0].t[-1]))
