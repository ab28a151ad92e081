"""What the parts of an instant do where contacts have two tangents: friction with exact cones.

The same parts as those of `touching.py`, `blow.py` and `resting.py`, called in their place; forces are those of
`cones/friction_cones.py`. The room for directions and responses holds a third block, the second tangents' behind the
first ones'; inverse masses of all three are in `masses`. The tangents of a contact are those of `shapes/frame3d.py`;
what an instant finds out about a direction is kept as WAY.
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..cones.directions import call_independent
from ..linalg import lu_at, solve
from ..linalg.analyze import call_analyze
from ..linalg.record import WANT_ROOM
from ..linalg.small import call_least_norm
from ..rounding import (
    IMMOVABLE,
    NEARLY_JAMMED,
    NO_ACCELERATION,
    PERHAPS_REST,
    REACHES_LIMIT,
    REACHES_LIMIT_NOW,
    STICKS_STILL,
    UNSOLVED,
)
from ..state.modes import ALONG, AXIS, CLOSED, IDLE, MEMORY_SIZE, MODE, OPEN, RATIO, SLIDE
from ..state.modes import SLOW as SLOW_SLIDING
from ..state.modes import STICKS as STUCK
from ..state.run_records import call_accelerations
from ..state.workspace_records import OK
from ..tables.evaluate import evaluate_residuals, evaluate_tangent
from ..tables.levels import rate_size
from ..tables.switch import engage_modes
from .forces import cones_at
from .impact import MOST_BOUNCES, MOST_ROUNDS, restitution
from .laws import POISSON
from .moment_in_space import decide_by_moment, moment_asked, moment_of_wedge, stop_in_space
from .rates_in_space import masses, pressing, push_in_space, read_in_space, read_rates_in_space, solve_cones_in_space
from .reading import largest_acceleration, unresolved_speed
from .records import (
    ACCELERATIONS,
    APART,
    APPROACH,
    AT_REST,
    B_N,
    B_S,
    B_T,
    BASE,
    CLOSES,
    COS_WAY,
    COUNT,
    DIRECTION,
    ENDLESS_ROUNDS,
    F_N,
    F_S,
    F_T,
    FLAG,
    FRICTION,
    IMPULSE,
    JAMS,
    KEPT_DIRECTION,
    KEPT_FULL,
    KEPT_TAKES,
    KINETIC,
    KNOWN,
    LEAVES,
    LEFT,
    LOSS,
    MOMENT,
    MU,
    NEW_RATIO,
    NEW_SLIDE,
    NO_FORCES,
    NO_FREE_ACCELERATIONS,
    NO_IMPACT,
    NONE,
    OLD_RATIO,
    OTHER_N,
    OTHER_T,
    OTHER_WN,
    P_N,
    P_S,
    P_T,
    PART,
    RANK,
    RATE,
    RATE_BEFORE,
    READY,
    RESIDUAL,
    ROUNDING,
    SEPARATION,
    SETTLED,
    SIN_WAY,
    SINGULAR_JOINTS,
    SIZE,
    SLID,
    SLIDE_BEFORE,
    SLIDE_RATE,
    SLIPS,
    SLOW,
    STATIC,
    STOPS,
    STRUCK,
    SWAY_BEFORE,
    SWAY_RATE,
    TAKES,
    W_N,
    W_S,
    W_T,
    WANT_MEMORY,
    WAS,
    WHO,
    WITHOUT,
    clear,
    col,
    copy,
    delassus,
    real,
    whole,
)
from .resting import note_loaded
from .torques_in_space import find_torques, press_with_torques
from .touching import find_gradient, force_noise, refuse_immovable

BEGINS = 2.0
"""In DIRECTION: sliding begins here."""
ENDS_WITH = 2.0
"""Of the sliding speed that has no direction: with less where sliding ends, the contact has stopped."""
HOLDS = 1e-6
"""Of the largest free acceleration: how fast a gap may close that is left to other contacts to hold."""
_FOUND = (
    (F_N, OTHER_N), (F_T, OTHER_T), (F_S, OTHER_WN), (DIRECTION, KEPT_DIRECTION), (COS_WAY, KEPT_FULL),
    (SIN_WAY, KEPT_TAKES), (KNOWN, APART),
)  # fmt: skip
RANK_OF_HELD = 1e-8
"""Of its inverse mass: a tangent of which no more is left beside others is held by these."""


# ---- open -----------------------------------------------------------------------------------------------------------


@internal
def open_in_space(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """As `open_touching`, with both tangents."""
    count, contacts, n = whole(ev)[COUNT], ivec(ev.contacts, ev.most), ws.n
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    for i in range(count):
        k = contacts[i]
        memory[k, MODE], memory[k, SLIDE], memory[k, RATIO] = OPEN, STUCK, 0.0
        # directions and rates are to speak of the same tangents
        memory[k, AXIS] = 0.0
    if engage_modes(ws) != OK:
        return WANT_MEMORY
    # the rows of those that slid or stuck now tell both velocities
    evaluate_residuals(ws)
    find_torques(ev, ws, count)
    for i in range(count):
        memory[contacts[i], MODE] = CLOSED
    evaluate_tangent(ws, 0.0, 0.0)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    static, directions = vec(ws.contact_sticking, ws.n_contacts), mat(ev.directions, 3 * count, n)
    for i in range(count):
        k = contacts[i]
        find_gradient(ws, rows[k], directions[i])
        for block in range(2):
            to = directions[(block + 1) * count + i]
            if slides[k] >= 0 and static[k] > 0.0:
                find_gradient(ws, slides[k] + block, to)
            else:
                clear(to, n)
        memory[k, MODE] = OPEN
    evaluate_tangent(ws, 0.0, 0.0)
    code = call_analyze(ws.analyze, lu_at(ws.kkt_query), ws.values)
    if code != OK:
        return WANT_MEMORY if code == WANT_ROOM else SINGULAR_JOINTS
    _respond(ev, ws, count)
    read_rates_in_space(ev, ws)
    return refuse_immovable(ev, ws, count)


@internal
def _respond(ev: Any, ws: Any, count: int) -> None:
    n, directions, responses = ws.n, mat(ev.directions, 3 * count, ws.n), mat(ev.responses, 3 * count, ws.n)
    a, plane, rhs = masses(ev, count), delassus(ev, count), vec(ws.rhs, n + ws.m_act)
    for i in range(3 * count):
        for j in range(n):
            rhs[j] = directions[i, j]
        for j in range(ws.m_act):
            rhs[n + j] = 0.0
        solve(lu_at(ws.kkt_query), ws.rhs)
        for j in range(n):
            responses[i, j] = rhs[j]
    for i in range(3 * count):
        for j in range(3 * count):
            product = 0.0
            for e in range(n):
                product += directions[i, e] * responses[j, e]
            a[i, j] = product
    for i in range(3 * count):
        for j in range(i):
            a[i, j] = a[j, i] = 0.5 * (a[i, j] + a[j, i])
    # a tangent that joints hold takes no friction
    largest = 0.0
    for i in range(3 * count):
        largest = max(largest, a[i, i])
    for i in range(count, 3 * count):
        if a[i, i] <= IMMOVABLE * largest:
            for j in range(3 * count):
                a[i, j] = a[j, i] = 0.0
    for i in range(2 * count):
        for j in range(2 * count):
            plane[i, j] = a[i, j]
    press_with_torques(ev, ws, count)


# ---- impact ---------------------------------------------------------------------------------------------------------


@internal
def strike_in_space(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """As `strike`: Newton's law of restitution speaks of end velocities, and so does the friction with both laws."""
    count, phid = whole(ev)[COUNT], vec(ws.phid, ws.m_ext)
    rate, slide, sway, rounding = col(ev, RATE), col(ev, SLIDE_RATE), col(ev, SWAY_RATE), col(ev, ROUNDING)
    active, joint_rates = ivec(ws.active, ws.m_act), vec(ev.joint_rates, ws.m_act)
    before_n, before_t, before_s = col(ev, RATE_BEFORE), col(ev, SLIDE_BEFORE), col(ev, SWAY_BEFORE)
    loss, p_n, p_t, p_s = col(ev, LOSS), col(ev, P_N), col(ev, P_T), col(ev, P_S)
    read_rates_in_space(ev, ws)
    for i in range(ws.m_act):
        joint_rates[i] = phid[active[i]]
    largest, left = 0.0, math.inf
    for i in range(count):
        col(ev, IMPULSE)[i] = col(ev, FRICTION)[i] = loss[i] = 0.0
        col(ev, APPROACH)[i] = max(-rate[i], 0.0)
        largest = max(largest, abs(rate[i]) / rounding[i], abs(slide[i]) / rounding[i], abs(sway[i]) / rounding[i])
    real(ev)[RESIDUAL], noise = 0.0, UNSOLVED * largest
    for turn in range(MOST_ROUNDS + 1):
        before_round, left = left, 0.0
        for i in range(count):
            left = max(left, -rate[i] / rounding[i])
        if left <= 1.0 or 0.5 * before_round <= left <= noise:
            break
        if turn == MOST_ROUNDS:
            return ENDLESS_ROUNDS
        for i in range(count):
            approach = col(ev, APPROACH)[i]
            col(ev, APPROACH)[i] = approach if approach > rounding[i] else -rate[i]
            before_n[i], before_t[i], before_s[i] = rate[i], slide[i], sway[i]
        status = _blow(ev, dr, ws, turn >= MOST_BOUNCES)
        if status != SETTLED:
            return status
        for i in range(count):
            work = p_n[i] * (before_n[i] + rate[i]) + p_t[i] * (before_t[i] + slide[i])
            loss[i] -= 0.5 * (work + p_s[i] * (before_s[i] + sway[i]))
            col(ev, IMPULSE)[i] += p_n[i]
            col(ev, FRICTION)[i] += math.sqrt(p_t[i] * p_t[i] + p_s[i] * p_s[i])
    evaluate_residuals(ws)
    read_rates_in_space(ev, ws)
    for i in range(ws.m_act):
        real(ev)[RESIDUAL] = max(real(ev)[RESIDUAL], abs(phid[active[i]] - joint_rates[i]))
    copy(col(ev, SEPARATION), rate, count)
    real(ev)[LEFT] = left
    return SETTLED


