"""Planar contacts with friction: a second scalar function, the sliding distance, beside the gap.

A closed contact that sticks has both as constraints. One that slides has the gap only, and its multiplier acts along
grad g - mu s grad d, with s = +-1 the direction of sliding and d the sliding distance: F_T = -mu F_N s (in general
F_T = `friction_ratio` F_N). A contact that acts as a force gets F_T from a regularised law. On a surface that moves
(`moving_surface.py`) the sliding velocity is d' - f, and sticking is a constraint of velocities.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT, line_of, shown, shown_at
from ..compiled.views import imat, ivec, mat, to_fixed_tuple, vec
from ..elements.geometry2d import (
    add_hessian,
    add_product,
    along,
    bearing,
    bend_of,
    constrain,
    distance,
    height_and_way,
    levels,
)
from ..laws.friction import call_friction
from ..state.modes import ACTIVE, CLOSED, STICKS, memories_at
from .geometry_kinds import DISKS, PLANE, are
from .moving_surface import moves, put_in, surface_speed
from .normal2d import LAW_ADDRESS, act, evaluate_law, idle

FRICTION_AT = 11
"""First friction parameter in the table of parameters."""
FRICTION_ADDRESS = 5
"""Column of `extra` with the address of a regularised law's formula."""


@internal
def _slide_row(
    b: Any, job: int, e: int, k: int, s: float, gradient: Any, hessian: Any, period: float, sticks: bool, surface: Any
) -> None:
    """The sliding distance's row: its value, rate and acceleration always; a constraint while the contact sticks."""
    row = imat(b.row, b.count, b.nrow)[e, 1]
    since = s - memories_at(b.memory, b.n_memory)[k].slide_start
    if period > 0.0:
        since -= period * np.rint(since / period)
    if sticks:
        constrain(b, job, e, row, 1, since, gradient, hessian)
    elif job == RESIDUAL:
        # what to remember if it begins to stick here
        levels(b, e, row, s, gradient, bend_of(b, e, hessian))
    if job == RESIDUAL and moves(b, e):
        vec(b.phi, b.m_extended)[row] = 0.0
        vec(b.phid, b.m_extended)[row] -= surface[0]
        vec(b.phidd, b.m_extended)[row] -= surface[1]


@internal
def _slip(b: Any, job: int, e: int, slope: float, gradient: Any, hessian: Any, speed: float) -> None:
    """Friction of a closed contact in proportion to its normal force: F_T = slope lam; slope = mu s where it slides."""
    coord = imat(b.coord, b.count, b.ncoord)[e]
    lam = vec(b.lam, b.m_extended)[imat(b.row, b.count, b.nrow)[e, 0]]
    if job == RESIDUAL:
        r = vec(b.r, b.n_extended)
        for i in range(len(gradient)):
            r[coord[i]] -= slope * lam * gradient[i]
        vec(b.monitor, b.n_monitor)[b.n_memory + imat(b.extra, b.count, b.nextra)[e, 0]] = slope * lam
    elif job == TANGENT:
        values = vec(b.values, b.n_values)
        n = b.ncoord
        line = line_of(b, e)
        slot = ivec(b.slot_jt + 16 * n * line, 2 * n)
        for i in range(len(gradient)):
            values[slot[i]] -= slope * gradient[i]
        block = imat(b.slot_s + 8 * line * n * n, n, n)
        add_hessian(values, block, gradient, hessian, -vec(b.coef, 2)[0] * slope * lam)
    elif job == POWER:
        rate = along(gradient, vec(b.v, b.n_extended), coord) - speed
        vec(b.a, b.n_extended)[imat(b.extra, b.count, b.nextra)[e, 3]] -= slope * lam * rate
        put_in(b, e, slope * lam * speed)


@internal
def add_friction(
    b: Any, job: int, e: int, g_gradient: Any, g_hessian: Any, gradient: Any, hessian: Any, force: float,
    by_rate: float, by_normal: float, normal_d: float, normal_dd: float,
) -> None:  # fmt: skip
    """Residual or tangent of a friction force that depends on the sliding velocity and on the normal force, and that
    on the penetration and its rate."""
    n = b.ncoord
    coord, v = imat(b.coord, b.count, n)[e], vec(b.v, b.n_extended)
    if job == RESIDUAL:
        r = vec(b.r, b.n_extended)
        for i in range(len(gradient)):
            r[coord[i]] -= force * gradient[i]
        vec(b.monitor, b.n_monitor)[b.n_memory + imat(b.extra, b.count, b.nextra)[e, 0]] = force
    elif job == TANGENT:
        values = vec(b.values, b.n_values)
        slot = imat(b.slot_s + 8 * line_of(b, e) * n * n, n, n)
        c_q, c_v = vec(b.coef, 2)[0], vec(b.coef, 2)[1]
        add_hessian(values, slot, gradient, hessian, -c_q * force)
        add_product(values, slot, gradient, gradient, hessian, v, coord, -c_v * by_rate, -c_q * by_rate)
        by_gap, by_gap_rate = c_q * normal_d + c_v * normal_dd, c_q * normal_dd
        add_product(
            values, slot, gradient, g_gradient, g_hessian, v, coord, by_normal * by_gap, by_normal * by_gap_rate
        )


