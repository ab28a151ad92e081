"""Which of the touching contacts stay closed: those that press, and some that carry nothing."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..state.modes import CLOSED
from .loaded import is_loaded
from .reading import comes_back
from .records import SETTLED, call_part, clear, scalars, touching
from .touching import free_jerks, looks_again

CLOSES_FROM, CLOSES_TO = 3, 12
"""Looks at one instant in which contacts that carry nothing close. Before, they stay as they are; after, those that
have pulled by rounding stay open, or some would open and others close in turns: bodies that fall side by side."""


@internal
def choose(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Which contacts stay closed, to `closes`."""
    contact = touching(instant)
    count, closes, now = scalars(instant).count, vec(instant.closes, instant.most), scalars(instant).struck == 0
    clear(closes, count)
    rests = False
    for i in range(count):
        rests = rests or vec(instant.at_rest, instant.most)[i] != 0.0
    if not rests:
        return SETTLED
    status = call_part(instant.find_forces, instant, drive, workspace, method)
    if status != SETTLED:
        return status
    idle, none = False, scalars(instant).no_acceleration
    for i in range(count):
        closes[i] = is_loaded(instant, i)
        leaves = contact[i].opens != 0.0
        if (
            now
            and contact[i].mode_before == CLOSED
            and not leaves
            and abs(contact[i].gap_acceleration) <= none * contact[i].gradient_size
        ):
            # touching without force: as it was
            closes[i] = 1.0
        idle = idle or (vec(instant.at_rest, instant.most)[i] != 0.0 and closes[i] == 0.0 and not leaves)
    if idle:
        _close_idle(instant, drive, workspace, closes)
    return SETTLED


@internal
def _close_idle(instant: Any, drive: Any, workspace: Any, closes: Any) -> None:
    """Contacts that carry nothing close where they would come back, or where every step closes them at once."""
    contact = touching(instant)
    jerks, contacts, none = (
        vec(instant.jerks, instant.most),
        ivec(instant.contacts, instant.most),
        scalars(instant).no_acceleration,
    )
    free_jerks(instant, workspace, jerks)
    for i in range(scalars(instant).count):
        if vec(instant.at_rest, instant.most)[i] == 0.0 or closes[i] != 0.0 or contact[i].opens != 0.0:
            continue
        motion = contact[i].gap_acceleration
        # nothing presses it, or others carry all: a table on two feet in balance, whose third one touches
        again = abs(motion) <= none * contact[i].gradient_size and CLOSES_FROM <= looks_again(drive) <= CLOSES_TO
        if again or comes_back(workspace, contacts[i], jerks[i], motion):
            closes[i] = 1.0
