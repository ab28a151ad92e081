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
from ..state.workspace_records import control_at
from .independent_directions import cones_at
from .loaded import note_loaded
from .rates import masses, pressing, push, solve_cone_problem
from .records import scalars, touching
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
def _fastest(instant: Any) -> float:
    """The largest of the free accelerations, m/s^2."""
    contact = touching(instant)
    largest = 0.0
    for i in range(scalars(instant).count):
        largest = max(
            largest,
            abs(contact[i].free_gap_acceleration),
            abs(contact[i].free_sliding_acceleration),
            abs(contact[i].free_sliding_acceleration2),
        )
    return largest


@internal
def moment_asked(instant: Any, drive: Any, workspace: Any) -> float:
    """The moment, s, that an instant which does not settle asks for; 0: none."""
    again, part = looks_again(drive) - FIRST_LOOK, 0.0
    for i in range(scalars(instant).count):
        if touching(instant)[i].least_sliding_speed > 0.0:
            part = OF_A_CROWD
    if again >= 0:
        part = max(part, min(SHORT * 10.0**again, LONG))
    return part / control_at(workspace.control).rate_scale


@internal
def moment_of_wedge(instant: Any, workspace: Any) -> float:
    """The moment, s, in which wedged contacts stop; 0: none slides."""
    speed, largest = 0.0, _fastest(instant)
    for i in range(scalars(instant).count):
        if vec(instant.at_rest, instant.most)[i] != 0.0:
            speed = max(speed, abs(touching(instant)[i].sliding_rate), abs(touching(instant)[i].sliding_rate2))
    if largest == 0.0:
        return 0.0
    return max(WEDGED * speed / largest, SHORT / control_at(workspace.control).rate_scale)


@internal
def decide_by_moment(instant: Any, drive: Any, workspace: Any, method: Any, part: Any, moment: float) -> bool:
    """Forces of the contacts `part`, which are at rest, as `find_forces` gives them, from what this moment (s)
    would do; what it stops is stopped. Rates and free accelerations are given. False, and nothing is done: no moment,
    or nothing moves by itself, or no impulses are found."""
    contact = touching(instant)
    count, least = scalars(instant).count, moment * _fastest(instant)
    if least == 0.0:
        return False
    b, p, a = vec(instant.space_b, 3 * count), vec(instant.space_p, 3 * count), pressing(instant, count)
    mu, none, takes, base = (
        vec(instant.mu, instant.most),
        vec(instant.undirected, instant.most),
        vec(instant.pressing, instant.most),
        vec(instant.base, instant.most),
    )
    of_n, of_t, of_s = contact.gap_rate, contact.sliding_rate, contact.sliding_rate2
    for i in range(count):
        takes[i], none[i], base[i] = part[i], 0.0, 0.0
        mu[i] = (
            contact[i].kinetic_friction
            if vec(instant.known_direction, instant.most)[i] != 0.0
            else contact[i].static_friction
        )
        b[i] = (0.0 if abs(of_n[i]) <= contact[i].rate_rounding else of_n[i]) + moment * contact[
            i
        ].free_gap_acceleration
        b[count + i] = of_t[i] + moment * contact[i].free_sliding_acceleration
        b[2 * count + i] = of_s[i] + moment * contact[i].free_sliding_acceleration2
    if not solve_cone_problem(instant, a, count, takes, b, mu, base, none, p):
        return False
    for i in range(count):
        contact[i].normal_impulse, contact[i].friction_impulse, contact[i].friction_impulse2 = (
            p[i],
            p[count + i],
            p[2 * count + i],
        )
        contact[i].normal_force, contact[i].friction_force, contact[i].friction_force2 = (
            p[i] / moment, p[count + i] / moment, p[2 * count + i] / moment
        )  # fmt: skip
    # the motion at the moment's end
    for i in range(3 * count):
        motion = b[i]
        for j in range(3 * count):
            motion += a[i, j] * p[j]
        if i < count:
            contact[i].gap_acceleration = motion
        elif i < 2 * count:
            contact[i - count].sliding_acceleration = motion
        else:
            contact[i - 2 * count].sliding_acceleration2 = motion
    _say_what_slides(instant, least)
    pressed, slow = vec(instant.pressed, instant.most), vec(instant.slow, instant.most)
    for i in range(count):
        pressed[i] = 1.0 if contact[i].normal_impulse > 0.0 else 0.0
        other = i + int(contact[i].companion)
        moves = abs(contact[i].sliding_acceleration) + abs(contact[i].sliding_acceleration2)
        if other != i:
            moves += abs(contact[other].sliding_acceleration) + abs(contact[other].sliding_acceleration2)
        slow[i] = 1.0 if moves <= FAST * least else 0.0
    _move(instant, drive, workspace, pressed, slow, True, True)
    _report(instant, drive, method, least)
    for i in range(count):
        contact[i].gap_acceleration = (contact[i].gap_acceleration - of_n[i]) / moment
        contact[i].sliding_acceleration = (contact[i].sliding_acceleration - of_t[i]) / moment
        contact[i].sliding_acceleration2 = (contact[i].sliding_acceleration2 - of_s[i]) / moment
    note_loaded(instant, workspace)
    return True


