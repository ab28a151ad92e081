"""Residuals of spheres, on each other, in each other and on half-spaces: from the motion of their points alone.

What `normal3d.py` and `tangent3d.py` say with gradients, Hessians and matrices of both bodies' coordinates, tangents of
the equations need; the equations themselves need but the place, velocity and acceleration of two points, and the
angular velocities. With d = x_b - x_a, and n the normal,
    g' = n.d'   g'' = n.d'' + (d'.d' - (n.d')^2)/|d|     of spheres,   g = n.d   with n'' = (A m)''   on a half-space,
    u = s d' + w_b x beta_b - w_a x beta_a   and u' its derivative, s, beta_a and beta_b those of `tangent3d.py`.
"""

import math
from typing import Any

from ..compiled.jit import inlined, internal
from ..compiled.views import imat, mat, vec
from ..elements.measure3d import AXES_A, POINT_A, POINT_B
from ..model.rotation3d import along, constant, cross, dot, four, less, onto, plus, space_axes, three, times, turns
from ..state.modes import ACTIVE, CLOSED, memories_at
from .moving_point3d import HOLLOW, on_plane
from .normal2d import LAW_ADDRESS, evaluate_law
from .normal3d import GAP_KIND, PAIR_SIZE, RADIUS_A, RADIUS_B, pair_of

ZERO = (0.0, 0.0, 0.0)


@internal
def gap_motion(kind: int, b: Any, coord: Any, pair: Any, radii: float) -> Any:
    """((g, g', g''), (d, d', d''), (n, n'), columns of both points' turning and of the normal's, 1/|d| and its relative
    rate) of a pair of spheres, or of a half-space and a sphere, where the last two mean nothing; radii: their sum."""
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    of_u, u, u_rate, u_second = turns(b, coord, 3, pair[0], constant(pair, POINT_A))
    of_w, w, w_rate, w_second = turns(b, coord, 10, pair[1], constant(pair, POINT_B))
    d = plus(less(three(q, coord, 7), three(q, coord, 0)), less(w, u))
    rate = plus(less(three(v, coord, 7), three(v, coord, 0)), less(w_rate, u_rate))
    second = plus(less(three(a, coord, 7), three(a, coord, 0)), less(w_second, u_second))
    if on_plane(kind):
        of_n, n, n_rate, n_second = turns(b, coord, 3, pair[0], constant(pair, AXES_A + 6))
        g, g_rate = dot(n, d) - radii, dot(n_rate, d) + dot(n, rate)
        g_second = dot(n_second, d) + 2.0 * dot(n_rate, rate) + dot(n, second)
        return (g, g_rate, g_second), (d, rate, second), (n, n_rate), (of_u, of_w, of_n), 1.0, 0.0
    length = math.sqrt(dot(d, d))
    # between spheres in spheres with one centre no direction is the normal
    one = 1.0 / length if length > 0.0 else 0.0
    if kind == HOLLOW:
        one, length = -one, -length
    n = times(one, d)
    g_rate = dot(n, rate)
    n_rate = times(one, less(rate, times(g_rate, n)))
    g_second = dot(n, second) + one * (dot(rate, rate) - g_rate * g_rate)
    return (length - radii, g_rate, g_second), (d, rate, second), (n, n_rate), (of_u, of_w, of_u), one, -one * g_rate


@inlined
def _add(r: Any, coord: Any, first: int, force: Any, of: Any) -> None:
    """r += a force at a point, the columns of whose turning are given."""
    for i in range(3):
        r[coord[first + i]] += force[i]
    by = onto(of, force)
    for i in range(4):
        r[coord[first + 3 + i]] += by[i]


@internal
def _press(b: Any, coord: Any, plane: bool, motion: Any, force: float) -> None:
    """r += force times the gradient of the gap."""
    r, n = vec(b.r, b.n_extended), motion[2][0]
    f = times(force, n)
    _add(r, coord, 7, f, motion[3][1])
    _add(r, coord, 0, times(-1.0, f), motion[3][0])
    if plane:
        by = onto(motion[3][2], motion[1][0])
        for i in range(4):
            r[coord[3 + i]] += force * by[i]


