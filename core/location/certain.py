"""Has a gap changed its sign within a step, however large the step? Decided by bounds, not by samples.

g is looked at as the polynomial p of fifth degree through (g, g', g'') at both ends of a part of the step. The rest is
g - p = g^(6)(x)/720 s^3 (s - 1)^3, s in [0, 1]. In the basis of Bernstein's polynomials of degree 6, s^3 (1 - s)^3 is
B_3/20: a bound of g^(6) lowers the coefficient c_3 of p, and if no coefficient is negative, neither is g. Where that
decides nothing, g_0 + g_1 > the way that the gap can go does, or the line through both ends less
G_2 s (1 - s)/2; else the part is halved. Halves of a part that holds no root are soon without: the rest shrinks with
the sixth power of their length. Parts are looked at in their order, so that the first root is found.

The bounds are those of the motion (`motion_bounds`). Of gaps that are linear in the coordinates nothing is left. Of
deformable lines and of kernels and functions that a user has written the rest is taken from how far the polynomial of
the whole was off at the middle; lines, and edges of bodies, are divided at least until nothing moves by more than the
shapes are thick.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, ivec, mat, vec
from ..shapes.cable_line import BOTH as CABLE_BOTH
from ..shapes.cable_line import LENGTH as CABLE_LENGTH
from ..shapes.cable_line import POINT as CABLE_POINT
from ..shapes.cable_line import VECTORS
from ..shapes.edges_nearest3d import EDGES
from ..shapes.geometry_kinds import CABLE, DISKS, EQUATIONS, LINE, LINEAR, OWN, PLANE, SEGMENT, SPHERE
from ..shapes.held3d import ON_MESH
from ..shapes.line2d import BOTH as LINE_BOTH
from ..shapes.line2d import NODES, POINTS
from ..shapes.mesh_nearest3d import OPEN
from ..shapes.normal3d import KIND as SHAPES
from ..shapes.normal3d import RADIUS_A, RADIUS_B
from ..shapes.travel3d import way_of_sphere
from .motion_bounds import control_points, gap_bounds
from .probe import KIND, NEAR_SIZE, VIEW, look, probe_of, state_of_pair

SHORTEST = 2.0**-34
"""Of the step: what a gap does in a shorter part cannot be told from a touch."""
MOST_LOOKS = 20_000
"""Parts of one step, for the gap of one contact."""
DEPTH = 64
NODE = 4 + 18
"""A place in the step: s, the gap with its two derivatives, and the state of both bodies."""


@internal
def _pair(kind: int) -> bool:
    return kind == DISKS or kind == PLANE or kind == SEGMENT


@internal
def way_of_gap(ws: Any, lc: Any, k: int, fastest: int) -> float:
    """An upper bound of how far the gap of contact k goes within the step, or (fastest = 1) of its greatest rate times
    the step; infinite where none is known."""
    kind = imat(lc.near, ws.n_contacts, NEAR_SIZE)[k, KIND]
    if kind == EQUATIONS or kind == OWN:
        return np.inf
    batch, way = probe_of(lc, k), mat(lc.travel, 2, ws.n_ext)[fastest]
    par, coord = mat(batch.par, batch.count, batch.npar), imat(batch.coord, batch.count, batch.ncoord)
    total = 0.0
    if kind == LINEAR:
        for i in range(6):
            total += abs(par[0, 16 + i]) * way[coord[0, i]]
        return total
    if _pair(kind):
        c, p = coord[0], par[0]
        total = way[c[0]] + way[c[1]] + way[c[3]] + way[c[4]] + math.hypot(p[2], p[3]) * way[c[5]]
        if kind == DISKS:
            return total + math.hypot(p[0], p[1]) * way[c[2]]
        if way[c[2]] > 0.0:
            q = vec(ws.q, ws.n_ext)
            arm = math.hypot(q[c[3]] - q[c[0]], q[c[4]] - q[c[1]]) + math.hypot(p[2], p[3])
            total += way[c[2]] * (arm + way[c[0]] + way[c[1]] + way[c[3]] + way[c[4]])
        return total
    if kind == SPHERE:
        return way_of_sphere(vec(ws.q, ws.n_ext), coord[0], par[0], way)
    largest = 0.0
    if kind == LINE:
        for e in range(batch.count):
            for node in range(NODES):
                c, u = coord[e, 3 * node : 3 * node + 3], par[e, POINTS + 2 * node : POINTS + 2 * node + 2]
                largest = max(largest, way[c[0]] + way[c[1]] + math.hypot(u[0], u[1]) * way[c[2]])
        c, u = coord[0, 3 * NODES :], par[0, POINTS + 2 * NODES :]
        return largest + way[c[0]] + way[c[1]] + math.hypot(u[0], u[1]) * way[c[2]]
    for e in range(batch.count):
        for end in range(2):
            c = coord[e, 4 * end : 4 * end + 4]
            # the inner control point of the cubic
            third = par[e, CABLE_LENGTH] / 3.0
            largest = max(largest, way[c[0]] + way[c[1]] + third * (way[c[2]] + way[c[3]]))
    c, u = coord[0, 2 * VECTORS :], par[0, CABLE_POINT:]
    return largest + way[c[0]] + way[c[1]] + math.hypot(u[0], u[1]) * way[c[2]]


@internal
def _thickness(lc: Any, k: int, kind: int) -> float:
    """Up to which way within a part the rest of the polynomial is trusted, m."""
    if kind == LINE or kind == CABLE:
        batch = probe_of(lc, k)
        both = mat(batch.par, batch.count, batch.npar)[0, LINE_BOTH if kind == LINE else CABLE_BOTH]
        return both if both > 0.0 else np.inf
    if kind == SPHERE:
        # edges that cross are apart again behind: the dip is as deep as they are round
        batch = probe_of(lc, k)
        par = mat(batch.par, batch.count, batch.npar)[0]
        if int(par[SHAPES]) == ON_MESH and imat(batch.extra, batch.count, batch.nextra)[0, OPEN] == EDGES:
            return par[RADIUS_A] + par[RADIUS_B]
    return np.inf


@internal
def _coefficients(left: Any, right: Any, tau: float, sign: float, c: Any) -> None:
    """Coefficients (7,) of degree 6 of the polynomial through the gap and its derivatives at both ends."""
    low = np.empty(6)
    control_points(
        sign * left[1], sign * left[2], sign * left[3], sign * right[1], sign * right[2], sign * right[3], tau, low
    )
    c[0], c[6] = low[0], low[5]
    for i in range(1, 6):
        c[i] = (i * low[i - 1] + (6 - i) * low[i]) / 6.0


@internal
def _first_rest(left: Any, right: Any, tau: float) -> float:
    """How far the polynomials of third and of fifth degree through both ends are from one another: more than the rest
    of the better one."""
    d, v0, v1 = right[1] - left[1], tau * left[2], tau * right[2]
    a0, a1 = 6.0 * d - 4.0 * v0 - 2.0 * v1, -6.0 * d + 2.0 * v0 + 4.0 * v1
    return (abs(tau * tau * left[3] - a0) + abs(tau * tau * right[3] - a1)) / 20.0


@internal
def _excluded(
    lc: Any, k: int, kind: int, left: Any, right: Any, tau: float, sign: float, slack: float, speed: float,
    thick: float, rest: float,
) -> Any:  # fmt: skip
    """(is there no root between two places, does the gap only fall there, is its polynomial somewhere negative)."""
    c = np.empty(7)
    g0, g1 = sign * left[1], sign * right[1]
    way = speed * tau
    if g0 + g1 > way:
        return True, False, False
    _coefficients(left, right, tau, sign, c)
    lowest = min(c[0], c[1], c[2], c[3], c[4], c[5], c[6])
    second, lowered = np.inf, 3.2 * rest
    if kind == LINEAR:
        lowered = 0.0
    elif _pair(kind):
        batch = probe_of(lc, k)
        par = mat(batch.par, batch.count, batch.npar)[0]
        way, second, sixth = gap_bounds(kind, par, left[4:], right[4:], left[1], right[1], tau)
        if g0 + g1 > way:
            return True, False, False
        lowered = sixth / 14400.0
    elif way > thick:
        return False, False, lowest < -slack
    if lowest >= -slack and c[3] - lowered >= -slack:
        return True, False, False
    if second < np.inf and g0 >= -slack and g1 >= -slack:
        least = min(g0, g1)
        if second > 0.0:
            s = 0.5 - (g1 - g0) / second
            if 0.0 < s < 1.0:
                least = g0 - 0.5 * second * s * s
        if least >= -slack:
            return True, False, False
    falls = True
    for i in range(6):
        falls = falls and c[i + 1] < c[i]
    falls = falls and c[3] - lowered < c[2] and lowered < 0.1 * (c[0] - c[6])
    return False, falls, lowest < -slack


@internal
def _place(ws: Any, ms: Any, lc: Any, k: int, kind: int, row: int, h: float, s: float, node: Any) -> None:
    """Look at a place between the ends of the step."""
    node[0] = s
    look(ws, ms, lc, k, row, h, s, node[1 : 1 + VIEW])
    if _pair(kind):
        state_of_pair(ws, ms, lc, k, h, s, node[4:])


@internal
def first_root(
    ws: Any, ms: Any, lc: Any, k: int, h: float, sign: float, start: Any, ended: bool, slack: float, bracket: Any
) -> bool:
    """True if `sign` times the gap of contact k goes from above zero to below within the step of size h.

    start : the gap with rate and acceleration at the newest row. ended : it counts as beyond zero at the step's end.
    slack : up to here a gap below zero is none, m. bracket (3,) gets, in parts of the step, the place before the first
    root, one beyond it, and the deepest one after it.
    """
    kind = imat(lc.near, ws.n_contacts, NEAR_SIZE)[k, KIND]
    row = ivec(ws.contact_rows, ws.n_contacts)[k]
    stack, rests, left, half = np.zeros((DEPTH, NODE)), np.empty(DEPTH), np.zeros(NODE), np.empty(7)
    right = stack[0]
    left[0], right[0] = 0.0, 1.0
    left[1], left[2], left[3] = start[0], start[1], start[2]
    right[1], right[2], right[3] = (
        vec(ws.phi, ws.m_ext)[row],
        vec(ws.phid, ws.m_ext)[row],
        vec(ws.phidd, ws.m_ext)[row],
    )
    if _pair(kind):
        state_of_pair(ws, ms, lc, k, h, 0.0, left[4:])
        state_of_pair(ws, ms, lc, k, h, 1.0, right[4:])
    # per second, for the whole step: of lines, whose nodes are many, and of thin edges
    speed, thick = np.inf, _thickness(lc, k, kind)
    if kind == LINE or kind == CABLE or thick < np.inf:
        speed = way_of_gap(ws, lc, k, 1) / h
    rests[0] = _first_rest(left, right, h)
    depth, looks = 1, 0
    while depth > 0:
        right, rest = stack[depth - 1], rests[depth - 1]
        long = right[0] - left[0]
        beyond = ended if right[0] == 1.0 else sign * right[1] < -slack
        excluded, falls, dips = _excluded(lc, k, kind, left, right, long * h, sign, slack, speed, thick, rest)
        if not beyond and (excluded or (long <= SHORTEST and not dips) or looks > MOST_LOOKS):
            left[:] = right
            depth -= 1
            continue
        if (beyond and falls) or long <= SHORTEST or depth == DEPTH:
            bracket[0], bracket[1] = left[0], right[0]
            _deepen(ws, ms, lc, k, kind, row, h, sign, bracket)
            return True
        _coefficients(left, right, long * h, 1.0, half)
        middle = stack[depth]
        _place(ws, ms, lc, k, kind, row, h, left[0] + 0.5 * long, middle)
        looks += 1
        # at the middle, of the polynomial and its slope
        value = (half[0] + half[6] + 6.0 * (half[1] + half[5]) + 15.0 * (half[2] + half[4]) + 20.0 * half[3]) / 64.0
        slope = 6.0 * (half[6] - half[0] + 4.0 * (half[5] - half[1]) + 5.0 * (half[4] - half[2])) / 32.0
        off = 0.25 * (abs(middle[1] - value) + 0.1 * abs(long * h * middle[2] - slope))
        rests[depth - 1], rests[depth] = off, off
        depth += 1
    return False


@internal
def _deepen(ws: Any, ms: Any, lc: Any, k: int, kind: int, row: int, h: float, sign: float, bracket: Any) -> None:
    """bracket[2] = the place beyond the root where the gap turns again, or the end of the step."""
    view, low = np.empty(VIEW), bracket[1]
    reach = max(bracket[1] - bracket[0], SHORTEST)
    bracket[2] = 1.0
    if low >= 1.0:
        return
    high = low
    while high < 1.0:
        high = min(high + reach, 1.0)
        reach *= 2.0
        look(ws, ms, lc, k, row, h, high, view)
        if sign * view[1] >= 0.0:
            break
        low = high
    if low >= 1.0:
        return
    for _ in range(40):
        middle = 0.5 * (low + high)
        look(ws, ms, lc, k, row, h, middle, view)
        if sign * view[1] < 0.0:
            low = middle
        else:
            high = middle
    bracket[2] = 0.5 * (low + high)
