"""How a turning frame moves: the unit quaternion f(t) that leads from its axes to those of space, and its rates.

Half the angular velocity of the frame, in its own axes, is the pure quaternion w = f^-1 f'. There are two motions:

- a regular precession, f = exp(n t) exp(s t): by 2 s in a frame that precesses by 2 n, both as they are in space where
  f is 1; without s that is uniform rotation. With e = exp(s t), w = e^-1 n e + s and w' = w s - s w.
- that of a free body with its inertia, attitude and angular velocity (`free_rotation.py`), of which f is the turn
  from the attitude where f is 1.

The record of a frame holds f, w and w' at one time, which `move_frame` changes.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from .free_rotation import SYMMETRIC_SIZE, free_acceleration, set_inertia, turn_freely
from .quaternions import conjugate, four_of, normalised, product, put_four, turned_by

# numbers of a frame, in `spin`: the time of f, w and w', these, the rate that limits steps (rad/s), whether it is that
# of a free body, the time at which f = 1
NOW, TURN, RATE, CHANGE, SPEED, IS_FREE, ANCHOR = 0, 1, 5, 8, 11, 12, 13
# of a regular precession n and s
OUTER, INNER = 14, 17
# of a free body: p where f is 1; time, p and angular velocity of the row that it begins with; p and angular velocity
# now; J and J^-1
ONE, BEGIN, NEWEST, REACHED, INERTIA = 14, 18, 19, 26, 33
MOTION_SIZE = INERTIA + 2 * SYMMETRIC_SIZE


@inlined
def _pure(x: Any, i: int) -> Any:
    return 0.0, x[i], x[i + 1], x[i + 2]


@inlined
def rate_of(spin: Any) -> Any:
    """w"""
    return _pure(spin, RATE)


@inlined
def second_of(spin: Any) -> Any:
    """f^-1 f'' = w' + w w"""
    x, y, z = spin[RATE], spin[RATE + 1], spin[RATE + 2]
    return -(x * x + y * y + z * z), spin[CHANGE], spin[CHANGE + 1], spin[CHANGE + 2]


@internal
def _exponential(x: Any, i: int, t: float) -> Any:
    """exp(a t) of the pure quaternion a from x[i] on."""
    size = np.sqrt(x[i] * x[i] + x[i + 1] * x[i + 1] + x[i + 2] * x[i + 2])
    part = np.sin(size * t) / size if size > 0.0 else t
    return np.cos(size * t), part * x[i], part * x[i + 1], part * x[i + 2]


@inlined
def _put_rates(spin: Any, w: Any, change: Any) -> None:
    spin[RATE], spin[RATE + 1], spin[RATE + 2] = w[1], w[2], w[3]
    spin[CHANGE], spin[CHANGE + 1], spin[CHANGE + 2] = change[1], change[2], change[3]


@internal
def _show_free(spin: Any) -> None:
    """f, w and w' of what has been reached."""
    one, w = four_of(spin, ONE), (spin[REACHED + 4], spin[REACHED + 5], spin[REACHED + 6])
    f = (1.0, 0.0, 0.0, 0.0)
    if spin[NOW] != spin[ANCHOR]:
        f = normalised(product(four_of(spin, REACHED), conjugate(one)))
    put_four(spin, TURN, f)
    change = free_acceleration(spin, INERTIA, w)
    _put_rates(
        spin,
        turned_by(one, (0.0, 0.5 * w[0], 0.5 * w[1], 0.5 * w[2])),
        turned_by(one, (0.0, 0.5 * change[0], 0.5 * change[1], 0.5 * change[2])),
    )


@internal
def _move_freely(memory: int, spin: Any, t: float) -> None:
    """The free body goes to t: from where it is if that lies on the way, else from where it began."""
    at, begin = spin[BEGIN], NEWEST
    if (spin[NOW] - at) * (t - at) > 0.0 and abs(spin[NOW] - at) < abs(t - at):
        at, begin = spin[NOW], REACHED
    w = (spin[begin + 4], spin[begin + 5], spin[begin + 6])
    p, w = turn_freely(memory, spin, INERTIA, four_of(spin, begin), w, t - at)
    put_four(spin, REACHED, p)
    spin[REACHED + 4], spin[REACHED + 5], spin[REACHED + 6] = w
    spin[NOW] = t


@internal
def move_frame(memory: int, spin: Any, t: float) -> None:
    """f, w and w' become those at t; `memory`: address of room for SERIES_SIZE numbers."""
    if spin[NOW] == t:
        return
    if spin[IS_FREE] != 0.0:
        _move_freely(memory, spin, t)
        _show_free(spin)
        return
    spin[NOW] = t
    time, inner = t - spin[ANCHOR], _pure(spin, INNER)
    turn = _exponential(spin, INNER, time)
    put_four(spin, TURN, product(_exponential(spin, OUTER, time), turn))
    w = turned_by(conjugate(turn), _pure(spin, OUTER))
    w = (0.0, w[1] + inner[1], w[2] + inner[2], w[3] + inner[3])
    back = product(inner, w)
    change = product(w, inner)
    _put_rates(spin, w, (0.0, change[1] - back[1], change[2] - back[2], change[3] - back[3]))


@internal
def set_precession(spin: Any, n: Any, s: Any, at: float, t: float) -> None:
    """The frame that precesses by n and turns by s in that (half rates in space at the time `at`, rad/s), with f = 1 at
    t."""
    spin[NOW], spin[IS_FREE], spin[ANCHOR] = np.nan, 0.0, t
    spin[OUTER], spin[OUTER + 1], spin[OUTER + 2] = n
    s = turned_by(_exponential(spin, OUTER, t - at), (0.0, s[0], s[1], s[2]))
    spin[INNER], spin[INNER + 1], spin[INNER + 2] = s[1], s[2], s[3]
    of_n = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    spin[SPEED] = 2.0 * (of_n + np.sqrt(s[1] * s[1] + s[2] * s[2] + s[3] * s[3]))


@internal
def set_free(memory: int, spin: Any, inertia: Any, p: Any, w: Any, at: float, t: float) -> None:
    """The frame of a free body with J = `inertia` (6) that has the attitude p (a unit quaternion to rounding) and the
    angular velocity w (rad/s, in its axes) at the time `at`, with f = 1 at t."""
    spin[NOW], spin[IS_FREE], spin[ANCHOR], spin[BEGIN] = np.nan, 1.0, t, at
    set_inertia(spin, INERTIA, inertia)
    size = np.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
    put_four(spin, NEWEST, (p[0] / size, p[1] / size, p[2] / size, p[3] / size))
    spin[NEWEST + 4], spin[NEWEST + 5], spin[NEWEST + 6] = w
    spin[SPEED] = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    _move_freely(memory, spin, t)
    put_four(spin, ONE, four_of(spin, REACHED))
    _show_free(spin)
