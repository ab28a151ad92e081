"""Planar contact along the normal: a gap function between two shapes, and a law.

The gap's value, rate and acceleration always stand in phi, phid and phidd of the contact's row; only a closed
contact makes them part of the constraints. A contact that acts as a force adds -F dg/dq to r.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT, line_of, shown, shown_at
from ..compiled.views import imat, ivec, mat, vec
from ..elements.geometry2d import (
    add_hessian,
    add_product,
    along,
    bend_of,
    constrain,
    distance,
    height_over_line,
    levels,
)
from ..laws import call_law
from ..state.modes import ACTIVE, CLOSED, memories_at
from .geometry_kinds import DISKS, PLANE, are

LAW_ADDRESS = 1
"""Column of `extra` with the address of a force law's formula; 0: the contact is a constraint."""


@internal
def is_sleeping(b: Any, e: int) -> bool:
    """True if element e of a batch of contacts is too far from touching to be evaluated."""
    return ivec(b.sleeping, b.n_memory)[imat(b.extra, b.count, b.nextra)[e, 0]] != 0


@internal
def idle(b: Any, e: int, job: int) -> bool:
    """True if element e of a batch of contacts has nothing to do: it is sleeping, or its shapes do not press and only
    its gap is asked for. Not so for friction with states of its own."""
    if is_sleeping(b, e):
        return True
    mode = memories_at(b.memory, b.n_memory)[imat(b.extra, b.count, b.nextra)[e, 0]].mode
    return bool(job != RESIDUAL and mode != CLOSED and mode != ACTIVE)


@internal
def evaluate_law(b: Any, e: int, k: int, g: float, rate: float) -> Any:
    """(F, dF/d delta, dF/d delta_dot, elastic part, elastic energy) of element e, contact k."""
    memory, p = memories_at(b.memory, b.n_memory)[k], mat(b.par, b.count, b.npar)[e]
    law, depth, speed = imat(b.extra, b.count, b.nextra)[e, LAW_ADDRESS], max(-g, 0.0), memory.approach_speed
    found = call_law(law, depth, -rate, speed, p[7], p[8], p[9], p[10])
    # shapes that were laid on each other are damped as by the blow that goes as deep, m v^2/2 = elastic energy
    twice, mass = 2.0 * found[4], memory.laid_mass
    if mass > 0.0 and twice > mass * speed * speed:
        f, f_d, f_dd, elastic, energy = call_law(law, depth, -rate, np.sqrt(twice / mass), p[7], p[8], p[9], p[10])
        return f, f_d + f_dd * rate * elastic / twice, f_dd, elastic, energy
    return found


@internal
def _add_force(b: Any, job: int, e: int, k: int, g: float, gradient: Any, hessian: Any) -> None:
    """The force law of element e, contact k: what it adds for `job`."""
    n = b.ncoord
    coord = imat(b.coord, b.count, n)[e]
    extra = imat(b.extra, b.count, b.nextra)
    v = vec(b.v, b.n_extended)
    rate = along(gradient, v, coord)
    f, f_d, f_dd, elastic, energy = evaluate_law(b, e, k, g, rate)
    active = memories_at(b.memory, b.n_memory)[k].mode == ACTIVE
    if job == RESIDUAL:
        vec(b.monitor, b.n_monitor)[k] = f
        if active:
            r = vec(b.r, b.n_extended)
            for i in range(len(gradient)):
                r[coord[i]] -= f * gradient[i]
    elif active and job == TANGENT:
        values = vec(b.values, b.n_values)
        coef = vec(b.coef, 2)
        slot = imat(b.slot_s + 8 * line_of(b, e) * n * n, n, n)
        add_hessian(values, slot, gradient, hessian, -coef[0] * f)
        by_value, by_rate = coef[0] * f_d + coef[1] * f_dd, coef[0] * f_dd
        add_product(values, slot, gradient, gradient, hessian, v, coord, by_value, by_rate)
    elif active and job == ENERGY:
        vec(b.energy, 3)[2] += energy
    elif active and job == POWER:
        a = vec(b.a, b.n_extended)
        a[extra[e, 2]] += f
        a[extra[e, 3]] += (elastic - f) * rate


@internal
def act(b: Any, job: int, e: int, g: float, gradient: Any, hessian: Any) -> None:
    """What element e of a batch of contacts adds for `job`, given its gap."""
    row = imat(b.row, b.count, b.nrow)[e, 0]
    k = imat(b.extra, b.count, b.nextra)[e, 0]
    force_law = imat(b.extra, b.count, b.nextra)[e, LAW_ADDRESS] != 0
    lam = vec(b.lam, b.m_extended)
    closed = memories_at(b.memory, b.n_memory)[k].mode == CLOSED
    if job == RESIDUAL and not closed:
        levels(b, e, row, g, gradient, bend_of(b, e, hessian))
        if not force_law:
            vec(b.monitor, b.n_monitor)[k] = 0.0
    elif job == RESIDUAL or (job == TANGENT and closed):
        constrain(b, job, e, row, 0, g, gradient, hessian)
        vec(b.monitor, b.n_monitor)[k] = -lam[row]
    if force_law:
        _add_force(b, job, e, k, g, gradient, hessian)
    elif job == POWER and closed:
        vec(b.a, b.n_extended)[imat(b.extra, b.count, b.nextra)[e, 2]] -= lam[row]


@internal
def disk_on_half_plane_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, b.npar)
    coord = imat(b.coord, b.count, 6)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        g, gradient, hessian = height_over_line(
            vec(b.q, b.n_extended), coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3], par[e, 4]
        )
        act(b, job, e, g - par[e, 5], gradient, hessian)


@internal
def disk_on_disk_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, b.npar)
    coord = imat(b.coord, b.count, 6)
    for i in range(shown(b)):
        e = shown_at(b, i)
        if idle(b, e, job):
            continue
        d, gradient, hessian = distance(vec(b.q, b.n_extended), coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        act(b, job, e, d - par[e, 5], gradient, hessian)


are(DISKS, disk_on_disk_kernel)
are(PLANE, disk_on_half_plane_kernel)
