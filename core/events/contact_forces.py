"""Forces of the contacts at rest, by exact friction cones: those under which none pulls, and what friction holds."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import REACHES_LIMIT, REACHES_LIMIT_NOW, STICKS_STILL
from ..state.run_records import loop_at
from .following_loads import solve_with_loads
from .free_tangents import find_sliding, list_held
from .loaded import note_loaded
from .painleve import name_jammed, refuse_jam
from .rates import pressing
from .reading import unresolved_speed
from .records import JAMS, NO_FORCES, SETTLED, clear, scalars, touching
from .resting import find_free
from .three_tangents import first_of, size_of
from .velocity_level_modes import decide_by_moment, moment_asked, moment_of_wedge, stop_rates

BEGINS = 2.0
"""In `slides`: sliding begins here."""


@internal
def find_forces(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Forces of all touching contacts (zero where they separate), with the accelerations that they leave, to
    `TOUCHING`; `slides` is 1 where the contact slides, 2 where it begins to. Where that has led to the same instant
    again and again, or to no forces, what would be a moment later decides."""
    if scalars(instant).accelerations_known == 0:
        status = find_free(instant, drive, workspace, 0.0)
        if status != SETTLED:
            return status
    if method.exact != 0 and decide_by_moment(
        instant, drive, workspace, method, vec(instant.at_rest, instant.most), moment_asked(instant, drive, workspace)
    ):
        return SETTLED
    part, loop = vec(instant.part, instant.most), loop_at(drive.loop)
    for i in range(scalars(instant).count):
        part[i] = 1.0 if vec(instant.at_rest, instant.most)[i] != 0.0 and touching(instant)[i].opens == 0.0 else 0.0
    status = balance(instant, workspace, method, loop, part)
    for _ in range(scalars(instant).count):
        if status != SETTLED or not _falls_back(instant, workspace, part):
            break
        status = balance(instant, workspace, method, loop, part)
    if status == SETTLED:
        note_loaded(instant, workspace)
        status = refuse_jam(instant, workspace)
    if status == SETTLED and method.exact != 0:
        stop_rates(instant, drive, workspace)
    wedged = (status == NO_FORCES or status == JAMS) and scalars(instant).count > 1 and method.exact != 0
    if wedged and decide_by_moment(
        instant, drive, workspace, method, vec(instant.at_rest, instant.most), moment_of_wedge(instant, workspace)
    ):
        return SETTLED
    return status


@internal
def _falls_back(instant: Any, workspace: Any, part: Any) -> bool:
    """True if gaps that open would, with these accelerations, open by less than could be told from zero: they are at
    rest too, and take `part` in the forces."""
    contact = touching(instant)
    found = False
    for i in range(scalars(instant).count):
        rate, k = contact[i].gap_rate, ivec(instant.contacts, instant.most)[i]
        if vec(instant.at_rest, instant.most)[i] == 0.0 and 0.0 < rate <= unresolved_speed(
            workspace, k, -contact[i].gap_acceleration
        ):
            vec(instant.at_rest, instant.most)[i], found = 1.0, True
            part[i] = 1.0 if contact[i].opens == 0.0 else 0.0
    return found


@internal
def _is_immovable(a: Any, count: int, i: int) -> bool:
    """True if no force moves touching contact i along its tangents."""
    return bool(a[count + i, count + i] == 0.0 and a[2 * count + i, 2 * count + i] == 0.0)


@internal
def _is_led(instant: Any, a: Any, count: int, i: int) -> bool:
    """True if no force moves it along those of its companion either."""
    return _is_immovable(a, count, i) and _is_immovable(a, count, i + int(touching(instant)[i].companion))


