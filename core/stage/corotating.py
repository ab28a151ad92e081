"""Attitudes in a frame that turns uniformly for the time of one step.

Euler parameters of a body that spins at W oscillate at W/2, and what a formula errs in them becomes, with their norm
held, an error of W that has one sign: energy grows or falls with every turn. So the formulas integrate u instead of p:

    p = exp(n t) u exp(s t)    p' = R (u' + W u)    p'' = R (u'' + 2 W u' + W^2 u)    W x = n x + x s

with products of quaternions, t from the end of the step, R x = exp(n t) x exp(s t). 2 n is an angular velocity in
space, 2 s one in the body: the body spins by s in a frame that precesses by n. As both are constant for all rows of the
history that a step looks at, u is as good a coordinate as p: the order stays. Of uniform rotation and of regular
precession (a top that is free, or steady under gravity) u is constant, which every formula integrates exactly. (The
idea is that of exponentially fitted formulas, Gautschi 1961, Numer. Math. 3, 381-397.)

A turn of four dimensions is one in two planes. With the unit quaternions e of n and f of s and x+- = (x +- e x f)/2,
W x = i (w+ x+ + w- x-) where i multiplies by e from the left, w+- = |n| -+ |s|. So every function of W is two complex
numbers g+-, and g x = g+ x+ + g- x-.

A stage z = q* + c_q z'', z' = v* + c_v z'' becomes one of p and its derivatives at the stage's time, where R q*, R v*
stand for q*, v* and with k = 2 W v* + W^2 q*, D = (1 + 2 c_v W + c_q W^2)^-1

    p = (q* - c_q D k) + c_q D p''    p' = (v* + W q* - (c_v + c_q W) D k) + (c_v + c_q W) D p''

D differs from 1 by the angle of a step: the matrices of the outer loop need not know it.

The constraints give one component of p at least, which is another direction of u at each time. So a stage of a
Runge-Kutta formula has two points: z of the formula, all four components of it, and (u, u', u'') of p on the
constraints, at which the forces are. Other stages see z, z', z''. That is the formula for z'' = R^-1 (p''(u, u', t) -
...), a smooth equation in all four components, which the motion solves: the order stays. Of points on the constraints
it would be none of one equation. Formulas with one time see these: their error estimates then know what constraints do.
"""

from typing import Any

import numpy as np

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, mat, vec
from ..state.workspace_records import OK, SPIN_SIZE, call_stage

# columns of `spin`: e, f, w+ and w-, the time at which R = 1, c_q (D - 1), (c_v + c_q W) D - c_v (two complex numbers
# each), and what was in q* and v* and at the last point in space
OUTER, INNER, RATES, ANCHOR, OF_Q, OF_V, STARS, POINT = 0, 3, 6, 8, 9, 13, 17, 25


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


@internal
def product(a: Any, b: Any) -> Any:
    """Of two quaternions."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
        a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1],
    )


@internal
def times_function(spin: Any, g: Any, x: Any) -> Any:
    """g x, of g = (Re g+, Im g+, Re g-, Im g-)."""
    y = product(x, (0.0, spin[INNER], spin[INNER + 1], spin[INNER + 2]))
    half_re, half_im = 0.5 * (g[0] + g[2]), 0.5 * (g[1] + g[3])
    other_re, other_im = 0.5 * (g[0] - g[2]), 0.5 * (g[1] - g[3])
    # (g+ + g-)/2 x + (g+ - g-)/2 e y
    along = (
        half_re * x[0] - other_im * y[0], half_re * x[1] - other_im * y[1],
        half_re * x[2] - other_im * y[2], half_re * x[3] - other_im * y[3],
    )  # fmt: skip
    across = (
        half_im * x[0] + other_re * y[0], half_im * x[1] + other_re * y[1],
        half_im * x[2] + other_re * y[2], half_im * x[3] + other_re * y[3],
    )  # fmt: skip
    return plus_times(along, product((0.0, spin[OUTER], spin[OUTER + 1], spin[OUTER + 2]), across), 1.0)


@inlined
def times_rate(spin: Any, x: Any) -> Any:
    """W x"""
    return times_function(spin, (0.0, spin[RATES], 0.0, spin[RATES + 1]), x)


@internal
def rotation_of(spin: Any, t: float) -> Any:
    """R as a function of W."""
    first, second = spin[RATES] * t, spin[RATES + 1] * t
    return np.cos(first), np.sin(first), np.cos(second), np.sin(second)


@internal
def set_rates(spin: Any, n: Any, s: Any, t: float) -> None:
    """The frame that precesses by n (in space) and spins by s (in the body), and stands in space's at t."""
    size_n = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    size_s = np.sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
    for j in range(3):
        # any direction serves where there is no rate
        spin[OUTER + j] = n[j] / size_n if size_n > 0.0 else (1.0 if j == 0 else 0.0)
        spin[INNER + j] = s[j] / size_s if size_s > 0.0 else (1.0 if j == 0 else 0.0)
    spin[RATES], spin[RATES + 1], spin[ANCHOR] = size_n - size_s, size_n + size_s, t


