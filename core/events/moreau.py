"""What several contacts in space do, decided by a moment of time instead of by forces.

Where a body stops on many feet, all of them come to rest together, each at a speed that is nearly nothing; which of
them stick then, and which way the others begin to slide, forces alone say only if each speed is known to be zero or
not. And where friction wedges contacts there are no forces at all. Both are settled by what a short moment of time
would do: velocities that may change by impulses, with the free accelerations times the moment added and no direction of
sliding given (Moreau 1988; Jean 1999). That problem always has a solution. What would stop within the moment is
stopped, what would slide slides as it would at the moment's end; divided by the moment, impulses are forces.
"""

from typing import Any

from ..assembly.evaluate import evaluate_energy
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..linalg.small import call_least_norm
from ..methods.history import history_time
from ..rounding import DIRECTION_RANK, REACHES_LIMIT, REACHES_LIMIT_NOW
from ..state.run_records import IMPACT
from ..state.workspace_records import CONTROL_SIZE, RATE_SCALE
from .forces import cones_at
from .loaded import note_loaded
from .rates import masses, pressing, push, solve_cone_problem
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
    HELD_SPIN,
    KINETIC,
    KNOWN,
    LEAVES,
    LOADED,
    LOST_BEFORE,
    MU,
    P_N,
    P_S,
    P_T,
    RATE,
    ROUNDING,
    SIN_WAY,
    SLIDE_BEFORE,
    SLIDE_RATE,
    SLIPS,
    SLOW,
    SPARE,
    STATIC,
    STOP_IMPULSE,
    STOP_LOSS,
    STOPS,
    STRUCK,
    SWAY_BEFORE,
    SWAY_RATE,
    TAKES,
    W_N,
    W_S,
    W_T,
    col,
    whole,
)
from .report import report
from .three_tangents import size_of
from .touching import looks_again

FIRST_LOOK, SHORT, LONG = 3, 1e-11, 1e-5
"""From this look at one instant on a moment decides: SHORT of the model's own time at first, ten times as long at each
of the following looks, at most LONG."""
OF_A_CROWD = 1e-7
"""The same where instants crowd (`zeno.py`)."""
WEDGED = 1e-6
"""How long a moment is in which wedged contacts stop, in parts of the time in which free accelerations make the speeds
of sliding."""
SLIDES = 1e-6
"""Of what the free accelerations make in the moment: what moves less along its tangents at its end sticks."""
SPINS = 0.9
"""Part of the torque against spinning from which on a contact does not creep, but spins."""
FAST = 1e3
"""Of the same: what moves more goes on as it did. Where a speed changes by more, the contact has been struck."""


@internal
def _fastest(ev: Any) -> float:
    """The largest of the free accelerations, m/s^2."""
    largest = 0.0
    for i in range(whole(ev)[COUNT]):
        largest = max(largest, abs(col(ev, B_N)[i]), abs(col(ev, B_T)[i]), abs(col(ev, B_S)[i]))
    return largest


@internal
def moment_asked(ev: Any, dr: Any, ws: Any) -> float:
    """The moment, s, that an instant which does not settle asks for; 0: none."""
    again, part = looks_again(dr) - FIRST_LOOK, 0.0
    for i in range(whole(ev)[COUNT]):
        if col(ev, SLOW)[i] > 0.0:
            part = OF_A_CROWD
    if again >= 0:
        part = max(part, min(SHORT * 10.0**again, LONG))
    return part / vec(ws.control, CONTROL_SIZE)[RATE_SCALE]


@internal
def moment_of_wedge(ev: Any, ws: Any) -> float:
    """The moment, s, in which wedged contacts stop; 0: none slides."""
    speed, largest = 0.0, _fastest(ev)
    for i in range(whole(ev)[COUNT]):
        if col(ev, AT_REST)[i] != 0.0:
            speed = max(speed, abs(col(ev, SLIDE_RATE)[i]), abs(col(ev, SWAY_RATE)[i]))
    if largest == 0.0:
        return 0.0
    return max(WEDGED * speed / largest, SHORT / vec(ws.control, CONTROL_SIZE)[RATE_SCALE])


