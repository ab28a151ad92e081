"""Contacts in space that act as forces, with LuGre's friction: bristles that bend along the tangent plane.

The bristles stand on the first shape: their deflection z is a vector that turns with its body, and the velocities of
two or three internal coordinates are its components along the axes of the first marker, zeta_l = z . X_l. So nothing
turns the bristles but the body that carries them, no choice of tangents enters, and none has to be changed on the way.
With the sliding velocity u_T = u - n (n.u) of `tangent3d.py` and h = s0 |u_T|/g(|u_T|, F_n),
    rho = u_T - h z,   F_T = -(s0 z + s1 rho + s2 u_T),   zeta_l' = X_l . rho - (n . X_l) S,
    S = sum of zeta_k (n . X_k)':
LuGre's law for isotropic friction in two dimensions (Velenis, Tsiotras, Canudas de Wit, Sorine 2005, Dynamic tyre
friction models for combined longitudinal and lateral vehicle motion, Vehicle System Dynamics 43; in one dimension
`laws/friction/lugre.py`). The last term carries z along a normal that goes over the first shape, parallel to itself, so
that z stays in the tangent plane with its length (Levi-Civita). On a half-space the normal is an axis of the marker:
S = 0, and two components are enough.
As in the plane (`bristle2d.py`) the bristles hold s0 z^2/2; what else the friction takes, is lost.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT, line_of, shown, shown_at
from ..compiled.views import imat, mat, vec
from ..elements.geometry2d import along as rate_along
from ..elements.measure3d import AXES_A, COLUMNS
from ..elements.relative_spin3d import add_torque
from ..laws.friction.lugre import lugre_slip
from ..model.rotation3d import along, constant, dot, four, less, plus, times, turned, turning
from ..state.modes import ACTIVE, memories_at
from .cable_contact3d import gap_of_cable
from .cable_foot3d import FOOT_ROWS, FOOT_WIDTH
from .geometry_kinds import CABLE_IN_SPACE, SPHERE, are
from .mesh_nearest3d import OPEN_SURFACE, hold_on_mesh
from .moving_point3d import MOVES, ON_MESH, POINT_OF_CABLE, on_plane
from .normal2d import act, evaluate_law, is_sleeping
from .normal3d import GAP_KIND, PAIR_SIZE, gap_of, hold, pair_of
from .normal_rate3d import turn_normal
from .sliding2d import FRICTION_AT
from .slip3d import add_slip, slip_of_batch, speed_rate_of_batch
from .surface3d import pass_surface_in, put_in_along
from .tangent3d import NORMAL, ROWS, U, W, column, product_with, put
from .turning3d import add_torque_tangent, resists_turning, turning_arms

BENT = 3
"""Components of a deflection, at most."""
BRISTLE_INDICES = OPEN_SURFACE + 1
"""Columns of `extra`: those of the shape with most of them."""
ZERO = (0.0, 0.0, 0.0)


@internal
def _bend(
    kind: int, b: Any, job: int, t: float, e: int, g: float, held: Any, moves: Any, gradient: Any, hessian: Any,
    work: Any,
) -> None:  # fmt: skip
    """The friction of element e of a batch, whose gap, of this kind, has been evaluated."""
    par, extra = mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e]
    width, both = work.shape[1], b.ncoord
    coord, k, bristles = imat(b.coord, b.count, both)[e], extra[0], both - width
    pair = pair_of(b, e)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    n, u, beta_a, beta_b, size = slip_of_batch(kind, b, par, coord, held, moves, work)
    u, more, surface = pass_surface_in(b, e, t, coord, pair, u, work)
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
    normal, last = max(found, 0.0), b.npar - 1
    s0, s1, s2 = par[FRICTION_AT], par[FRICTION_AT + 1], par[FRICTION_AT + 2]
    # below the least normal force bristles slip and rub in proportion to it, as in the plane; a damper that pulls
    # leaves them as they are
    least = par[last - 1] * s0 / par[FRICTION_AT + 3]
    part = min(normal / least, 1.0)
    h, h_speed, h_normal = lugre_slip(
        speed, max(normal, least), s0, par[FRICTION_AT + 3], par[FRICTION_AT + 4], par[last]
    )  # fmt: skip
    p, pd = four(q, coord, 3, held[0]), four(v, coord, 3, 0.0)
    # X_l, and the columns of its turning
    axes, in_body, energy = np.empty((3 * BENT, 5)), ZERO, 0.0
    for i in range(bristles):
        axis, zeta = constant(pair, AXES_A + 3 * i), v[coord[width + i]]
        of_axis = turning(p, axis)
        put(axes, 3 * i, 0, turned(of_axis, p))
        for j in range(4):
            put(axes, 3 * i, 1 + j, of_axis[j])
        in_body = plus(in_body, times(zeta, axis))
        energy += 0.5 * s0 * zeta * zeta
    if job == ENERGY:
        vec(b.energy, 3)[2] += energy
        return
    of_z = turning(p, in_body)
    z, carried, curved = turned(of_z, p), along(of_z, pd), not on_plane(kind)
    n_rate, shift = ZERO, 0.0
    if curved:
        n_rate = product_with(work, NORMAL, v, coord)
        shift = dot(n_rate, z) + dot(n, carried)
    bends = less(slide, times(h, z))
    whole = times(-1.0, plus(times(s0, z), plus(times(s1, bends), times(s2, slide))))
    pressed = times(part, whole)
    pull = less(pressed, times(dot(n, pressed), n))
    m, power, turns_hard = ZERO, 0.0, resists_turning(par)
    if turns_hard:
        m, power = turning_arms(b, par, coord, held, n)
    if job == RESIDUAL:
        r = vec(b.r, b.n_extended)
        for i in range(width):
            r[coord[i]] -= dot(column(work, W, i), pull)
        for i in range(bristles):
            r[coord[width + i]] -= part * dot(column(axes, 3 * i, 0), bends) - shift * dot(n, column(axes, 3 * i, 0))
        vec(b.monitor, b.n_monitor)[b.n_memory + k] = math.sqrt(dot(pull, pull))
        if turns_hard:
            add_torque(b, coord, held, times(-normal, m))
        return
    if job == POWER:
        stored = s0 * (part * dot(z, bends) - shift * dot(n, z))
        vec(b.a, b.n_extended)[extra[3]] -= dot(pull, slide) + stored - normal * power
        put_in_along(b, e, pull, surface)
        return
    if job != TANGENT:
        return
    values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
    c_q, c_v = coef[0], coef[1]
    slot = imat(b.slot_s + 8 * both * both * line_of(b, e), both, both)
    add_slip(kind, b, par, values, slot, coord, held, moves, work, beta_a, beta_b, size, pull, -c_q)
    changes, turns, rate_z = np.empty(width), np.empty((3, width)), turning(pd, in_body)
    if curved:
        turn_normal(kind, b, coord, held, moves, work, n, n_rate, turns)
    one = 1.0 / speed if speed > 0.0 else 0.0
    for j in range(both):
        by_n, by_z, by_carried, slides, of_normal, by_shift = ZERO, ZERO, ZERO, ZERO, 0.0, 0.0
        if j < width:
            n_of, of_v, of_q = column(work, NORMAL, j), column(work, W, j), column(work, U, j)
            by_n = times(c_q, n_of)
            of_q = less(of_q, plus(times(dot(n, of_q) + dot(n_of, u), n), times(across, n_of)))
            of_v = less(of_v, times(dot(n, of_v), n))
            slides = plus(times(c_q, of_q), times(c_v, of_v))
            turn = 0.0
            for i in range(width):
                turn += hessian[i, j] * v[coord[i]]
            # penetration and its rate are less the gap and its rate
            if found > 0.0:
                of_normal = -c_q * (normal_d * gradient[j] + normal_dd * turn) - c_v * normal_dd * gradient[j]
            changes[j] = -of_normal
            if curved:
                by_shift = c_v * dot(n_of, z) + c_q * dot(column(turns, 0, j), z) + dot(by_n, carried)
            if 3 <= j < 7:
                by_z = times(c_q, of_z[j - 3])
                by_carried = plus(times(c_v, of_z[j - 3]), times(c_q, rate_z[j - 3]))
        else:
            at = 3 * (j - width)
            by_z = times(c_v, column(axes, at, 0))
            for i in range(4):
                by_carried = plus(by_carried, times(c_v * pd[i], column(axes, at, 1 + i)))
        if curved:
            by_shift += dot(n_rate, by_z) + dot(n, by_carried)
        by_h = h_speed * one * dot(slide, slides) + (h_normal * of_normal if found >= least else 0.0)
        by_part = of_normal / least if found < least else 0.0
        by_bends = less(slides, plus(times(h, by_z), times(by_h, z)))
        by_whole = times(-1.0, plus(times(s0, by_z), plus(times(s1, by_bends), times(s2, slides))))
        change = plus(times(part, by_whole), times(by_part, whole))
        change = less(change, times(dot(n, change) + dot(by_n, pressed), n))
        change = less(change, times(dot(n, pressed), by_n))
        for i in range(width):
            values[slot[i, j]] -= dot(column(work, W, i), change)
        by_bent = plus(times(part, by_bends), times(by_part, bends))
        for i in range(bristles):
            axis = column(axes, 3 * i, 0)
            by = dot(axis, by_bent) - dot(by_n, axis) * shift - dot(n, axis) * by_shift
            if 3 <= j < 7:
                of_axis = times(c_q, column(axes, 3 * i, j - 2))
                by += part * dot(of_axis, bends) - dot(n, of_axis) * shift
            values[slot[width + i, j]] -= by
    if turns_hard:
        add_torque_tangent(b, par, coord, held, slot, work, n, m, -normal, changes)


@internal
def _act_all(job: int, t: float, b: Any, width: int, rows: int) -> None:
    """All elements of a batch, whose gaps depend on `width` coordinates; rows : of what says how points move. Kernels
    share it, so that there is one in machine code."""
    gradient, hessian, packed = np.empty(width), np.empty((width, width)), np.empty(width * (width + 1) // 2)
    work, held, moves = np.empty((ROWS, width)), np.empty(COLUMNS), np.empty((rows, width))
    par = mat(b.par, b.count, b.npar)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if is_sleeping(b, e):
            continue
        kind = int(par[e, GAP_KIND])
        if kind == POINT_OF_CABLE:
            _, g = gap_of_cable(b, e, held, moves, gradient, hessian, packed)
        else:
            kind = hold_on_mesh(b, e, held, moves) if kind == ON_MESH else hold(b, e, held, moves)
            g = gap_of(kind, b, e, held, moves, gradient, hessian, packed)
        act(b, job, e, g, gradient, packed)
        _bend(kind, b, job, t, e, g, held, moves, gradient, hessian, work)


@internal
def bristle_sphere3d_kernel(job: int, t: float, b: Any) -> None:
    _act_all(job, t, b, PAIR_SIZE, MOVES)


@internal
def bristle_cable3d_kernel(job: int, t: float, b: Any) -> None:
    _act_all(job, t, b, FOOT_WIDTH, FOOT_ROWS)


are(SPHERE, bristle_sphere3d_kernel)
are(CABLE_IN_SPACE, bristle_cable3d_kernel)
