"""Forces of the contacts that touch at one instant: which of them stay closed, and which stick, slide or are held.

With dependent directions (a body on two feet) sticking friction is not unique: one of them has the sliding distance
as a constraint, the others carry a constant share of their normal force (IDLE, with their RATIO) until the first
reaches its limit; then it keeps that limit and another takes the rest, or all let go.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..rounding import FORCE_ROUNDING, NO_ACCELERATION, NO_SLIDING, PERHAPS_REST, PRESSING, REACHES_LIMIT, TO_SPARE
from ..state.modes import CLOSED, IDLE
from ..state.modes import STICKS as STUCK
from ..state.workspace_records import CONTROL_SIZE, ENERGY_SCALE
from ..tables.levels import position_level, rate_size
from .forces import NO_SOLUTION, among, farthest_of, independent_of, remove_rates
from .reading import comes_back, largest_acceleration, unresolved_speed
from .records import (
    ACCELERATIONS,
    APART,
    AT_REST,
    B_N,
    B_T,
    CLOSES,
    COUNT,
    DIRECTION,
    EARLY,
    F_N,
    F_T,
    FIRST,
    FLAG,
    FULL,
    JAMS,
    KEPT_DIRECTION,
    KEPT_FULL,
    KEPT_TAKES,
    KINETIC,
    KNOWN,
    LEAVES,
    LOADED,
    NEW_RATIO,
    NEW_SLIDE,
    NO_FORCES,
    NONE,
    OLD_RATIO,
    OTHER_FLAG,
    OTHER_N,
    OTHER_T,
    OTHER_WN,
    OTHER_WT,
    RANK,
    RATE,
    READY,
    ROUNDING,
    SETTLED,
    SIZE,
    SLID,
    SLIDE_RATE,
    SLIPPING,
    SLIPS,
    SLOW,
    SPARE,
    STATIC,
    STICKS,
    STOPS,
    STRUCK,
    TAKES,
    W_N,
    W_T,
    WAS,
    WHO,
    call_part,
    clear,
    col,
    copy,
    delassus,
    real,
    whole,
)
from .touching import force_noise, free_accelerations, free_jerks, looks_again, push, push_and_account

NEARLY_SINGULAR = 1e-6
"""Part of a contact's inverse effective mass that friction leaves where it is about to jam."""
RANK_OF_MANY, LOOSEST_RANK = 1e-6, 1e-4
"""Parts of an inverse mass: directions of many contacts that differ by less are taken for one; and at an instant that
does not settle. To bring rates of rounding's size to zero takes motions larger by one over the root of that."""
CLOSES_FROM, CLOSES_TO = 3, 12
"""Looks at one instant in which contacts that carry nothing close. Before, they stay as they are; after, those that
have pulled by rounding stay open, or some would open and others close in turns: bodies that fall side by side."""
PULLING = 1e-3
"""Of the largest force of the contacts: one that pulls by more has been kept together with the wrong others."""
AHEAD, FARTHEST_AHEAD = 1e-9, 1e-6
"""How far the mechanism is moved, of its size, to see what holds a moment later: at the second event of an instant, and
ten times farther at each of the following ones, but not beyond."""


# ---- what the velocities tell ---------------------------------------------------------------------------------------


@internal
def look(ev: Any, ms: Any) -> None:
    """What the rates say: +-1 in `KNOWN` where the contact slides, 0 where friction decides."""
    slide_rate, known, slid = col(ev, SLIDE_RATE), col(ev, KNOWN), col(ev, SLID)
    for i in range(whole(ev)[COUNT]):
        slow = max(col(ev, SLOW)[i], col(ev, ROUNDING)[i])
        known[i] = np.sign(slide_rate[i]) if abs(slide_rate[i]) > slow else 0.0
        if whole(ev)[STRUCK] == 0 and col(ev, WAS)[i] == CLOSED:
            # one that did not slide by itself, since others held it, may already go the other way by a little
            turned = ms.exact != 0 and slid[i] * slide_rate[i] < -slow
            # what the forces were before this instant says nothing of one that hardly moves
            moves = abs(slide_rate[i]) > slow and col(ev, STOPS)[i] == 0.0
            slides = abs(slid[i]) == 1.0 and (turned or moves)
            way = np.sign(slide_rate[i]) if turned else slid[i]
            known[i] = way if slides else 0.0


