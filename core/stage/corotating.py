"""Attitudes in a frame that turns for the time of one step as the body would, if its motion was a simple one.

Euler parameters of a body that spins at W oscillate at W/2, and what a formula errs in them becomes, with their norm
held, an error of W that has one sign: energy grows or falls with every turn. So the formulas integrate u instead of p:

    p = f u g    p' = f (u' + W u) g    p'' = f (u'' + 2 W u' + S u) g    W x = w x + x r    S x = W W x + x r'

with products of quaternions, unit quaternions f(t) and g(t), constant w = f^-1 f' and r = g' g^-1 (`frame_motion.py`);
f and g are 1 at the end of the step. As the frame's motion is one and the same smooth one for all rows of the history
that a step looks at, u is as good a coordinate as p: the order stays. Of a body that moves as its frame does u is
constant, which every formula integrates exactly. (The idea is that of exponentially fitted formulas, Gautschi 1961,
Numer. Math. 3, 381-397.)

A stage z = q* + c_q z'', z' = v* + c_v z'' becomes one of p and its derivatives: with k = 2 W v* + S q*,
D = (1 + 2 c_v W + c_q S)^-1 and R x = f x g

    p = R (q* - c_q D k) + c_q R D R^-1 p''    p' = R (v* + W q* - (c_v + c_q W) D k) + R (c_v + c_q W) D R^-1 p''

D differs from 1 by the angle of a step: the matrices of the outer loop need not know it.

The constraints give one component of p at least, which is another direction of u at each time. So a stage of a
Runge-Kutta formula has two points: z of the formula, all four components of it, and (u, u', u'') of p on the
constraints, at which the forces are. Other stages see z, z', z''. That is the formula for z'' = R^-1 (p''(u, u', t) -
...), a smooth equation in all four components, which the motion solves: the order stays. Of points on the constraints
it would be none of one equation. Formulas with one time see these: their error estimates then know what constraints do.
"""

from typing import Any

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, mat, vec
from ..state.workspace_records import OK, SERIES, SPIN_SIZE, call_stage
from .frame_motion import MOTION_SIZE, back_from_space, move_frame, times_rate, times_second, to_space
from .quaternions import four_of, plus_times, put_four

# numbers of a frame, in `spin`, behind those of its motion: D, c_q (R D R^-1 - 1), R (c_v + c_q W) D R^-1 - c_v
# (matrices by columns), and what was in q* and v* and at the last point in space
INVERSE, OF_Q, OF_V, STARS = MOTION_SIZE, MOTION_SIZE + 16, MOTION_SIZE + 32, MOTION_SIZE + 48
POINT = STARS + 8


@inlined
def series_memory(workspace: Any) -> int:
    """Address of what `move_frame` needs."""
    return workspace.scratch + 8 * SERIES


