"""How many contacts a contact element has on both sides, and why a difference in that may tell nothing."""

from typing import TYPE_CHECKING

import numpy as np

from ..exudyn_run import ExudynResult
from ..metrics import ContactInterval, contact_intervals
from .common import Row, Touch, touches

if TYPE_CHECKING:
    from .force_rows import Sides

RESOLVED = 10.0
"""exudyn's steps that a contact must take to be one for certain."""


def contact_count(sides: "Sides", contact: str) -> list[Row]:
    """A row if the first contact of a contact element is not in all of exudyn's runs as one, from touch to release;
    otherwise none: then its figures are compared."""
    until = min(float(r.t[-1]) for r in sides.levels.runs)
    mine = [touch for touch in sides.found if touch.contact == contact]
    first = mine[0]
    theirs = [_intervals(run, contact) for run in sides.levels.runs]
    whole = [bool(x) and x[0].end is not None and not _pieces(x, mine) for x in theirs]
    if all(whole):
        return []
    if first.end > until:
        doubt = f"exudyn's run ends at {until:.5g} s, before the first contact of '{contact}' does at {first.end:.5g} s"
        return [Row(f"{contact}: contacts that end before exudyn's run", "1", 1.0, 0.0, 0.0, "absolute", doubt=doubt)]
    counts = float(sum(touch.end <= until for touch in mine)), float(sum(x.end is not None for x in theirs[-1]))
    title = f"{contact}: contacts up to {until:.5g} s"
    return [Row(title, "1", *counts, 0.0, "absolute", doubt=_doubt(sides, contact, mine, theirs))]


def _intervals(run: ExudynResult, contact: str) -> list[ContactInterval]:
    return contact_intervals(run.t, run[f"{contact}.gap"], run[f"{contact}.gap_rate"])


def _pieces(theirs: list[ContactInterval], mine: list[Touch]) -> bool:
    """Whether exudyn's first contact is followed at once by another where ours is one."""
    first, second = mine[0], mine[1].start if len(mine) > 1 else np.inf
    lasting = first.end - first.start
    until = min(first.end + 0.5 * lasting, second - 0.5 * max(0.0, second - first.end))
    return sum(first.start - 0.5 * lasting < x.start < until for x in theirs) > 1


def _doubt(sides: "Sides", contact: str, mine: list[Touch], theirs: list[list[ContactInterval]]) -> str:
    """Why the contacts of a contact element are not counted alike; empty if that is one of the models."""
    runs, first = sides.levels.runs, mine[0]
    numbers = [len(x) for x in theirs]
    if len(set(numbers)) > 1:
        return f"how many contacts of '{contact}' exudyn has depends on its step: {', '.join(map(str, numbers))}"
    if any(x and x[0].end is None for x in theirs):
        return f"the first contact of '{contact}' is not over when exudyn's run ends"
    if any(_pieces(x, mine) for x in theirs):
        return f"exudyn has the first contact of '{contact}' in pieces, where ours is one"
    loose = [touch for touch in touches(sides.loose.events) if touch.contact == contact]
    if len(loose) != len(mine):
        return f"how many contacts of '{contact}' there are depends on our tolerance: {len(mine)}, {len(loose)}"
    if first.end - first.start < RESOLVED * runs[-1].step:
        return f"the first contact of '{contact}' takes {first.end - first.start:.1e} s, few of exudyn's steps"
    near = (sides.ours.t >= first.start) & (sides.ours.t <= first.end)
    depth = -float(np.min(sides.ours[f"{contact}.gap"][near], initial=0.0))
    at = np.array([first.start])
    gaps = [float(np.interp(at, r.t, r[f"{contact}.gap"])[0]) for r in runs]
    if depth < 3.0 * (max(gaps) - min(gaps)):
        return (
            f"the first contact of '{contact}' grazes, {depth:.1e} m deep: less than what exudyn's step moves the gap"
        )
    return ""
