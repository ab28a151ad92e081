"""Friction with three tangents, that of spherical joints, at an instant.

Two contacts have a part each (`contacts/spherical_friction3d.py`): the first one two of the tangents, its companion,
which is the next one, the third, and a second one that nothing moves. Both have the same load, and do the same. So what
is asked of both tangents of a contact is asked of those of both: the size of the friction, of the sliding velocity, and
the direction. `companion` says how far on the other one stands, 1 or -1; 0 of all other contacts.

Where both are at rest their frames, (`direction_cos`, `direction_sin`) of each, are a turn about the third axis and
one about the first tangent after it: as in the plane the second tangent is along a friction at its limit.
"""

import math
from typing import Any

from ..compiled.jit import internal
from .records import touching


@internal
def size_of(instant: Any, i: int, first: Any, second: Any) -> float:
    """Size of what stands along the tangents of touching contact i in these columns, with those of its companion."""
    square, other = first[i] * first[i] + second[i] * second[i], i + int(touching(instant)[i].companion)
    if other != i:
        square += first[other] * first[other] + second[other] * second[other]
    return math.sqrt(square)


@internal
def first_of(instant: Any, i: int) -> int:
    """The one that has two of three tangents, of it and its companion; other contacts themselves."""
    return i - 1 if touching(instant)[i].companion < 0.0 else i


@internal
def turn_frame(instant: Any, i: int, first: Any, second: Any, full: bool) -> None:
    """The frame of contact i, which has a companion or is one, for the friction in these columns, if that is `full`."""
    own = first_of(instant, i)
    x, y, z = first[own], second[own], first[own + 1]
    across = math.sqrt(x * x + y * y)
    size = math.sqrt(across * across + z * z)
    c, s = (y / across, -x / across) if full and across > 0.0 else (1.0, 0.0)
    level, lean = (across / size, z / size) if full and size > 0.0 else (1.0, 0.0)
    touching(instant)[i].direction_cos, touching(instant)[i].direction_sin = (c, s) if i == own else (level, lean)


@internal
def axis_in_frame(instant: Any, own: int, row: int) -> Any:
    """Along the tangents of `own` and the first one of its companion: the first tangent (0) of the frame, the second
    one (1), and the first one of the companion (2)."""
    contact = touching(instant)
    c, s = contact[own].direction_cos, contact[own].direction_sin
    level, lean = contact[own + 1].direction_cos, contact[own + 1].direction_sin
    if row == 0:
        return c, s, 0.0
    return (-s * level, c * level, lean) if row == 1 else (s * lean, -c * lean, level)
