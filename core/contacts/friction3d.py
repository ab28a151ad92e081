"""Regularised friction of contacts in space: a law of the sliding speed, against the direction of sliding.

F_T = F(|u_T|, F_N) u_T/|u_T|, u_T = u - n (n.u) the sliding velocity (`tangent3d.py`); F < 0. The contact's second row
says the sliding speed. On a patch the law speaks of s = |(u_T, z)|, z = r w_n (`turning3d.py`), in place of |u_T|:
F_T = F(s, F_N) u_T/s, and the torque along n is F(s, F_N) r z/s.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT, line_of, shown, shown_at
from ..compiled.views import imat, mat, vec
from ..elements.geometry2d import along as rate_along
from ..elements.measure3d import COLUMNS
from ..elements.relative_spin3d import add_torque
from ..laws.friction import call_friction
from ..model.rotation3d import dot, less, plus, times
from ..state.modes import ACTIVE, memories_at
from .geometry_kinds import SPHERE, are
from .moving_point3d import MOVES, moves_on
from .normal2d import act, evaluate_law, idle
from .normal3d import GAP_KIND, PACKED, PAIR_SIZE, gap_of, hold, pair_of
from .sliding2d import FRICTION_ADDRESS, FRICTION_AT
from .slip3d import add_slip, slip_of_batch, speed_rate, speed_rate_of_batch
from .spheres3d import press_spheres, pull_spheres, slip_of_spheres
from .surface3d import pass_surface, pass_surface_in, put_in_along
from .tangent3d import NORMAL, ROWS, U, W, column
from .turning3d import (
    FRICTION_RADIUS,
    add_spin_tangent,
    add_torque_tangent,
    resists_turning,
    spin_changes,
    spin_on_patch,
    turning_arms,
)

SLOW = 1e-150
"""m/s: below it the direction of sliding is lost to rounding, and the law's slope at rest says the force."""


@internal
def _law(b: Any, e: int, speed: float, normal: float) -> Any:
    """(F, dF/d speed, dF/dF_N) of element e of a batch."""
    par, extra = mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e]
    return call_friction(
        extra[FRICTION_ADDRESS], speed, normal,
        par[FRICTION_AT], par[FRICTION_AT + 1], par[FRICTION_AT + 2], par[FRICTION_AT + 3], par[FRICTION_AT + 4],
    )  # fmt: skip


@internal
def rub_spheres(b: Any, t: float, e: int) -> None:
    """The residual of element e of a batch, a pair of spheres, or a sphere on a half-space: gap and friction."""
    par, extra, coord = (
        mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e], imat(b.coord, b.count, PAIR_SIZE)[e]
    )  # fmt: skip
    motion, found = press_spheres(b, e)
    pair, n, row = pair_of(b, e), motion[2][0], imat(b.row, b.count, 2)[e, 1]
    slip = slip_of_spheres(b, par, coord, pair, motion)
    u, u_rate = pass_surface(b, e, t, coord, pair, slip[0], slip[1])
    slide = less(u, times(dot(n, u), n))
    speed = math.sqrt(dot(slide, slide))
    vec(b.phi, b.m_extended)[row], vec(b.phid, b.m_extended)[row] = 0.0, speed
    vec(b.phidd, b.m_extended)[row] = speed_rate(n, motion[2][1], u, u_rate)
    vec(b.monitor, b.n_monitor)[b.n_memory + extra[0]] = 0.0
    if memories_at(b.memory, b.n_memory)[extra[0]].mode != ACTIVE:
        return
    normal, z = max(found, 0.0), spin_on_patch(b, par, coord, pair, n)
    whole = math.sqrt(speed * speed + z * z)
    force, by_rate, _ = _law(b, e, whole, normal)
    over = force / whole if whole > SLOW else by_rate
    pull_spheres(b, coord, motion, slip, times(over, slide))
    vec(b.monitor, b.n_monitor)[b.n_memory + extra[0]] = -over * speed
    if resists_turning(par):
        m, _ = turning_arms(b, par, coord, pair, n)
        add_torque(b, coord, pair, less(times(over * par[FRICTION_RADIUS] * z, n), times(normal, m)))


