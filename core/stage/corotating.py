"""Attitudes in a frame that turns uniformly for the time of one step.

Euler parameters of a body that spins at W oscillate at W/2, and what a formula errs in them becomes, with their norm
held, an error of W that has one sign: energy grows or falls with every turn. So the formulas integrate u instead of p:

    p = R u    p' = R (u' + Omega u)    p'' = R (u'' + 2 Omega u' + Omega^2 u)    R(t) = exp(Omega (t - t_end))

Omega x = (0, omega) o x is the product of quaternions with half the angular velocity in space, omega, that the body has
at the start of the step. As Omega is constant for all rows of the history that a step looks at, u is as good a
coordinate as p: the order stays. Of uniform rotation u is constant, which every formula integrates exactly. (The idea
is that of exponentially fitted formulas, Gautschi 1961, Numer. Math. 3, 381-397.)

A stage u = q* + c_q u'', u' = v* + c_v u'' becomes one of p and its derivatives at the stage's time, where R q*, R v*
stand for q*, v* and with k = 2 Omega v* + Omega^2 q*, D = (1 + 2 c_v Omega + c_q Omega^2)^-1

    p = (q* - c_q D k) + c_q D p''    p' = (v* + Omega q* - (c_v + c_q Omega) D k) + (c_v + c_q Omega) D p''

with Omega^2 = -|omega|^2. D differs from 1 by the angle of a step: the matrices of the outer loop need not know it.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, mat, vec
from ..state.workspace_records import OK, SPIN_SIZE, call_stage
from ..tables.evaluate import evaluate_power

# columns of `spin`: omega, the time at which R = 1, c_q (D - 1), (c_v + c_q Omega) D - c_v, and what was in q* and v*
# and at the last point in space
OMEGA, ANCHOR, OF_Q, OF_V, STARS, POINT = 0, 3, 4, 8, 12, 20


@inlined
def four_of(x: Any, i: int) -> Any:
    return x[i], x[i + 1], x[i + 2], x[i + 3]


@inlined
def put_four(x: Any, i: int, y: Any) -> None:
    x[i], x[i + 1], x[i + 2], x[i + 3] = y


@inlined
def plus_times(a: Any, b: Any, factor: float) -> Any:
    """a + factor b"""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2], a[3] + factor * b[3]


@inlined
def product(a: Any, b: Any) -> Any:
    """Of two quaternions."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
        a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1],
    )


@inlined
def _omega(spin: Any) -> Any:
    """As a quaternion."""
    return 0.0, spin[OMEGA], spin[OMEGA + 1], spin[OMEGA + 2]


@inlined
def rotation_of(spin: Any, t: float) -> Any:
    """exp(omega t)"""
    size = np.sqrt(spin[OMEGA] ** 2 + spin[OMEGA + 1] ** 2 + spin[OMEGA + 2] ** 2)
    part = np.sin(size * t) / size if size > 0.0 else 0.0
    return np.cos(size * t), part * spin[OMEGA], part * spin[OMEGA + 1], part * spin[OMEGA + 2]