@internal
def begin_rest(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Which contacts neither separate nor approach. `ACCELERATIONS` of the coordinates before, 1/s^2, are given."""
    count, at_rest, contacts = whole(ev)[COUNT], col(ev, AT_REST), ivec(ev.contacts, ev.most)
    look(ev, ms)
    rates, slow = col(ev, RATE), whole(ev)[STRUCK] == 0
    for i in range(count):
        at_rest[i] = abs(rates[i]) <= col(ev, ROUNDING)[i]
        # a constraint that holds does not separate, however much its method drifts
        if whole(ev)[STRUCK] == 0 and col(ev, WAS)[i] == CLOSED:
            at_rest[i] = 1.0
        slow = slow or abs(rates[i]) <= PERHAPS_REST * rate_size(ws, contacts[i])
    _stop_slow(ev, dr, ws, ms)
    whole(ev)[READY] = 0
    if not slow:
        return SETTLED
    return _prepare(ev, dr, ws, ms, real(ev)[ACCELERATIONS])


@internal
def _stop_slow(ev: Any, dr: Any, ws: Any, ms: Any) -> None:
    """Where instants crowd, take away what is left of sliding that counts as none (`crowding.py`)."""
    some = False
    for i in range(whole(ev)[COUNT]):
        none = col(ev, KNOWN)[i] == 0.0 and col(ev, AT_REST)[i] != 0.0 and col(ev, STATIC)[i] > 0.0
        some = some or (none and abs(col(ev, SLIDE_RATE)[i]) > col(ev, ROUNDING)[i])
    if some and ms.exact != 0:
        stop(ev, dr, ws, ms)


@internal
def stop(ev: Any, dr: Any, ws: Any, ms: Any) -> None:
    """Take away the rates of the contacts at rest, and of their sliding where friction decides."""
    normal, along = col(ev, SPARE), col(ev, OTHER_FLAG)
    remove_rates(ev, normal, along)
    push_and_account(ev, dr, ws, normal, along)
    look(ev, ms)


@internal
def _ahead(dr: Any, ws: Any) -> float:
    """How far ahead accelerations are looked at, s: where a geometry's curvature jumps (a corner is passed), the
    present point may lie before the jump by rounding, and what holds behind it decides. 0 at first."""
    again, v, scale, speed = looks_again(dr) - 1, vec(ws.v, ws.n_ext), vec(ws.scale, ws.n), 0.0
    if again < 1:
        return 0.0
    for i in range(ws.n):
        speed = max(speed, abs(v[i]) / scale[i])
    return min(AHEAD * 10.0 ** (again - 1), FARTHEST_AHEAD) / speed if speed > 0.0 else 0.0


@internal
def _prepare(ev: Any, dr: Any, ws: Any, ms: Any, accelerations: float) -> int:
    """Free accelerations of gaps and sliding distances, with zero for what is rounding."""
    count, n, b_n, b_t, size = whole(ev)[COUNT], ws.n, col(ev, B_N), col(ev, B_T), col(ev, SIZE)
    status = free_accelerations(ev, dr, ws, b_n, b_t, _ahead(dr, ws))
    if status != SETTLED:
        return status
    whole(ev)[READY] = 1
    none = NO_ACCELERATION * max(largest_acceleration(ws), accelerations, 1e-300)
    real(ev)[NONE] = none
    forces, scale = force_noise(ev, ws), vec(ws.scale, n)
    directions, responses = mat(ev.directions, 2 * count, n), mat(ev.responses, 2 * count, n)
    for i in range(2 * count):
        largest, noise = 0.0, 0.0
        for j in range(n):
            largest = max(largest, abs(directions[i, j]) * scale[j])
            noise += abs(responses[i, j]) * forces[j]
        least = max(none * largest, noise)
        if i < count:
            size[i] = largest
            b_n[i] = 0.0 if abs(b_n[i]) <= least else b_n[i]
        else:
            b_t[i - count] = 0.0 if abs(b_t[i - count]) <= least else b_t[i - count]
    _hold_back(ev, ws, ms, b_n)
    return SETTLED


@internal
def _hold_back(ev: Any, ws: Any, ms: Any, motion: Any) -> bool:
    """Gaps that open but, with these accelerations, less than could be told from zero, are at rest too: what is left of
    the rates is taken away. False if there are none."""
    count, contacts, back, found = whole(ev)[COUNT], ivec(ev.contacts, ev.most), col(ev, FLAG), False
    at_rest = col(ev, AT_REST)
    for i in range(count):
        rate = col(ev, RATE)[i]
        back[i] = at_rest[i] == 0.0 and 0.0 < rate <= unresolved_speed(ws, contacts[i], -motion[i])
        found = found or back[i] != 0.0
    if not found:
        return False
    for i in range(count):
        at_rest[i] = 1.0 if back[i] != 0.0 else at_rest[i]
    if ms.exact == 0:
        return True
    # rounding's worth, which no account sees
    normal, along = col(ev, SPARE), col(ev, OTHER_FLAG)
    remove_rates(ev, normal, along)
    push(ev, ws, normal, along)
    look(ev, ms)
    return True


# ---- forces ---------------------------------------------------------------------------------------------------------


@internal
def find_forces(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Forces of all touching contacts (zero where they separate), in `F_N` and `F_T`."""
    count, takes, leaves, at_rest = whole(ev)[COUNT], col(ev, TAKES), col(ev, LEAVES), col(ev, AT_REST)
    if whole(ev)[READY] == 0:
        status = _prepare(ev, dr, ws, ms, 0.0)
        if status != SETTLED:
            return status
    for i in range(count):
        takes[i] = at_rest[i] != 0.0 and leaves[i] == 0.0
    status = _balance(ev, ws, ms)
    if status == SETTLED and _turned(ev):
        status = _balance(ev, ws, ms)
    for _ in range(count):
        # one that opens so slowly that it falls back at once
        if status != SETTLED or not _hold_back(ev, ws, ms, col(ev, W_N)):
            break
        for i in range(count):
            takes[i] = 1.0 if col(ev, FLAG)[i] != 0.0 else takes[i]
        status = _balance(ev, ws, ms)
    if status != SETTLED:
        return status
    _stand_apart(ev, ws, ms)
    return _refuse_jam(ev)


@internal
def _turned(ev: Any) -> bool:
    """True if a contact that has reached the limit of its friction would set off the other way, since others have let
    go at the same instant: then it is friction that decides."""
    slips, found, fastest = col(ev, SLIPS), False, _fastest(ev)
    for i in range(whole(ev)[COUNT]):
        if slips[i] * col(ev, W_T)[i] < -PRESSING * fastest and col(ev, DIRECTION)[i] == slips[i]:
            slips[i], found = 0.0, True
    return found


@internal
def _fastest(ev: Any) -> float:
    """The largest of the free accelerations, m/s^2."""
    fastest = 0.0
    for i in range(whole(ev)[COUNT]):
        fastest = max(fastest, abs(col(ev, B_N)[i]), abs(col(ev, B_T)[i]))
    return fastest


@internal
def _stand_apart(ev: Any, ws: Any, ms: Any) -> None:
    """Of contacts whose normals repeat each other take those that lie farthest apart: on them a body stands firmly."""
    count, apart = whole(ev)[COUNT], col(ev, APART)
    if not _spread(ev, ws, apart):
        return
    kept = (DIRECTION, KEPT_DIRECTION), (FULL, KEPT_FULL), (TAKES, KEPT_TAKES)
    for one, other in kept:
        copy(col(ev, other), col(ev, one), count)
    slipping, sticks = whole(ev)[SLIPPING], whole(ev)[STICKS]
    _swap_forces(ev, count)
    copy(col(ev, TAKES), apart, count)
    good = _balance(ev, ws, ms) == SETTLED
    for i in range(count):
        good = good and (apart[i] == 0.0 or _loaded(ev, i))
    if good:
        return
    for one, other in kept:
        copy(col(ev, one), col(ev, other), count)
    whole(ev)[SLIPPING], whole(ev)[STICKS] = slipping, sticks
    _swap_forces(ev, count)
    note_loaded(ev, ws)


@internal
def _swap_forces(ev: Any, count: int) -> None:
    for one, other in ((F_N, OTHER_N), (F_T, OTHER_T), (W_N, OTHER_WN), (W_T, OTHER_WT)):
        for i in range(count):
            x = col(ev, one)[i]
            col(ev, one)[i] = col(ev, other)[i]
            col(ev, other)[i] = x


@internal
def _spread(ev: Any, ws: Any, apart: Any) -> bool:
    """Which contacts that is; False if there are none, or if nothing asks for a new choice."""
    count, some, asked, still = whole(ev)[COUNT], ivec(ev.some, 2 * ev.most), whole(ev)[STRUCK] != 0, 0
    for i in range(count):
        asked = asked or (_loaded(ev, i) and col(ev, WAS)[i] != CLOSED)
    if not asked:
        return False
    for i in range(count):
        if col(ev, TAKES)[i] != 0.0 and abs(col(ev, W_N)[i]) <= 1e3 * real(ev)[NONE] * col(ev, SIZE)[i]:
            some[still] = i
            still += 1
    number = farthest_of(ev, count, still)
    chosen, every = ivec(ev.chosen, 2 * ev.most), True
    for j in range(number):
        every = every and _loaded(ev, chosen[j])
    if number == still or every:
        return False
    clear(apart, count)
    for j in range(number):
        apart[chosen[j]] = 1.0
    return True


@internal
def _balance(ev: Any, ws: Any, ms: Any) -> int:
    """Forces of the contacts `TAKES`."""
    count, slips, direction, known = whole(ev)[COUNT], col(ev, SLIPS), col(ev, DIRECTION), col(ev, KNOWN)
    full, any_slips, differ = col(ev, FULL), False, False
    for i in range(count):
        direction[i], full[i] = known[i], 0.0
        any_slips = any_slips or slips[i] != 0.0
    whole(ev)[SLIPPING] = 0
    if any_slips:
        if _held(ev, ws):
            return SETTLED
        whole(ev)[SLIPPING] = 1
        for i in range(count):
            direction[i] = slips[i] if slips[i] != 0.0 else direction[i]
    for _ in range(count + 1):
        status = _solve(ev, ws, ms)
        if status != SETTLED:
            return status
        _begins(ev, ws)
        differ = False
        begins = col(ev, FLAG)
        for i in range(count):
            if begins[i] != 0.0:
                differ = differ or col(ev, KINETIC)[i] != col(ev, STATIC)[i]
                direction[i] = -np.sign(col(ev, F_T)[i])
        if not differ:
            break
    return SETTLED


@internal
def _solve(ev: Any, ws: Any, ms: Any) -> int:
    count, takes, none = whole(ev)[COUNT], col(ev, TAKES), real(ev)[NONE]
    for _ in range(2):
        if among(ev, count, takes, col(ev, DIRECTION), col(ev, DIRECTION)) == NO_SOLUTION:
            _name_jammed(ev)
            return NO_FORCES
        note_loaded(ev, ws)
        # one that leaves does so unless the others' forces press it together again
        again = False
        for i in range(count):
            pressed = col(ev, W_N)[i] < -1e3 * none * col(ev, SIZE)[i]
            if ms.exact != 0 and col(ev, AT_REST)[i] != 0.0 and takes[i] == 0.0 and pressed:
                takes[i], again = 1.0, True
        if not again:
            break
    return SETTLED


@internal
def _name_jammed(ev: Any) -> None:
    """Which contact's friction alone may turn the effect of the normal force round; -1: none's."""
    count, kinetic = whole(ev)[COUNT], col(ev, KINETIC)
    a, who = delassus(ev, count), -1
    for i in range(count - 1, -1, -1):
        if kinetic[i] > 0.0 and a[i, i] <= kinetic[i] * abs(a[i, count + i]):
            who = ivec(ev.contacts, ev.most)[i]
    whole(ev)[WHO] = who


@internal
def _held(ev: Any, ws: Any) -> bool:
    """Contacts that reach the limit of their friction need not slide: others may hold them. False if they slide."""
    count, slips, full = whole(ev)[COUNT], col(ev, SLIPS), col(ev, FULL)
    direction, static, tried = col(ev, DIRECTION), col(ev, STATIC), col(ev, SPARE)
    for i in range(count):
        ratio = col(ev, OLD_RATIO)[i]
        idle = col(ev, WAS)[i] == CLOSED and col(ev, SLID)[i] == IDLE
        at_limit = idle and abs(ratio) >= static[i] * (1.0 - REACHES_LIMIT)
        full[i] = slips[i] if slips[i] != 0.0 else (-np.sign(ratio) if at_limit else 0.0)
    # those at their limit keep it, others take the rest; or all is distributed anew
    for attempt in range(2):
        for i in range(count):
            tried[i] = direction[i] if direction[i] != 0.0 or attempt == 1 else full[i]
        good = _tries(ev, ws, tried, attempt == 0, REACHES_LIMIT if attempt == 0 else TO_SPARE)
        if good:
            for i in range(count):
                full[i] = 1.0 if attempt == 0 and full[i] != 0.0 else 0.0
            return True
    clear(full, count)
    return False


@internal
def _tries(ev: Any, ws: Any, tried: Any, keeps: bool, spare: float) -> bool:
    """True if the contacts stay where they are with the directions `tried`; `keeps`: those in `FULL` do not move by
    these."""
    count, static, full, order = whole(ev)[COUNT], col(ev, STATIC), col(ev, FULL), ivec(ev.order, 2 * ev.most)
    if among(ev, count, col(ev, TAKES), tried, col(ev, DIRECTION)) == NO_SOLUTION:
        return False
    note_loaded(ev, ws)
    free = 0
    for i in range(count):
        if _loaded(ev, i) and tried[i] == 0.0 and static[i] > 0.0:
            if abs(col(ev, F_T)[i]) >= static[i] * col(ev, F_N)[i] * (1.0 - spare):
                return False
            order[free] = i
            free += 1
    if free == 0:
        return False
    for i in range(count):
        if keeps and full[i] != 0.0 and _loaded(ev, i) and _moves(ev, ws, free, i):
            return False
    return True


@internal
def note_loaded(ev: Any, ws: Any) -> None:
    """Which touching contacts press, to `LOADED`."""
    count, contacts, largest = whole(ev)[COUNT], ivec(ev.contacts, ev.most), vec(ws.control, CONTROL_SIZE)[ENERGY_SCALE]
    level, rows, scale = position_level(ws), ivec(ws.contact_rows, ws.n_contacts), vec(ws.row_scale, ws.m_ext)
    f_n, loaded = col(ev, F_N), col(ev, LOADED)
    for i in range(count):
        largest = max(largest, f_n[i] * level * scale[rows[contacts[i]]])
    for i in range(count):
        loaded[i] = f_n[i] > FORCE_ROUNDING * largest / (level * scale[rows[contacts[i]]])


@internal
def _loaded(ev: Any, i: int) -> bool:
    """True if touching contact i presses."""
    return bool(col(ev, LOADED)[i] != 0.0)


@internal
def sticking(ev: Any) -> int:
    """Contacts with friction below its limit (or below it in any case: the least distribution was found), to `order`;
    those with the highest limits first, and those at their limits last: where some are to carry a constant share, it is
    these, for as constraints they would be beyond their limits at once. Returns their number."""
    count, static, order, found = whole(ev)[COUNT], col(ev, STATIC), ivec(ev.order, 2 * ev.most), 0
    early = col(ev, EARLY)
    slipping, f_n, f_t = whole(ev)[SLIPPING] != 0, col(ev, F_N), col(ev, F_T)
    fastest = _fastest(ev)
    for i in range(count):
        limit = static[i] * f_n[i]
        below = abs(f_t[i]) < limit * (1.0 - REACHES_LIMIT) or limit == 0.0
        # blocks that ride on one another need just the limit
        below = below or (not slipping and (whole(ev)[STICKS] != 0 or _stays(ev, i)))
        # where next to nothing presses, rounding must not say that friction is below the limit of next to nothing
        below = below and (limit == 0.0 or abs(col(ev, W_T)[i]) <= PRESSING * fastest)
        free = static[i] > 0.0 and col(ev, DIRECTION)[i] == 0.0 and col(ev, FULL)[i] == 0.0
        if below and free and col(ev, AT_REST)[i] != 0.0:
            at = found
            at_limit = limit > 0.0 and abs(f_t[i]) >= limit * (1.0 - REACHES_LIMIT)
            early[i] = -1.0 / limit if at_limit else limit
            while at > 0 and early[order[at - 1]] < early[i]:
                order[at] = order[at - 1]
                at -= 1
            order[at] = i
            found += 1
    return found


@internal
def _stays(ev: Any, i: int) -> bool:
    """True if contact i has no acceleration along its tangent but for rounding."""
    count, f_n, f_t = whole(ev)[COUNT], col(ev, F_N), col(ev, F_T)
    a, terms = delassus(ev, count), abs(col(ev, B_T)[i])
    for j in range(count):
        terms += abs(a[j, count + i]) * f_n[j]
    for j in range(count):
        terms += abs(a[count + i, count + j]) * abs(f_t[j])
    return abs(col(ev, W_T)[i]) <= NO_SLIDING * terms


@internal
def _begins(ev: Any, ws: Any) -> None:
    """Contacts at the limit of their friction that no others hold, to `FLAG`."""
    count, flag, order, kept = whole(ev)[COUNT], col(ev, FLAG), ivec(ev.order, 2 * ev.most), 0
    for i in range(count):
        free = col(ev, STATIC)[i] > 0.0 and col(ev, DIRECTION)[i] == 0.0
        flag[i] = free and _loaded(ev, i)
    number = sticking(ev)
    for j in range(number):
        i = order[j]
        flag[i] = 0.0
        if _loaded(ev, i):
            order[kept] = i
            kept += 1
    for i in range(count):
        if flag[i] != 0.0 and not _moves(ev, ws, kept, i):
            flag[i] = 0.0


@internal
def _moves(ev: Any, ws: Any, number: int, i: int) -> bool:
    """True if closed gaps and those that stick, the first `number` in `order`, leave contact i free to slide."""
    count, some, order, normals = whole(ev)[COUNT], ivec(ev.some, 2 * ev.most), ivec(ev.order, 2 * ev.most), 0
    for j in range(count):
        if _loaded(ev, j):
            some[normals] = j
            normals += 1
    for j in range(number):
        some[normals + j] = count + order[j]
    some[normals + number] = count + i
    kept, chosen = independent_of(ev, ws, normals + number + 1, 0.0), ivec(ev.chosen, 2 * ev.most)
    return kept > 0 and chosen[kept - 1] == normals + number


# ---- what it means --------------------------------------------------------------------------------------------------


@internal
def choose(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Which contacts stay closed, to `CLOSES`."""
    count, closes, now = whole(ev)[COUNT], col(ev, CLOSES), whole(ev)[STRUCK] == 0
    clear(closes, count)
    rests = False
    for i in range(count):
        rests = rests or col(ev, AT_REST)[i] != 0.0
    if not rests:
        return SETTLED
    status = call_part(ev.find_forces, ev, dr, ws, ms)
    if status != SETTLED:
        return status
    idle, none = False, real(ev)[NONE]
    for i in range(count):
        closes[i] = _loaded(ev, i)
        leaves = col(ev, LEAVES)[i] != 0.0
        if now and col(ev, WAS)[i] == CLOSED and not leaves and abs(col(ev, W_N)[i]) <= none * col(ev, SIZE)[i]:
            # touching without force: as it was
            closes[i] = 1.0
        idle = idle or (col(ev, AT_REST)[i] != 0.0 and closes[i] == 0.0 and not leaves)
    if idle:
        _close_idle(ev, dr, ws, closes)
    _slide_unloaded(ev, closes)
    return SETTLED


@internal
def _slide_unloaded(ev: Any, closes: Any) -> None:
    """Contacts that stay closed without force begin to slide where nothing holds them: no friction does."""
    least, direction = PRESSING * _fastest(ev), col(ev, DIRECTION)
    for i in range(whole(ev)[COUNT]):
        free = col(ev, STATIC)[i] > 0.0 and direction[i] == 0.0 and col(ev, F_N)[i] == 0.0
        if free and closes[i] != 0.0 and abs(col(ev, W_T)[i]) > least:
            direction[i] = np.sign(col(ev, W_T)[i])


@internal
def _close_idle(ev: Any, dr: Any, ws: Any, closes: Any) -> None:
    """Contacts that carry nothing close where they would come back, or where every step closes them at once."""
    jerks, contacts, none = col(ev, SPARE), ivec(ev.contacts, ev.most), real(ev)[NONE]
    free_jerks(ev, ws, jerks)
    for i in range(whole(ev)[COUNT]):
        if col(ev, AT_REST)[i] == 0.0 or closes[i] != 0.0 or col(ev, LEAVES)[i] != 0.0:
            continue
        motion = col(ev, W_N)[i]
        # nothing presses it, or others carry all: a table on two feet in balance, whose third one touches
        again = abs(motion) <= none * col(ev, SIZE)[i] and CLOSES_FROM <= looks_again(dr) <= CLOSES_TO
        if again or comes_back(ws, contacts[i], jerks[i], motion):
            closes[i] = 1.0


@internal
def keep(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Of the contacts in `CLOSES` those that do not repeat each other, to `RANK`, with what each does along its tangent
    (SLIDE and RATIO): `FLAG`, `NEW_SLIDE`, `NEW_RATIO`. Contacts that repeat each other nearly need large forces
    against each other to move as constraints say: where an instant does not settle, more and more of them count as
    one."""
    count, closes, f_n, flag = whole(ev)[COUNT], col(ev, CLOSES), col(ev, F_N), col(ev, FLAG)
    some, order, chosen = ivec(ev.some, 2 * ev.most), ivec(ev.order, 2 * ev.most), ivec(ev.chosen, 2 * ev.most)
    slide, ratio, kinetic, direction = col(ev, NEW_SLIDE), col(ev, NEW_RATIO), col(ev, KINETIC), col(ev, DIRECTION)
    rank = real(ev)[RANK]
    clear(flag, count)
    stuck, normals, kept = sticking(ev), 0, 0
    for i in range(count):
        if closes[i] != 0.0:
            at = normals
            while at > 0 and f_n[some[at - 1]] < f_n[i]:
                some[at] = some[at - 1]
                at -= 1
            some[at] = i
            normals += 1
    if normals == 0:
        return SETTLED
    for j in range(stuck):
        if closes[order[j]] != 0.0:
            at = normals + kept
            while at > normals and col(ev, FIRST)[some[at - 1] - count] < col(ev, FIRST)[order[j]]:
                some[at] = some[at - 1]
                at -= 1
            some[at] = count + order[j]
            kept += 1
    number = independent_of(ev, ws, normals + kept, rank)
    for j in range(number):
        if chosen[j] < normals:
            i = some[chosen[j]]
            flag[i] = 1.0
            slides = direction[i] != 0.0 and _has_friction(ev, ws, i)
            slide[i] = direction[i] if slides else IDLE
            ratio[i] = -kinetic[i] * direction[i] if slides else (col(ev, F_T)[i] / f_n[i] if f_n[i] > 0.0 else 0.0)
    for j in range(number):
        if chosen[j] >= normals:
            i = some[chosen[j]] - count
            slide[i], ratio[i] = STUCK, 0.0
    return SETTLED


@internal
def keep_others(ev: Any, ws: Any) -> bool:
    """Say that `keep` is to begin with those along whose tangents others were left to hold; False if there are none.

    A disk that presses against two others balances their friction by itself: if one is to carry a constant share of its
    normal force, that share is the one with which the disk is in balance under any normal force, and nothing says how
    large that is.
    """
    count, first, some, latest = whole(ev)[COUNT], col(ev, FIRST), False, 0.0
    for i in range(count):
        latest = max(latest, first[i])
    stuck, order = sticking(ev), ivec(ev.order, 2 * ev.most)
    for j in range(stuck):
        i = order[j]
        if col(ev, FLAG)[i] != 0.0 and col(ev, NEW_SLIDE)[i] == IDLE and first[i] == 0.0:
            first[i], some = latest + 1.0, True
    return some


@internal
def pulls(ev: Any, ws: Any) -> bool:
    """True if a contact that has been kept pulls, by more than what the forces may be wrong by."""
    lam, rows, contacts = vec(ws.lam, ws.m_ext), ivec(ws.contact_rows, ws.n_contacts), ivec(ev.contacts, ev.most)
    largest, least = 0.0, 0.0
    for i in range(whole(ev)[COUNT]):
        if col(ev, FLAG)[i] != 0.0:
            largest = max(largest, col(ev, F_N)[i])
            least = min(least, -lam[rows[contacts[i]]])
    return least < -PULLING * largest


@internal
def _has_friction(ev: Any, ws: Any, i: int) -> bool:
    return bool(ivec(ws.contact_slide_rows, ws.n_contacts)[ivec(ev.contacts, ev.most)[i]] >= 0)


@internal
def _refuse_jam(ev: Any) -> int:
    """Painleve's paradox: friction turns the effect of the normal force round."""
    count = whole(ev)[COUNT]
    a, direction, kinetic = delassus(ev, count), col(ev, DIRECTION), col(ev, KINETIC)
    for i in range(count):
        if direction[i] != 0.0 and kinetic[i] > 0.0:
            left = a[i, i] - kinetic[i] * direction[i] * a[i, count + i]
            pressed = col(ev, F_N)[i] > 0.0 or col(ev, WAS)[i] == CLOSED
            if left <= NEARLY_SINGULAR * a[i, i] and pressed:
                whole(ev)[WHO] = ivec(ev.contacts, ev.most)[i]
                return JAMS
    return SETTLED
