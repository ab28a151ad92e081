"""Surfaces in space that move past the bodies that carry them (`moving_surface.py`): w = f(t) A d in each point, d a
direction of the body, whose part along the normal friction does not see. One of the second shape has f with the other
sign: it is taken off the motion of the second shape on the first."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import imat, vec
from ..model.rotation3d import constant, dot, less, plus, times, turns
from .moving_surface import CARRIER, DIRECTION, SURFACE, moves, put_in, surface_speed
from .tangent3d import U, column, put

FIRST_ATTITUDE, SECOND_ATTITUDE = 3, 10
"""Where the Euler parameters of the first body and of the second one are among the coordinates."""
ZERO = (0.0, 0.0, 0.0)


@internal
def _turning_direction(b: Any, e: int, coord: Any, pair: Any) -> Any:
    """(place of the Euler parameters, columns of the direction's turning, direction and its rate) of the surface of
    element e of a batch, which moves."""
    at, pool = imat(b.extra, b.count, b.nextra)[e, SURFACE] - 1, vec(b.signals, b.n_signals)
    first = int(pool[at + CARRIER])
    rest = pair[0] if first == FIRST_ATTITUDE else pair[1]
    columns, d, d_rate, _ = turns(b, coord, first, rest, constant(pool, at + DIRECTION))
    return first, columns, d, d_rate


@internal
def pass_surface(b: Any, e: int, t: float, coord: Any, pair: Any, u: Any, u_rate: Any) -> Any:
    """(sliding velocity, its rate) of element e of a batch whose shapes move on each other with u."""
    if not moves(b, e):
        return u, u_rate
    f, df = surface_speed(b, e, t)
    _, _, d, d_rate = _turning_direction(b, e, coord, pair)
    return less(u, times(f, d)), less(u_rate, plus(times(df, d), times(f, d_rate)))


@internal
def pass_surface_in(b: Any, e: int, t: float, coord: Any, pair: Any, u: Any, work: Any) -> Any:
    """(sliding velocity, what its rate has besides W a + U v, velocity of the surface) of the same; U, its derivatives
    by the coordinates, are those in `work` (`tangent3d.py`)."""
    if not moves(b, e):
        return u, ZERO, ZERO
    f, df = surface_speed(b, e, t)
    first, columns, d, _ = _turning_direction(b, e, coord, pair)
    for j in range(4):
        put(work, U, first + j, less(column(work, U, first + j), times(f, columns[j])))
    w = times(f, d)
    return less(u, w), times(-df, d), w


@internal
def put_in_along(b: Any, e: int, pull: Any, w: Any) -> None:
    """The power of a surface with velocity w on which the force `pull` acts against it, and on the other shape."""
    put_in(b, e, dot(pull, w))
