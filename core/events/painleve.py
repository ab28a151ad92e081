"""Painleve's paradox at an instant: friction that turns the effect of a normal force round."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec
from ..rounding import NEARLY_JAMMED
from ..state.modes import CLOSED
from .rates import masses
from .records import (
    COS_WAY,
    COUNT,
    DIRECTION,
    F_N,
    JAMS,
    KINETIC,
    SETTLED,
    SIN_WAY,
    WAS,
    WHO,
    col,
    whole,
)


@internal
def _jams(ev: Any, ws: Any, i: int) -> bool:
    """True if sliding friction of contact i leaves next to nothing of its inverse mass along the normal: along the way
    in which it slides, of one that does not whichever way is worst."""
    count, way = whole(ev)[COUNT], col(ev, DIRECTION)[i]
    a = masses(ev, count)
    own, first, second = a[i, i], a[i, count + i], a[i, 2 * count + i]
    along = first * col(ev, COS_WAY)[i] + second * col(ev, SIN_WAY)[i]
    turned = along if way != 0.0 else math.sqrt(first * first + second * second)
    return col(ev, KINETIC)[i] > 0.0 and own - col(ev, KINETIC)[i] * turned <= NEARLY_JAMMED * own


@internal
def name_jammed(ev: Any, ws: Any) -> None:
    """Whose friction alone may be why there are no forces, to `WHO`; -1: none's."""
    whole(ev)[WHO] = -1
    for i in range(whole(ev)[COUNT] - 1, -1, -1):
        if _jams(ev, ws, i):
            whole(ev)[WHO] = ivec(ev.contacts, ev.most)[i]


@internal
def refuse_jam(ev: Any, ws: Any) -> int:
    """JAMS, with its number in `WHO`, if a contact that slides and presses does; else SETTLED."""
    for i in range(whole(ev)[COUNT]):
        pressed = col(ev, F_N)[i] > 0.0 or col(ev, WAS)[i] == CLOSED
        if col(ev, DIRECTION)[i] != 0.0 and pressed and _jams(ev, ws, i):
            whole(ev)[WHO] = ivec(ev.contacts, ev.most)[i]
            return JAMS
    return SETTLED