@internal
def enter(spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(p, p', p'') at t becomes (u, u', u'')."""
    r = rotation_of(spin, spin[ANCHOR] - t)
    p, rate, second = four_of(q, i), four_of(v, i), four_of(a, i)
    own = plus_times(rate, times_rate(spin, p), -1.0)
    put_four(q, i, times_function(spin, r, p))
    put_four(v, i, times_function(spin, r, own))
    second = plus_times(second, times_rate(spin, plus_times(rate, own, 1.0)), -1.0)
    put_four(a, i, times_function(spin, r, second))


@internal
def leave(spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(u, u', u'') at t becomes (p, p', p'')."""
    r = rotation_of(spin, t - spin[ANCHOR])
    p, own = times_function(spin, r, four_of(q, i)), times_function(spin, r, four_of(v, i))
    rate = plus_times(own, times_rate(spin, p), 1.0)
    second = times_rate(spin, plus_times(rate, own, 1.0))
    put_four(a, i, plus_times(times_function(spin, r, four_of(a, i)), second, 1.0))
    put_four(q, i, p)
    put_four(v, i, rate)


@internal
def _remember(workspace: Any) -> None:
    """The workspace's point, which is in space."""
    n = workspace.n_ext
    for k in range(workspace.n_spins):
        i, spin = ivec(workspace.spinning, workspace.n_spins)[k], mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        put_four(spin, POINT, four_of(vec(workspace.q, n), i))
        put_four(spin, POINT + 4, four_of(vec(workspace.v, n), i))
        put_four(spin, POINT + 8, four_of(vec(workspace.a, n), i))


@internal
def recall_point(workspace: Any) -> None:
    """The point in space that was remembered becomes that of the workspace."""
    n = workspace.n_ext
    for k in range(workspace.n_spins):
        i, spin = ivec(workspace.spinning, workspace.n_spins)[k], mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        put_four(vec(workspace.q, n), i, four_of(spin, POINT))
        put_four(vec(workspace.v, n), i, four_of(spin, POINT + 4))
        put_four(vec(workspace.a, n), i, four_of(spin, POINT + 8))


@internal
def enter_frame(workspace: Any) -> None:
    """The workspace's point in the turning frame; that in space is remembered."""
    _remember(workspace)
    n, t = workspace.n_ext, vec(workspace.t, 1)[0]
    for k in range(workspace.n_spins):
        i, spin = ivec(workspace.spinning, workspace.n_spins)[k], mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        enter(spin, t, vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), i)


@internal
def leave_frame(workspace: Any) -> None:
    """The workspace's point in space."""
    n, t = workspace.n_ext, vec(workspace.t, 1)[0]
    for k in range(workspace.n_spins):
        spin = mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        leave(
            spin,
            t,
            vec(workspace.q, n),
            vec(workspace.v, n),
            vec(workspace.a, n),
            ivec(workspace.spinning, workspace.n_spins)[k],
        )


