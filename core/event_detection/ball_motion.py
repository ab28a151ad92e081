"""How far balls of the broad phase go: within a step, and since the last sweep.

Two balls come nearer to each other by no more than their ways relative to any motion that both share. The mean motion
of all balls is taken, so that those that fall together count as slow; half-spaces at rest ask for the whole way. The
centre of a ball follows its body's place, a polynomial of fifth degree within a step, which lies in the hull of its
control points (`contact_evaluation.between`), and turns with the body.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, mat, vec
from ..contacts.gap_motion_bound3d import TURN_BOUND
from .balls import (
    BALL_INTEGERS,
    BALL_MOVES,
    BALL_NUMBERS,
    BALL_POINT,
    BALL_POLYGON,
    BALL_REST,
    CENTRE,
    IN_SPACE,
    RELATIVE_WAY,
    SKIN,
    THICK_SKIN,
    WHOLE_WAY,
)
from .contact_evaluation import acceleration_at

PIECES = 5
"""Differences of the control points of a polynomial of fifth degree."""


@internal
def place_ball(loop: Any, i: int, q: Any, centre: Any) -> None:
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
def ways_in_step(workspace: Any, loop: Any, start: Any, h: float) -> None:
    """The ways within the step of size h from the row `start` to the current point; `set_travel` has been called."""
    n, coords, begins = (
        workspace.n_ext,
        imat(loop.ball_coords, loop.n_balls, BALL_INTEGERS),
        acceleration_at(workspace, loop),
    )
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    polygons = mat(loop.ball_polygons, loop.n_balls, BALL_POLYGON)
    for i in range(loop.n_balls):
        for x in range(2 + coords[i, IN_SPACE]):
            j = coords[i, x]
            first, last = 0.2 * h * start[n + j], 0.2 * h * v[j]
            second, fourth = first + 0.05 * h * h * start[begins + j], last - 0.05 * h * h * a[j]
            polygons[i, x], polygons[i, 3 + x], polygons[i, 9 + x], polygons[i, 12 + x] = first, second, fourth, last
            polygons[i, 6 + x] = q[j] - start[j] - first - second - fourth - last
    _sum_up(workspace, loop)


@internal
def ways_ahead(workspace: Any, loop: Any, start: Any, h: float) -> None:
    """About the ways within a step of size h that begins at the row `start`."""
    n, coords, begins = (
        workspace.n_ext,
        imat(loop.ball_coords, loop.n_balls, BALL_INTEGERS),
        acceleration_at(workspace, loop),
    )
    polygons, way = mat(loop.ball_polygons, loop.n_balls, BALL_POLYGON), mat(loop.travel, 2, n)[0]
    for i in range(loop.n_balls):
        for x in range(BALL_POLYGON):
            polygons[i, x] = 0.0
        for x in range(2 + coords[i, IN_SPACE]):
            j = coords[i, x]
            polygons[i, x], polygons[i, 3 + x] = h * start[n + j], h * h * start[begins + j]
    for j in range(workspace.n):
        way[j] = abs(h * start[n + j]) + abs(h * h * start[begins + j])
    _sum_up(workspace, loop)


@internal
def no_ways(workspace: Any, loop: Any) -> None:
    """Balls at rest."""
    moves = mat(loop.ball_moves, loop.n_balls, BALL_MOVES)
    for i in range(loop.n_balls):
        moves[i, RELATIVE_WAY] = moves[i, WHOLE_WAY] = 0.0


@internal
def _sum_up(workspace: Any, loop: Any) -> None:
    """Upper bounds of the ways, from the polygons and from how far bodies turn."""
    n, polygons = loop.n_balls, mat(loop.ball_polygons, loop.n_balls, BALL_POLYGON)
    moves, mean, way = (
        mat(loop.ball_moves, n, BALL_MOVES),
        np.zeros(BALL_POLYGON),
        mat(loop.travel, 2, workspace.n_ext)[0],
    )
    for i in range(n):
        for x in range(BALL_POLYGON):
            mean[x] += polygons[i, x] / n
    for i in range(n):
        turns = _turns(loop, i, way)
        relative, whole = turns, turns
        for k in range(PIECES):
            x, y, z = polygons[i, 3 * k], polygons[i, 3 * k + 1], polygons[i, 3 * k + 2]
            whole += math.sqrt(x * x + y * y + z * z)
            x, y, z = x - mean[3 * k], y - mean[3 * k + 1], z - mean[3 * k + 2]
            relative += math.sqrt(x * x + y * y + z * z)
        moves[i, RELATIVE_WAY], moves[i, WHOLE_WAY] = relative, whole


@internal
def _turns(loop: Any, i: int, way: Any) -> float:
    """An upper bound of how far the centre of ball i goes about the place of its body, m."""
    c, x = imat(loop.ball_coords, loop.n_balls, BALL_INTEGERS)[i], mat(loop.balls, loop.n_balls, BALL_NUMBERS)[i]
    arm = math.sqrt(x[BALL_POINT] ** 2 + x[BALL_POINT + 1] ** 2 + x[BALL_POINT + 2] ** 2)
    if c[IN_SPACE] == 0:
        return float(arm * way[c[2]])
    turns = math.sqrt(way[c[3]] ** 2 + way[c[4]] ** 2 + way[c[5]] ** 2 + way[c[6]] ** 2)
    return float(TURN_BOUND * arm * turns)


@internal
def within_skins(loop: Any, start: Any) -> bool:
    """True if no ball has left its skin by the end of the step from the row `start`."""
    n, moves = loop.n_balls, mat(loop.ball_moves, loop.n_balls, BALL_MOVES)
    gone, mean, now = mat(loop.ball_polygons, n, BALL_POLYGON), np.zeros(3), np.empty(3)
    for i in range(n):
        place_ball(loop, i, start, now)
        for x in range(3):
            gone[i, x] = now[x] - moves[i, CENTRE + x]
            mean[x] += gone[i, x] / n
    for i in range(n):
        x, y, z = gone[i, 0], gone[i, 1], gone[i, 2]
        if not math.sqrt(x * x + y * y + z * z) + moves[i, WHOLE_WAY] <= moves[i, THICK_SKIN]:
            return False
        x, y, z = x - mean[0], y - mean[1], z - mean[2]
        if not math.sqrt(x * x + y * y + z * z) + moves[i, RELATIVE_WAY] <= moves[i, SKIN]:
            return False
    return True
