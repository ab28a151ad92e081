"""Friction against rolling and spinning of contacts in space: torques of `laws/friction/turning.py`.

w = w_b - w_a is the angular velocity of the second shape on the first, w_n = n.w its part along the normal, with which
it spins, w_T the rest, with which it rolls. The torque on the second shape is M = -F_N m, on the first -M,
    m = rho w_T/sqrt(|w_T|^2 + w_s^2) + sigma n w_n/sqrt(w_n^2 + w_s^2),
rho and sigma the arms in m, and w_s in rad/s. On a patch of friction radius r the part along the normal is no such
torque: it goes with friction against sliding, `friction3d.py` and `patch3d.py` say how, and z = r w_n, m/s, stands
for the spin beside the sliding velocity.
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..elements.relative_spin3d import relative_spin, spin_by_coordinate
from ..model.rotation3d import add_lever, dot, four, less, onto, plus, space_axes, times
from .normal3d import NUMBERS, PAIR_SIZE
from .support3d import SUPPORT_NUMBERS
from .tangent3d import NORMAL, column

ROLLING = NUMBERS + SUPPORT_NUMBERS
SPINNING, SLOW_TURNS, FRICTION_RADIUS = ROLLING + 1, ROLLING + 2, ROLLING + 3
"""Columns of the parameters: rho, sigma, w_s, r."""
TURNING_NUMBERS = 4


@internal
def resists_turning(par: Any) -> bool:
    """True if the contact with these parameters has a torque."""
    return par[ROLLING] > 0.0 or par[SPINNING] > 0.0 or par[FRICTION_RADIUS] > 0.0


@internal
def _parts(par: Any, w: Any, n: Any) -> Any:
    """(w_n, w_T, sqrt(w_n^2 + w_s^2), sqrt(|w_T|^2 + w_s^2))."""
    w_n, slow = dot(n, w), par[SLOW_TURNS]
    w_t = less(w, times(w_n, n))
    return w_n, w_t, math.sqrt(w_n * w_n + slow * slow), math.sqrt(dot(w_t, w_t) + slow * slow)


@internal
def turning_arms(b: Any, par: Any, coord: Any, pair: Any, n: Any) -> Any:
    """(m, m.w) at the current point of a batch."""
    w = relative_spin(vec(b.q, b.n_extended), vec(b.v, b.n_extended), coord, pair)
    w_n, w_t, of_n, of_t = _parts(par, w, n)
    m = plus(times(par[ROLLING] / of_t, w_t), times(par[SPINNING] * w_n / of_n, n))
    return m, dot(m, w)


@internal
def spin_on_patch(b: Any, par: Any, coord: Any, pair: Any, n: Any) -> float:
    """z at the current point of a batch."""
    if par[FRICTION_RADIUS] == 0.0:
        return 0.0
    w = relative_spin(vec(b.q, b.n_extended), vec(b.v, b.n_extended), coord, pair)
    return float(par[FRICTION_RADIUS] * dot(n, w))


@internal
def spin_rate(b: Any, par: Any, coord: Any, pair: Any, n: Any, n_rate: Any) -> float:
    """z' at the current point of a batch; E(p') p' = 0."""
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    return float(
        par[FRICTION_RADIUS]
        * (dot(n, relative_spin(q, a, coord, pair)) + dot(n_rate, relative_spin(q, v, coord, pair)))
    )


@internal
def spin_changes(b: Any, par: Any, coord: Any, pair: Any, work: Any, n: Any, out: Any) -> None:
    """Derivatives of z by the coordinates and velocities, each with its coefficient, to out (14,)."""
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    c_q, c_v, r = vec(b.coef, 2)[0], vec(b.coef, 2)[1], par[FRICTION_RADIUS]
    axes_a, axes_b = space_axes(four(q, coord, 3, pair[0])), space_axes(four(q, coord, 10, pair[1]))
    spin_a, spin_b = space_axes(four(v, coord, 3, 0.0)), space_axes(four(v, coord, 10, 0.0))
    w = relative_spin(q, v, coord, pair)
    for j in range(PAIR_SIZE):
        turn = spin_by_coordinate(j, c_q, c_v, axes_a, axes_b, spin_a, spin_b)
        out[j] = r * (dot(w, times(c_q, column(work, NORMAL, j))) + dot(n, turn))


