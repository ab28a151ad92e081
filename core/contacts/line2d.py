"""Contact of a disk with a deformable line: a polyline through nodes on different bodies, with rounded vertices.

Points between two nodes are interpolated linearly, but for a part `rounding` of each half segment beside a vertex,
where the parabola that touches both segments takes their place. So the line has a tangent everywhere, and a disk has
one nearest point on it, on the hollow side too as long as its radius is below the line's radius of curvature there,
about rounding * (length of a segment)/(angle of the vertex). Gap and normal go on from piece to piece.

Every piece is an element with the coordinates of three nodes and of the disk; the one with the nearest point acts.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import TANGENT, line_of
from ..compiled.views import imat, mat, vec
from ..elements.geometry2d import along
from .bristle2d import act_bristles
from .curve2d import add_direction, arm_derivatives, foot_derivatives, length_derivatives, nearest_on_parabola
from .geometry_kinds import LINE, are
from .normal2d import act
from .sliding2d import act_sliding

PIECE_NODES = 3
PIECE_WIDTH = 3 * PIECE_NODES + 3
PAIRS = PIECE_WIDTH * (PIECE_WIDTH + 1) // 2

# columns of the table of parameters; 7 to 15 are those of the laws
CURVE_RADII, CURVE_RADIUS = 0, 1
CURVE_POINTS = 16  # of the nodes and of the disk in their bodies, (PIECE_NODES + 1, 2)
MIXTURE = CURVE_POINTS + 2 * (
    PIECE_NODES + 1
)  # control points of the parabola as weighted sums of nodes, (3, PIECE_NODES)

# columns of `extra` after those that every contact has: the number of the piece, -1 for all pieces of a closed line,
# whose foot no end holds; and how many there are
PIECE, PIECES = 6, 7


@internal
def _place(q: Any, coord: Any, par: Any, points: Any, directions: Any, bends: Any) -> None:
    """Nodes and centre (PIECE_NODES + 1, 2), and how they move with the coordinates."""
    for k in range(PIECE_NODES + 1):
        ux, uy, theta = par[CURVE_POINTS + 2 * k], par[CURVE_POINTS + 2 * k + 1], q[coord[3 * k + 2]]
        c, s = math.cos(theta), math.sin(theta)
        x, y = c * ux - s * uy, s * ux + c * uy
        points[k, 0], points[k, 1] = q[coord[3 * k]] + x, q[coord[3 * k + 1]] + y
        directions[3 * k, 0], directions[3 * k, 1] = 1.0, 0.0
        directions[3 * k + 1, 0], directions[3 * k + 1, 1] = 0.0, 1.0
        directions[3 * k + 2, 0], directions[3 * k + 2, 1] = -y, x
        bends[3 * k : 3 * k + 2] = 0.0
        bends[3 * k + 2, 0], bends[3 * k + 2, 1] = -x, -y


@internal
def _controls(par: Any, points: Any, control: Any) -> None:
    """Control points (3, 2) of a piece."""
    for j in range(3):
        for c in range(2):
            control[j, c] = 0.0
            for k in range(PIECE_NODES):
                control[j, c] += par[MIXTURE + PIECE_NODES * j + k] * points[k, c]


@internal
def _weigh(par: Any, t: float, weights: Any) -> None:
    """Weights (3, PIECE_WIDTH) of the nodes in p, p' and p''; the disk's centre counts as -1, 0, 0."""
    for k in range(PIECE_NODES):
        m0, m1, m2 = par[MIXTURE + k], par[MIXTURE + PIECE_NODES + k], par[MIXTURE + 2 * PIECE_NODES + k]
        second = 2.0 * (m0 - 2.0 * m1 + m2)
        slope = 2.0 * (m1 - m0) + second * t
        for c in range(3):
            weights[0, 3 * k + c] = m0 + 2.0 * (m1 - m0) * t + 0.5 * second * t * t
            weights[1, 3 * k + c] = slope
            weights[2, 3 * k + c] = second
    for c in range(3 * PIECE_NODES, PIECE_WIDTH):
        weights[0, c], weights[1, c], weights[2, c] = -1.0, 0.0, 0.0


@internal
def _find_piece(b: Any, first: int, points: Any, directions: Any, bends: Any, control: Any) -> Any:
    """(piece, t) of the nearest point of the line whose pieces begin with element `first`."""
    par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
    best, t_best, least = first, 0.0, np.inf
    for e in range(first, first + imat(b.extra, b.count, b.nextra)[first, PIECES]):
        _place(q, coord[e], par[e], points, directions, bends)
        _controls(par[e], points, control)
        # all of the piece is within this distance of its middle control point
        reach = max(
            math.hypot(control[0, 0] - control[1, 0], control[0, 1] - control[1, 1]),
            math.hypot(control[2, 0] - control[1, 0], control[2, 1] - control[1, 1]),
        )
        if math.hypot(
            points[PIECE_NODES, 0] - control[1, 0], points[PIECE_NODES, 1] - control[1, 1]
        ) - reach > math.sqrt(least):
            continue
        t, square = nearest_on_parabola(control, points[PIECE_NODES, 0], points[PIECE_NODES, 1])
        if square < least:
            best, t_best, least = e, t, square
    other = _beyond_joint(b, first, best, t_best, points, directions, bends, control)
    if other >= 0:
        _place(q, coord[other], par[other], points, directions, bends)
        _controls(par[other], points, control)
        t_best, _ = nearest_on_parabola(control, points[PIECE_NODES, 0], points[PIECE_NODES, 1])
        best = other
    return best, t_best


@internal
def _beyond_joint(b: Any, first: int, e: int, t: float, points: Any, directions: Any, bends: Any, control: Any) -> int:
    """The neighbour of piece `e` on which the foot lies if that ends before it is reached; else -1.

    Within sqrt(rounding) of a joint both pieces are as near as the other, and their curvatures are not the same: the
    slope of the distance, which is not zero where a piece ends too early, tells them apart down to rounding.
    """
    if 0.0 < t < 1.0:
        return -1
    par, q = mat(b.par, b.count, b.npar)[e], vec(b.q, b.n_extended)
    extra = imat(b.extra, b.count, b.nextra)[e]
    pieces, closed = extra[PIECES], extra[PIECE] < 0
    _place(q, imat(b.coord, b.count, b.ncoord)[e], par, points, directions, bends)
    _controls(par, points, control)
    here, k = 0 if t <= 0.0 else 2, e - first
    along_x = (control[1, 0] - control[0, 0]) if here == 0 else (control[2, 0] - control[1, 0])
    along_y = (control[1, 1] - control[0, 1]) if here == 0 else (control[2, 1] - control[1, 1])
    on = (points[PIECE_NODES, 0] - control[here, 0]) * along_x + (points[PIECE_NODES, 1] - control[here, 1]) * along_y
    if here == 0 and on < 0.0 and (closed or k > 0):
        return first + (k - 1) % pieces
    if here == 2 and on > 0.0 and (closed or k < pieces - 1):
        return first + (k + 1) % pieces
    return -1


@internal
def _slopes(control: Any, t: float, slopes: Any) -> None:
    """p', p'' and p''' (3, 2)."""
    for c in range(2):
        second = 2.0 * (control[0, c] - 2.0 * control[1, c] + control[2, c])
        slopes[0, c] = 2.0 * (control[1, c] - control[0, c]) + second * t
        slopes[1, c], slopes[2, c] = second, 0.0


@internal
def _foot(b: Any, first: int, points: Any, directions: Any, bends: Any, control: Any, weights: Any, slopes: Any) -> Any:
    """(piece, t, does the foot move, e_x, e_y) of the line whose pieces begin with element `first`; fills the rest."""
    piece, t = _find_piece(b, first, points, directions, bends, control)
    par = mat(b.par, b.count, b.npar)[piece]
    extra = imat(b.extra, b.count, b.nextra)[piece]
    _place(vec(b.q, b.n_extended), imat(b.coord, b.count, b.ncoord)[piece], par, points, directions, bends)
    _controls(par, points, control)
    _weigh(par, t, weights)
    _slopes(control, t, slopes)
    ex, ey = points[PIECE_NODES, 0], points[PIECE_NODES, 1]
    for j in range(3):
        share = (1.0 - t) ** 2 if j == 0 else (2.0 * t * (1.0 - t) if j == 1 else t * t)
        ex -= share * control[j, 0]
        ey -= share * control[j, 1]
    beyond = ex * slopes[0, 0] + ey * slopes[0, 1]
    before = extra[PIECE] == 0 and t <= 0.0 and beyond < 0.0
    behind = extra[PIECE] == extra[PIECES] - 1 and t >= 1.0 and beyond > 0.0
    return piece, t, not (before or behind), ex, ey


@internal
def _stretch(weights: Any, directions: Any, slopes: Any, side: float, offset: float, by_node: Any) -> Any:
    """How fast the surface passes the foot as xi grows: a = side |p'| - offset kappa, kappa = p' x p''/|p'|^2, and
    its derivative by xi; `by_node` (W,) gets those by the coordinates at fixed xi."""
    x1, y1, x2, y2, x3, y3 = slopes[0, 0], slopes[0, 1], slopes[1, 0], slopes[1, 1], slopes[2, 0], slopes[2, 1]
    square = x1 * x1 + y1 * y1
    speed, growth, turning = math.sqrt(square), x1 * x2 + y1 * y2, (x1 * y2 - y1 * x2) / square
    for i in range(len(by_node)):
        dx, dy = directions[i, 0], directions[i, 1]
        on_1 = weights[1, i] * (x1 * dx + y1 * dy)
        across = weights[1, i] * (dx * y2 - dy * x2) + weights[2, i] * (x1 * dy - y1 * dx)
        by_node[i] = side * on_1 / speed - offset * (across - 2.0 * turning * on_1) / square
    bending = (x1 * y3 - y1 * x3 - 2.0 * turning * growth) / square
    return side * speed - offset * turning, side * growth / speed - offset * bending


@internal
def _add_curl(b: Any, e: int, force: float, by_rate: float, gradient: Any, xi: Any, by_node: Any) -> None:
    """Tangent of a friction force along `gradient`, whose derivatives lack the skew part (xi a^T - a xi^T)/2."""
    n = b.ncoord
    values, c_q = vec(b.values, b.n_values), vec(b.coef, 2)[0]
    slot = imat(b.slot_s + 8 * line_of(b, e) * n * n, n, n)
    _add_turn(b, e, gradient, by_rate, xi, by_node)
    for i in range(len(xi)):
        for j in range(len(xi)):
            values[slot[i, j]] -= c_q * force * 0.5 * (xi[i] * by_node[j] - by_node[i] * xi[j])


@internal
def _add_turn(b: Any, e: int, left: Any, factor: float, xi: Any, by_node: Any) -> None:
    """What the skew part does to the sliding velocity: rows `left` of the tangent, (ncoord,) or fewer."""
    n = b.ncoord
    coord, v = imat(b.coord, b.count, n)[e], vec(b.v, b.n_extended)
    values, c_q = vec(b.values, b.n_values), vec(b.coef, 2)[0]
    slot = imat(b.slot_s + 8 * line_of(b, e) * n * n, n, n)
    moved, stretched = 0.5 * along(xi, v, coord), 0.5 * along(by_node, v, coord)
    for j in range(len(xi)):
        turn = c_q * factor * (moved * by_node[j] - stretched * xi[j])
        for i in range(len(left)):
            values[slot[i, j]] -= turn * left[i]


@internal
def disk_on_line_kernel(job: int, t: float, b: Any) -> None:
    points, directions, bends = np.empty((PIECE_NODES + 1, 2)), np.empty((PIECE_WIDTH, 2)), np.empty((PIECE_WIDTH, 2))
    control, weights, slopes = np.empty((3, 2)), np.empty((3, PIECE_WIDTH)), np.empty((3, 2))
    first, second = np.empty((PIECE_WIDTH, 2)), np.empty((PAIRS, 2))
    xi, xi_hessian, gradient, hessian = np.empty(PIECE_WIDTH), np.empty(PAIRS), np.empty(PIECE_WIDTH), np.empty(PAIRS)
    e = 0
    while e < b.count:
        piece, _, moves, ex, ey = _foot(b, e, points, directions, bends, control, weights, slopes)
        foot_derivatives(weights, directions, bends, ex, ey, slopes, moves, xi, xi_hessian)
        arm_derivatives(weights, directions, bends, slopes, xi, xi_hessian, first, second)
        d = length_derivatives(ex, ey, first, second, gradient, hessian)
        act(b, job, piece, d - mat(b.par, b.count, b.npar)[piece, CURVE_RADII], gradient, hessian)
        e += imat(b.extra, b.count, b.nextra)[e, PIECES]


@internal
def _slide_on_line(b: Any, first: int) -> Any:
    """(piece, does the foot move, gap, gradient, Hessian, w, derivatives of w, grad xi, a's by the nodes) of the line
    whose pieces begin with element `first`.

    w . v is the velocity of the disk's surface on the line's; w is no gradient where the line can stretch:
    w = a grad xi - r grad phi + r grad theta_b, phi the direction of the normal; on a held end
    -R grad phi + (R - r) grad(angle of the tangent) + r grad theta_b. The symmetric part of its derivatives is given.
    """
    points, directions, bends = np.empty((PIECE_NODES + 1, 2)), np.empty((PIECE_WIDTH, 2)), np.empty((PIECE_WIDTH, 2))
    control, weights, slopes = np.empty((3, 2)), np.empty((3, PIECE_WIDTH)), np.empty((3, 2))
    one, two, turn, by_node = (
        np.empty((PIECE_WIDTH, 2)),
        np.empty((PAIRS, 2)),
        np.empty(PIECE_WIDTH),
        np.zeros(PIECE_WIDTH),
    )
    xi, xi_hessian, g_gradient, g_hessian = (
        np.empty(PIECE_WIDTH),
        np.empty(PAIRS),
        np.empty(PIECE_WIDTH),
        np.empty(PAIRS),
    )
    gradient, hessian = np.zeros(PIECE_WIDTH), np.zeros(PAIRS)
    piece, _, moves, ex, ey = _foot(b, first, points, directions, bends, control, weights, slopes)
    par = mat(b.par, b.count, b.npar)[piece]
    both, radius = par[CURVE_RADII], par[CURVE_RADIUS]
    foot_derivatives(weights, directions, bends, ex, ey, slopes, moves, xi, xi_hessian)
    arm_derivatives(weights, directions, bends, slopes, xi, xi_hessian, one, two)
    d = length_derivatives(ex, ey, one, two, g_gradient, g_hessian)
    tx, ty = slopes[0, 0], slopes[0, 1]
    if moves:
        side = 1.0 if tx * ey - ty * ex >= 0.0 else -1.0
        a, growth = _stretch(weights, directions, slopes, side, both - radius, by_node)
        k = 0
        for i in range(PIECE_WIDTH):
            gradient[i] = a * xi[i]
            for j in range(i, PIECE_WIDTH):
                mixed = 0.5 * (xi[i] * by_node[j] + xi[j] * by_node[i])
                hessian[k] = a * xi_hessian[k] + growth * xi[i] * xi[j] + mixed
                k += 1
        add_direction(ex, ey, one, two, -radius, gradient, hessian, turn)
    else:
        add_direction(ex, ey, one, two, -both, gradient, hessian, turn)
        k = 0
        for i in range(PIECE_WIDTH):
            for c in range(2):
                one[i, c] = weights[1, i] * directions[i, c]
                two[k : k + PIECE_WIDTH - i, c] = 0.0
                two[k, c] = weights[1, i] * bends[i, c]
            k += PIECE_WIDTH - i
        add_direction(tx, ty, one, two, both - radius, gradient, hessian, turn)
    gradient[PIECE_WIDTH - 1] += radius
    return piece, moves, d - both, g_gradient, g_hessian, gradient, hessian, xi, by_node


@internal
def sliding_disk_on_line_kernel(job: int, t: float, b: Any) -> None:
    e = 0
    while e < b.count:
        piece, moves, g, g_gradient, g_hessian, gradient, hessian, xi, by_node = _slide_on_line(b, e)
        # without a sliding distance: none could be held
        force, by_rate = act_sliding(b, job, t, piece, g, g_gradient, g_hessian, 0.0, gradient, hessian, 0.0)
        if job == TANGENT and moves:
            _add_curl(b, piece, force, by_rate, gradient, xi, by_node)
        e += imat(b.extra, b.count, b.nextra)[e, PIECES]


@internal
def bristle_disk_on_line_kernel(job: int, t: float, b: Any) -> None:
    bristle = np.zeros(PIECE_WIDTH + 1)
    bristle[PIECE_WIDTH] = 1.0
    e = 0
    while e < b.count:
        piece, moves, g, g_gradient, g_hessian, gradient, hessian, xi, by_node = _slide_on_line(b, e)
        force, by_rate, z_by_rate = act_bristles(b, job, t, piece, g, g_gradient, g_hessian, gradient, hessian)
        if job == TANGENT and moves:
            _add_curl(b, piece, force, by_rate, gradient, xi, by_node)
            _add_turn(b, piece, bristle, z_by_rate, xi, by_node)
        e += imat(b.extra, b.count, b.nextra)[e, PIECES]


are(LINE, bristle_disk_on_line_kernel, disk_on_line_kernel, sliding_disk_on_line_kernel)