@internal
def _say_what_slides(instant: Any, least: float) -> None:
    """`slides` and the direction from the motion at the moment's end; 0 where a contact sticks or is open."""
    contact = touching(instant)
    direction = vec(instant.slides, instant.most)
    for i in range(scalars(instant).count):
        x, y, p_n = contact[i].sliding_acceleration, contact[i].sliding_acceleration2, contact[i].normal_impulse
        speed, friction = (
            size_of(instant, i, contact.sliding_acceleration, contact.sliding_acceleration2),
            size_of(instant, i, contact.friction_impulse, contact.friction_impulse2),
        )
        inside = p_n > 0.0 and friction < vec(instant.mu, instant.most)[i] * p_n * (1.0 - REACHES_LIMIT)
        before = size_of(instant, i, contact.sliding_rate, contact.sliding_rate2)
        direction[i] = vec(instant.known_direction, instant.most)[i] = 0.0
        contact[i].direction_cos, contact[i].direction_sin = 1.0, 0.0
        spins = abs(contact[i].spin_share) > SPINS
        if contact[i].static_friction > 0.0 and ((not inside and speed > SLIDES * least) or spins):
            # what has slid or spun goes on, the other begins
            direction[i] = 1.0 if before > contact[i].rate_rounding or spins else 2.0
            vec(instant.known_direction, instant.most)[i] = 1.0
            if speed > 0.0:
                contact[i].direction_cos, contact[i].direction_sin = x / speed, y / speed
        elif contact[i].slips != 0.0 and friction > (1.0 - REACHES_LIMIT_NOW) * vec(instant.mu, instant.most)[i] * max(
            p_n, 0.0
        ):
            # its event is that it reaches its limit: others' directions are not those of the moment's end to the last
            # digit, and with them it may be just within
            direction[i], vec(instant.known_direction, instant.most)[i] = 2.0, 1.0
            contact[i].direction_cos, contact[i].direction_sin = (
                -contact[i].friction_impulse / friction,
                -contact[i].friction_impulse2 / friction,
            )


@internal
def stop_rates(instant: Any, drive: Any, workspace: Any) -> None:
    """Take away what is left of the rates of contacts that press, along the normals and, where friction decides, along
    the tangents: what begins to slide there begins at rest. With accounts."""
    contact = touching(instant)
    still, slips, opens = vec(instant.slow, instant.most), False, False
    for i in range(scalars(instant).count):
        still[i] = (
            1.0 if vec(instant.known_direction, instant.most)[i] == 0.0 and contact[i].static_friction > 0.0 else 0.0
        )
        speed = size_of(instant, i, contact.sliding_rate, contact.sliding_rate2)
        if vec(instant.loaded, instant.most)[i] != 0.0:
            begins = vec(instant.slides, instant.most)[i] != 0.0
            slips = slips or (still[i] != 0.0 and speed > (0.0 if begins else contact[i].rate_rounding))
            opens = opens or abs(contact[i].gap_rate) > contact[i].rate_rounding
    if slips:
        _move(instant, drive, workspace, vec(instant.loaded, instant.most), still, False, True)
    # what would open by less than can be seen: rounding's worth, which no account sees
    if opens:
        _move(instant, drive, workspace, vec(instant.loaded, instant.most), still, False, False)


