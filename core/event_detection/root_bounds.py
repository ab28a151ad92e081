"""Has a gap changed its sign within a step, however large the step? Decided by bounds, not by samples.

Of two rigid shapes a bound says whether the gap can reach zero between two places in the step (`separation.py`); where
it can, the part between them is halved. Parts are looked at in their order, so that the first root is found. Gaps that
are linear in the coordinates are polynomials themselves, whose coefficients in the basis of Bernstein bound them.

Of deformable lines, of edges, of parts of surfaces and of kernels and functions that a user has written, g is looked at
as the polynomial p of fifth degree through (g, g', g'') at both ends of a part. The rest is
g - p = g^(6)(x)/720 s^3 (s - 1)^3, s in [0, 1]. In the basis of Bernstein's polynomials of degree 6, s^3 (1 - s)^3 is
B_3/20: a bound of g^(6) lowers the coefficient c_3 of p, and if no coefficient is negative, neither is g. The bound is
an estimate, from how far the polynomial of the whole was off at the middle: the rest shrinks with the sixth power of a
part's length. Lines, edges and parts of surfaces are divided at least until nothing moves by more than a share of their
thickness. The same estimate is for shapes that touch all the while, which no bound tells from a root.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, ivec, mat, vec
from ..contacts.cable_line import LINE_LENGTH as CABLE_LENGTH
from ..contacts.cable_line import LINE_POINT as CABLE_POINT
from ..contacts.cable_line import LINE_RADII as CABLE_BOTH
from ..contacts.cable_line import LINE_VECTORS
from ..contacts.gap_motion_bound3d import way_of_cable, way_of_sphere
from ..contacts.geometry_kinds import CABLE, CABLE_IN_SPACE, EQUATIONS, JOINT, LINE, LINEAR, OWN, SPHERE, STOP, TURN
from ..contacts.line2d import CURVE_POINTS, PIECE_NODES
from ..contacts.line2d import CURVE_RADII as LINE_BOTH
from ..contacts.mesh_nearest3d import OPEN_SURFACE
from ..contacts.moving_point3d import ON_MESH
from ..contacts.normal3d import GAP_KIND as SHAPES
from ..contacts.normal3d import RADIUS_A, RADIUS_B
from .contact_evaluation import NEAR_KIND, NEAR_SIZE, VIEW, look, probe_of, state_of_pair
from .motion_bounds import PLANAR_BODY, control_points
from .separation import NODE, NODE_MOTION, arms, stays_apart, width_of

SHORTEST_PART = 2.0**-34
"""Of the step: what a gap does in a shorter part cannot be told from a touch."""
MOST_LOOKS = 20_000
"""Parts of one step, for the gap of one contact."""
DEPTH = 64
THICK = 0.25
"""Of the thickness of lines, edges and parts of surfaces: how far they may go in a part that is looked at as a
polynomial."""
BENDS = 4.0
"""Of what a gap falls in a part: if it can bend by more there, it may rise and fall again."""


@internal
def way_of_gap(workspace: Any, loop: Any, k: int, fastest: int) -> float:
    """An upper bound of how far the gap of contact k goes within the step, or (fastest = 1) of its greatest rate times
    the step; infinite where none is known."""
    kind = imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KIND]
    if kind == EQUATIONS or kind == OWN:
        return np.inf
    batch, way = probe_of(loop, k), mat(loop.travel, 2, workspace.n_ext)[fastest]
    par, coord = mat(batch.par, batch.count, batch.npar), imat(batch.coord, batch.count, batch.ncoord)
    total = 0.0
    if kind == JOINT:
        return 0.0
    if kind == LINEAR:
        for i in range(6):
            total += abs(par[0, 16 + i]) * way[coord[0, i]]
        return total
    if kind == TURN:
        return way[coord[0, 2]] + way[coord[0, 5]]
    if width_of(kind) == PLANAR_BODY:
        first, second, point, _ = arms(kind, par[0])
        c = coord[0]
        total = way[c[0]] + way[c[1]] + way[c[3]] + way[c[4]] + second * way[c[5]]
        if not point and way[c[2]] > 0.0:
            q = vec(workspace.q, workspace.n_ext)
            reach = math.hypot(q[c[3]] - q[c[0]], q[c[4]] - q[c[1]]) + second
            first = reach + way[c[0]] + way[c[1]] + way[c[3]] + way[c[4]]
        return total + (first * way[c[2]] if way[c[2]] > 0.0 else 0.0)
    if kind == SPHERE or kind == STOP:
        return way_of_sphere(vec(workspace.q, workspace.n_ext), coord[0], par[0], way)
    if kind == CABLE_IN_SPACE:
        return way_of_cable(vec(workspace.q, workspace.n_ext), coord, par, way)
    largest = 0.0
    if kind == LINE:
        for e in range(batch.count):
            for node in range(PIECE_NODES):
                c, u = coord[e, 3 * node : 3 * node + 3], par[e, CURVE_POINTS + 2 * node : CURVE_POINTS + 2 * node + 2]
                largest = max(largest, way[c[0]] + way[c[1]] + math.hypot(u[0], u[1]) * way[c[2]])
        c, u = coord[0, 3 * PIECE_NODES :], par[0, CURVE_POINTS + 2 * PIECE_NODES :]
        return largest + way[c[0]] + way[c[1]] + math.hypot(u[0], u[1]) * way[c[2]]
    for e in range(batch.count):
        for end in range(2):
            c = coord[e, 4 * end : 4 * end + 4]
            # the inner control point of the cubic
            third = par[e, CABLE_LENGTH] / 3.0
            largest = max(largest, way[c[0]] + way[c[1]] + third * (way[c[2]] + way[c[3]]))
    c, u = coord[0, 2 * LINE_VECTORS :], par[0, CABLE_POINT:]
    return largest + way[c[0]] + way[c[1]] + math.hypot(u[0], u[1]) * way[c[2]]


@internal
def _thickness(loop: Any, k: int, kind: int) -> float:
    """Up to which way within a part the rest of the polynomial is trusted, m."""
    if kind != LINE and kind != CABLE and kind != SPHERE and kind != CABLE_IN_SPACE:
        return np.inf
    batch = probe_of(loop, k)
    par = mat(batch.par, batch.count, batch.npar)[0]
    if kind == LINE or kind == CABLE:
        both = par[LINE_BOTH if kind == LINE else CABLE_BOTH]
    else:
        both = par[RADIUS_A] + par[RADIUS_B]
    if kind == SPHERE and (
        int(par[SHAPES]) != ON_MESH or imat(batch.extra, batch.count, batch.nextra)[0, OPEN_SURFACE] == 0
    ):
        return np.inf
    # edges that cross are apart again behind: the dip is as deep as they are round
    return THICK * both if both > 0.0 else np.inf


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
    workspace: Any, method: Any, loop: Any, k: int, kind: int, row: int, h: float, left: Any, right: Any, sign: float,
    slack: float,
    speed: float, thick: float, rest: float,
) -> Any:  # fmt: skip
    """(is there no root between two places, does the gap only fall there, is its polynomial somewhere negative)."""
    c, tau = np.empty(7), (right[0] - left[0]) * h
    g0, g1 = sign * left[1], sign * right[1]
    way, known, bends = speed * tau, False, 0.0
    if g0 + g1 > way:
        return True, False, False
    if width_of(kind) > 0:
        apart, known, bends = stays_apart(workspace, method, loop, k, kind, row, h, left, right, sign, slack)
        if apart:
            return True, False, False
    _coefficients(left, right, tau, sign, c)
    lowest = min(c[0], c[1], c[2], c[3], c[4], c[5], c[6])
    lowered = 0.0 if kind == LINEAR or kind == TURN or kind == JOINT else 3.2 * rest
    if way > thick:
        return False, False, lowest < -slack
    touching = g0 <= slack and g1 <= slack
    if (touching or not known) and lowest >= -slack and c[3] - lowered >= -slack:
        return True, False, False
    falls = bends <= BENDS * (g0 - g1)
    for i in range(6):
        falls = falls and c[i + 1] < c[i]
    falls = falls and c[3] - lowered < c[2] and lowered < 0.1 * (c[0] - c[6])
    return False, falls, lowest < -slack


@internal
def _place(workspace: Any, method: Any, loop: Any, k: int, kind: int, row: int, h: float, s: float, node: Any) -> None:
    """Look at a place between the ends of the step."""
    node[:] = 0.0
    node[0] = s
    look(workspace, method, loop, k, row, h, s, node[1 : 1 + VIEW])
    if width_of(kind) > 0:
        state_of_pair(workspace, method, loop, k, width_of(kind), h, s, node[NODE_MOTION:])


@internal
def first_root(
    workspace: Any,
    method: Any,
    loop: Any,
    k: int,
    h: float,
    sign: float,
    start: Any,
    ended: bool,
    slack: float,
    bracket: Any,
) -> bool:
    """True if `sign` times the gap of contact k goes from above zero to below within the step of size h.

    start : the gap with rate and acceleration at the newest row. ended : it counts as beyond zero at the step's end.
    slack : up to here a gap below zero is none, m. bracket (3,) gets, in parts of the step, the place before the first
    root, one beyond it, and the deepest one after it.
    """
    kind = imat(loop.near, workspace.n_contacts, NEAR_SIZE)[k, NEAR_KIND]
    row = ivec(workspace.contact_rows, workspace.n_contacts)[k]
    stack, rests, left, half = np.zeros((DEPTH, NODE)), np.empty(DEPTH), np.zeros(NODE), np.empty(7)
    right = stack[0]
    left[0], right[0] = 0.0, 1.0
    left[1], left[2], left[3] = start[0], start[1], start[2]
    right[1], right[2], right[3] = (
        vec(workspace.phi, workspace.m_ext)[row],
        vec(workspace.phid, workspace.m_ext)[row],
        vec(workspace.phidd, workspace.m_ext)[row],
    )
    if width_of(kind) > 0:
        state_of_pair(workspace, method, loop, k, width_of(kind), h, 0.0, left[NODE_MOTION:])
        state_of_pair(workspace, method, loop, k, width_of(kind), h, 1.0, right[NODE_MOTION:])
    # per second, for the whole step: of lines, whose nodes are many, and of thin edges
    speed, thick = np.inf, _thickness(loop, k, kind)
    if kind == LINE or kind == CABLE or kind == CABLE_IN_SPACE or thick < np.inf:
        speed = way_of_gap(workspace, loop, k, 1) / h
    rests[0] = _first_rest(left, right, h)
    # a place where it is zero but for the slack is none before the root: a low bounce would end below zero
    depth, looks, above = 1, 0, 0.0
    while depth > 0:
        right, rest = stack[depth - 1], rests[depth - 1]
        long = right[0] - left[0]
        beyond = ended if right[0] == 1.0 else sign * right[1] < -slack
        excluded, falls, dips = _excluded(
            workspace, method, loop, k, kind, row, h, left, right, sign, slack, speed, thick, rest
        )  # fmt: skip
        if not beyond and (excluded or (long <= SHORTEST_PART and not dips) or looks > MOST_LOOKS):
            left[:] = right
            above = left[0] if sign * left[1] > 0.0 else above
            depth -= 1
            continue
        if (beyond and falls) or long <= SHORTEST_PART or depth == DEPTH:
            bracket[0], bracket[1] = above, right[0]
            _deepen(workspace, method, loop, k, kind, row, h, sign, bracket)
            return True
        _coefficients(left, right, long * h, 1.0, half)
        middle = stack[depth]
        _place(workspace, method, loop, k, kind, row, h, left[0] + 0.5 * long, middle)
        looks += 1
        # at the middle, of the polynomial and its slope
        value = (half[0] + half[6] + 6.0 * (half[1] + half[5]) + 15.0 * (half[2] + half[4]) + 20.0 * half[3]) / 64.0
        slope = 6.0 * (half[6] - half[0] + 4.0 * (half[5] - half[1]) + 5.0 * (half[4] - half[2])) / 32.0
        off = 0.25 * (abs(middle[1] - value) + 0.1 * abs(long * h * middle[2] - slope))
        rests[depth - 1], rests[depth] = off, off
        depth += 1
    return False


@internal
def _deepen(
    workspace: Any, method: Any, loop: Any, k: int, kind: int, row: int, h: float, sign: float, bracket: Any
) -> None:
    """bracket[2] = the place beyond the root where the gap turns again, or the end of the step."""
    view, low = np.empty(VIEW), bracket[1]
    reach = max(bracket[1] - bracket[0], SHORTEST_PART)
    bracket[2] = 1.0
    if low >= 1.0:
        return
    high = low
    while high < 1.0:
        high = min(high + reach, 1.0)
        reach *= 2.0
        look(workspace, method, loop, k, row, h, high, view)
        if sign * view[1] >= 0.0:
            break
        low = high
    if low >= 1.0:
        return
    for _ in range(40):
        middle = 0.5 * (low + high)
        look(workspace, method, loop, k, row, h, middle, view)
        if sign * view[1] < 0.0:
            low = middle
        else:
            high = middle
    bracket[2] = 0.5 * (low + high)
