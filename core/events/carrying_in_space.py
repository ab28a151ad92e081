"""Which of the closed contacts with two tangents carry: as `carrying.py`, in its place."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..cones.directions import call_independent
from ..linalg.small import call_least_norm
from ..rounding import REACHES_LIMIT_NOW, STICKS_STILL
from ..state.modes import ALONG, IDLE
from .balance_in_space import BEGINS, balance_in_space
from .forces import cones_at
from .held_in_space import hold
from .moment_in_space import decide_by_moment
from .rates_in_space import masses
from .records import (
    APART,
    B_N,
    B_S,
    B_T,
    CLOSES,
    COS_WAY,
    COUNT,
    DIRECTION,
    F_N,
    F_S,
    F_T,
    FLAG,
    KEPT_DIRECTION,
    KEPT_FULL,
    KEPT_TAKES,
    KNOWN,
    MOMENT,
    NEW_RATIO,
    NEW_SLIDE,
    OLD_RATIO,
    OTHER_N,
    OTHER_T,
    OTHER_WN,
    RANK,
    SETTLED,
    SIN_WAY,
    SLID,
    STATIC,
    W_N,
    W_S,
    W_T,
    clear,
    col,
    copy,
    real,
    whole,
)

HOLDS = 1e-6
"""Of the largest free acceleration: how fast a gap may close that is left to other contacts to hold."""
_FOUND = (
    (F_N, OTHER_N), (F_T, OTHER_T), (F_S, OTHER_WN), (DIRECTION, KEPT_DIRECTION), (COS_WAY, KEPT_FULL),
    (SIN_WAY, KEPT_TAKES), (KNOWN, APART),
)  # fmt: skip


@internal
def _independent(ev: Any, ws: Any, number: int, rank: float) -> int:
    """As `forces.independent_of`, among all three blocks."""
    count, work = whole(ev)[COUNT], vec(ev.work, ev.work_size)
    directions, responses = mat(ev.directions, 3 * count, ws.n), mat(ev.responses, 3 * count, ws.n)
    some, chosen = ivec(ev.some, number), ivec(ev.chosen, 3 * ev.most)
    return int(call_independent(ev.independent, directions, responses, some, rank, chosen, work))


@internal
def _carry(ev: Any, ws: Any, kept: int, k: int, rank: float) -> int:
    """Contact k to those in `some`, the first `kept` of which do not repeat each other; their number. Where it repeats
    them they take its force, or it takes the place of the first of them whose force would come to zero by that: so
    those that are kept press with what all did (Caratheodory)."""
    some, f_n, a = ivec(ev.some, 3 * ev.most), col(ev, F_N), masses(ev, whole(ev)[COUNT])
    some[kept] = k
    if _independent(ev, ws, kept + 1, rank) == kept + 1:
        return kept + 1
    matrix, right = mat(ev.matrix, kept, kept), mat(ev.matrix + 8 * kept * kept, kept, 1)
    parts = mat(ev.matrix + 8 * (kept * kept + kept), kept, 1)
    for i in range(kept):
        right[i, 0] = a[some[i], k]
        for j in range(kept):
            matrix[i, j] = a[some[i], some[j]]
    call_least_norm(cones_at(ev.cones).least_norm, matrix, right, parts, rank, ev.work)
    moved, first = f_n[k], -1
    for i in range(kept):
        if parts[i, 0] < 0.0 and f_n[some[i]] < -parts[i, 0] * moved:
            moved, first = f_n[some[i]] / -parts[i, 0], i
    for i in range(kept):
        f_n[some[i]] = max(f_n[some[i]] + moved * parts[i, 0], 0.0)
    f_n[k] -= moved
    if first >= 0:
        some[first] = k
    return kept


@internal
def _swap(ev: Any, back: bool) -> None:
    """Keep what has been found, or put it `back`."""
    for one, other in _FOUND:
        copy(col(ev, one if back else other), col(ev, other if back else one), whole(ev)[COUNT])


@internal
def _hand_over(ev: Any, dr: Any, ws: Any, ms: Any) -> None:
    """What the contacts in `FLAG` do without those that are left to them, if they can: others' friction is no longer
    there, so that sliding may begin another way."""
    kept, moment = col(ev, FLAG), real(ev)[MOMENT]
    _swap(ev, False)
    good = moment > 0.0 and decide_by_moment(ev, dr, ws, ms, kept, moment)
    if moment == 0.0:
        good = balance_in_space(ev, ws, kept, False) == SETTLED
    fastest = 0.0
    for i in range(whole(ev)[COUNT]):
        fastest = max(fastest, abs(col(ev, B_N)[i]), abs(col(ev, B_T)[i]), abs(col(ev, B_S)[i]))
    for i in range(whole(ev)[COUNT]):
        pressed = col(ev, CLOSES)[i] != 0.0 and kept[i] == 0.0 and col(ev, W_N)[i] < -HOLDS * fastest
        good = good and not pressed and (kept[i] == 0.0 or col(ev, F_N)[i] > 0.0)
    if not good:
        _swap(ev, True)


@internal
def _gives_way(ev: Any, i: int, fastest: float) -> bool:
    """True if contact i, which others hold along one tangent, has reached its limit with what it carries there, and
    does not move: without that share it need not slide yet. A ball in a corner, on floor and wall, is held by both, and
    its friction on the wall, upwards, may be anything with the normal forces that fit it."""
    moves = math.sqrt(col(ev, W_T)[i] ** 2 + col(ev, W_S)[i] ** 2) > STICKS_STILL * fastest
    shared = col(ev, SLID)[i] == ALONG and col(ev, OLD_RATIO)[i] != 0.0
    return bool(col(ev, DIRECTION)[i] == BEGINS and shared and not moves)


@internal
def keep_in_space(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """As `keep`: normals first, those that carry most before others; then tangents of those that stick. Where both of a
    contact are left to others, or one, it carries its share of friction along with its normal force; at the limit of
    its friction it leaves all that it carries there to them, for it can only slide across that."""
    count, some, flag = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most), col(ev, FLAG)
    f_n, f_t, f_s, order = col(ev, F_N), col(ev, F_T), col(ev, F_S), ivec(ev.order, 2 * ev.most)
    rank, normals, fastest, friction = real(ev)[RANK], 0, 0.0, vec(dr.friction, ws.n_contacts)
    for i in range(count):
        fastest = max(fastest, abs(col(ev, B_N)[i]), abs(col(ev, B_T)[i]), abs(col(ev, B_S)[i]))
    clear(flag, count)
    for i in range(count):
        if col(ev, CLOSES)[i] != 0.0:
            at = normals
            while at > 0 and f_n[order[at - 1]] < f_n[i]:
                order[at] = order[at - 1]
                at -= 1
            order[at] = i
            normals += 1
    kept = 0
    for j in range(normals):
        kept = _carry(ev, ws, kept, order[j], rank)
    for j in range(kept):
        order[j] = some[j]
        flag[some[j]] = 1.0
    if kept < normals:
        _hand_over(ev, dr, ws, ms)
    normals = total = kept
    for j in range(normals):
        i = order[j]
        rubs = col(ev, STATIC)[i] > 0.0
        size = math.sqrt(f_t[i] ** 2 + f_s[i] ** 2)
        if _gives_way(ev, i, fastest):
            col(ev, DIRECTION)[i] = 0.0
        if col(ev, DIRECTION)[i] != 0.0 and rubs:
            # (what a spin leaves of it the contact itself says)
            col(ev, NEW_SLIDE)[i], col(ev, NEW_RATIO)[i] = 1.0, -friction[ivec(ev.contacts, ev.most)[i]]
            continue
        # until it is known whether its tangents are told from others: a share
        col(ev, NEW_SLIDE)[i] = IDLE
        col(ev, NEW_RATIO)[i] = size / f_n[i] if f_n[i] > 0.0 and rubs else 0.0
        col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = (f_t[i] / size, f_s[i] / size) if size > 0.0 else (1.0, 0.0)
        if rubs:
            total += hold(ev, total, i, rank)
            full = size >= (1.0 - REACHES_LIMIT_NOW) * col(ev, STATIC)[i] * f_n[i]
            if col(ev, NEW_SLIDE)[i] == ALONG and full:
                col(ev, NEW_RATIO)[i] = 0.0
    return SETTLED
