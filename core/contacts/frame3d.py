"""Tangents of a contact in space: two directions across its normal, smooth while the contact lasts.

Angles are counted from an axis of the first shape's marker, less its part along the normal: of a half-space its x axis,
of spheres the one that was farthest from the normal when the contact closed. The first tangent is at
`tangent_angle`, that of sliding or of a friction force where there is one; the second is across both.
"""

import math
from typing import Any

from ..compiled.jit import inlined, internal
from ..elements.measure3d import AXES_A
from ..model.rotation3d import columns_at, constant, cross, dot, less, plus, times
from .moving_point3d import on_plane
from .tangent3d import NORMAL, column, put

T1, T2 = 19, 22
"""Rows of the work matrix behind those of `tangent3d`: derivatives of the tangents."""
FRAME_ROWS = 25


@internal
def farthest_axis(b: Any, coord: Any, pair: Any, kind: int, n: Any) -> int:
    """1, 2 or 3: the axis of the first marker that angles are counted from, if it is chosen now."""
    if on_plane(kind):
        return 1
    found, least = 1, 2.0
    for k in range(3):
        _, z = columns_at(b, coord, 3, pair[0], constant(pair, AXES_A + 3 * k))
        along = abs(dot(n, z))
        if along < least:
            found, least = k + 1, along
    return found


@inlined
def _turn(c: float, s: float, a: Any, b: Any) -> Any:
    return plus(times(c, a), times(s, b))


@internal
def tangents(b: Any, coord: Any, pair: Any, axis: int, angle: float, n: Any, work: Any) -> Any:
    """(t1, t2); their derivatives go to work."""
    of_z, z = columns_at(b, coord, 3, pair[0], constant(pair, AXES_A + 3 * (axis - 1)))
    across = dot(n, z)
    t = less(z, times(across, n))
    size = math.sqrt(dot(t, t))
    e1 = times(1.0 / size, t)
    e2 = cross(n, e1)
    c, s = math.cos(angle), math.sin(angle)
    for j in range(work.shape[1]):
        by_n = column(work, NORMAL, j)
        by_t = times(-1.0, plus(times(across, by_n), times(dot(by_n, z), n)))
        if 3 <= j < 7:
            by_z = of_z[j - 3]
            by_t = plus(by_t, less(by_z, times(dot(n, by_z), n)))
        by_e1 = times(1.0 / size, less(by_t, times(dot(e1, by_t), e1)))
        by_e2 = plus(cross(by_n, e1), cross(n, by_e1))
        put(work, T1, j, _turn(c, s, by_e1, by_e2))
        put(work, T2, j, _turn(-s, c, by_e1, by_e2))
    return _turn(c, s, e1, e2), _turn(-s, c, e1, e2)