@internal
def _regularised(
    b: Any, job: int, e: int, g: float, g_gradient: Any, g_hessian: Any, gradient: Any, hessian: Any, speed: float
) -> Any:
    """The friction of an active force contact, by its regularised law: (F_T, dF_T/dv)."""
    coord = imat(b.coord, b.count, b.ncoord)[e]
    extra = imat(b.extra, b.count, b.nextra)[e]
    par = mat(b.par, b.count, b.npar)[e]
    v = vec(b.v, b.n_extended)
    normal, normal_d, normal_dd, _, _ = evaluate_law(b, e, extra[0], g, along(g_gradient, v, coord))
    rate = along(gradient, v, coord) - speed
    pushing = normal > 0.0
    force, by_rate, by_normal = call_friction(
        extra[FRICTION_ADDRESS], rate, max(normal, 0.0),
        par[FRICTION_AT], par[FRICTION_AT + 1], par[FRICTION_AT + 2], par[FRICTION_AT + 3], par[FRICTION_AT + 4],
    )  # fmt: skip
    if not pushing:
        by_normal = 0.0
    if job == POWER:
        vec(b.a, b.n_extended)[extra[3]] -= force * rate
        put_in(b, e, force * speed)
    else:
        add_friction(
            b, job, e, g_gradient, g_hessian, gradient, hessian, force, by_rate, by_normal, normal_d, normal_dd
        )
    return force, by_rate


@internal
def act_sliding(
    b: Any, job: int, t: float, e: int, g: float, g_gradient: Any, g_hessian: Any, s: float, gradient: Any,
    hessian: Any, period: float,
) -> Any:  # fmt: skip
    """What a contact with friction adds for `job`: gap g, sliding distance s (which may jump by `period`).

    Returns a regularised friction force and its derivative by the sliding velocity, (0, 0) if there is none.
    """
    act(b, job, e, g, g_gradient, g_hessian)
    k = imat(b.extra, b.count, b.nextra)[e, 0]
    memory = memories_at(b.memory, b.n_memory)[k]
    closed, surface = memory.mode == CLOSED, surface_speed(b, e, t)
    sticks = closed and memory.slide_mode == STICKS
    lam = vec(b.lam, b.m_extended)
    if job == RESIDUAL:
        vec(b.monitor, b.n_monitor)[b.n_memory + k] = -lam[imat(b.row, b.count, b.nrow)[e, 1]] if sticks else 0.0
    if job == RESIDUAL or job == TANGENT:
        _slide_row(b, job, e, k, s, gradient, hessian, period, sticks, surface)
    elif job == POWER and sticks:
        put_in(b, e, -lam[imat(b.row, b.count, b.nrow)[e, 1]] * surface[0])
    if closed and memory.friction_ratio != 0.0:
        _slip(b, job, e, -memory.friction_ratio, gradient, hessian, surface[0])
    elif memory.mode == ACTIVE and imat(b.extra, b.count, b.nextra)[e, LAW_ADDRESS] != 0:
        return _regularised(b, job, e, g, g_gradient, g_hessian, gradient, hessian, surface[0])
    return 0.0, 0.0


@internal
def slide_on_half_plane(q: Any, coord: Any, par: Any) -> Any:
    """(gap, gradient, Hessian, sliding distance, gradient, Hessian) of one row of coordinates and parameters."""
    ux, uy, wx, wy, angle, radius = par[0], par[1], par[2], par[3], par[4], par[5]
    # along t = -J n, n the normal, and rolling: d = t . (r_b - r_a) + radius (theta_b - theta_a)
    g, g_gradient, g_hessian, s, (t0, t1, t2, t3, t4, t5), hessian = height_and_way(q, coord, ux, uy, wx, wy, angle)
    s += radius * (q[coord[5]] - q[coord[2]])
    return g - radius, g_gradient, g_hessian, s, (t0, t1, t2 - radius, t3, t4, t5 + radius), hessian


@internal
def slide_on_disk(q: Any, coord: Any, par: Any) -> Any:
    """The same for two disks."""
    ux, uy, wx, wy, both, first = par[0], par[1], par[2], par[3], par[5], par[6]
    d, g_gradient, g_hessian = distance(q, coord, ux, uy, wx, wy)
    # d = -(R_a + R_b) phi + R_a theta_a + R_b theta_b, phi the direction from a to b
    phi, turn, bend = bearing(q, coord, ux, uy, wx, wy)
    turn *= -both
    bend *= -both
    turn[2] += first
    turn[5] += both - first
    s = first * q[coord[2]] + (both - first) * q[coord[5]] - both * phi
    # tuples, so that the loops over them have lengths that the compiler knows
    return d - both, g_gradient, g_hessian, s, to_fixed_tuple(turn, 6), to_fixed_tuple(bend, 21)


@internal
def sliding_disk_on_half_plane_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        g, g_gradient, g_hessian, s, gradient, hessian = slide_on_half_plane(q, coord[e], par[e])
        act_sliding(b, job, t, e, g, g_gradient, g_hessian, s, gradient, hessian, 0.0)


@internal
def sliding_disk_on_disk_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        g, g_gradient, g_hessian, s, gradient, hessian = slide_on_disk(q, coord[e], par[e])
        act_sliding(b, job, t, e, g, g_gradient, g_hessian, s, gradient, hessian, 2.0 * np.pi * par[e, 5])


are(DISKS, sliding_disk_on_disk_kernel)
are(PLANE, sliding_disk_on_half_plane_kernel)