@internal
def _move(instant: Any, drive: Any, workspace: Any, pressed: Any, slow: Any, slides: bool, accounts: bool) -> None:
    """Take away the rates of the contacts that press, and along the tangents of those that are slow; or, with `slides`,
    leave these their sliding motion if they slide. By the least impulses at the contacts. `accounts`: they count,
    and the energy that they take."""
    contact = touching(instant)
    count, some, size = scalars(instant).count, ivec(instant.some, 3 * instant.most), 0
    a, p = masses(instant, count), vec(instant.space_p, 3 * count)
    rate, slide, sway, loss = contact.gap_rate, contact.sliding_rate, contact.sliding_rate2, contact.stopping_loss
    for block in range(3):
        for i in range(count):
            row = block * count + i
            if pressed[i] != 0.0 and (block == 0 or (slow[i] != 0.0 and a[row, row] > 0.0)):
                some[size] = row
                size += 1
    matrix = mat(instant.space_room, size, size)
    right, found = (
        mat(instant.space_room + 8 * size * size, size, 1),
        mat(instant.space_room + 8 * size * (size + 1), size, 1),
    )
    for k in range(size):
        row, i, target = some[k], some[k] % count, 0.0
        sticks = not slides or vec(instant.slides, instant.most)[i] == 0.0
        if row < count:
            # (sliding that stops lets what opens go on)
            now, target = rate[i], max(rate[i], 0.0) if accounts and not slides else 0.0
        elif row < 2 * count:
            now, target = slide[i], 0.0 if sticks else contact[i].sliding_acceleration
        else:
            now, target = sway[i], 0.0 if sticks else contact[i].sliding_acceleration2
        right[k, 0] = target - now
        for l in range(size):
            matrix[k, l] = a[row, some[l]]
    most = 3 * instant.most
    work = instant.space_room + 8 * (most * most + 4 * most)
    call_least_norm(cones_at(instant.cones).least_norm, matrix, right, found, DIRECTION_RANK, work)
    for i in range(3 * count):
        p[i] = 0.0
    for k in range(size):
        p[some[k]] = found[k, 0]
    if not accounts:
        push(instant, workspace, p)
        return
    energy, lost = vec(workspace.energy, 3), 0.0
    evaluate_energy(workspace)
    before = energy[0]
    for i in range(count):
        contact[i].sliding_rate_before, contact[i].sliding_rate2_before, contact[i].stopping_loss_before = (
            slide[i],
            sway[i],
            loss[i],
        )
    for turn in range(2):
        if turn == 1:
            push(instant, workspace, p)
        for i in range(count):
            work_done = p[i] * rate[i] + p[count + i] * slide[i] + p[2 * count + i] * sway[i]
            loss[i] -= 0.5 * work_done
            lost -= 0.5 * work_done
    evaluate_energy(workspace)
    for i in range(count):
        contact[i].stopping_impulse += p[i]
    if drive.input_account >= 0:
        vec(workspace.v, workspace.n_ext)[drive.input_account] += energy[0] - before + lost


@internal
def _report(instant: Any, drive: Any, method: Any, least: float) -> None:
    """Events of the contacts whose sliding has jumped: then velocities alone say what moves how."""
    contact = touching(instant)
    count, p = scalars(instant).count, vec(instant.space_p, 3 * scalars(instant).count)
    for i in range(count):
        x = contact[i].sliding_rate - contact[i].sliding_rate_before
        y = contact[i].sliding_rate2 - contact[i].sliding_rate2_before
        if (x * x + y * y) ** 0.5 > FAST * least and contact[i].normal_impulse > 0.0 and contact[i].companion == 0.0:
            friction = (p[count + i] ** 2 + p[2 * count + i] ** 2) ** 0.5
            lost, apart = contact[i].stopping_loss - contact[i].stopping_loss_before, max(contact[i].gap_rate, 0.0)
            k = ivec(instant.contacts, instant.most)[i]
            report(drive, history_time(method, 0), IMPACT, k, p[i], lost, 0.0, apart, 0.0, friction)
            scalars(instant).struck = 1
    if scalars(instant).struck != 0:
        for i in range(count):
            contact[i].opens = contact[i].stops = contact[i].slips = 0.0