@internal
def enter(spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(p, p', p'') at t becomes (u, u', u'')."""
    w, r = _omega(spin), rotation_of(spin, spin[ANCHOR] - t)
    p, rate, second = four_of(q, i), four_of(v, i), four_of(a, i)
    own = plus_times(rate, product(w, p), -1.0)
    put_four(q, i, product(r, p))
    put_four(v, i, product(r, own))
    put_four(a, i, product(r, plus_times(second, product(w, plus_times(rate, own, 1.0)), -1.0)))


@internal
def leave(spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(u, u', u'') at t becomes (p, p', p'')."""
    w, r = _omega(spin), rotation_of(spin, t - spin[ANCHOR])
    p, own = product(r, four_of(q, i)), product(r, four_of(v, i))
    rate = plus_times(own, product(w, p), 1.0)
    put_four(a, i, plus_times(product(r, four_of(a, i)), product(w, plus_times(rate, own, 1.0)), 1.0))
    put_four(q, i, p)
    put_four(v, i, rate)


@internal
def enter_frame(ws: Any) -> None:
    """The workspace's point in the turning frame; that in space is remembered."""
    n, t = ws.n_ext, vec(ws.t, 1)[0]
    q, v, a, spins = vec(ws.q, n), vec(ws.v, n), vec(ws.a, n), mat(ws.spin, ws.n_spins, SPIN_SIZE)
    for k in range(ws.n_spins):
        i, spin = ivec(ws.spinning, ws.n_spins)[k], spins[k]
        put_four(spin, POINT, four_of(q, i))
        put_four(spin, POINT + 4, four_of(v, i))
        put_four(spin, POINT + 8, four_of(a, i))
        enter(spin, t, q, v, a, i)


@internal
def leave_frame(ws: Any) -> None:
    """The workspace's point in space."""
    n, t = ws.n_ext, vec(ws.t, 1)[0]
    for k in range(ws.n_spins):
        spin = mat(ws.spin, ws.n_spins, SPIN_SIZE)[k]
        leave(spin, t, vec(ws.q, n), vec(ws.v, n), vec(ws.a, n), ivec(ws.spinning, ws.n_spins)[k])


@internal
def _begin_stage(ws: Any, spin: Any, i: int, t: float, c_q: float, c_v: float) -> None:
    """q*, v*, the prediction of p'' and the relations between them as they are in space at t."""
    n = ws.n_ext
    q_star, v_star, a = vec(ws.q_star, n), vec(ws.v_star, n), vec(ws.a, n)
    put_four(spin, STARS, four_of(q_star, i))
    put_four(spin, STARS + 4, four_of(v_star, i))
    w, predicted = _omega(spin), product(rotation_of(spin, t - spin[ANCHOR]), four_of(a, i))
    put_four(a, i, (0.0, 0.0, 0.0, 0.0))
    leave(spin, t, q_star, v_star, a, i)
    constant = four_of(a, i)
    square = w[1] * w[1] + w[2] * w[2] + w[3] * w[3]
    rest = 1.0 - c_q * square
    size = 1.0 / (rest * rest + 4.0 * c_v * c_v * square)
    d = plus_times((rest * size, 0.0, 0.0, 0.0), w, -2.0 * c_v * size)
    e = plus_times((c_v * d[0], c_v * d[1], c_v * d[2], c_v * d[3]), product(w, d), c_q)
    put_four(q_star, i, plus_times(four_of(q_star, i), product(d, constant), -c_q))
    put_four(v_star, i, plus_times(four_of(v_star, i), product(e, constant), -1.0))
    put_four(spin, OF_Q, (c_q * (d[0] - 1.0), c_q * d[1], c_q * d[2], c_q * d[3]))
    put_four(spin, OF_V, (e[0] - c_v, e[1], e[2], e[3]))
    moved = plus_times(constant, predicted, rest)
    put_four(a, i, plus_times(moved, product(w, predicted), 2.0 * c_v))


@internal
def solve_spinning_stage(ws: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve a stage whose q*, v* and predicted a are those of the turning frames; so is its solution. Powers are those
    of the solution in space."""
    n = ws.n_ext
    spins, spinning = mat(ws.spin, ws.n_spins, SPIN_SIZE), ivec(ws.spinning, ws.n_spins)
    for k in range(ws.n_spins):
        _begin_stage(ws, spins[k], spinning[k], t, c_q, c_v)
    status = call_stage(ws.plain_stage, ws, t, c_q, c_v)
    for k in range(ws.n_spins):
        put_four(vec(ws.q_star, n), spinning[k], four_of(spins[k], STARS))
        put_four(vec(ws.v_star, n), spinning[k], four_of(spins[k], STARS + 4))
    if status == OK:
        evaluate_power(ws)
        enter_frame(ws)
    return status


@internal
def add_in_frame(ws: Any, x: Any) -> None:
    """What accelerations x (of the workspace or increments of them) move attitudes and their rates beyond c_q x and
    c_v x."""
    q, v = vec(ws.q, ws.n_ext), vec(ws.v, ws.n_ext)
    for k in range(ws.n_spins):
        i, spin = ivec(ws.spinning, ws.n_spins)[k], mat(ws.spin, ws.n_spins, SPIN_SIZE)[k]
        put_four(q, i, plus_times(four_of(q, i), product(four_of(spin, OF_Q), four_of(x, i)), 1.0))
        put_four(v, i, plus_times(four_of(v, i), product(four_of(spin, OF_V), four_of(x, i)), 1.0))
