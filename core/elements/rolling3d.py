"""Rolling on a plane: a wheel of radius R whose rim is rounded with radius r (a torus; R = 0: a sphere; r = 0: a disk).

With the plane's normal n and tangents t_k, the wheel's axis a, sigma = n . a, d from the plane's point to the centre:
  gap = n . d - R sqrt(1 - sigma^2) - r          a row with a position form
  t_k . (velocity of the wheel's point that touches - that of the plane's) = 0,  k = 1, 2     rows at velocity level
The point that touches is at the centre + R u - r n, u = -w/|w|, w = n - sigma a. Velocities by angular velocities
2 E(p) p'. A force f there acts on the wheel's Euler parameters by 2 E^T (rho x f), rho from the frame to the point.
(Neimark and Fufaev 1972, Dynamics of Nonholonomic Systems.) All rows have the sign that makes multipliers the force on
the wheel along t_1, t_2, n.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.frame3d import FRAME, in_space, vector_of
from ..model.markers import Marker3D
from ..model.rotation3d import (
    add_bend,
    columns_at,
    constant,
    cross,
    dot,
    four,
    less,
    onto,
    plus,
    space_rate,
    three,
    times,
    turns,
)
from .base import Form
from .primitive3d import PA, PB, RA, RB, SIZE, Primitive


@inlined
def _of_torque(p: Any, y: Any) -> Any:
    """2 E(p)^T y: what a torque y in space does to the Euler parameters."""
    c = cross(y, (p[1], p[2], p[3]))
    return (
        -2.0 * (p[1] * y[0] + p[2] * y[1] + p[3] * y[2]),
        2.0 * (p[0] * y[0] + c[0]),
        2.0 * (p[0] * y[1] + c[1]),
        2.0 * (p[0] * y[2] + c[2]),
    )


@internal
def _rim(n: Any, a: Any) -> Any:
    """u, and 1/|w|."""
    w = less(n, times(dot(n, a), a))
    size = 1.0 / np.sqrt(dot(w, w))
    return times(-size, w), size


@internal
def _rim_change(n: Any, a: Any, dn: Any, da: Any) -> Any:
    """The change of u with changes of n and a."""
    u, size = _rim(n, a)
    dw = less(less(dn, times(dot(dn, a) + dot(n, da), a)), times(dot(n, a), da))
    return times(-size, less(dw, times(dot(u, dw), u)))


@internal
def rolling3d_kernel(job: int, t: float, b: Any) -> None:
    if job == RESIDUAL:
        _residual(b)
    elif job == TANGENT:
        _tangent(b)


@internal
def _residual(b: Any) -> None:
    par, coord, row = mat(b.par, b.count, 22), imat(b.coord, b.count, 14), imat(b.row, b.count, 3)
    q, v, a, r = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended), vec(b.r, b.n_extended)
    lam = vec(b.lam, b.m_extended)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    for e in range(b.count):
        at, large, small = coord[e], par[e, 20], par[e, 21]
        of_n, n, n_rate, n_second = turns(b, at, PA, par[e, 0], constant(par[e], 2))
        of_u, own, own_rate, own_second = turns(b, at, PA, par[e, 0], constant(par[e], 11))
        of_w, arm, arm_rate, arm_second = turns(b, at, PB, par[e, 1], constant(par[e], 14))
        d = plus(less(three(q, at, RB), three(q, at, RA)), less(arm, own))
        d_rate = plus(less(three(v, at, RB), three(v, at, RA)), less(arm_rate, own_rate))
        d_second = plus(less(three(a, at, RB), three(a, at, RA)), less(arm_second, own_second))
        gap, rate = dot(n, d) - small, dot(n_rate, d) + dot(n, d_rate)
        second = dot(n_second, d) + 2.0 * dot(n_rate, d_rate) + dot(n, d_second)
        # from the wheel's frame to the point that touches, and how that moves
        out, out_rate = less(arm, times(small, n)), less(arm_rate, times(small, n_rate))
        load = -lam[row[e, 0]]
        by_n, by_u, by_w = onto(of_n, d), onto(of_u, n), onto(of_w, n)
        for i in range(3):
            r[at[RA + i]] -= load * n[i]
            r[at[RB + i]] += load * n[i]
        for i in range(4):
            r[at[PA + i]] += load * (by_n[i] - by_u[i])
            r[at[PB + i]] += load * by_w[i]
        if large > 0.0:
            of_a, axis, axis_rate, axis_second = turns(b, at, PB, par[e, 1], constant(par[e], 17))
            sigma, sigma_rate = dot(n, axis), dot(n_rate, axis) + dot(n, axis_rate)
            sigma_second = dot(n_second, axis) + 2.0 * dot(n_rate, axis_rate) + dot(n, axis_second)
            root = np.sqrt(1.0 - sigma * sigma)
            slope = -large * sigma / root
            gap -= large * root
            rate -= slope * sigma_rate
            second -= slope * sigma_second - large * sigma_rate * sigma_rate / (root * root * root)
            by_n, by_w = onto(of_n, axis), onto(of_a, n)
            for i in range(4):
                r[at[PA + i]] -= load * slope * by_n[i]
                r[at[PB + i]] -= load * slope * by_w[i]
            u, _ = _rim(n, axis)
            out = plus(out, times(large, u))
            out_rate = plus(out_rate, times(large, _rim_change(n, axis, n_rate, axis_rate)))
        k = row[e, 0]
        phi[k], phid[k], phidd[k] = -gap, -rate, -second
        # the same from the plane's frame
        back = plus(less(three(q, at, RB), three(q, at, RA)), out)
        back_rate = plus(less(three(v, at, RB), three(v, at, RA)), out_rate)
        pa, pb = four(q, at, PA, par[e, 0]), four(q, at, PB, par[e, 1])
        wa, wb = times(2.0, space_rate(pa, four(v, at, PA, 0.0))), times(2.0, space_rate(pb, four(v, at, PB, 0.0)))
        turn_a = times(2.0, space_rate(pa, four(a, at, PA, 0.0)))
        turn_b = times(2.0, space_rate(pb, four(a, at, PB, 0.0)))
        slip = less(plus(three(v, at, RB), cross(wb, out)), plus(three(v, at, RA), cross(wa, back)))
        of_b = plus(three(a, at, RB), plus(cross(turn_b, out), cross(wb, out_rate)))
        of_a_second = plus(three(a, at, RA), plus(cross(turn_a, back), cross(wa, back_rate)))
        slip_rate = less(of_b, of_a_second)
        force = (0.0, 0.0, 0.0)
        for side in range(2):
            _, along, along_rate, _ = turns(b, at, PA, par[e, 0], constant(par[e], 5 + 3 * side))
            k = row[e, 1 + side]
            phi[k], phid[k] = 0.0, -dot(along, slip)
            phidd[k] = -(dot(along_rate, slip) + dot(along, slip_rate))
            force = less(force, times(lam[k], along))
        of_a_torque, of_b_torque = _of_torque(pa, cross(back, force)), _of_torque(pb, cross(out, force))
        for i in range(3):
            r[at[RA + i]] -= force[i]
            r[at[RB + i]] += force[i]
        for i in range(4):
            r[at[PA + i]] -= of_a_torque[i]
            r[at[PB + i]] += of_b_torque[i]


@inlined
def _put(columns: Any, first: int, j: int, x: Any) -> None:
    for i in range(3):
        columns[first + j, i] = x[i]


@inlined
def _column(columns: Any, j: int) -> Any:
    return columns[j, 0], columns[j, 1], columns[j, 2]


@internal
def _tangent(b: Any) -> None:
    par, coord, row = mat(b.par, b.count, 22), imat(b.coord, b.count, 14), imat(b.row, b.count, 3)
    q, lam, values = vec(b.q, b.n_extended), vec(b.lam, b.m_extended), vec(b.values, b.n_values)
    c_q = vec(b.coef, 2)[0]
    # derivatives by the coordinates, (14, 3): of n, of the axis, of d, of the arms from both frames, of the force
    space = np.empty((6, 14, 3))
    dn, da, dd, d_out, d_back, df = space[0], space[1], space[2], space[3], space[4], space[5]
    for e in range(b.count):
        at, large, small = coord[e], par[e, 20], par[e, 21]
        slot = imat(b.slot_s + 8 * 196 * e, 14, 14)
        slot_j, slot_jt = imat(b.slot_j, b.count, 42)[e], imat(b.slot_jt, b.count, 42)[e]
        space[:] = 0.0
        of_n, n = columns_at(b, at, PA, par[e, 0], constant(par[e], 2))
        of_u, own = columns_at(b, at, PA, par[e, 0], constant(par[e], 11))
        of_w, arm = columns_at(b, at, PB, par[e, 1], constant(par[e], 14))
        between = less(three(q, at, RB), three(q, at, RA))
        d, out = plus(between, less(arm, own)), less(arm, times(small, n))
        for i in range(3):
            dd[RA + i, i], dd[RB + i, i] = -1.0, 1.0
        for j in range(4):
            _put(dn, PA, j, of_n[j])
            _put(dd, PA, j, times(-1.0, of_u[j]))
            _put(dd, PB, j, of_w[j])
            _put(d_out, PA, j, times(-small, of_n[j]))
            _put(d_out, PB, j, of_w[j])
        load = -lam[row[e, 0]] * c_q
        add_bend(values, slot, PA, load, d, constant(par[e], 2))
        add_bend(values, slot, PA, -load, n, constant(par[e], 11))
        add_bend(values, slot, PB, load, n, constant(par[e], 14))
        slope, bent, axis = 0.0, 0.0, (0.0, 0.0, 1.0)
        if large > 0.0:
            of_a, axis = columns_at(b, at, PB, par[e, 1], constant(par[e], 17))
            sigma = dot(n, axis)
            root = np.sqrt(1.0 - sigma * sigma)
            slope, bent = -large * sigma / root, -large / (root * root * root)
            u, _ = _rim(n, axis)
            out = plus(out, times(large, u))
            still = (0.0, 0.0, 0.0)
            for j in range(4):
                _put(da, PB, j, of_a[j])
                _put(d_out, PA, j, plus(_column(d_out, PA + j), times(large, _rim_change(n, axis, of_n[j], still))))
                _put(d_out, PB, j, plus(_column(d_out, PB + j), times(large, _rim_change(n, axis, still, of_a[j]))))
            add_bend(values, slot, PA, -load * slope, axis, constant(par[e], 2))
            add_bend(values, slot, PB, -load * slope, n, constant(par[e], 17))
        for j in range(14):
            nj, dj, aj = _column(dn, j), _column(dd, j), _column(da, j)
            by_sigma = dot(nj, axis) + dot(n, aj) if large > 0.0 else 0.0
            entry = -(dot(nj, d) + dot(n, dj) - slope * by_sigma)
            values[slot_j[j]] += entry
            values[slot_jt[j]] += entry
            for i in range(14):
                ni, di, ai = _column(dn, i), _column(dd, i), _column(da, i)
                curved = dot(ni, dj) + dot(nj, di)
                if large > 0.0:
                    of_i = dot(ni, axis) + dot(n, ai)
                    curved -= slope * (dot(ni, aj) + dot(nj, ai)) + bent * of_i * by_sigma
                values[slot[i, j]] += load * curved
        # the tangential force at the point that touches
        back, force = plus(between, out), (0.0, 0.0, 0.0)
        for j in range(14):
            _put(d_back, j, 0, _column(d_out, j))
        for i in range(3):
            d_back[RA + i, i], d_back[RB + i, i] = -1.0, 1.0
        pa, pb = four(q, at, PA, par[e, 0]), four(q, at, PB, par[e, 1])
        for side in range(2):
            of_t, along = columns_at(b, at, PA, par[e, 0], constant(par[e], 5 + 3 * side))
            load = lam[row[e, 1 + side]]
            force = less(force, times(load, along))
            for j in range(4):
                _put(df, PA, j, less(_column(df, PA + j), times(load, of_t[j])))
            to_a, to_b = _of_torque(pa, cross(back, along)), _of_torque(pb, cross(out, along))
            first = 14 * (1 + side)
            for i in range(3):
                for slots in (slot_j, slot_jt):
                    values[slots[first + RA + i]] += along[i]
                    values[slots[first + RB + i]] -= along[i]
            for i in range(4):
                for slots in (slot_j, slot_jt):
                    values[slots[first + PA + i]] += to_a[i]
                    values[slots[first + PB + i]] -= to_b[i]
        on_a, on_b = cross(back, force), cross(out, force)
        for j in range(14):
            fj = _column(df, j)
            to_a = _of_torque(pa, plus(cross(_column(d_back, j), force), cross(back, fj)))
            to_b = _of_torque(pb, plus(cross(_column(d_out, j), force), cross(out, fj)))
            for i in range(3):
                values[slot[RA + i, j]] -= c_q * fj[i]
                values[slot[RB + i, j]] += c_q * fj[i]
            for i in range(4):
                values[slot[PA + i, j]] -= c_q * to_a[i]
                values[slot[PB + i, j]] += c_q * to_b[i]
        _add_turning(values, slot, PA, -2.0 * c_q, on_a)
        _add_turning(values, slot, PB, 2.0 * c_q, on_b)


@inlined
def _add_turning(values: Any, slot: Any, first: int, factor: float, y: Any) -> None:
    """values[slot] += factor d(E^T y)/dp = factor [[0, -y^T], [y, y~]]."""
    for i in range(3):
        values[slot[first, first + 1 + i]] -= factor * y[i]
        values[slot[first + 1 + i, first]] += factor * y[i]
    values[slot[first + 1, first + 2]] -= factor * y[2]
    values[slot[first + 1, first + 3]] += factor * y[1]
    values[slot[first + 2, first + 1]] += factor * y[2]
    values[slot[first + 2, first + 3]] -= factor * y[0]
    values[slot[first + 3, first + 1]] -= factor * y[1]
    values[slot[first + 3, first + 2]] += factor * y[0]


@internal
def rolling_load(row: Any, places: Any, numbers: Any, out: Any) -> None:
    n, x = in_space(row, places, 0, vector_of(numbers, 0)), in_space(row, places, 0, vector_of(numbers, 3))
    y, axis = in_space(row, places, 0, vector_of(numbers, 6)), in_space(row, places, FRAME, vector_of(numbers, 15))
    radius, rim_radius = numbers[18], numbers[19]
    # from the centre to the point that touches
    arm = times(-rim_radius, n)
    if radius != 0.0:
        w = less(n, times(dot(n, axis), axis))
        arm = less(arm, times(radius / math.sqrt(dot(w, w)), w))
    by_n, by_x, by_y = row[places[2 * FRAME]], row[places[2 * FRAME + 1]], row[places[2 * FRAME + 2]]
    force = plus(times(by_n, n), plus(times(by_x, x), times(by_y, y)))
    torque = cross(arm, force)
    for k in range(3):
        out[k] += force[k]
        out[3 + k] += torque[k]


@dataclass(frozen=True)
class Rolling(Primitive):
    """A wheel whose centre is the point of marker b and whose axis is its z axis rolls on the xy plane of marker a, on
    the side to which z points; 3 rows, of which two at velocity level."""

    radius: float
    """Of the circle about which the rim is rounded, m; 0: a sphere."""
    rim_radius: float
    """Of the rounding, m; 0: a sharp rim."""
    holds_axes: ClassVar[bool] = True
    load: ClassVar[Any] = rolling_load
    form: ClassVar[Form] = Form(
        rolling3d_kernel,
        3,
        tuple((i, j) for i in range(SIZE) for j in range(SIZE)),
        tuple((k, j) for k in range(3) for j in range(SIZE)),
        rate_rows=(1, 2),
    )

    def parameters(self, a: Marker3D, b: Marker3D) -> Sequence[float]:
        axes = a.axes()
        plane = (*axes[:, 2], *axes[:, 0], *axes[:, 1], *a.point)
        return (*plane, *b.point, *b.axes()[:, 2], self.radius, self.rim_radius)