@internal
def balance(instant: Any, workspace: Any, method: Any, loop: Any, part: Any) -> int:
    """Forces of the contacts `part`, and of others at rest that these press together again."""
    contact = touching(instant)
    count, takes = scalars(instant).count, vec(instant.pressing, instant.most)
    direction, b, p = (
        vec(instant.slides, instant.most),
        vec(instant.space_b, 3 * count),
        vec(instant.space_p, 3 * count),
    )
    fastest, any_slips, a = 0.0, False, pressing(instant, count)
    for i in range(count):
        takes[i] = part[i]
        any_slips = any_slips or contact[i].slips != 0.0
        b[i], b[count + i], b[2 * count + i] = (
            contact[i].free_gap_acceleration,
            contact[i].free_sliding_acceleration,
            contact[i].free_sliding_acceleration2,
        )
        fastest = max(fastest, abs(b[i]), abs(b[count + i]), abs(b[2 * count + i]))
        direction[i], vec(instant.base, instant.most)[i] = vec(instant.known_direction, instant.most)[i], 0.0
        begins = size_of(instant, i, contact.free_sliding_acceleration, contact.free_sliding_acceleration2)
        if _is_led(instant, a, count, i) and begins > 0.0 and direction[i] == 0.0 and contact[i].static_friction > 0.0:
            # its motion is prescribed, friction is against it
            direction[i], contact[i].direction_cos, contact[i].direction_sin = (
                BEGINS,
                b[count + i] / begins,
                b[2 * count + i] / begins,
            )
    mu, free = vec(instant.mu, instant.most), vec(instant.can_slide, instant.most)
    for _ in range(2 * count + 2):
        for i in range(count):
            mu[i] = contact[i].kinetic_friction if direction[i] != 0.0 else contact[i].static_friction
        if not solve_with_loads(
            instant, workspace, loop, a, takes, b, mu, vec(instant.base, instant.most), direction, p
        ):
            name_jammed(instant, workspace)
            return NO_FORCES
        joins, again = False, False
        for i in range(count):
            contact[i].normal_force, contact[i].friction_force, contact[i].friction_force2 = (
                p[i],
                p[count + i],
                p[2 * count + i],
            )
            w_n, w_t, w_s = b[i], b[count + i], b[2 * count + i]
            for j in range(3 * count):
                w_n += a[i, j] * p[j]
                w_t += a[count + i, j] * p[j]
                w_s += a[2 * count + i, j] * p[j]
            contact[i].gap_acceleration, contact[i].sliding_acceleration, contact[i].sliding_acceleration2 = (
                w_n,
                w_t,
                w_s,
            )
            if method.exact != 0 and takes[i] == 0.0 and vec(instant.at_rest, instant.most)[i] != 0.0:
                if w_n < -1e3 * scalars(instant).no_acceleration * contact[i].gradient_size:
                    takes[i], joins = 1.0, True
        if joins:
            # what begins to slide follows from the forces of all that press, not of those that did before
            for i in range(count):
                if direction[i] == BEGINS and not _is_led(instant, a, count, i):
                    direction[i] = 0.0
            continue
        clear(free, count)
        if any_slips:
            find_sliding(instant, list_held(instant, workspace, takes, REACHES_LIMIT_NOW, free), free)
        for i in range(count):
            if direction[i] == 0.0 and mu[i] > 0.0 and p[i] > 0.0:
                # at its limit, and it moves: it begins to slide, against its friction
                force, limit = size_of(instant, i, contact.friction_force, contact.friction_force2), mu[i] * p[i]
                moves = (
                    size_of(instant, i, contact.sliding_acceleration, contact.sliding_acceleration2)
                    > STICKS_STILL * fastest
                )
                # where a contact has its event at its limit, so have those that nothing else holds
                least = limit * (1.0 - (REACHES_LIMIT_NOW if any_slips else REACHES_LIMIT))
                if force >= least and (moves or free[first_of(instant, i)] != 0.0):
                    direction[i] = BEGINS
                    contact[i].direction_cos, contact[i].direction_sin = (
                        -p[count + i] / force,
                        -p[2 * count + i] / force,
                    )
                    again = again or any_slips or contact[i].kinetic_friction != contact[i].static_friction
        if not again:
            break
    return SETTLED