@internal
def decide_by_moment(ev: Any, dr: Any, ws: Any, ms: Any, part: Any, moment: float) -> bool:
    """Forces of the contacts `part`, which are at rest, as `find_forces` gives them, from what this moment (s)
    would do; what it stops is stopped. Rates and free accelerations are given. False, and nothing is done: no moment,
    or nothing moves by itself, or no impulses are found."""
    count, least = whole(ev)[COUNT], moment * _fastest(ev)
    if least == 0.0:
        return False
    b, p, a = vec(ev.space_b, 3 * count), vec(ev.space_p, 3 * count), pressing(ev, count)
    mu, none, takes, base = col(ev, MU), col(ev, SPARE), col(ev, TAKES), col(ev, BASE)
    of_n, of_t, of_s = col(ev, RATE), col(ev, SLIDE_RATE), col(ev, SWAY_RATE)
    for i in range(count):
        takes[i], none[i], base[i] = part[i], 0.0, 0.0
        mu[i] = col(ev, KINETIC)[i] if col(ev, KNOWN)[i] != 0.0 else col(ev, STATIC)[i]
        b[i] = (0.0 if abs(of_n[i]) <= col(ev, ROUNDING)[i] else of_n[i]) + moment * col(ev, B_N)[i]
        b[count + i] = of_t[i] + moment * col(ev, B_T)[i]
        b[2 * count + i] = of_s[i] + moment * col(ev, B_S)[i]
    if not solve_cone_problem(ev, a, count, takes, b, mu, base, none, p):
        return False
    for i in range(count):
        col(ev, P_N)[i], col(ev, P_T)[i], col(ev, P_S)[i] = p[i], p[count + i], p[2 * count + i]
        col(ev, F_N)[i], col(ev, F_T)[i], col(ev, F_S)[i] = (
            p[i] / moment, p[count + i] / moment, p[2 * count + i] / moment
        )  # fmt: skip
    # the motion at the moment's end
    for i in range(3 * count):
        motion, to = b[i], W_N if i < count else (W_T if i < 2 * count else W_S)
        for j in range(3 * count):
            motion += a[i, j] * p[j]
        col(ev, to)[i % count] = motion
    _say_what_slides(ev, least)
    pressed, slow = col(ev, BASE), col(ev, SPARE)
    for i in range(count):
        pressed[i] = 1.0 if col(ev, P_N)[i] > 0.0 else 0.0
        other = i + int(col(ev, COMPANION)[i])
        moves = abs(col(ev, W_T)[i]) + abs(col(ev, W_S)[i])
        if other != i:
            moves += abs(col(ev, W_T)[other]) + abs(col(ev, W_S)[other])
        slow[i] = 1.0 if moves <= FAST * least else 0.0
    _move(ev, dr, ws, pressed, slow, True, True)
    _report(ev, dr, ms, least)
    for i in range(count):
        col(ev, W_N)[i] = (col(ev, W_N)[i] - of_n[i]) / moment
        col(ev, W_T)[i] = (col(ev, W_T)[i] - of_t[i]) / moment
        col(ev, W_S)[i] = (col(ev, W_S)[i] - of_s[i]) / moment
    note_loaded(ev, ws)
    return True


@internal
def _say_what_slides(ev: Any, least: float) -> None:
    """DIRECTION and the way of sliding from the motion at the moment's end; 0 where a contact sticks or is open."""
    direction = col(ev, DIRECTION)
    for i in range(whole(ev)[COUNT]):
        x, y, p_n = col(ev, W_T)[i], col(ev, W_S)[i], col(ev, P_N)[i]
        speed, friction = size_of(ev, i, col(ev, W_T), col(ev, W_S)), size_of(ev, i, col(ev, P_T), col(ev, P_S))
        inside = p_n > 0.0 and friction < col(ev, MU)[i] * p_n * (1.0 - REACHES_LIMIT)
        before = size_of(ev, i, col(ev, SLIDE_RATE), col(ev, SWAY_RATE))
        direction[i] = col(ev, KNOWN)[i] = 0.0
        col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = 1.0, 0.0
        spins = abs(col(ev, HELD_SPIN)[i]) > SPINS
        if col(ev, STATIC)[i] > 0.0 and ((not inside and speed > SLIDES * least) or spins):
            # what has slid or spun goes on, the other begins
            direction[i] = 1.0 if before > col(ev, ROUNDING)[i] or spins else 2.0
            col(ev, KNOWN)[i] = 1.0
            if speed > 0.0:
                col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = x / speed, y / speed
        elif col(ev, SLIPS)[i] != 0.0 and friction > (1.0 - REACHES_LIMIT_NOW) * col(ev, MU)[i] * max(p_n, 0.0):
            # its event is that it reaches its limit: others' directions are not those of the moment's end to the last
            # digit, and with them it may be just within
            direction[i], col(ev, KNOWN)[i] = 2.0, 1.0
            col(ev, COS_WAY)[i], col(ev, SIN_WAY)[i] = -col(ev, P_T)[i] / friction, -col(ev, P_S)[i] / friction


@internal
def stop_rates(ev: Any, dr: Any, ws: Any) -> None:
    """Take away what is left of the rates of contacts that press, along the normals and, where friction decides, along
    the tangents: what begins to slide there begins at rest. With accounts."""
    still, slips, opens = col(ev, SPARE), False, False
    for i in range(whole(ev)[COUNT]):
        still[i] = 1.0 if col(ev, KNOWN)[i] == 0.0 and col(ev, STATIC)[i] > 0.0 else 0.0
        speed = size_of(ev, i, col(ev, SLIDE_RATE), col(ev, SWAY_RATE))
        if col(ev, LOADED)[i] != 0.0:
            begins = col(ev, DIRECTION)[i] != 0.0
            slips = slips or (still[i] != 0.0 and speed > (0.0 if begins else col(ev, ROUNDING)[i]))
            opens = opens or abs(col(ev, RATE)[i]) > col(ev, ROUNDING)[i]
    if slips:
        _move(ev, dr, ws, col(ev, LOADED), still, False, True)
    # what would open by less than can be seen: rounding's worth, which no account sees
    if opens:
        _move(ev, dr, ws, col(ev, LOADED), still, False, False)


