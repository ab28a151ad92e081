"""Coulomb friction of contacts in space that are constraints.

A closed contact that sticks has, beside the gap, two rows at velocity level: the sliding velocity along both tangents
is zero; one that others hold at the limit of its friction has the first one's row, across that friction, which is a
constant part of its normal force along the second one. One that slides has the gap only, and F_T = -mu F_N u_T/|u_T|.
Where |u_T| comes to zero a direction has to go on through it: steps end beyond the event before they end at it, and a
speed that is less than what error control resolves has no direction but that of its errors. With x and y along the
tangents, x along the direction of sliding at the last event, the speed v_0 = `slow_sliding` that is so small, and
s^2 = x^2 + v_0^2, the angle of friction is atan(y/s): that of u_T but for (v_0/x)^2/2. It is there where sliding
begins, and draws y to zero from the first instant on.

On a patch (`patch3d.py`) z = r w_n stands beside x and y, and the torque over r beside both forces: it slides or spins
as a whole, with a direction in space, at the angle `sliding_lean` out of the tangent plane.

Rows of a contact that does not stick: of an open one x and y; of a sliding one p - TURNED (|(p-hat, y,
q)| - v_0), whose zero is the end of sliding, or a turn of its direction by much, and |u_T|. The third block of the
monitor says z of an open contact, of a closed one z/sqrt(z^2 + c^2).
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT, line_of, shown, shown_at
from ..compiled.views import imat, ivec, mat, vec
from ..elements.measure3d import COLUMNS
from ..elements.relative_spin3d import add_torque, add_torque_by
from ..model.rotation3d import dot, less, plus, times
from ..state.modes import AT_LIMIT, CLOSED, IDLE, STICKS, memories_at
from .frame3d import FRAME_ROWS, T1, T2, farthest_axis, tangents
from .geometry_kinds import SPHERE, are
from .moving_point3d import MOVES, moves_on
from .normal2d import act, idle
from .normal3d import GAP_KIND, PACKED, PAIR_SIZE, gap_of, hold, pair_of
from .patch3d import STILL_SPEED, creep_size, direction, turn_of_direction
from .sliding2d import FRICTION_AT
from .slip3d import add_slip, slip_of_batch
from .spheres3d import press_spheres, pull_spheres, slip_of_spheres, tangents_in_motion
from .surface3d import pass_surface, pass_surface_in, put_in_along
from .tangent3d import NORMAL, U, W, column, product_with
from .turning3d import (
    FRICTION_RADIUS,
    add_spin_tangent,
    add_torque_tangent,
    resists_turning,
    spin_changes,
    spin_on_patch,
    spin_rate,
    turning_arms,
)

TURNED = 0.2
"""Cosine of the angle by which the direction of sliding has turned when it is taken anew."""

TURNS_HARD = 4.0
"""Added to the axis that the tangents of an open contact are counted from: it resists turning."""


@internal
def _levels(b: Any, e: int, now: Any, rates: Any, lean: float, slow: float) -> None:
    """The rows of the tangents at all levels, from (x, y, z) and its rates; slow < 0: of a contact that does not
    slide."""
    first = imat(b.row, b.count, 3)[e, 1]
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    x, y, x_rate, y_rate = now[0], now[1], rates[0], rates[1]
    phi[first] = phi[first + 1] = 0.0
    if slow < 0.0:
        phid[first], phid[first + 1], phidd[first], phidd[first + 1] = x, y, x_rate, y_rate
        return
    p, _, size, _, _, _, c, s = direction(x, y, now[2], lean, slow)
    speed, power = math.sqrt(x * x + y * y), x * x_rate + y * y_rate
    faster = power / speed if speed > 0.0 else math.sqrt(x_rate * x_rate + y_rate * y_rate)
    phid[first], phid[first + 1] = p - TURNED * (size - slow), speed
    phidd[first], phidd[first + 1] = c * x_rate + s * rates[2] - TURNED * (power + now[2] * rates[2]) / size, faster


@inlined
def _state(par: Any, memory: Any, closed: bool) -> Any:
    """(it slides, it sticks along both tangents, along the first one, speed that has no direction; -1: it does not
    slide) of a contact."""
    state = memory.slide_mode
    slides = closed and abs(state) == 1.0
    return slides, closed and state == STICKS, closed and state == AT_LIMIT, (
        max(par[STILL_SPEED], memory.slow_sliding) if slides else -1.0
    )  # fmt: skip


@internal
def _forces(b: Any, memory: Any, row: Any, state: Any, t1: Any, t2: Any, now: Any) -> Any:
    """(force on the second shape, how it goes with the normal's multiplier, g_1, g_2 and g_3) of a contact at (x, y,
    z)."""
    lam, (slides, both, one, slow) = vec(b.lam, b.m_extended), state
    share, pull = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    c, s, spins = 1.0, 0.0, 0.0
    if slides:
        _, _, _, g_d, g_y, g_e, to_d, to_e = direction(now[0], now[1], now[2], memory.sliding_lean, slow)
        c, s, spins = to_d * g_d - to_e * g_e, g_y, to_e * g_d + to_d * g_e
    if slides or (memory.mode == CLOSED and memory.slide_mode == IDLE):
        share = times(-memory.friction_ratio, plus(times(c, t1), times(s, t2)))
        pull = times(lam[row[0]], share)
    elif both or one:
        pull = times(-lam[row[1]], t1)
        if both:
            pull = less(pull, times(lam[row[2]], t2))
        else:
            share = times(-memory.friction_ratio, t2)
            pull = plus(pull, times(lam[row[0]], share))
    return pull, share, c, s, spins


@inlined
def _says_of_tangents(par: Any, axis: int) -> float:
    """Of an open contact nobody asks for friction: what an instant has to know of its tangents stands there."""
    return float(axis) + (TURNS_HARD if resists_turning(par) else 0.0)


@internal
def grip_spheres(b: Any, t: float, e: int) -> None:
    """The residual of element e of a batch, a pair of spheres, or a sphere on a half-space: gap and friction."""
    par, extra, coord = (
        mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e], imat(b.coord, b.count, PAIR_SIZE)[e]
    )  # fmt: skip
    memory, row, pair = memories_at(b.memory, b.n_memory)[extra[0]], imat(b.row, b.count, 3)[e], pair_of(b, e)
    motion, _ = press_spheres(b, e)
    slip, n, closed = slip_of_spheres(b, par, coord, pair, motion), motion[2][0], memory.mode == CLOSED
    u, u_rate = pass_surface(b, e, t, coord, pair, slip[0], slip[1])
    axis, angle = int(memory.tangent_axis), memory.tangent_angle
    if not closed or axis == 0:
        axis, angle = farthest_axis(b, coord, pair, int(par[GAP_KIND]), n), 0.0
    t1, t2, t1_rate, t2_rate = tangents_in_motion(b, coord, pair, axis, angle, motion)
    x, y, state, z, z_rate = dot(u, t1), dot(u, t2), _state(par, memory, closed), 0.0, 0.0
    if par[FRICTION_RADIUS] > 0.0:
        z, z_rate = spin_on_patch(b, par, coord, pair, n), spin_rate(b, par, coord, pair, n, motion[2][1])
    rates = dot(u_rate, t1) + dot(u, t1_rate), dot(u_rate, t2) + dot(u, t2_rate), z_rate
    pull, _, _, _, spins = _forces(b, memory, row, state, t1, t2, (x, y, z))
    _levels(b, e, (x, y, z), rates, memory.sliding_lean, state[3])
    says, creeps = math.sqrt(dot(pull, pull)) if closed else _says_of_tangents(par, axis), 0.0
    if par[FRICTION_RADIUS] > 0.0:
        creeps = z / creep_size(par, memory, x, y, z)
    monitor = vec(b.monitor, b.n_monitor)
    monitor[b.n_memory + extra[0]], monitor[2 * b.n_memory + extra[0]] = says, creeps if closed else z
    if not closed:
        return
    pull_spheres(b, coord, motion, slip, pull)
    if resists_turning(par):
        m, _ = turning_arms(b, par, coord, pair, n)
        m = plus(m, times(par[FRICTION_AT] * par[FRICTION_RADIUS] * (spins if state[0] else creeps), n))
        add_torque(b, coord, pair, times(vec(b.lam, b.m_extended)[row[0]], m))


@internal
def grip(kind: int, b: Any, job: int, t: float, e: int, gradient: Any, held: Any, moves: Any, work: Any) -> None:
    """The friction of element e of a batch, whose gap, of this kind, has been evaluated."""
    memory = memories_at(b.memory, b.n_memory)[imat(b.extra, b.count, b.nextra)[e, 0]]
    closed = memory.mode == CLOSED
    if job != RESIDUAL and not (closed and (job == TANGENT or job == POWER)):
        return
    par, extra = mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e]
    width, coord, k = b.ncoord, imat(b.coord, b.count, b.ncoord)[e], extra[0]
    row, lam, v = imat(b.row, b.count, 3)[e], vec(b.lam, b.m_extended), vec(b.v, b.n_extended)
    pair = pair_of(b, e)  # its axes, which those that are held may not be
    n, u, beta_a, beta_b, size = slip_of_batch(kind, b, par, coord, held, moves, work)
    u, more, surface = pass_surface_in(b, e, t, coord, pair, u, work)
    axis, angle = int(memory.tangent_axis), memory.tangent_angle
    if not closed or axis == 0:
        axis, angle = farthest_axis(b, coord, pair, int(par[GAP_KIND]), n), 0.0
    t1, t2 = tangents(b, coord, pair, axis, angle, n, work)
    x, y, z, radius = dot(u, t1), dot(u, t2), 0.0, par[FRICTION_RADIUS]
    if radius > 0.0:
        z = spin_on_patch(b, par, coord, held, n)
    state = _state(par, memory, closed)
    slides, both, one, slow = state
    pull, share, c, s, spins = _forces(b, memory, row, state, t1, t2, (x, y, z))
    creeping, drills = creep_size(par, memory, x, y, z), 0.0
    creeps = z / creeping
    m, power, turns_hard = (0.0, 0.0, 0.0), 0.0, closed and resists_turning(par)
    if turns_hard:
        m, power = turning_arms(b, par, coord, held, n)
        drills = par[FRICTION_AT] * (spins if slides else creeps)
    whole = plus(m, times(drills * radius, n))
    if job == RESIDUAL:
        a = vec(b.a, b.n_extended)
        u_rate = plus(more, plus(product_with(work, W, a, coord), product_with(work, U, v, coord)))
        t1_rate, t2_rate = product_with(work, T1, v, coord), product_with(work, T2, v, coord)
        z_rate = 0.0
        if radius > 0.0:
            z_rate = spin_rate(b, par, coord, held, n, product_with(work, NORMAL, v, coord))
        rates = dot(u_rate, t1) + dot(u, t1_rate), dot(u_rate, t2) + dot(u, t2_rate), z_rate
        _levels(b, e, (x, y, z), rates, memory.sliding_lean, slow)
        force, monitor = math.sqrt(dot(pull, pull)), vec(b.monitor, b.n_monitor)
        monitor[b.n_memory + k] = force if closed else _says_of_tangents(par, axis)
        monitor[2 * b.n_memory + k] = creeps if closed else z
        r = vec(b.r, b.n_extended)
        for i in range(width):
            r[coord[i]] -= dot(column(work, W, i), pull)
        if turns_hard:
            add_torque(b, coord, held, times(lam[row[0]], whole))
    elif job == POWER:
        vec(b.a, b.n_extended)[extra[3]] -= dot(pull, u) + lam[row[0]] * (power + drills * z)
        put_in_along(b, e, pull, surface)
    else:
        values, c_q, line = vec(b.values, b.n_values), vec(b.coef, 2)[0], line_of(b, e)
        slot = imat(b.slot_s + 8 * width * width * line, width, width)
        slot_j = ivec(b.slot_j + 24 * width * line, 3 * width)
        slot_jt = ivec(b.slot_jt + 24 * width * line, 3 * width)
        add_slip(kind, b, par, values, slot, coord, held, moves, work, beta_a, beta_b, size, pull, -c_q)
        for j in range(width):
            gradient[j] = 0.0
        if turns_hard:
            add_torque_tangent(b, par, coord, held, slot, work, n, m, lam[row[0]], gradient)
            add_torque_by(b, coord, held, slot_jt, whole)
        way, load, spin = direction(x, y, z, memory.sliding_lean, slow), -memory.friction_ratio * lam[row[0]], gradient
        if radius > 0.0:
            spin_changes(b, par, coord, held, work, n, spin)
        for j in range(width):
            of_v, by_t1, by_t2 = column(work, W, j), column(work, T1, j), column(work, T2, j)
            along_1, along_2, of_q, c_v = dot(of_v, t1), dot(of_v, t2), column(work, U, j), vec(b.coef, 2)[1]
            of_x = c_q * (dot(of_q, t1) + dot(u, by_t1)) + c_v * along_1
            of_y = c_q * (dot(of_q, t2) + dot(u, by_t2)) + c_v * along_2
            g_3 = (spin[j] - creeps / creeping * (x * of_x + y * of_y + z * spin[j])) / creeping
            if both or one:
                values[slot_j[width + j]] += along_1
                values[slot_jt[width + j]] += along_1
                change = times(-c_q * lam[row[1]], by_t1)
                if both:
                    values[slot_j[2 * width + j]] += along_2
                    values[slot_jt[2 * width + j]] += along_2
                    change = less(change, times(c_q * lam[row[2]], by_t2))
                else:
                    values[slot_jt[j]] -= dot(of_v, share)
                    change = plus(change, times(c_q * load, by_t2))
            else:
                values[slot_jt[j]] -= dot(of_v, share)
                g_1, g_2 = 0.0, 0.0
                if slides:
                    g_1, g_2, g_3 = turn_of_direction(way, of_x, of_y, spin[j])
                change = plus(times(g_1, t1), plus(times(g_2, t2), times(c_q, plus(times(c, by_t1), times(s, by_t2)))))
                change = times(load, change)
            # that of z becomes that of the torque
            spin[j] = lam[row[0]] * radius * par[FRICTION_AT] * g_3
            for i in range(width):
                values[slot[i, j]] -= dot(column(work, W, i), change)
        if radius > 0.0:
            add_spin_tangent(b, coord, held, slot, work, n, lam[row[0]] * radius * drills, spin)


@internal
def gripping_sphere3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(PAIR_SIZE), np.empty((PAIR_SIZE, PAIR_SIZE)), np.empty(PACKED)
    work, held, moves = np.empty((FRAME_ROWS, PAIR_SIZE)), np.empty(COLUMNS), np.empty((MOVES, PAIR_SIZE))
    par = mat(b.par, b.count, b.npar)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        if job == RESIDUAL and not moves_on(int(par[e, GAP_KIND])):
            grip_spheres(b, t, e)
            continue
        kind = hold(b, e, held, moves)
        g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
        grip(kind, b, job, t, e, gradient, held, moves, work)


are(SPHERE, gripping_sphere3d_kernel)