@internal
def regularised(
    kind: int, b: Any, job: int, t: float, e: int, g: float, held: Any, moves: Any, gradient: Any, hessian: Any,
    work: Any,
) -> None:  # fmt: skip
    """The friction of element e of a batch, whose gap, of this kind, has been evaluated."""
    par, extra = mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e]
    width, coord, k = b.ncoord, imat(b.coord, b.count, b.ncoord)[e], extra[0]
    v = vec(b.v, b.n_extended)
    n, u, beta_a, beta_b, size = slip_of_batch(kind, b, par, coord, held, moves, work)
    u, more, surface = pass_surface_in(b, e, t, coord, pair_of(b, e), u, work)
    across = dot(n, u)
    slide = less(u, times(across, n))
    speed = math.sqrt(dot(slide, slide))
    if job == RESIDUAL:
        row = imat(b.row, b.count, 2)[e, 1]
        vec(b.phi, b.m_extended)[row], vec(b.phid, b.m_extended)[row] = 0.0, speed
        vec(b.phidd, b.m_extended)[row] = speed_rate_of_batch(b, coord, work, n, u, more)
        vec(b.monitor, b.n_monitor)[b.n_memory + k] = 0.0
    if memories_at(b.memory, b.n_memory)[k].mode != ACTIVE:
        return
    found, normal_d, normal_dd, _, _ = evaluate_law(b, e, k, g, rate_along(gradient, v, coord))
    normal = max(found, 0.0)
    z, turns_hard = 0.0, resists_turning(par)
    if turns_hard:
        z = spin_on_patch(b, par, coord, held, n)
    whole = math.sqrt(speed * speed + z * z)
    force, by_rate, by_normal = _law(b, e, whole, normal)
    one = 1.0 / whole if whole > SLOW else 0.0
    along, along_z = times(one, slide), one * z
    over_speed = force * one if whole > SLOW else by_rate
    pull, torque = times(over_speed, slide), par[FRICTION_RADIUS] * over_speed * z
    m, power = (0.0, 0.0, 0.0), 0.0
    if turns_hard:
        m, power = turning_arms(b, par, coord, held, n)
    if job == RESIDUAL:
        r = vec(b.r, b.n_extended)
        for i in range(width):
            r[coord[i]] -= dot(column(work, W, i), pull)
        vec(b.monitor, b.n_monitor)[b.n_memory + k] = -over_speed * speed
        if turns_hard:
            add_torque(b, coord, held, less(times(torque, n), times(normal, m)))
    elif job == POWER:
        vec(b.a, b.n_extended)[extra[3]] -= force * whole - normal * power
        put_in_along(b, e, pull, surface)
    elif job == TANGENT:
        values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
        slot = imat(b.slot_s + 8 * width * width * line_of(b, e), width, width)
        if not found > 0.0:
            by_normal = 0.0
        add_slip(
            kind, b, par, values, slot, coord, held, moves, work, beta_a, beta_b, size, pull, -coef[0],
        )  # fmt: skip
        changes, spins = np.empty(width), np.zeros(width)
        if par[FRICTION_RADIUS] > 0.0:
            spin_changes(b, par, coord, held, work, n, spins)
        for j in range(width):
            by_n, of_v = column(work, NORMAL, j), column(work, W, j)
            of_q = less(column(work, U, j), times(across, by_n))
            of_q = less(of_q, times(dot(by_n, u) + dot(n, column(work, U, j)), n))
            of_v = less(of_v, times(dot(n, of_v), n))
            turn = 0.0
            for i in range(width):
                turn += hessian[i, j] * v[coord[i]]
            # penetration and its rate are less the gap and its rate
            of_normal = -coef[0] * (normal_d * gradient[j] + normal_dd * turn) - coef[1] * normal_dd * gradient[j]
            changes[j] = -of_normal if found > 0.0 else 0.0
            slides = plus(times(coef[0], of_q), times(coef[1], of_v))
            forward = dot(along, slides) + along_z * spins[j]
            more = by_rate * forward + by_normal * of_normal
            change = plus(times(over_speed, less(slides, times(forward, along))), times(more, along))
            spins[j] = par[FRICTION_RADIUS] * (over_speed * (spins[j] - forward * along_z) + more * along_z)
            for i in range(width):
                values[slot[i, j]] -= dot(column(work, W, i), change)
        if turns_hard:
            add_torque_tangent(b, par, coord, held, slot, work, n, m, -normal, changes)
        if par[FRICTION_RADIUS] > 0.0:
            add_spin_tangent(b, coord, held, slot, work, n, torque, spins)


@internal
def rubbing_sphere3d_kernel(job: int, t: float, b: Any) -> None:
    gradient, hessian, packed = np.empty(PAIR_SIZE), np.empty((PAIR_SIZE, PAIR_SIZE)), np.empty(PACKED)
    work, held, moves = np.empty((ROWS, PAIR_SIZE)), np.empty(COLUMNS), np.empty((MOVES, PAIR_SIZE))
    par = mat(b.par, b.count, b.npar)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        if job == RESIDUAL and not moves_on(int(par[e, GAP_KIND])):
            rub_spheres(b, t, e)
            continue
        kind = hold(b, e, held, moves)
        g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
        regularised(kind, b, job, t, e, g, held, moves, gradient, hessian, work)


are(SPHERE, rubbing_sphere3d_kernel)