@internal
def _begin_stage(workspace: Any, spin: Any, i: int, t: float, c_q: float, c_v: float) -> None:
    """q*, v*, the prediction of p'' and the relations between them as they are in space at t."""
    n = workspace.n_ext
    q_star, v_star, a = vec(workspace.q_star, n), vec(workspace.v_star, n), vec(workspace.a, n)
    put_four(spin, STARS, four_of(q_star, i))
    put_four(spin, STARS + 4, four_of(v_star, i))
    predicted = times_function(spin, rotation_of(spin, t - spin[ANCHOR]), four_of(a, i))
    put_four(a, i, (0.0, 0.0, 0.0, 0.0))
    leave(spin, t, q_star, v_star, a, i)
    constant = four_of(a, i)
    for side in range(2):
        w = spin[RATES + side]
        rest, turn = 1.0 - c_q * w * w, 2.0 * c_v * w
        size = 1.0 / (rest * rest + turn * turn)
        d_re, d_im = rest * size, -turn * size
        at = 2 * side
        spin[OF_Q + at], spin[OF_Q + at + 1] = c_q * (d_re - 1.0), c_q * d_im
        spin[OF_V + at] = c_v * (d_re - 1.0) - c_q * w * d_im
        spin[OF_V + at + 1] = c_v * d_im + c_q * w * d_re
    of_q = plus_times(times_function(spin, four_of(spin, OF_Q), constant), constant, c_q)
    of_v = plus_times(times_function(spin, four_of(spin, OF_V), constant), constant, c_v)
    put_four(q_star, i, plus_times(four_of(q_star, i), of_q, -1.0))
    put_four(v_star, i, plus_times(four_of(v_star, i), of_v, -1.0))
    own = times_rate(spin, predicted)
    moved = plus_times(plus_times(constant, predicted, 1.0), own, 2.0 * c_v)
    put_four(a, i, plus_times(moved, times_rate(spin, own), c_q))


@internal
def solve_spinning_stage(workspace: Any, t: float, c_q: float, c_v: float) -> int:
    """Solve a stage whose q*, v* and predicted a are those of the turning frames, if there are some; so is its
    solution. Powers are those of the solution in space then."""
    n = workspace.n_ext
    spins, spinning = mat(workspace.spin, workspace.n_spins, SPIN_SIZE), ivec(workspace.spinning, workspace.n_spins)
    for k in range(workspace.n_spins):
        _begin_stage(workspace, spins[k], spinning[k], t, c_q, c_v)
    status = call_stage(workspace.plain_stage, workspace, t, c_q, c_v)
    if status == OK and workspace.n_spins > 0:
        evaluate_power(workspace)
        enter_frame(workspace)
    for k in range(workspace.n_spins):
        put_four(vec(workspace.q_star, n), spinning[k], four_of(spins[k], STARS))
        put_four(vec(workspace.v_star, n), spinning[k], four_of(spins[k], STARS + 4))
    return status


@internal
def use_formula(workspace: Any, c_q: float, c_v: float) -> None:
    """z, z' and z'' in place of the stage's point on the constraints: p'' is that of both."""
    n = workspace.n_ext
    q, v, a = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n)
    for k in range(workspace.n_spins):
        i, spin = ivec(workspace.spinning, workspace.n_spins)[k], mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        q_star, v_star = four_of(vec(workspace.q_star, n), i), four_of(vec(workspace.v_star, n), i)
        off = times_rate(spin, plus_times(four_of(q, i), q_star, -1.0))
        off = plus_times(off, plus_times(four_of(v, i), v_star, -1.0), 2.0)
        whole = plus_times(four_of(a, i), times_rate(spin, off), 1.0)
        # D of it
        whole = plus_times(whole, times_function(spin, four_of(spin, OF_Q), whole), 1.0 / c_q)
        put_four(q, i, plus_times(q_star, whole, c_q))
        put_four(v, i, plus_times(v_star, whole, c_v))
        put_four(a, i, whole)


@internal
def add_in_frame(workspace: Any, x: Any) -> None:
    """What accelerations x (of the workspace or increments of them) move attitudes and their rates beyond c_q x and
    c_v x."""
    q, v = vec(workspace.q, workspace.n_ext), vec(workspace.v, workspace.n_ext)
    for k in range(workspace.n_spins):
        i, spin = ivec(workspace.spinning, workspace.n_spins)[k], mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        increment = four_of(x, i)
        of_q = times_function(spin, four_of(spin, OF_Q), increment)
        of_v = times_function(spin, four_of(spin, OF_V), increment)
        put_four(q, i, plus_times(four_of(q, i), of_q, 1.0))
        put_four(v, i, plus_times(four_of(v, i), of_v, 1.0))


@internal
def to_formula(workspace: Any, row: Any, increment: Any) -> None:
    """Of a coupled stage whose z and z' are in `row`: these in place of the workspace's point on the constraints, and
    increments of accelerations at its time in the turning frames."""
    n, t = workspace.n_ext, vec(workspace.t, 1)[0]
    for k in range(workspace.n_spins):
        i, spin = ivec(workspace.spinning, workspace.n_spins)[k], mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        put_four(vec(workspace.q, n), i, four_of(row, i))
        put_four(vec(workspace.v, n), i, four_of(row, n + i))
        put_four(increment, i, times_function(spin, rotation_of(spin, spin[ANCHOR] - t), four_of(increment, i)))