@internal
def add_spin_tangent(b: Any, coord: Any, pair: Any, slot: Any, work: Any, n: Any, torque: float, changes: Any) -> None:
    """values += derivative of the residual with the torque `torque` n on the second body by the coordinates; changes
    (14,): of its size."""
    q, values, c_q = vec(b.q, b.n_extended), vec(b.values, b.n_values), vec(b.coef, 2)[0]
    axes_a, axes_b = space_axes(four(q, coord, 3, pair[0])), space_axes(four(q, coord, 10, pair[1]))
    for j in range(PAIR_SIZE):
        by = plus(times(changes[j], n), times(c_q * torque, column(work, NORMAL, j)))
        on_a, on_b = onto(axes_a, by), onto(axes_b, by)
        for i in range(4):
            values[slot[3 + i, j]] += 2.0 * on_a[i]
            values[slot[10 + i, j]] -= 2.0 * on_b[i]
    add_lever(values, slot, 3, 2.0 * c_q, times(torque, n))
    add_lever(values, slot, 10, -2.0 * c_q, times(torque, n))


@internal
def turning_gradient(q: Any, coord: Any, pair: Any, axis: Any, n: int, out: Any) -> None:
    """d(axis . w)/dv, to out (n,): w_a = 2 E(p_a) p_a'."""
    on_a, on_b = (
        onto(space_axes(four(q, coord, 3, pair[0])), axis),
        onto(space_axes(four(q, coord, 10, pair[1])), axis),
    )
    for i in range(4):
        if coord[3 + i] < n:
            out[coord[3 + i]] = -2.0 * on_a[i]
        if coord[10 + i] < n:
            out[coord[10 + i]] = 2.0 * on_b[i]


@internal
def add_torque_tangent(
    b: Any, par: Any, coord: Any, pair: Any, slot: Any, work: Any, n: Any, m: Any, force: float, changes: Any
) -> None:
    """values += derivative of the residual with the torque force m by the coordinates, force being -F_N; changes (14,):
    of the force."""
    q, v, values = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.values, b.n_values)
    c_q, c_v, slow = vec(b.coef, 2)[0], vec(b.coef, 2)[1], par[SLOW_TURNS]
    axes_a, axes_b = space_axes(four(q, coord, 3, pair[0])), space_axes(four(q, coord, 10, pair[1]))
    spin_a, spin_b = space_axes(four(v, coord, 3, 0.0)), space_axes(four(v, coord, 10, 0.0))
    w = relative_spin(q, v, coord, pair)
    w_n, w_t, of_n, of_t = _parts(par, w, n)
    for j in range(PAIR_SIZE):
        by_n = times(c_q, column(work, NORMAL, j))
        change = spin_by_coordinate(j, c_q, c_v, axes_a, axes_b, spin_a, spin_b)
        along_n = dot(change, n) + dot(w, by_n)
        across = less(change, plus(times(along_n, n), times(w_n, by_n)))
        turn = less(times(1.0 / of_t, across), times(dot(w_t, across) / of_t**3, w_t))
        drill = plus(times(slow * slow / of_n**3 * along_n, n), times(w_n / of_n, by_n))
        by = plus(times(par[ROLLING], turn), times(par[SPINNING], drill))
        by = plus(times(force, by), times(changes[j], m))
        on_a, on_b = onto(axes_a, by), onto(axes_b, by)
        for i in range(4):
            values[slot[3 + i, j]] += 2.0 * on_a[i]
            values[slot[10 + i, j]] -= 2.0 * on_b[i]
    torque = times(force, m)
    add_lever(values, slot, 3, 2.0 * c_q, torque)
    add_lever(values, slot, 10, -2.0 * c_q, torque)
