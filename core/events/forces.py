"""The problems of an instant, as those of `cones/cones.py` and `cones/directions.py`."""

from typing import Any

from ..compiled.jit import internal, record_view
from ..compiled.views import ivec, mat, vec
from ..cones.cones import CONES_TYPE, NONE, SOLVED, STICKS, call_cones
from ..cones.directions import call_farthest, call_independent
from ..linalg.small import call_least_norm
from ..rounding import DIRECTION_RANK
from .records import (
    AT_REST,
    B_N,
    B_T,
    BASE,
    COUNT,
    F_N,
    F_T,
    KINETIC,
    KNOWN,
    NOW_N,
    NOW_T,
    PART,
    RATE,
    RIGHT_N,
    RIGHT_T,
    SLIDE_RATE,
    STATIC,
    W_N,
    W_T,
    col,
    delassus,
    whole,
)
from .records import STICKS as ALL_STICK

NO_SOLUTION = False
SPEED = 1e3
"""Of the largest free acceleration: no force that keeps contacts closed makes a motion of that size."""
STOPPED = 1e-3
"""Of that speed: what is left of one that friction has stopped."""
cones_at = record_view(CONES_TYPE)


@internal
def _pose(ev: Any, count: int, takes: Any, b_n: Any, b_t: Any) -> int:
    """Inverse masses and motion of the contacts that take part, to the record of the problem; their number."""
    cn, some, n = cones_at(ev.cones), ivec(ev.some, 2 * ev.most), 0
    for i in range(count):
        if takes[i] != 0.0:
            some[n] = i
            n += 1
    cn.n = n
    a, nn, nt, tt = delassus(ev, count), mat(cn.nn, n, n), mat(cn.nt, n, n), mat(cn.tt, n, n)
    for i in range(n):
        p = some[i]
        for j in range(n):
            q = some[j]
            nn[i, j], nt[i, j], tt[i, j] = a[p, q], a[p, count + q], a[count + p, count + q]
        vec(cn.b_n, n)[i], vec(cn.b_t, n)[i], vec(cn.base, n)[i] = b_n[p], b_t[p], 0.0
    return n


@internal
def among(ev: Any, count: int, takes: Any, direction: Any, slides: Any) -> bool:
    """Forces `F_N`, `F_T` of the contacts `takes`, with the motion `W_N`, `W_T` of all; the others get none. Friction
    has the direction `direction` where that is not 0, with the kinetic coefficient where `slides` is not 0."""
    f_n, f_t, w_n, w_t, b_n, b_t = (
        col(ev, F_N), col(ev, F_T), col(ev, W_N), col(ev, W_T), col(ev, B_N), col(ev, B_T)
    )  # fmt: skip
    n, cn, some = _pose(ev, count, takes, b_n, b_t), cones_at(ev.cones), ivec(ev.some, 2 * ev.most)
    for i in range(n):
        p = some[i]
        vec(cn.mu, n)[i] = col(ev, KINETIC)[p] if slides[p] != 0.0 else col(ev, STATIC)[p]
        vec(cn.direction, n)[i] = direction[p]
    status = call_cones(ev.solve_cones, cn)
    if status == NONE:
        status = _with_speeds(ev, cn, n)
    if status == NONE:
        return NO_SOLUTION
    whole(ev)[ALL_STICK] = 1 if status == STICKS else 0
    for i in range(count):
        f_n[i] = f_t[i] = 0.0
    for i in range(n):
        f_n[some[i]], f_t[some[i]] = vec(cn.normal, n)[i], vec(cn.tangential, n)[i]
    a = delassus(ev, count)
    for i in range(count):
        along, across = 0.0, 0.0
        for j in range(count):
            along += a[i, j] * f_n[j] + a[i, count + j] * f_t[j]
            across += a[count + i, j] * f_n[j] + a[count + i, count + j] * f_t[j]
        w_n[i], w_t[i] = b_n[i] + along, b_t[i] + across
    return not NO_SOLUTION


