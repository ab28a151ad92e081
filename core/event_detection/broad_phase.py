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
from ..contacts.gap_motion_bound3d import TURN_BOUND
from ..methods.history import history_row
from ..state.modes import OPEN, memories_at
from .balls import (
    BALL_INTEGERS,
    BALL_NUMBERS,
    BALL_POINT,
    BALL_RADIUS,
    BALL_REST,
    IN_SPACE,
    MARKS,
    ORDERED,
    PAIRS_FOUND,
    SIDE,
    VALID,
    WHO,
    tell_ball,
)
from .contact_evaluation import BRACKET, HAPPENS
from .contact_sleeping import DEEPLY, PLAINLY, show_elements, wake

SKIN_WAYS = 4.0
"""A skin is as thick as so many ways that the ball goes in the present step,"""
SKIN_SIZE = 0.05
"""and at least this share of its radius."""
TOO_THICK = 8.0
"""So many times as thick as it would be now: where that are the skins of half the balls, as behind a long step, it is
time for a sweep."""
CENTRE, SKIN, GONE = 0, 3, 4
"""Columns of `ball_moves`: where the centre was at the last sweep, the skin, and the way since then, m."""


@internal
def _way_of_ball(loop: Any, i: int, way: Any) -> float:
    """An upper bound of how far the centre of ball i goes within the step, m."""
    c, x = imat(loop.ball_coords, loop.n_balls, BALL_INTEGERS)[i], mat(loop.balls, loop.n_balls, BALL_NUMBERS)[i]
    arm = math.sqrt(x[BALL_POINT] ** 2 + x[BALL_POINT + 1] ** 2 + x[BALL_POINT + 2] ** 2)
    if c[IN_SPACE] == 0:
        return float(way[c[0]] + way[c[1]] + arm * way[c[2]])
    moves = math.sqrt(way[c[0]] ** 2 + way[c[1]] ** 2 + way[c[2]] ** 2)
    turns = math.sqrt(way[c[3]] ** 2 + way[c[4]] ** 2 + way[c[5]] ** 2 + way[c[6]] ** 2)
    return float(moves + TURN_BOUND * arm * turns)


@internal
def _skin(loop: Any, i: int, way: float) -> float:
    """How thick the skin of ball i is, m, that goes this way in a step."""
    return float(max(SKIN_WAYS * way, SKIN_SIZE * mat(loop.balls, loop.n_balls, BALL_NUMBERS)[i, BALL_RADIUS]))


@internal
def _place(loop: Any, i: int, q: Any, centre: Any) -> None:
    """Where the centre of ball i is, (3,), m."""
    c, x = imat(loop.ball_coords, loop.n_balls, BALL_INTEGERS)[i], mat(loop.balls, loop.n_balls, BALL_NUMBERS)[i]
    u, v, w = x[BALL_POINT], x[BALL_POINT + 1], x[BALL_POINT + 2]
    centre[0], centre[1], centre[2] = q[c[0]], q[c[1]], 0.0
    if c[IN_SPACE] == 0:
        cos, sin = math.cos(q[c[2]]), math.sin(q[c[2]])
        centre[0] += cos * u - sin * v
        centre[1] += sin * u + cos * v
        return
    centre[2] = q[c[2]]
    a, b, d, e = x[BALL_REST] + q[c[3]], q[c[4]], q[c[5]], q[c[6]]
    # u + 2 a (p x u) + 2 p x (p x u), p = (b, d, e)
    x1, x2, x3 = d * w - e * v, e * u - b * w, b * v - d * u
    centre[0] += u + 2.0 * (a * x1 + d * x3 - e * x2)
    centre[1] += v + 2.0 * (a * x2 + e * x1 - b * x3)
    centre[2] += w + 2.0 * (a * x3 + b * x2 - d * x1)


@internal
def keep_watch(workspace: Any, method: Any, loop: Any) -> None:
    """Have the pairs looked at that could close within the step that ends at the current point, for which `set_travel`
    has been called: where a ball goes beyond its skin there, sweep at the newest row."""
    if loop.n_balls == 0 or loop.may_sleep == 0:
        return
    way, moves = mat(loop.travel, 2, workspace.n_ext)[0], mat(loop.ball_moves, loop.n_balls, 5)
    fits = ivec(loop.broad, MARKS)[VALID] != 0
    for i in range(loop.n_balls):
        if not fits:
            break
        fits = moves[i, GONE] + _way_of_ball(loop, i, way) <= moves[i, SKIN]
    if not fits:
        _sweep(workspace, method, loop)


