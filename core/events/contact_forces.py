"""Forces of the contacts at rest, by exact friction cones: those under which none pulls, and what friction holds."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import REACHES_LIMIT, REACHES_LIMIT_NOW, STICKS_STILL
from ..state.run_records import loop_at
from .following_loads import solve_with_loads
from .free_tangents import find_sliding, list_held
from .loaded import note_loaded
from .moreau import decide_by_moment, moment_asked, moment_of_wedge, stop_rates
from .painleve import name_jammed, refuse_jam
from .rates import pressing
from .reading import unresolved_speed
from .records import (
    AT_REST,
    B_N,
    B_S,
    B_T,
    BASE,
    COMPANION,
    COS_WAY,
    COUNT,
    DIRECTION,
    F_N,
    F_S,
    F_T,
    JAMS,
    KINETIC,
    KNOWN,
    LEAVES,
    MU,
    NO_FORCES,
    NONE,
    OTHER_FLAG,
    PART,
    RATE,
    READY,
    SETTLED,
    SIN_WAY,
    SIZE,
    SLIPS,
    STATIC,
    TAKES,
    W_N,
    W_S,
    W_T,
    clear,
    col,
    real,
    whole,
)
from .resting import find_free
from .three_tangents import first_of, size_of

BEGINS = 2.0
"""In DIRECTION: sliding begins here."""


@internal
def find_forces(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Forces of all touching contacts (zero where they separate), in `F_N`, `F_T` and `F_S`, with the motion `W_N`,
    `W_T`, `W_S`; DIRECTION is 1 where the contact slides, 2 where it begins to. Where that has led to the same instant
    again and again, or to no forces, what would be a moment later decides."""
    if whole(ev)[READY] == 0:
        status = find_free(ev, dr, ws, 0.0)
        if status != SETTLED:
            return status
    if ms.exact != 0 and decide_by_moment(ev, dr, ws, ms, col(ev, AT_REST), moment_asked(ev, dr, ws)):
        return SETTLED
    part, lc = col(ev, PART), loop_at(dr.loop)
    for i in range(whole(ev)[COUNT]):
        part[i] = 1.0 if col(ev, AT_REST)[i] != 0.0 and col(ev, LEAVES)[i] == 0.0 else 0.0
    status = balance(ev, ws, ms, lc, part)
    for _ in range(whole(ev)[COUNT]):
        if status != SETTLED or not _falls_back(ev, ws, part):
            break
        status = balance(ev, ws, ms, lc, part)
    if status == SETTLED:
        note_loaded(ev, ws)
        status = refuse_jam(ev, ws)
    if status == SETTLED and ms.exact != 0:
        stop_rates(ev, dr, ws)
    wedged = (status == NO_FORCES or status == JAMS) and whole(ev)[COUNT] > 1 and ms.exact != 0
    if wedged and decide_by_moment(ev, dr, ws, ms, col(ev, AT_REST), moment_of_wedge(ev, ws)):
        return SETTLED
    return status


@internal
def _falls_back(ev: Any, ws: Any, part: Any) -> bool:
    """True if gaps that open would, with these accelerations, open by less than could be told from zero: they are at
    rest too, and take `part` in the forces."""
    found = False
    for i in range(whole(ev)[COUNT]):
        rate, k = col(ev, RATE)[i], ivec(ev.contacts, ev.most)[i]
        if col(ev, AT_REST)[i] == 0.0 and 0.0 < rate <= unresolved_speed(ws, k, -col(ev, W_N)[i]):
            col(ev, AT_REST)[i], found = 1.0, True
            part[i] = 1.0 if col(ev, LEAVES)[i] == 0.0 else 0.0
    return found


@internal
def _is_immovable(a: Any, count: int, i: int) -> bool:
    """True if no force moves touching contact i along its tangents."""
    return bool(a[count + i, count + i] == 0.0 and a[2 * count + i, 2 * count + i] == 0.0)