@internal
def enter(memory: int, spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(p, p', p'') at t becomes (u, u', u''); `memory` as for `move_frame`."""
    move_frame(memory, spin, t)
    u = back_from_space(spin, four_of(q, i))
    rate = plus_times(back_from_space(spin, four_of(v, i)), times_rate(spin, u), -1.0)
    second = plus_times(back_from_space(spin, four_of(a, i)), times_rate(spin, rate), -2.0)
    put_four(q, i, u)
    put_four(v, i, rate)
    put_four(a, i, plus_times(second, times_second(spin, u), -1.0))


@internal
def leave(memory: int, spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(u, u', u'') at t becomes (p, p', p'')."""
    move_frame(memory, spin, t)
    u, rate = four_of(q, i), four_of(v, i)
    second = plus_times(plus_times(four_of(a, i), times_rate(spin, rate), 2.0), times_second(spin, u), 1.0)
    put_four(q, i, to_space(spin, u))
    put_four(v, i, to_space(spin, plus_times(rate, times_rate(spin, u), 1.0)))
    put_four(a, i, to_space(spin, second))


@internal
def _matrix_times(spin: Any, i: int, x: Any) -> Any:
    """The matrix whose columns begin at spin[i], times x."""
    y = (0.0, 0.0, 0.0, 0.0)
    for j in range(4):
        y = plus_times(y, four_of(spin, i + 4 * j), x[j])
    return y


@inlined
def _axis(j: int) -> Any:
    return 1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0, 1.0 if j == 3 else 0.0


@inlined
def _of_second(spin: Any, x: Any, c_q: float, c_v: float) -> Any:
    """D^-1 x"""
    return plus_times(plus_times(x, times_rate(spin, x), 2.0 * c_v), times_second(spin, x), c_q)


@internal
def _invert(spin: Any, c_q: float, c_v: float) -> None:
    """D, by elimination without pivoting: D^-1 is 1 but for a part of the angle of a step."""
    # columns of D^-1 in the place of OF_Q, which is not needed yet
    for j in range(4):
        put_four(spin, OF_Q + 4 * j, _of_second(spin, _axis(j), c_q, c_v))
        put_four(spin, INVERSE + 4 * j, _axis(j))
    for j in range(4):
        pivot = 1.0 / spin[OF_Q + 5 * j]
        for l in range(4):
            spin[OF_Q + 4 * l + j] *= pivot
            spin[INVERSE + 4 * l + j] *= pivot
        for k in range(4):
            factor = spin[OF_Q + 4 * j + k]
            for l in range(4 if k != j else 0):
                spin[OF_Q + 4 * l + k] -= factor * spin[OF_Q + 4 * l + j]
                spin[INVERSE + 4 * l + k] -= factor * spin[INVERSE + 4 * l + j]


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
        enter(series_memory(workspace), spin, t, vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), i)


@internal
def leave_frame(workspace: Any) -> None:
    """The workspace's point in space."""
    n, t = workspace.n_ext, vec(workspace.t, 1)[0]
    for k in range(workspace.n_spins):
        spin = mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        leave(
            series_memory(workspace),
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
    q, v, predicted = four_of(q_star, i), four_of(v_star, i), four_of(a, i)
    put_four(spin, STARS, q)
    put_four(spin, STARS + 4, v)
    move_frame(series_memory(workspace), spin, t)
    _invert(spin, c_q, c_v)
    for j in range(4):
        x = _matrix_times(spin, INVERSE, back_from_space(spin, _axis(j)))
        put_four(spin, OF_Q + 4 * j, plus_times(to_space(spin, x), _axis(j), -1.0))
        moved = plus_times(to_space(spin, times_rate(spin, x)), four_of(spin, OF_Q + 4 * j), c_v / c_q)
        for l in range(4):
            spin[OF_Q + 4 * j + l] *= c_q
            spin[OF_V + 4 * j + l] = c_q * moved[l]
    constant = plus_times(times_second(spin, q), times_rate(spin, v), 2.0)
    x = _matrix_times(spin, INVERSE, constant)
    put_four(q_star, i, to_space(spin, plus_times(q, x, -c_q)))
    moved = plus_times(plus_times(v, times_rate(spin, q), 1.0), x, -c_v)
    put_four(v_star, i, to_space(spin, plus_times(moved, times_rate(spin, x), -c_q)))
    put_four(a, i, to_space(spin, plus_times(_of_second(spin, predicted, c_q, c_v), constant, 1.0)))


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
        # the frame is at the stage's time
        off_q, off_v = plus_times(four_of(q, i), q_star, -1.0), plus_times(four_of(v, i), v_star, -1.0)
        whole = plus_times(four_of(a, i), times_rate(spin, off_v), 2.0)
        whole = _matrix_times(spin, INVERSE, plus_times(whole, times_second(spin, off_q), 1.0))
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
        of_q = _matrix_times(spin, OF_Q, increment)
        of_v = _matrix_times(spin, OF_V, increment)
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
        move_frame(series_memory(workspace), spin, t)
        put_four(increment, i, back_from_space(spin, four_of(increment, i)))