@internal
def begin_watch(workspace: Any, method: Any, loop: Any, h: float) -> None:
    """Let the pairs sleep that are far from each other, where all are awake, before a step of about h (s)."""
    if loop.n_balls == 0 or loop.may_sleep == 0 or ivec(loop.broad, MARKS)[VALID] != 0:
        return
    n, start, way = workspace.n_ext, history_row(workspace, method, 0), mat(loop.travel, 2, workspace.n_ext)[0]
    for i in range(workspace.n):
        way[i] = abs(h * start[n + i]) + abs(h * h * start[2 * n + i])
    _sweep(workspace, method, loop)


@internal
def go_on(workspace: Any, loop: Any) -> None:
    """The step that ends at the current point has been accepted."""
    if loop.n_balls == 0 or loop.may_sleep == 0 or ivec(loop.broad, MARKS)[VALID] == 0:
        return
    way, moves = mat(loop.travel, 2, workspace.n_ext)[0], mat(loop.ball_moves, loop.n_balls, 5)
    thick = 0
    for i in range(loop.n_balls):
        goes = _way_of_ball(loop, i, way)
        moves[i, GONE] += goes
        thick += 1 if moves[i, SKIN] > TOO_THICK * _skin(loop, i, goes) else 0
    if 2 * thick > loop.n_balls:
        moves[0, GONE] = np.inf


@internal
def _measure(loop: Any) -> None:
    """Balls as the contacts' parameters are now: each about the point of one of its contacts, and so large that the
    shapes of all lie in it."""
    n = loop.n_balls
    coords, balls = imat(loop.ball_coords, n, BALL_INTEGERS), mat(loop.balls, n, BALL_NUMBERS)
    for i in range(n):
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
def _sweep(workspace: Any, method: Any, loop: Any) -> None:
    if ivec(loop.broad, MARKS)[VALID] == 0:
        _measure(loop)
    n, start = loop.n_balls, history_row(workspace, method, 0)
    way, moves, balls = (
        mat(loop.travel, 2, workspace.n_ext)[0],
        mat(loop.ball_moves, n, 5),
        mat(loop.balls, n, BALL_NUMBERS),
    )
    marks, order, reach = ivec(loop.broad, MARKS), ivec(loop.ball_order, n), vec(loop.ball_reach, n)
    mean, spread = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in range(n):
        _place(loop, i, start, moves[i])
        radius = balls[i, BALL_RADIUS]
        moves[i, SKIN] = _skin(loop, i, _way_of_ball(loop, i, way))
        moves[i, GONE] = 0.0
        reach[i] = (1.0 + PLAINLY) * radius + moves[i, SKIN]
        x, y, z = moves[i, 0], moves[i, 1], moves[i, 2]
        mean = (mean[0] + x / n, mean[1] + y / n, mean[2] + z / n)
        spread = (spread[0] + x * x / n, spread[1] + y * y / n, spread[2] + z * z / n)
    widest, axis = -1.0, 0
    for j in range(3):
        if spread[j] - mean[j] * mean[j] > widest:
            widest, axis = spread[j] - mean[j] * mean[j], j
    if marks[ORDERED] == 0:
        for i in range(n):
            order[i] = i
        marks[ORDERED] = 1
    # nearly in order since the last time
    for p in range(1, n):
        i, at = order[p], p
        low = moves[i, axis] - reach[i]
        while at > 0 and moves[order[at - 1], axis] - reach[order[at - 1]] > low:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i
    marks[PAIRS_FOUND] += 1
    for p in range(n):
        i = order[p]
        high = moves[i, axis] + reach[i]
        for other in range(p + 1, n):
            j = order[other]
            if moves[j, axis] - reach[j] > high:
                break
            both = reach[i] + reach[j]
            dx, dy, dz = moves[i, 0] - moves[j, 0], moves[i, 1] - moves[j, 1], moves[i, 2] - moves[j, 2]
            if dx * dx + dy * dy + dz * dz <= both * both:
                _find(loop, i, j, marks[PAIRS_FOUND], workspace)
    _choose(workspace, method, loop, marks)
    marks[VALID] = 1


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
        near = found[k] < 0 or found[k] == marks[PAIRS_FOUND]
        if near and sleeping[k] == DEEPLY:
            wake(workspace, method, loop, k)
        elif not near and sleeping[k] != DEEPLY and memory[k].mode == OPEN:
            sleeping[k], brackets[k, HAPPENS] = DEEPLY, 0.0
        if sleeping[k] != DEEPLY:
            count += 1
            looked[count] = k
    looked[0] = count
    show_elements(workspace)
