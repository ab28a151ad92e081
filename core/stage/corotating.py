"""Attitudes in a frame that turns for the time of one step as the body would, if its motion was a simple one.

Euler parameters of a body that spins at W oscillate at W/2, and what a formula errs in them becomes, with their norm
held, an error of W that has one sign: energy grows or falls with every turn. So the formulas integrate u instead of p:

    p = f u    p' = f (u' + w u)    p'' = f (u'' + 2 w u' + g u)    g = w' + w w

with products of quaternions, the unit quaternion f(t) of the frame and w = f^-1 f' (`frame_motion.py`); f is 1 at the
end of the step. As the frame's motion is one and the same smooth one for all rows of the history that a step looks at,
u is as good a coordinate as p: the order stays. Of a body that moves as its frame does u is constant, which every
formula integrates exactly. (The idea is that of exponentially fitted formulas, Gautschi 1961, Numer. Math. 3, 381-397.)

A stage z = q* + c_q z'', z' = v* + c_v z'' becomes one of p and its derivatives: with k = 2 w v* + g q* and
D = (1 + 2 c_v w + c_q g)^-1

    p = f (q* - c_q D k) + c_q f D f^-1 p''    p' = f (v* + w q* - (c_v + c_q w) D k) + f (c_v + c_q w) D f^-1 p''

D differs from 1 by the angle of a step: the matrices of the outer loop need not know it.

The constraints give one component of p at least, which is another direction of u at each time. So a stage of a
Runge-Kutta formula has two points: z of the formula, all four components of it, and (u, u', u'') of p on the
constraints, at which the forces are. Other stages see z, z', z''. That is the formula for z'' = f^-1 (p''(u, u', t) -
...), a smooth equation in all four components, which the motion solves: the order stays. Of points on the constraints
it would be none of one equation. Formulas with one time see these: their error estimates then know what constraints do.
"""

from typing import Any

from ..assembly.evaluate import evaluate_power
from ..compiled.jit import inlined, internal
from ..compiled.views import ivec, mat, vec
from ..state.workspace_records import OK, SERIES, SPIN_SIZE, call_stage
from .frame_motion import MOTION_SIZE, TURN, move_frame, rate_of, second_of
from .quaternions import conjugate, four_of, plus_times, product, put_four, turned_by

# numbers of a frame, in `spin`, behind those of its motion: D, c_q (f D f^-1 - 1), f (c_v + c_q w) D f^-1 - c_v, and
# what was in q* and v* and at the last point in space
INVERSE, OF_Q, OF_V, STARS = MOTION_SIZE, MOTION_SIZE + 4, MOTION_SIZE + 8, MOTION_SIZE + 12
POINT = STARS + 8


@inlined
def series_memory(workspace: Any) -> int:
    """Address of what `move_frame` needs."""
    return workspace.scratch + 8 * SERIES


@internal
def enter(memory: int, spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(p, p', p'') at t becomes (u, u', u''); `memory` as for `move_frame`."""
    move_frame(memory, spin, t)
    back, w = conjugate(four_of(spin, TURN)), rate_of(spin)
    u = product(back, four_of(q, i))
    rate = plus_times(product(back, four_of(v, i)), product(w, u), -1.0)
    second = plus_times(product(back, four_of(a, i)), product(w, rate), -2.0)
    put_four(q, i, u)
    put_four(v, i, rate)
    put_four(a, i, plus_times(second, product(second_of(spin), u), -1.0))


@internal
def leave(memory: int, spin: Any, t: float, q: Any, v: Any, a: Any, i: int) -> None:
    """(u, u', u'') at t becomes (p, p', p'')."""
    move_frame(memory, spin, t)
    f, w, u, rate = four_of(spin, TURN), rate_of(spin), four_of(q, i), four_of(v, i)
    second = plus_times(plus_times(four_of(a, i), product(w, rate), 2.0), product(second_of(spin), u), 1.0)
    put_four(q, i, product(f, u))
    put_four(v, i, product(f, plus_times(rate, product(w, u), 1.0)))
    put_four(a, i, product(f, second))


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
    f, w, g = four_of(spin, TURN), rate_of(spin), second_of(spin)
    whole = plus_times(plus_times((1.0, 0.0, 0.0, 0.0), w, 2.0 * c_v), g, c_q)
    size = 1.0 / (whole[0] * whole[0] + whole[1] * whole[1] + whole[2] * whole[2] + whole[3] * whole[3])
    inverse = (size * whole[0], -size * whole[1], -size * whole[2], -size * whole[3])
    of_v = product((c_v, c_q * w[1], c_q * w[2], c_q * w[3]), inverse)
    put_four(spin, INVERSE, inverse)
    there = turned_by(f, inverse)
    put_four(spin, OF_Q, (c_q * (there[0] - 1.0), c_q * there[1], c_q * there[2], c_q * there[3]))
    there = turned_by(f, of_v)
    put_four(spin, OF_V, (there[0] - c_v, there[1], there[2], there[3]))
    constant = plus_times(product(g, q), product(w, v), 2.0)
    put_four(q_star, i, product(f, plus_times(q, product(inverse, constant), -c_q)))
    put_four(v_star, i, product(f, plus_times(plus_times(v, product(w, q), 1.0), product(of_v, constant), -1.0)))
    put_four(a, i, product(f, plus_times(product(whole, predicted), constant, 1.0)))


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
        whole = plus_times(four_of(a, i), product(rate_of(spin), off_v), 2.0)
        whole = product(four_of(spin, INVERSE), plus_times(whole, product(second_of(spin), off_q), 1.0))
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
        of_q = product(four_of(spin, OF_Q), increment)
        of_v = product(four_of(spin, OF_V), increment)
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
        put_four(increment, i, product(conjugate(four_of(spin, TURN)), four_of(increment, i)))
