"""The broad phase: sweep and prune over balls around the shapes, for pairs that are far from each other.

Each shape that may touch many others lies in a ball about a point of its body. A sweep along the axis on which the
centres differ most finds the balls that come near within a *skin*, a way that is allowed to each (Verlet 1967 keeps
lists of neighbours like this; sweep and prune: Cohen, Lin, Manocha, Ponamgi 1995). Pairs that are not found sleep
deeply: nothing of them is looked at until a ball has gone as far as its skin, and the next sweep begins. What is found
is looked at by `contact_sleeping.py`, pair by pair. Balls and skins bound the motion within every step, so whether a
pair sleeps changes no bit of it, and nothing here is part of the state.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, ivec, mat, vec
from ..methods.history import history_row, history_time
from ..state.modes import OPEN, memories_at
from .ball_motion import no_ways, place_ball, ways_ahead, ways_in_step, within_skins
from .balls import (
    BALL_INTEGERS,
    BALL_MOVES,
    BALL_NUMBERS,
    BALL_RADIUS,
    IN_SPACE,
    MARKS,
    ORDERED,
    PAIRS_FOUND,
    RELATIVE_WAY,
    SIDE,
    SKIN,
    SWEEP_DUE,
    THICK_SKIN,
    VALID,
    WHO,
    WHOLE_WAY,
    WITHOUT_SLOT,
    tell_ball,
)
from .contact_evaluation import BRACKET, HAPPENS
from .contact_pool import begin_pairs, bind_new, find_half_spaces, find_pair, write_all_tables
from .contact_sleeping import AWAKE, DEEPLY, PLAINLY, show_elements, wake

SKIN_WAYS = 4.0
"""A skin is as thick as so many ways that the ball goes in the present step,"""
SKIN_SIZE = 0.05
"""and at least this share of its radius."""
TOO_THICK = 8.0
"""So many times as thick as it would be now: where that are the skins of half the balls, as behind a long step, it is
time for a sweep."""


@internal
def keep_watch(workspace: Any, method: Any, loop: Any) -> None:
    """Have the pairs looked at that could close within the step that ends at the current point, for which `set_travel`
    has been called: where a ball goes beyond its skin there, sweep at the newest row."""
    if not _sweeps(loop):
        return
    start, marks = history_row(workspace, method, 0), ivec(loop.broad, MARKS)
    ways_in_step(workspace, loop, start, vec(workspace.t, 1)[0] - history_time(method, 0))
    if marks[VALID] == 0 or marks[SWEEP_DUE] != 0 or not within_skins(loop, start):
        _sweep(workspace, method, loop, start)


@internal
def _sweeps(loop: Any) -> bool:
    """Slots of pools are taken even where no contact may sleep."""
    return bool(loop.n_balls > 0 and (loop.may_sleep != 0 or loop.n_slots > 0))


@internal
def begin_watch(workspace: Any, method: Any, loop: Any, h: float) -> None:
    """Let the pairs sleep that are far from each other, where all are awake, before a step of about h (s)."""
    if not _sweeps(loop) or ivec(loop.broad, MARKS)[VALID] != 0:
        return
    start = history_row(workspace, method, 0)
    ways_ahead(workspace, loop, start, h)
    _sweep(workspace, method, loop, start)


@internal
def begin_pools(workspace: Any, loop: Any) -> None:
    """Slots for the pairs that are near at the current point, where a run begins."""
    if loop.n_slots == 0:
        return
    write_all_tables(workspace, loop)
    ivec(loop.broad, MARKS)[WITHOUT_SLOT] = 0
    no_ways(workspace, loop)
    _sweep_at(workspace, loop, vec(workspace.q, workspace.n_ext))
    sleeping = ivec(workspace.sleeping, workspace.n_contacts)
    for slot in range(loop.n_slots):
        sleeping[ivec(loop.slot_contact, loop.n_slots)[slot]] = AWAKE
    ivec(loop.broad, MARKS)[VALID] = 0


@internal
def go_on(workspace: Any, loop: Any) -> None:
    """The step that ends at the current point has been accepted."""
    marks = ivec(loop.broad, MARKS)
    if not _sweeps(loop) or marks[VALID] == 0:
        return
    moves, balls = mat(loop.ball_moves, loop.n_balls, BALL_MOVES), mat(loop.balls, loop.n_balls, BALL_NUMBERS)
    thick = 0
    for i in range(loop.n_balls):
        now = max(SKIN_WAYS * moves[i, RELATIVE_WAY], SKIN_SIZE * balls[i, BALL_RADIUS])
        thick += 1 if moves[i, SKIN] > TOO_THICK * now else 0
    if 2 * thick > loop.n_balls:
        marks[SWEEP_DUE] = 1


@internal
def _measure(loop: Any) -> None:
    """Balls as the contacts' parameters are now: each about the point of one of its contacts, and so large that the
    shapes of all lie in it."""
    n = loop.n_balls
    coords, balls = imat(loop.ball_coords, n, BALL_INTEGERS), mat(loop.balls, n, BALL_NUMBERS)
    for i in range(n):
        # the numbers of a pool's shapes are known from the start
        if coords[i, WHO] >= 0:
            tell_ball(loop, coords[i, WHO], coords[i, SIDE], coords[i, IN_SPACE], balls[i])
    start = ivec(loop.pair_start, n + 1)
    others, contacts = ivec(loop.pair_other, start[n]), ivec(loop.pair_contact, start[n])
    turned, other = ivec(loop.pair_turned, start[n]), np.empty(BALL_NUMBERS)
    for i in range(n):
        for p in range(start[i], start[i + 1]):
            for side in range(2):
                ball = balls[i if side == turned[p] else others[p]]
                tell_ball(loop, contacts[p], side, coords[i, IN_SPACE], other)
                u, v, w = other[0] - ball[0], other[1] - ball[1], other[2] - ball[2]
                ball[BALL_RADIUS] = max(ball[BALL_RADIUS], other[BALL_RADIUS] + math.sqrt(u * u + v * v + w * w))


@internal
def _sweep(workspace: Any, method: Any, loop: Any, start: Any) -> None:
    """Sweep at the newest row; pairs that are found are awake then."""
    _sweep_at(workspace, loop, start)
    _choose(workspace, method, loop, ivec(loop.broad, MARKS))


@internal
def _sweep_at(workspace: Any, loop: Any, start: Any) -> None:
    """Find the pairs that are near at q = start, for the ways that are known of the present step."""
    marks, n = ivec(loop.broad, MARKS), loop.n_balls
    if marks[VALID] == 0:
        _measure(loop)
    axis = _place_all(loop, start)
    # where pools have no room for pairs that could come near in some steps, for those that could in this one
    for ways in (SKIN_WAYS, 1.0):
        moves, balls = mat(loop.ball_moves, n, BALL_MOVES), mat(loop.balls, n, BALL_NUMBERS)
        reach, shape_of = vec(loop.ball_reach, n), ivec(loop.ball_shape, n)
        for i in range(n):
            radius = balls[i, BALL_RADIUS]
            least = SKIN_SIZE * radius if ways > 1.0 else 0.0
            moves[i, SKIN] = max(ways * moves[i, RELATIVE_WAY], least)
            moves[i, THICK_SKIN] = max(ways * moves[i, WHOLE_WAY], least)
            reach[i] = (1.0 + PLAINLY) * radius + moves[i, SKIN]
        _order(loop, axis)
        marks[PAIRS_FOUND] += 1
        begin_pairs(loop)
        for i in range(n):
            if shape_of[i] >= 0:
                find_half_spaces(
                    loop,
                    i,
                    moves[i],
                    (1.0 + PLAINLY) * balls[i, BALL_RADIUS] + moves[i, THICK_SKIN],
                    marks[PAIRS_FOUND],
                )
        _find_pairs(workspace, loop, axis)
        if bind_new(workspace, loop, marks[PAIRS_FOUND]):
            break
        marks[WITHOUT_SLOT] = 1 if ways == 1.0 else 0
    marks[VALID], marks[SWEEP_DUE] = 1, 0


@internal
def _place_all(loop: Any, start: Any) -> int:
    """Where the balls are at q = start; the axis along which they differ most."""
    n, moves = loop.n_balls, mat(loop.ball_moves, loop.n_balls, BALL_MOVES)
    mean, spread = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in range(n):
        place_ball(loop, i, start, moves[i])
        x, y, z = moves[i, 0], moves[i, 1], moves[i, 2]
        mean = (mean[0] + x / n, mean[1] + y / n, mean[2] + z / n)
        spread = (spread[0] + x * x / n, spread[1] + y * y / n, spread[2] + z * z / n)
    widest, axis = -1.0, 0
    for j in range(3):
        if spread[j] - mean[j] * mean[j] > widest:
            widest, axis = spread[j] - mean[j] * mean[j], j
    return axis


@internal
def _order(loop: Any, axis: int) -> None:
    """The balls in the order in which they begin along an axis; nearly so since the last time."""
    n, marks, order = loop.n_balls, ivec(loop.broad, MARKS), ivec(loop.ball_order, loop.n_balls)
    moves, reach = mat(loop.ball_moves, n, BALL_MOVES), vec(loop.ball_reach, n)
    if marks[ORDERED] == 0:
        for i in range(n):
            order[i] = i
        marks[ORDERED] = 1
    for p in range(1, n):
        i, at = order[p], p
        low = moves[i, axis] - reach[i]
        while at > 0 and moves[order[at - 1], axis] - reach[order[at - 1]] > low:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i


@internal
def _find_pairs(workspace: Any, loop: Any, axis: int) -> None:
    """Sweep over the balls in order."""
    n, marks, order = loop.n_balls, ivec(loop.broad, MARKS), ivec(loop.ball_order, loop.n_balls)
    moves, reach = mat(loop.ball_moves, n, BALL_MOVES), vec(loop.ball_reach, n)
    shape_of = ivec(loop.ball_shape, n)
    for p in range(n):
        i = order[p]
        high = moves[i, axis] + reach[i]
        for other in range(p + 1, n):
            j = order[other]
            if moves[j, axis] - reach[j] > high:
                break
            both = reach[i] + reach[j]
            dx, dy, dz = moves[i, 0] - moves[j, 0], moves[i, 1] - moves[j, 1], moves[i, 2] - moves[j, 2]
            if dx * dx + dy * dy + dz * dz > both * both:
                continue
            if shape_of[i] < 0 and shape_of[j] < 0:
                _find(loop, i, j, marks[PAIRS_FOUND], workspace)
            elif shape_of[i] >= 0 and shape_of[j] >= 0:
                find_pair(loop, shape_of[i], shape_of[j], marks[PAIRS_FOUND])


@internal
def _find(loop: Any, i: int, j: int, number: int, workspace: Any) -> None:
    """Mark the contacts of balls i and j."""
    first, last = min(i, j), max(i, j)
    start = ivec(loop.pair_start, loop.n_balls + 1)
    low, high = start[first], start[first + 1]
    others, contacts = ivec(loop.pair_other, start[loop.n_balls]), ivec(loop.pair_contact, start[loop.n_balls])
    found, end = ivec(loop.pair_found, workspace.n_contacts), high
    while low < high:
        middle = (low + high) // 2
        if others[middle] < last:
            low = middle + 1
        else:
            high = middle
    while low < end and others[low] == last:
        found[contacts[low]] = number
        low += 1


@internal
def _choose(workspace: Any, method: Any, loop: Any, marks: Any) -> None:
    """Wake the pairs that were found, and let those sleep deeply that were not and are open."""
    n = workspace.n_contacts
    looked, found, sleeping = ivec(workspace.looked, n + 1), ivec(loop.pair_found, n), ivec(workspace.sleeping, n)
    memory, brackets, count = memories_at(workspace.memory, n), mat(loop.brackets, n, BRACKET), 0
    for k in range(n):
        near = found[k] < 0 or found[k] == marks[PAIRS_FOUND] or loop.may_sleep == 0
        if near and sleeping[k] == DEEPLY:
            wake(workspace, method, loop, k)
        elif not near and sleeping[k] != DEEPLY and memory[k].mode == OPEN:
            sleeping[k], brackets[k, HAPPENS] = DEEPLY, 0.0
        if sleeping[k] != DEEPLY:
            count += 1
            looked[count] = k
    looked[0] = count
    show_elements(workspace)
