"""Painleve's paradox at an instant: friction that turns the effect of a normal force round."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import NEARLY_JAMMED
from ..state.modes import CLOSED
from .rates import masses
from .records import JAMS, SETTLED, scalars, touching


@internal
def _jams(instant: Any, workspace: Any, i: int) -> bool:
    """True if sliding friction of contact i leaves next to nothing of its inverse mass along the normal: along the way
    in which it slides, of one that does not whichever way is worst."""
    contact = touching(instant)
    count, way = scalars(instant).count, vec(instant.slides, instant.most)[i]
    a = masses(instant, count)
    own, first, second = a[i, i], a[i, count + i], a[i, 2 * count + i]
    along = first * contact[i].direction_cos + second * contact[i].direction_sin
    turned = along if way != 0.0 else math.sqrt(first * first + second * second)
    return contact[i].kinetic_friction > 0.0 and own - contact[i].kinetic_friction * turned <= NEARLY_JAMMED * own


@internal
def name_jammed(instant: Any, workspace: Any) -> None:
    """Whose friction alone may be why there are no forces, to `WHO`; -1: none's."""
    scalars(instant).failed_contact = -1
    for i in range(scalars(instant).count - 1, -1, -1):
        if _jams(instant, workspace, i):
            scalars(instant).failed_contact = ivec(instant.contacts, instant.most)[i]


@internal
def refuse_jam(instant: Any, workspace: Any) -> int:
    """JAMS, with its number in `WHO`, if a contact that slides and presses does; else SETTLED."""
    for i in range(scalars(instant).count):
        pressed = touching(instant)[i].normal_force > 0.0 or touching(instant)[i].mode_before == CLOSED
        if vec(instant.slides, instant.most)[i] != 0.0 and pressed and _jams(instant, workspace, i):
            scalars(instant).failed_contact = ivec(instant.contacts, instant.most)[i]
            return JAMS
    return SETTLED
