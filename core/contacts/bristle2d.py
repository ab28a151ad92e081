"""Planar contacts that act as forces, with LuGre's friction: a bristle deflection z beside the coordinates.

z is the velocity of an internal coordinate of the contact, the last of its local ones: 1 a_zeta = z'(z, v, F_n). So
every method integrates it like any velocity, with its exact tangent; the coordinate itself means nothing.
The bristles hold s0 z^2/2; what else the friction takes, is lost. A contact that is not active, or whose damper pulls,
leaves z as it is.
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT, line_of
from ..compiled.views import imat, mat, vec
from ..elements.geometry2d import add_product, along, bend_of, levels
from ..laws.friction.lugre import lugre_formula
from ..state.modes import ACTIVE, memories_at
from .geometry_kinds import DISKS, PLANE, are
from .moving_surface import put_in, surface_speed
from .normal2d import act, evaluate_law
from .sliding2d import FRICTION_AT, add_friction, slide_on_disk, slide_on_half_plane


@internal
def _bristles(
    b: Any, job: int, t: float, e: int, g: float, g_gradient: Any, g_hessian: Any, gradient: Any, hessian: Any
) -> Any:
    """Friction of an active contact: (F_T, dF_T/dv, dz'/dv)."""
    n, w = b.ncoord, len(gradient)
    coord = imat(b.coord, b.count, n)[e]
    extra = imat(b.extra, b.count, b.nextra)[e]
    par = mat(b.par, b.count, b.npar)[e]
    v = vec(b.v, b.n_extended)
    normal, normal_d, normal_dd, _, _ = evaluate_law(b, e, extra[0], g, along(g_gradient, v, coord))
    speed, _ = surface_speed(b, e, t)
    z, rate = v[coord[w]], along(gradient, v, coord) - speed
    s0, last = par[FRICTION_AT], b.npar - 1
    if job == ENERGY:
        vec(b.energy, 3)[2] += 0.5 * s0 * z * z
    if not normal > 0.0:
        # a damper that pulls: nothing is pressed, nothing rubs, and the bristles stay as they are
        return 0.0, 0.0, 0.0
    # bristles that would slip at less slip and rub in proportion to the normal force: their equation has no limit at
    # normal force zero, where a contact ends
    least = par[last - 1] * s0 / par[FRICTION_AT + 3]
    zd, zd_z, zd_v, zd_n, force, f_z, f_v, f_n = lugre_formula(
        z, rate, max(normal, least), s0, par[FRICTION_AT + 1], par[FRICTION_AT + 2], par[FRICTION_AT + 3],
        par[FRICTION_AT + 4], par[last],
    )  # fmt: skip
    if normal < least:
        # error control would find no end of a jump at zero
        part = normal / least
        zd_n, f_n = zd / least, force / least
        zd, zd_z, zd_v, force, f_z, f_v = part * zd, part * zd_z, part * zd_v, part * force, part * f_z, part * f_v
    if job == POWER:
        vec(b.a, b.n_extended)[extra[3]] -= force * rate + s0 * z * zd
        put_in(b, e, force * speed)
    elif job != ENERGY:
        add_friction(b, job, e, g_gradient, g_hessian, gradient, hessian, force, f_v, f_n, normal_d, normal_dd)
    if job == RESIDUAL:
        vec(b.r, b.n_extended)[coord[w]] -= zd
    elif job == TANGENT:
        values = vec(b.values, b.n_values)
        slot = imat(b.slot_s + 8 * line_of(b, e) * n * n, n, n)
        c_q, c_v = vec(b.coef, 2)[0], vec(b.coef, 2)[1]
        for i in range(len(gradient)):
            values[slot[i, w]] -= c_v * f_z * gradient[i]
        values[slot[w, w]] -= c_v * zd_z
        own, one = slot[w : w + 1], (1.0,)
        add_product(values, own, one, gradient, hessian, v, coord, -c_v * zd_v, -c_q * zd_v)
        by_gap, by_gap_rate = zd_n * (c_q * normal_d + c_v * normal_dd), zd_n * c_q * normal_dd
        add_product(values, own, one, g_gradient, g_hessian, v, coord, by_gap, by_gap_rate)
    return force, f_v, zd_v


@internal
def act_bristles(
    b: Any, job: int, t: float, e: int, g: float, g_gradient: Any, g_hessian: Any, gradient: Any, hessian: Any
) -> Any:
    """What a contact with LuGre's friction adds for `job`, given its gap and the gradient of its sliding distance.

    Returns the friction force and the derivatives of it and of z' by the sliding velocity, zeros if there is none.
    """
    act(b, job, e, g, g_gradient, g_hessian)
    k = imat(b.extra, b.count, b.nextra)[e, 0]
    if job == RESIDUAL:
        vec(b.monitor, b.n_monitor)[b.n_memory + k] = 0.0
        row, (speed, faster) = imat(b.row, b.count, 2)[e, 1], surface_speed(b, e, t)
        levels(b, e, row, 0.0, gradient, bend_of(b, e, hessian))
        vec(b.phid, b.m_extended)[row] -= speed
        vec(b.phidd, b.m_extended)[row] -= faster
    if memories_at(b.memory, b.n_memory)[k].mode == ACTIVE:
        return _bristles(b, job, t, e, g, g_gradient, g_hessian, gradient, hessian)
    return 0.0, 0.0, 0.0


@internal
def bristle_disk_on_half_plane_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    for e in range(b.count):
        g, g_gradient, g_hessian, _, gradient, hessian = slide_on_half_plane(q, coord[e], par[e])
        act_bristles(b, job, t, e, g, g_gradient, g_hessian, gradient, hessian)


@internal
def bristle_disk_on_disk_kernel(job: int, t: float, b: Any) -> None:
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    for e in range(b.count):
        g, g_gradient, g_hessian, _, gradient, hessian = slide_on_disk(q, coord[e], par[e])
        act_bristles(b, job, t, e, g, g_gradient, g_hessian, gradient, hessian)


are(DISKS, bristle_disk_on_disk_kernel)
are(PLANE, bristle_disk_on_half_plane_kernel)