@internal
def _move(ev: Any, dr: Any, ws: Any, pressed: Any, slow: Any, slides: bool, accounts: bool) -> None:
    """Take away the rates of the contacts that press, and along the tangents of those that are slow; or, with `slides`,
    leave these the motion W_T and W_S if they slide. By the least impulses at the contacts. `accounts`: they count,
    and the energy that they take."""
    count, some, size = whole(ev)[COUNT], ivec(ev.some, 3 * ev.most), 0
    a, p = masses(ev, count), vec(ev.space_p, 3 * count)
    rate, slide, sway, loss = col(ev, RATE), col(ev, SLIDE_RATE), col(ev, SWAY_RATE), col(ev, STOP_LOSS)
    for block in range(3):
        for i in range(count):
            row = block * count + i
            if pressed[i] != 0.0 and (block == 0 or (slow[i] != 0.0 and a[row, row] > 0.0)):
                some[size] = row
                size += 1
    matrix = mat(ev.space_room, size, size)
    right, found = mat(ev.space_room + 8 * size * size, size, 1), mat(ev.space_room + 8 * size * (size + 1), size, 1)
    for k in range(size):
        row, i, target = some[k], some[k] % count, 0.0
        sticks = not slides or col(ev, DIRECTION)[i] == 0.0
        if row < count:
            # (sliding that stops lets what opens go on)
            now, target = rate[i], max(rate[i], 0.0) if accounts and not slides else 0.0
        elif row < 2 * count:
            now, target = slide[i], 0.0 if sticks else col(ev, W_T)[i]
        else:
            now, target = sway[i], 0.0 if sticks else col(ev, W_S)[i]
        right[k, 0] = target - now
        for l in range(size):
            matrix[k, l] = a[row, some[l]]
    most = 3 * ev.most
    work = ev.space_room + 8 * (most * most + 4 * most)
    call_least_norm(cones_at(ev.cones).least_norm, matrix, right, found, DIRECTION_RANK, work)
    for i in range(3 * count):
        p[i] = 0.0
    for k in range(size):
        p[some[k]] = found[k, 0]
    if not accounts:
        push(ev, ws, p)
        return
    energy, lost = vec(ws.energy, 3), 0.0
    evaluate_energy(ws)
    before = energy[0]
    for i in range(count):
        col(ev, SLIDE_BEFORE)[i], col(ev, SWAY_BEFORE)[i], col(ev, LOST_BEFORE)[i] = slide[i], sway[i], loss[i]
    for turn in range(2):
        if turn == 1:
            push(ev, ws, p)
        for i in range(count):
            work_done = p[i] * rate[i] + p[count + i] * slide[i] + p[2 * count + i] * sway[i]
            loss[i] -= 0.5 * work_done
            lost -= 0.5 * work_done
    evaluate_energy(ws)
    for i in range(count):
        col(ev, STOP_IMPULSE)[i] += p[i]
    if dr.input_account >= 0:
        vec(ws.v, ws.n_ext)[dr.input_account] += energy[0] - before + lost


@internal
def _report(ev: Any, dr: Any, ms: Any, least: float) -> None:
    """Events of the contacts whose sliding has jumped: then velocities alone say what moves how."""
    count, p = whole(ev)[COUNT], vec(ev.space_p, 3 * whole(ev)[COUNT])
    for i in range(count):
        x = col(ev, SLIDE_RATE)[i] - col(ev, SLIDE_BEFORE)[i]
        y = col(ev, SWAY_RATE)[i] - col(ev, SWAY_BEFORE)[i]
        if (x * x + y * y) ** 0.5 > FAST * least and col(ev, P_N)[i] > 0.0 and col(ev, COMPANION)[i] == 0.0:
            friction = (p[count + i] ** 2 + p[2 * count + i] ** 2) ** 0.5
            lost, apart = col(ev, STOP_LOSS)[i] - col(ev, LOST_BEFORE)[i], max(col(ev, RATE)[i], 0.0)
            k = ivec(ev.contacts, ev.most)[i]
            report(dr, history_time(ms, 0), IMPACT, k, p[i], lost, 0.0, apart, 0.0, friction)
            whole(ev)[STRUCK] = 1
    if whole(ev)[STRUCK] != 0:
        for i in range(count):
            col(ev, LEAVES)[i] = col(ev, STOPS)[i] = col(ev, SLIPS)[i] = 0.0
