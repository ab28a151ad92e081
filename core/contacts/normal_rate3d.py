"""How the rate of a contact's normal changes with the coordinates: of spheres, and of segments at their nearest points.

n = d/|d|, n' = (D - n (n.D))/|d|, D the rate of d. Of spheres D is that of the markers' points, d'. Of segments along
the unit vectors a and b the points move along them too, D = d' + t' b - s' a, as fast as a.d = b.d = 0 says:
    (a.a) s' - (a.b) t' = a'.d + a.d' = X    (b.b) t' - (a.b) s' = -(b'.d + b.d') = -Y
for those of them that are free (`moving_point3d.py`). Here that is differentiated once more.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..elements.measure3d import AXES_A, AXES_B, POINT_A, POINT_B, offset
from ..model.rotation3d import along, constant, dot, four, less, plus, times, turned, turning
from .moving_point3d import CROSSED, MOVED_POINT, SEGMENTS
from .normal3d import PAIR_SIZE
from .tangent3d import NORMAL, OFFSET, column, product_with, put

ZERO = (0.0, 0.0, 0.0)


@internal
def turn_normal(
    kind: int, b: Any, coord: Any, pair: Any, moves: Any, work: Any, n: Any, n_rate: Any, turns: Any
) -> None:
    """Derivatives of n' by the coordinates, to turns (3, 14), of a pair of shapes whose points are held."""
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    p, s, pd, sd = (
        four(q, coord, 3, pair[0]),
        four(q, coord, 10, pair[1]),
        four(v, coord, 3, 0.0),
        four(v, coord, 10, 0.0),
    )
    d, _, _ = offset(q, coord, pair, p, s)
    square = dot(d, d)
    # between spheres in spheres with one centre no direction is the normal
    one = dot(n, d) / square if square > 0.0 else 0.0
    rate_u, rate_w = turning(pd, constant(pair, POINT_A)), turning(sd, constant(pair, POINT_B))
    of_a, of_b = turning(p, constant(pair, AXES_A + 6)), turning(s, constant(pair, AXES_B + 6))
    rate_of_a, rate_of_b = turning(pd, constant(pair, AXES_A + 6)), turning(sd, constant(pair, AXES_B + 6))
    a, to, a_rate, to_rate = turned(of_a, p), turned(of_b, s), along(of_a, pd), along(of_b, sd)
    held, s_rate, t_rate, free_a, free_b = product_with(work, OFFSET, v, coord), 0.0, 0.0, False, False
    if kind == SEGMENTS or kind == CROSSED:
        for j in range(PAIR_SIZE):
            s_rate += moves[MOVED_POINT, j] * v[coord[j]]
            t_rate += moves[MOVED_POINT + 1, j] * v[coord[j]]
            free_a, free_b = free_a or moves[MOVED_POINT, j] != 0.0, free_b or moves[MOVED_POINT + 1, j] != 0.0
    goes = plus(held, less(times(t_rate, to), times(s_rate, a)))
    aa, bb, c = dot(a, a), dot(to, to), dot(a, to)
    for j in range(PAIR_SIZE):
        local, by_n, apart, change = j % 7 - 3, column(work, NORMAL, j), column(work, OFFSET, j), ZERO
        a_turns, b_turns, a_bends, b_bends = ZERO, ZERO, ZERO, ZERO
        if local >= 0 and j < 7:
            change, a_turns, a_bends = times(-1.0, rate_u[local]), of_a[local], rate_of_a[local]
        elif local >= 0:
            change, b_turns, b_bends = rate_w[local], of_b[local], rate_of_b[local]
        if free_a or free_b:
            ds, dt = moves[MOVED_POINT, j], moves[MOVED_POINT + 1, j]
            apart = plus(apart, less(times(dt, to), times(ds, a)))
            change = plus(change, less(times(dt, to_rate), times(ds, a_rate)))
            by_c = dot(a_turns, to) + dot(a, b_turns)
            x = dot(a_bends, d) + dot(a_rate, apart) + dot(a_turns, held) + dot(a, change)
            y = dot(b_bends, d) + dot(to_rate, apart) + dot(b_turns, held) + dot(to, change)
            x -= 2.0 * dot(a, a_turns) * s_rate - by_c * t_rate
            y += 2.0 * dot(to, b_turns) * t_rate - by_c * s_rate
            if free_a and free_b:
                s_turns, t_turns = (bb * x - c * y) / (aa * bb - c * c), (c * x - aa * y) / (aa * bb - c * c)
            else:
                s_turns, t_turns = (x / aa, 0.0) if free_a else (0.0, -y / bb)
            change = plus(change, plus(times(t_turns, to), times(t_rate, b_turns)))
            change = less(change, plus(times(s_turns, a), times(s_rate, a_turns)))
        by = less(change, plus(times(dot(n, goes), by_n), times(dot(by_n, goes) + dot(n, change), n)))
        put(turns, 0, j, times(one, less(by, times(dot(n, apart), n_rate))))
