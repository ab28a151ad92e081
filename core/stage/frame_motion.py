"""How a turning frame moves: R x = f x g with unit quaternions f(t), on the side of space, and g(t), on the body's.

Half their angular velocities are the pure quaternions w = f^-1 f', which is constant, and r = g' g^-1. There are two
motions:

- a regular precession, f = exp(w t) and g = exp(r t): by 2 r in the body, which precesses by 2 w in space; without r
  that is uniform rotation;
- that of a free body with its inertia, attitude and angular velocity (`free_rotation.py`), of which g is the turn
  from the attitude where g is 1, and f = 1.

What torques change is seen from space or from the precessing axes so: there it is smoother than in axes that spin.
The record of a frame holds f, g, w, r and r' at one time, which `move_frame` changes.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from .free_rotation import SYMMETRIC_SIZE, free_acceleration, set_inertia, turn_freely
from .quaternions import conjugate, four_of, normalised, plus_times, product, put_four, turned_by

# numbers of a frame, in `spin`: the time of the others, f and g, w and r, r', the rate that limits steps (rad/s),
# whether it is that of a free body, the time at which f = g = 1
NOW, OUTER_TURN, INNER_TURN, OUTER, INNER, CHANGE, SPEED, IS_FREE, ANCHOR = 0, 1, 5, 9, 12, 15, 18, 19, 20
# of a free body: p where g is 1; time, p and angular velocity of the row that it begins with; p and angular velocity
# now; J and J^-1
ONE, BEGIN, NEWEST, REACHED, INERTIA = 21, 25, 26, 33, 40
MOTION_SIZE = INERTIA + 2 * SYMMETRIC_SIZE


@inlined
def _pure(x: Any, i: int) -> Any:
    return 0.0, x[i], x[i + 1], x[i + 2]


@internal
def to_space(spin: Any, x: Any) -> Any:
    """R x"""
    return product(product(four_of(spin, OUTER_TURN), x), four_of(spin, INNER_TURN))


@internal
def back_from_space(spin: Any, x: Any) -> Any:
    """R^-1 x"""
    return product(product(conjugate(four_of(spin, OUTER_TURN)), x), conjugate(four_of(spin, INNER_TURN)))


@internal
def times_rate(spin: Any, x: Any) -> Any:
    """W x = w x + x r, with R' = R W"""
    return plus_times(product(_pure(spin, OUTER), x), product(x, _pure(spin, INNER)), 1.0)


@internal
def times_second(spin: Any, x: Any) -> Any:
    """S x, with R'' = R S"""
    return plus_times(times_rate(spin, times_rate(spin, x)), product(x, _pure(spin, CHANGE)), 1.0)


@internal
def _exponential(x: Any, i: int, t: float) -> Any:
    """exp(a t) of the pure quaternion a from x[i] on."""
    size = np.sqrt(x[i] * x[i] + x[i + 1] * x[i + 1] + x[i + 2] * x[i + 2])
    part = np.sin(size * t) / size if size > 0.0 else t
    return np.cos(size * t), part * x[i], part * x[i + 1], part * x[i + 2]


@internal
def _show_free(spin: Any) -> None:
    """g, r and r' of what has been reached."""
    back, w = conjugate(four_of(spin, ONE)), (spin[REACHED + 4], spin[REACHED + 5], spin[REACHED + 6])
    g, change = (1.0, 0.0, 0.0, 0.0), free_acceleration(spin, INERTIA, w)
    if spin[NOW] != spin[ANCHOR]:
        g = normalised(product(back, four_of(spin, REACHED)))
    put_four(spin, INNER_TURN, g)
    rate, second = turned_by(g, (0.0, w[0], w[1], w[2])), turned_by(g, (0.0, change[0], change[1], change[2]))
    for j in range(3):
        spin[INNER + j], spin[CHANGE + j] = 0.5 * rate[1 + j], 0.5 * second[1 + j]


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
    """f, g and their rates become those at t; `memory`: address of room for SERIES_SIZE numbers."""
    if spin[NOW] == t:
        return
    if spin[IS_FREE] != 0.0:
        _move_freely(memory, spin, t)
        _show_free(spin)
        return
    spin[NOW] = t
    put_four(spin, OUTER_TURN, _exponential(spin, OUTER, t - spin[ANCHOR]))
    put_four(spin, INNER_TURN, _exponential(spin, INNER, t - spin[ANCHOR]))


@internal
def set_precession(spin: Any, n: Any, s: Any, p: Any, t: float) -> None:
    """The frame that precesses by n and turns by s in that (half rates in space at a time at which the body has the
    attitude p, a unit quaternion to rounding; rad/s), with f = g = 1 at t."""
    spin[NOW], spin[IS_FREE], spin[ANCHOR] = np.nan, 0.0, t
    s = turned_by(conjugate(p), (0.0, s[0], s[1], s[2]))
    for j in range(3):
        spin[OUTER + j], spin[INNER + j], spin[CHANGE + j] = n[j], s[1 + j], 0.0
    of_n = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    spin[SPEED] = 2.0 * (of_n + np.sqrt(s[1] * s[1] + s[2] * s[2] + s[3] * s[3]))


@internal
def set_free(memory: int, spin: Any, inertia: Any, p: Any, w: Any, at: float, t: float) -> None:
    """The frame of a free body with J = `inertia` (6) that has the attitude p (a unit quaternion to rounding) and the
    angular velocity w (rad/s, in its axes) at the time `at`, with g = 1 at t."""
    spin[NOW], spin[IS_FREE], spin[ANCHOR], spin[BEGIN] = np.nan, 1.0, t, at
    set_inertia(spin, INERTIA, inertia)
    size = np.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
    put_four(spin, NEWEST, (p[0] / size, p[1] / size, p[2] / size, p[3] / size))
    spin[NEWEST + 4], spin[NEWEST + 5], spin[NEWEST + 6] = w
    spin[SPEED] = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    put_four(spin, OUTER_TURN, (1.0, 0.0, 0.0, 0.0))
    spin[OUTER], spin[OUTER + 1], spin[OUTER + 2] = 0.0, 0.0, 0.0
    _move_freely(memory, spin, t)
    put_four(spin, ONE, four_of(spin, REACHED))
    _show_free(spin)
