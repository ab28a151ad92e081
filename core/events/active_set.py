"""Which of the touching contacts stay closed: those that press, and some that carry nothing."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import FORCE_AT_EVENT, PRESSING
from ..state.modes import CLOSED, OPEN
from .loaded import is_loaded
from .reading import comes_back
from .records import SETTLED, call_part, clear, scalars, touching
from .three_tangents import size_of
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
    idle, none, least = False, scalars(instant).no_acceleration, _least_force(instant) if now else 0.0
    for i in range(count):
        unasked = (
            contact[i].mode_before == OPEN
            and ivec(drive.pending, workspace.n_contacts)[ivec(instant.contacts, instant.most)[i]] == 0
        )
        closes[i] = is_loaded(instant, i) and not (unasked and contact[i].normal_force < least)
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
    _slide_unloaded(instant, workspace, closes)
    return SETTLED


@internal
def _least_force(instant: Any) -> float:
    """Force from which on contacts close that were open and have no event of their own, N: 0 unless another one opens
    since its force has come to zero. That event is known as well as its time, and so are forces without it."""
    leaves, largest = False, 0.0
    for i in range(scalars(instant).count):
        leaves, largest = leaves or touching(instant)[i].opens != 0.0, max(largest, touching(instant)[i].normal_force)
    return FORCE_AT_EVENT * largest if leaves else 0.0


@internal
def _slide_unloaded(instant: Any, workspace: Any, closes: Any) -> None:
    """Contacts that stay closed without force begin to slide where nothing holds them: no friction does."""
    contact = touching(instant)
    fastest, direction = 0.0, vec(instant.slides, instant.most)
    for i in range(scalars(instant).count):
        fastest = max(
            fastest,
            abs(contact[i].free_gap_acceleration),
            abs(contact[i].free_sliding_acceleration),
            abs(contact[i].free_sliding_acceleration2),
        )
    for i in range(scalars(instant).count):
        free = contact[i].static_friction > 0.0 and direction[i] == 0.0 and contact[i].normal_force == 0.0
        x, y, speed = (
            contact[i].sliding_acceleration,
            contact[i].sliding_acceleration2,
            size_of(instant, i, contact.sliding_acceleration, contact.sliding_acceleration2),
        )
        if free and closes[i] != 0.0 and speed > PRESSING * fastest:
            direction[i] = 1.0
            contact[i].direction_cos, contact[i].direction_sin = x / speed, y / speed


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