@internal
def _blow(ev: Any, dr: Any, ws: Any, last: bool) -> int:
    """One problem of the contacts that do not separate, and a second one for the expansion of Poisson's contacts; or
    the `last`, of all contacts and without restitution."""
    count, law, contacts = whole(ev)[COUNT], ivec(dr.law, ws.n_contacts), ivec(ev.contacts, ev.most)
    part, base, rate, rounding = col(ev, PART), col(ev, BASE), col(ev, RATE), col(ev, ROUNDING)
    p_n, p_t, p_s, back = col(ev, P_N), col(ev, P_T), col(ev, P_S), False
    low = whole(ev)[WITHOUT] != 0
    for i in range(count):
        part[i] = 1.0 if last or rate[i] <= rounding[i] else 0.0
        base[i] = p_n[i] = p_t[i] = p_s[i] = 0.0
    for phase in range(2):
        b, p = vec(ev.space_b, 3 * count), vec(ev.space_p, 3 * count)
        for i in range(count):
            poisson = law[contacts[i]] == POISSON
            e = 0.0 if last else restitution(ev, low, i)
            back = back or (part[i] != 0.0 and poisson and e > 0.0)
            if phase == 1:
                base[i] = e * max(p_n[i], 0.0) if poisson else 0.0
            clear_rate = 0.0 if abs(rate[i]) <= rounding[i] else rate[i]
            wanted = e * (col(ev, RATE_BEFORE)[i] if phase == 1 else clear_rate) if not poisson else 0.0
            b[i] = clear_rate + wanted
            b[count + i], b[2 * count + i] = col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i]
            if abs(b[count + i]) <= rounding[i] and abs(b[2 * count + i]) <= rounding[i]:
                b[count + i] = b[2 * count + i] = 0.0
            col(ev, KNOWN)[i] = 0.0
        if not solve_cones_in_space(ev, masses(ev, count), count, part, b, col(ev, KINETIC), base, col(ev, KNOWN), p):
            return NO_IMPACT
        push_in_space(ev, ws, p)
        for i in range(count):
            p_n[i] += p[i]
            p_t[i] += p[count + i]
            p_s[i] += p[2 * count + i]
        if not back:
            break
    return SETTLED