@internal
def _is_led(ev: Any, a: Any, count: int, i: int) -> bool:
    """True if no force moves it along those of its companion either."""
    return _is_immovable(a, count, i) and _is_immovable(a, count, i + int(col(ev, COMPANION)[i]))


@internal
def balance(ev: Any, ws: Any, ms: Any, lc: Any, part: Any) -> int:
    """Forces of the contacts `part`, and of others at rest that these press together again."""
    count, takes = whole(ev)[COUNT], col(ev, TAKES)
    direction, b, p = col(ev, DIRECTION), vec(ev.space_b, 3 * count), vec(ev.space_p, 3 * count)
    fastest, any_slips, a = 0.0, False, pressing(ev, count)
    for i in range(count):
        takes[i] = part[i]
        any_slips = any_slips or col(ev, SLIPS)[i] != 0.0
        b[i], b[count + i], b[2 * count + i] = col(ev, B_N)[i], col(ev, B_T)[i], col(ev, B_S)[i]
        fastest = max(fastest, abs(b[i]), abs(b[count + i]), abs(b[2 * count + i]))
        direction[i], col(ev, BASE)[i] = col(ev, KNOWN)[i], 0.0
        begins = size_of(ev, i, col(ev, B_T), col(ev, B_S))
        if _is_led(ev, a, count, i) and begins > 0.0 and direction[i] == 0.0 and col(ev, STATIC)[i] > 0.0:
            # its motion is prescribed, friction is against it
            direction[i], col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = (
                BEGINS,
                b[count + i] / begins,
                b[2 * count + i] / begins,
            )
    mu, free = col(ev, MU), col(ev, OTHER_FLAG)
    for _ in range(2 * count + 2):
        for i in range(count):
            mu[i] = col(ev, KINETIC)[i] if direction[i] != 0.0 else col(ev, STATIC)[i]
        if not solve_with_loads(ev, ws, lc, a, takes, b, mu, col(ev, BASE), direction, p):
            name_jammed(ev, ws)
            return NO_FORCES
        joins, again = False, False
        for i in range(count):
            col(ev, F_N)[i], col(ev, F_T)[i], col(ev, F_S)[i] = p[i], p[count + i], p[2 * count + i]
            w_n, w_t, w_s = b[i], b[count + i], b[2 * count + i]
            for j in range(3 * count):
                w_n += a[i, j] * p[j]
                w_t += a[count + i, j] * p[j]
                w_s += a[2 * count + i, j] * p[j]
            col(ev, W_N)[i], col(ev, W_T)[i], col(ev, W_S)[i] = w_n, w_t, w_s
            if ms.exact != 0 and takes[i] == 0.0 and col(ev, AT_REST)[i] != 0.0:
                if w_n < -1e3 * real(ev)[NONE] * col(ev, SIZE)[i]:
                    takes[i], joins = 1.0, True
        if joins:
            # what begins to slide follows from the forces of all that press, not of those that did before
            for i in range(count):
                if direction[i] == BEGINS and not _is_led(ev, a, count, i):
                    direction[i] = 0.0
            continue
        clear(free, count)
        if any_slips:
            find_sliding(ev, list_held(ev, ws, takes, REACHES_LIMIT_NOW, free), free)
        for i in range(count):
            if direction[i] == 0.0 and mu[i] > 0.0 and p[i] > 0.0:
                # at its limit, and it moves: it begins to slide, against its friction
                force, limit = size_of(ev, i, col(ev, F_T), col(ev, F_S)), mu[i] * p[i]
                moves = size_of(ev, i, col(ev, W_T), col(ev, W_S)) > STICKS_STILL * fastest
                # where a contact has its event at its limit, so have those that nothing else holds
                least = limit * (1.0 - (REACHES_LIMIT_NOW if any_slips else REACHES_LIMIT))
                if force >= least and (moves or free[first_of(ev, i)] != 0.0):
                    direction[i] = BEGINS
                    col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = -p[count + i] / force, -p[2 * count + i] / force
                    again = again or any_slips or col(ev, KINETIC)[i] != col(ev, STATIC)[i]
        if not again:
            break
    return SETTLED