@internal
def press_spheres(b: Any, e: int) -> Any:
    """What the gap of element e of a batch adds to the residual: (motion of the gap, normal force of its law)."""
    par, extra = mat(b.par, b.count, b.npar)[e], imat(b.extra, b.count, b.nextra)[e]
    coord, kind, k = imat(b.coord, b.count, PAIR_SIZE)[e], int(par[GAP_KIND]), extra[0]
    row = imat(b.row, b.count, b.nrow)[e, 0]
    motion = gap_motion(kind, b, coord, pair_of(b, e), par[RADIUS_A] + par[RADIUS_B])
    g, rate, second = motion[0]
    vec(b.phi, b.m_extended)[row], vec(b.phid, b.m_extended)[row] = g, rate
    vec(b.phidd, b.m_extended)[row] = second
    mode, monitor, force = memories_at(b.memory, b.n_memory)[k].mode, vec(b.monitor, b.n_monitor), 0.0
    if extra[LAW_ADDRESS] != 0:
        force, _, _, _, _ = evaluate_law(b, e, k, g, rate)
        monitor[k] = force
        if mode == ACTIVE:
            _press(b, coord, on_plane(kind), motion, -force)
    else:
        lam = vec(b.lam, b.m_extended)[row] if mode == CLOSED else 0.0
        monitor[k] = -lam if mode == CLOSED else 0.0
        if mode == CLOSED:
            _press(b, coord, on_plane(kind), motion, lam)
    return motion, force


@internal
def slip_of_spheres(b: Any, par: Any, coord: Any, pair: Any, motion: Any) -> Any:
    """(u, u', beta_a, beta_b, s, E(p) of both bodies): how they slide, from the motion of the gap."""
    v, a, q = vec(b.v, b.n_extended), vec(b.a, b.n_extended), vec(b.q, b.n_extended)
    _, (d, rate, second), (n, n_rate), _, one, grows = motion
    ra, rb, plane = par[RADIUS_A], par[RADIUS_B], on_plane(int(par[GAP_KIND]))
    axes_a, axes_b = space_axes(four(q, coord, 3, pair[0])), space_axes(four(q, coord, 10, pair[1]))
    w_a, w_b = times(2.0, along(axes_a, four(v, coord, 3, 0.0))), times(2.0, along(axes_b, four(v, coord, 10, 0.0)))
    # E(p') p' = 0
    a_turns = times(2.0, along(axes_a, four(a, coord, 3, 0.0)))
    b_turns = times(2.0, along(axes_b, four(a, coord, 10, 0.0)))
    size = 1.0 if plane else (ra + rb) * one
    size_rate = 0.0 if plane else size * grows
    beta_b, beta_b_rate = times(-rb, n), times(-rb, n_rate)
    beta_a = less(d, times(rb, n)) if plane else times(ra, n)
    beta_a_rate = less(rate, times(rb, n_rate)) if plane else times(ra, n_rate)
    u = plus(times(size, rate), less(cross(w_b, beta_b), cross(w_a, beta_a)))
    u_rate = plus(times(size_rate, rate), times(size, second))
    u_rate = plus(u_rate, plus(cross(b_turns, beta_b), cross(w_b, beta_b_rate)))
    u_rate = less(u_rate, plus(cross(a_turns, beta_a), cross(w_a, beta_a_rate)))
    return u, u_rate, beta_a, beta_b, size, axes_a, axes_b


@internal
def tangents_in_motion(b: Any, coord: Any, pair: Any, axis: int, angle: float, motion: Any) -> Any:
    """(t1, t2) of `frame3d.tangents`, and their rates."""
    n, n_rate = motion[2]
    _, z, z_rate, _ = turns(b, coord, 3, pair[0], constant(pair, AXES_A + 3 * (axis - 1)))
    across, across_rate = dot(n, z), dot(n_rate, z) + dot(n, z_rate)
    t = less(z, times(across, n))
    t_rate = less(z_rate, plus(times(across_rate, n), times(across, n_rate)))
    one = 1.0 / math.sqrt(dot(t, t))
    e1 = times(one, t)
    e1_rate = times(one, less(t_rate, times(dot(e1, t_rate), e1)))
    e2, e2_rate = cross(n, e1), plus(cross(n_rate, e1), cross(n, e1_rate))
    c, s = math.cos(angle), math.sin(angle)
    t1, t2 = plus(times(c, e1), times(s, e2)), plus(times(-s, e1), times(c, e2))
    t1_rate = plus(times(c, e1_rate), times(s, e2_rate))
    return t1, t2, t1_rate, plus(times(-s, e1_rate), times(c, e2_rate))


@internal
def pull_spheres(b: Any, coord: Any, motion: Any, slip: Any, pull: Any) -> None:
    """r -= W^T pull: a force on the second shape against the first one at their point of contact."""
    r = vec(b.r, b.n_extended)
    _, _, beta_a, beta_b, size, axes_a, axes_b = slip
    f = times(size, pull)
    _add(r, coord, 7, times(-1.0, f), motion[3][1])
    _add(r, coord, 0, f, motion[3][0])
    on_a, on_b = onto(axes_a, cross(beta_a, pull)), onto(axes_b, cross(beta_b, pull))
    for i in range(4):
        r[coord[3 + i]] += 2.0 * on_a[i]
        r[coord[10 + i]] -= 2.0 * on_b[i]