# ---- rest -----------------------------------------------------------------------------------------------------------


@internal
def _look(ev: Any, ws: Any) -> None:
    """Which contacts slide, and where to: 1 in KNOWN, with COS_WAY and SIN_WAY; 0 where friction decides."""
    contacts = ivec(ev.contacts, ev.most)
    for i in range(whole(ev)[COUNT]):
        x, y, none = col(ev, SLIDE_RATE)[i], col(ev, SWAY_RATE)[i], max(col(ev, SLOW)[i], col(ev, ROUNDING)[i])
        speed, stands = math.sqrt(x * x + y * y), col(ev, STOPS)[i] != 0.0 and whole(ev)[STRUCK] == 0
        if stands:
            # it has gone on in its direction to where error control does not resolve another
            none = max(none, ENDS_WITH * mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[contacts[i], SLOW_SLIDING])
        slides = speed > none and col(ev, STATIC)[i] > 0.0
        col(ev, KNOWN)[i] = 1.0 if slides else 0.0
        col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = (x / speed, y / speed) if slides else (1.0, 0.0)


@internal
def begin_rest_in_space(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """As `begin_rest`."""
    count, at_rest, contacts = whole(ev)[COUNT], col(ev, AT_REST), ivec(ev.contacts, ev.most)
    read_rates_in_space(ev, ws)
    _look(ev, ws)
    slow = whole(ev)[STRUCK] == 0
    for i in range(count):
        held = whole(ev)[STRUCK] == 0 and col(ev, WAS)[i] == CLOSED
        at_rest[i] = 1.0 if held or abs(col(ev, RATE)[i]) <= col(ev, ROUNDING)[i] else 0.0
        slow = slow or abs(col(ev, RATE)[i]) <= PERHAPS_REST * rate_size(ws, contacts[i])
    whole(ev)[READY] = 0
    return _free(ev, dr, ws, real(ev)[ACCELERATIONS]) if slow else SETTLED


@internal
def _free(ev: Any, dr: Any, ws: Any, accelerations: float) -> int:
    """Free accelerations, with zero for what is rounding; gaps that open by less than can be seen are at rest."""
    count, n, scale = whole(ev)[COUNT], ws.n, vec(ws.scale, ws.n)
    if call_accelerations(dr.accelerations, ws) != OK:
        return NO_FREE_ACCELERATIONS
    read_in_space(ev, ws, vec(ws.phidd, ws.m_ext), col(ev, B_N), col(ev, B_T), col(ev, B_S))
    whole(ev)[READY] = 1
    none = NO_ACCELERATION * max(largest_acceleration(ws), accelerations, 1e-300)
    real(ev)[NONE] = none
    forces = force_noise(ev, ws)
    directions, responses = mat(ev.directions, 3 * count, n), mat(ev.responses, 3 * count, n)
    for i in range(3 * count):
        largest, noise, of = 0.0, 0.0, col(ev, B_N)
        for j in range(n):
            largest = max(largest, abs(directions[i, j]) * scale[j])
            noise += abs(responses[i, j]) * forces[j]
        if i < count:
            col(ev, SIZE)[i] = largest
        elif i < 2 * count:
            of = col(ev, B_T)
        else:
            of = col(ev, B_S)
        k = i % count
        of[k] = 0.0 if abs(of[k]) <= max(none * largest, noise) else of[k]
    for i in range(count):
        rate = col(ev, RATE)[i]
        if 0.0 < rate <= unresolved_speed(ws, ivec(ev.contacts, ev.most)[i], -col(ev, B_N)[i]):
            col(ev, AT_REST)[i] = 1.0
    return SETTLED


@internal
def find_forces_in_space(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """As `find_forces`: in `F_N`, `F_T` and `F_S`, with the motion `W_N`, `W_T`, `W_S`; DIRECTION is 1 where the
    contact slides, 2 where it begins to. Where that has led to the same instant again and again, or to no forces, what
    would be a moment later decides."""
    if whole(ev)[READY] == 0:
        status = _free(ev, dr, ws, 0.0)
        if status != SETTLED:
            return status
    if ms.exact != 0 and decide_by_moment(ev, dr, ws, ms, col(ev, AT_REST), moment_asked(ev, dr, ws)):
        return SETTLED
    part, real(ev)[MOMENT] = col(ev, PART), 0.0
    for i in range(whole(ev)[COUNT]):
        part[i] = 1.0 if col(ev, AT_REST)[i] != 0.0 and col(ev, LEAVES)[i] == 0.0 else 0.0
    status = _find_forces(ev, part, True)
    for _ in range(whole(ev)[COUNT]):
        if status != SETTLED or not _falls_back(ev, ws, part):
            break
        status = _find_forces(ev, part, True)
    if status == SETTLED:
        note_loaded(ev, ws)
        status = _refuse_jam(ev)
    if status == SETTLED and ms.exact != 0:
        stop_in_space(ev, dr, ws)
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
def _find_forces(ev: Any, part: Any, more: bool) -> int:
    """Forces of the contacts `part`; `more`: of others at rest too, which these press together again."""
    count, takes = whole(ev)[COUNT], col(ev, TAKES)
    direction, b, p = col(ev, DIRECTION), vec(ev.space_b, 3 * count), vec(ev.space_p, 3 * count)
    fastest, any_slips, a = 0.0, False, pressing(ev, count)
    for i in range(count):
        takes[i] = part[i]
        any_slips = any_slips or col(ev, SLIPS)[i] != 0.0
        b[i], b[count + i], b[2 * count + i] = col(ev, B_N)[i], col(ev, B_T)[i], col(ev, B_S)[i]
        fastest = max(fastest, abs(b[i]), abs(b[count + i]), abs(b[2 * count + i]))
        direction[i], col(ev, BASE)[i] = col(ev, KNOWN)[i], 0.0
    mu = col(ev, MU)
    for _ in range(2 * count + 2):
        for i in range(count):
            mu[i] = col(ev, KINETIC)[i] if direction[i] != 0.0 else col(ev, STATIC)[i]
        if not solve_cones_in_space(ev, a, count, takes, b, mu, col(ev, BASE), direction, p):
            _name_jammed(ev)
            return NO_FORCES
        again = False
        for i in range(count):
            w_n, w_t, w_s = b[i], b[count + i], b[2 * count + i]
            for j in range(3 * count):
                w_n += a[i, j] * p[j]
                w_t += a[count + i, j] * p[j]
                w_s += a[2 * count + i, j] * p[j]
            col(ev, F_N)[i], col(ev, F_T)[i], col(ev, F_S)[i] = p[i], p[count + i], p[2 * count + i]
            col(ev, W_N)[i], col(ev, W_T)[i], col(ev, W_S)[i] = w_n, w_t, w_s
            if direction[i] == 0.0 and mu[i] > 0.0 and p[i] > 0.0:
                # at its limit, and it moves: it begins to slide, against its friction
                force, limit = math.sqrt(p[count + i] ** 2 + p[2 * count + i] ** 2), mu[i] * p[i]
                moves = math.sqrt(w_t * w_t + w_s * w_s) > STICKS_STILL * fastest
                # contacts that hold each other reach it together
                now = any_slips
                least = limit * (1.0 - (REACHES_LIMIT_NOW if now else REACHES_LIMIT))
                if force >= least and (moves or now):
                    direction[i] = BEGINS
                    col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = -p[count + i] / force, -p[2 * count + i] / force
                    again = again or now or col(ev, KINETIC)[i] != col(ev, STATIC)[i]
            elif more and takes[i] == 0.0 and col(ev, AT_REST)[i] != 0.0:
                if w_n < -1e3 * real(ev)[NONE] * col(ev, SIZE)[i]:
                    takes[i], again = 1.0, True
        if not again:
            break
    return SETTLED


@internal
def _lightened(ev: Any, i: int) -> float:
    """Part of the inverse mass along the normal that friction of a sliding contact leaves."""
    count = whole(ev)[COUNT]
    a = masses(ev, count)
    turned = a[i, count + i] * col(ev, COS_WAY)[i] + a[i, 2 * count + i] * col(ev, SIN_WAY)[i]
    return (a[i, i] - col(ev, KINETIC)[i] * turned) / a[i, i]


@internal
def _name_jammed(ev: Any) -> None:
    whole(ev)[WHO] = -1
    for i in range(whole(ev)[COUNT] - 1, -1, -1):
        if col(ev, DIRECTION)[i] != 0.0 and _lightened(ev, i) <= 0.0:
            whole(ev)[WHO] = ivec(ev.contacts, ev.most)[i]


@internal
def _refuse_jam(ev: Any) -> int:
    """Painleve's paradox: friction turns the effect of the normal force round."""
    for i in range(whole(ev)[COUNT]):
        pressed = col(ev, F_N)[i] > 0.0 or col(ev, WAS)[i] == CLOSED
        if col(ev, DIRECTION)[i] != 0.0 and pressed and _lightened(ev, i) <= NEARLY_JAMMED:
            whole(ev)[WHO] = ivec(ev.contacts, ev.most)[i]
            return JAMS
    return SETTLED


# ---- what it means --------------------------------------------------------------------------------------------------


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
def _part(ev: Any, count: int, row: int, which: int) -> Any:
    """(direction, factor) of the two that make row `row`: a normal, or the first or second tangent of a contact, in its
    own frame."""
    i = row % count
    c, s = col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i]
    if row < count:
        return (row, 1.0) if which == 0 else (row, 0.0)
    if row < 2 * count:
        return (count + i, c) if which == 0 else (2 * count + i, s)
    return (count + i, -s) if which == 0 else (2 * count + i, c)


@internal
def _between(ev: Any, count: int, one: int, other: int) -> float:
    """Inverse mass between two rows."""
    a, total = masses(ev, count), 0.0
    for j in range(2):
        p, of_p = _part(ev, count, one, j)
        for k in range(2):
            q, of_q = _part(ev, count, other, k)
            total += of_p * of_q * a[p, q]
    return total


@internal
def _hold(ev: Any, total: int, i: int, rank: float) -> int:
    """Along which tangents contact i is held by itself beside the first `total` rows in `some`: both, one, or none, to
    NEW_SLIDE with the way and the share; the rows go to `some`, and their number is returned. One is that which the
    others hold least."""
    count, some = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most)
    f_n, f_t, f_s = col(ev, F_N)[i], col(ev, F_T)[i], col(ev, F_S)[i]
    cos_way, sin_way, c, s = col(ev, COS_WAY), col(ev, SIN_WAY), col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i]
    cos_way[i], sin_way[i] = 1.0, 0.0
    matrix, rows = mat(ev.space_room, total, total), (count + i, 2 * count + i)
    right = mat(ev.space_room + 8 * total * total, total, 2)
    found = mat(ev.space_room + 8 * total * (total + 2), total, 2)
    for k in range(total):
        for j in range(2):
            right[k, j] = _between(ev, count, some[k], rows[j])
        for j in range(total):
            matrix[k, j] = _between(ev, count, some[k], some[j])
    most = 3 * ev.most
    work = ev.space_room + 8 * (most * most + 4 * most)
    call_least_norm(cones_at(ev.cones).least_norm, matrix, right, found, RANK_OF_HELD, work)
    # what is left of both, and its principal directions
    left_11, left_12 = _between(ev, count, rows[0], rows[0]), _between(ev, count, rows[0], rows[1])
    left_22 = _between(ev, count, rows[1], rows[1])
    least = max(rank, RANK_OF_HELD) * (left_11 + left_22)
    for k in range(total):
        first, second = _between(ev, count, some[k], rows[0]), _between(ev, count, some[k], rows[1])
        left_11 -= first * found[k, 0]
        left_12 -= first * found[k, 1]
        left_22 -= second * found[k, 1]
    half, radius = 0.5 * (left_11 + left_22), math.hypot(0.5 * (left_11 - left_22), left_12)
    if half - radius > least:
        col(ev, NEW_SLIDE)[i], col(ev, NEW_RATIO)[i] = STUCK, 0.0
        some[total], some[total + 1] = rows
        return 2
    if half + radius > least:
        angle = 0.5 * math.atan2(2.0 * left_12, left_11 - left_22)
        cos_way[i], sin_way[i] = math.cos(angle), math.sin(angle)
        col(ev, NEW_SLIDE)[i] = ALONG
        col(ev, NEW_RATIO)[i] = (cos_way[i] * f_s - sin_way[i] * f_t) / f_n if f_n > 0.0 else 0.0
        some[total] = rows[0]
        return 1
    cos_way[i], sin_way[i] = c, s
    return 0


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
        good = _find_forces(ev, kept, False) == SETTLED
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
    rank, normals, fastest = real(ev)[RANK], 0, 0.0
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
            col(ev, NEW_SLIDE)[i], col(ev, NEW_RATIO)[i] = 1.0, -col(ev, KINETIC)[i]
            continue
        # until it is known whether its tangents are told from others: a share
        col(ev, NEW_SLIDE)[i] = IDLE
        col(ev, NEW_RATIO)[i] = size / f_n[i] if f_n[i] > 0.0 and rubs else 0.0
        col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = (f_t[i] / size, f_s[i] / size) if size > 0.0 else (1.0, 0.0)
        if rubs:
            total += _hold(ev, total, i, rank)
            full = size >= (1.0 - REACHES_LIMIT_NOW) * col(ev, STATIC)[i] * f_n[i]
            if col(ev, NEW_SLIDE)[i] == ALONG and full:
                col(ev, NEW_RATIO)[i] = 0.0
    return SETTLED