@internal
def _with_speeds(ev: Any, cn: Any, n: int) -> int:
    """The same problem with its directions of sliding as speeds, so large that no force turns them round: friction then
    takes what it can of any motion, which finds forces where fixed directions lead nowhere. NONE where it stops one of
    them after all."""
    direction, b_n, b_t, largest, some = vec(cn.direction, n), vec(cn.b_n, n), vec(cn.b_t, n), 0.0, False
    for i in range(n):
        largest, some = max(largest, abs(b_n[i]), abs(b_t[i])), some or direction[i] != 0.0
    if not some:
        return NONE
    ways = ivec(ev.chosen, n)
    for i in range(n):
        ways[i] = int(direction[i])
        b_t[i] += SPEED * largest * direction[i]
        direction[i] = 0.0
    if call_cones(ev.solve_cones, cn) == NONE:
        return NONE
    for i in range(n):
        if ways[i] != 0 and not vec(cn.tangential_motion, n)[i] * ways[i] > STOPPED * SPEED * largest:
            return NONE
    return SOLVED


@internal
def impulses_among(ev: Any, count: int) -> bool:
    """Impulses `NOW_N`, `NOW_T` of the contacts `PART` from the motion `RIGHT_N`, `RIGHT_T`, at least `BASE`."""
    n = _pose(ev, count, col(ev, PART), col(ev, RIGHT_N), col(ev, RIGHT_T))
    cn, some = cones_at(ev.cones), ivec(ev.some, 2 * ev.most)
    for i in range(n):
        p = some[i]
        vec(cn.mu, n)[i], vec(cn.direction, n)[i], vec(cn.base, n)[i] = col(ev, KINETIC)[p], 0.0, col(ev, BASE)[p]
    if call_cones(ev.solve_cones, cn) == NONE:
        return NO_SOLUTION
    for i in range(count):
        col(ev, NOW_N)[i] = col(ev, NOW_T)[i] = 0.0
    for i in range(n):
        col(ev, NOW_N)[some[i]], col(ev, NOW_T)[some[i]] = vec(cn.normal, n)[i], vec(cn.tangential, n)[i]
    return not NO_SOLUTION


@internal
def independent_of(ev: Any, ws: Any, blocks: int, number: int, rank: float) -> int:
    """Positions of those of the first `number` directions in `some` that do not repeat earlier ones, to `chosen`; their
    number. Directions come in 2 or 3 `blocks` (normals, tangents). `rank` 0: that of forces."""
    rows = blocks * whole(ev)[COUNT]
    directions, responses = mat(ev.directions, rows, ws.n), mat(ev.responses, rows, ws.n)
    work, least = vec(ev.work, ev.work_size), rank if rank > 0.0 else DIRECTION_RANK
    chosen = ivec(ev.chosen, blocks * ev.most)
    return int(call_independent(ev.independent, directions, responses, ivec(ev.some, number), least, chosen, work))


@internal
def farthest_of(ev: Any, count: int, number: int) -> int:
    """Those of the first `number` contacts in `some` whose normals do not repeat others, to `chosen`; their number."""
    chosen, work = ivec(ev.chosen, 2 * ev.most), vec(ev.work, ev.work_size)
    return int(call_farthest(ev.farthest, delassus(ev, count), ivec(ev.some, number), chosen, work))


@internal
def remove_rates(ev: Any, normal: Any, along: Any) -> None:
    """Impulses that take away the rates of the contacts at rest, the least of them."""
    count, some, n, stuck, cn = whole(ev)[COUNT], ivec(ev.some, 2 * ev.most), 0, 0, cones_at(ev.cones)
    for i in range(count):
        normal[i] = along[i] = 0.0
        if col(ev, AT_REST)[i] != 0.0:
            some[n] = i
            n += 1
    for i in range(count):
        if col(ev, AT_REST)[i] != 0.0 and col(ev, STATIC)[i] > 0.0 and col(ev, KNOWN)[i] == 0.0:
            some[n + stuck] = count + i
            stuck += 1
    a, size = delassus(ev, count), n + stuck
    matrix, rates = mat(ev.matrix, size, size), mat(ev.matrix + 8 * size * size, size, 1)
    found = mat(ev.matrix + 8 * size * (size + 1), size, 1)
    for i in range(size):
        p = some[i]
        rates[i, 0] = -col(ev, RATE)[p] if p < count else -col(ev, SLIDE_RATE)[p - count]
        for j in range(size):
            matrix[i, j] = a[p, some[j]]
    call_least_norm(cn.least_norm, matrix, rates, found, DIRECTION_RANK, ev.work)
    for i in range(size):
        if some[i] < count:
            normal[some[i]] = found[i, 0]
        else:
            along[some[i] - count] = found[i, 0]
