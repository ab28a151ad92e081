"""How far the gap of two rigid shapes can fall within a part of a step: the bound by which no contact is passed by.

Let y be the place of a point of the second shape as the first one sees it. A gap G(y) that is the distance of y from a
convex set, less radii, lies over each of its tangents: G(y) >= G(y_0) + n_0 . (y - y_0), n_0 its gradient (Rockafellar
1970, Convex Analysis, theorem 25.1). So along the motion, where n_0 turns with the first shape,
    g(t) >= g_0 + n_0 . (x(t) - x(t_0)) + r_0' (t - t_0) - C (t - t_0)^2/2,
x the place of the second body against the first, r_0' the rest of g_0', which comes from turning, and C a bound of what
turning makes of n_0 . y''. This is conservative advancement along the separating direction (Mirtich 1996), whole
polynomials at a time: motion along a surface costs nothing. The distance from any set lies under
G_0 + n_0 . (y - y_0) + |y - y_0|^2/(2 d_0), d_0 the distance itself: of points in rings, at the end of ropes, and where
shapes that overlap may come apart, C has |y'|^2/d_0 more.

A second shape that is no point, but turns against the first, may touch with a point that was not the nearest: the bound
falls by the way of that, no more than 2 e times the relative turning, e how far points of contact are from its marker.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import imat, mat
from ..contacts.geometry_kinds import DISKS, OUTLINE, PLANE, RING, ROPE, SEGMENT, SPHERE, STOP
from ..contacts.mesh_nearest3d import OPEN_SURFACE
from ..contacts.moving_point3d import HOLLOW, ON_MESH, ON_RING, on_plane
from ..contacts.normal3d import EXTENT_A, EXTENT_B, PAIR_AT, RADIUS_A, RADIUS_B, TILT
from ..contacts.normal3d import GAP_KIND as SHAPES
from ..contacts.parallel_axes3d import BACK, STEEPEST
from ..contacts.scalar_contact2d import FIRST_PARAMETER
from ..contacts.stop3d import STOP_LIMIT, STOP_SIGN
from ..elements.measure3d import ANGLE, DISTANCE, POINT_A, POINT_B
from ..methods.history import history_time
from .contact_evaluation import look, probe_of, rate_alone
from .motion_bounds import CONTROL_POINTS, PLANAR_BODY, SPATIAL_BODY, moves, turns

BOTH, LENGTH = 5, 16
"""Columns of the parameters: sum of the radii of disks and segments, and a segment's length."""
SECOND_MARKER, NUMBERS = FIRST_PARAMETER + 5, FIRST_PARAMETER + 10
"""Columns of the parameters of contacts from formulas: of the second marker, and of the first number."""
NODE_PLACE, NODE_MOTION = 0, 4
"""Columns of a node: its place in the step, followed by the gap with its two derivatives; and the bodies' motion."""
NORMAL = NODE_MOTION + 6 * SPATIAL_BODY
KNOWN = NORMAL + 3
NODE = KNOWN + 1
"""And the gap's gradient by the place of the second body, with 1 where that has been asked for."""


@internal
def width_of(kind: int) -> int:
    """Coordinates of each body, 0 for kinds that are no two rigid shapes."""
    if kind == SPHERE or kind == STOP:
        return SPATIAL_BODY
    rigid = kind == DISKS or kind == PLANE or kind == SEGMENT or kind == OUTLINE
    return PLANAR_BODY if rigid or kind == RING or kind == ROPE else 0


@internal
def arms(kind: int, par: Any) -> Any:
    """(how far points that touch may be from the first body's place, infinite without end, and from the second's, is
    the first one a point, how far they may be from the second's marker), m."""
    if kind == DISKS or kind == PLANE or kind == SEGMENT:
        arm = math.hypot(par[0], par[1])
        arm = arm if kind == DISKS else (arm + par[LENGTH] if kind == SEGMENT else math.inf)
        return arm, math.hypot(par[2], par[3]), kind == DISKS, 0.0
    if kind == OUTLINE or kind == RING or kind == ROPE:
        arm = math.inf if kind == OUTLINE else math.hypot(par[FIRST_PARAMETER], par[FIRST_PARAMETER + 1])
        return arm, math.hypot(par[SECOND_MARKER], par[SECOND_MARKER + 1]), kind != OUTLINE, 0.0
    at, shape = PAIR_AT + POINT_A, int(par[SHAPES])
    a = math.sqrt(par[at] ** 2 + par[at + 1] ** 2 + par[at + 2] ** 2) + par[EXTENT_A]
    at = PAIR_AT + POINT_B
    b = math.sqrt(par[at] ** 2 + par[at + 1] ** 2 + par[at + 2] ** 2) + par[EXTENT_B]
    if kind == STOP and shape == ANGLE:
        # rad: of a joint's axis, on which both bodies turn
        return 1.0, 1.0, True, 0.0
    return math.inf if on_plane(shape) else a, b, shape == DISTANCE or shape == HOLLOW, par[EXTENT_B]


@internal
def curvature(kind: int, batch: Any, g: float, sign: float) -> float:
    """1/m: by half of it, times |y - y_0|^2, `sign` times the gap can be under its tangent where the gap is g; infinite
    where nothing is known."""
    par, outwards, distance = mat(batch.par, batch.count, batch.npar)[0], sign > 0.0, math.inf
    if kind == DISKS or kind == SEGMENT:
        distance = g + par[BOTH]
    elif kind == OUTLINE:
        distance = 0.0
    elif kind == RING:
        outwards, distance = not outwards, par[NUMBERS] - par[NUMBERS + 1] - g
    elif kind == ROPE:
        outwards, distance = not outwards, par[NUMBERS] - g
    elif kind == STOP and int(par[SHAPES]) == DISTANCE:
        outwards, distance = outwards == (par[STOP_SIGN] < 0.0), par[STOP_LIMIT] - par[STOP_SIGN] * g
    elif kind == SPHERE and not on_plane(int(par[SHAPES])):
        shape = int(par[SHAPES])
        distance = g + par[RADIUS_A] + par[RADIUS_B]
        if shape == HOLLOW:
            outwards, distance = not outwards, -distance
        elif outwards and shape == ON_RING:
            # towards its axis the distance from a circle bends the other way
            outwards, distance = False, par[EXTENT_A] - distance
        elif outwards and shape == ON_MESH and imat(batch.extra, batch.count, batch.nextra)[0, OPEN_SURFACE] != 0:
            # a part of a surface, or edges, are no convex set
            return math.inf
    if outwards or distance == math.inf:
        return 0.0
    if sign > 0.0:
        # from the middle of a ring, or from afar, only the way tells anything
        return 1.0 / max(distance, 1e-30)
    return 1.0 / distance if distance > 0.0 else math.inf


@internal
def _find_normal(
    workspace: Any, method: Any, loop: Any, k: int, kind: int, width: int, row: int, h: float, node: Any
) -> None:
    """The gradient of the gap at a node by the place of the second body, to NORMAL; of an
    angle none."""
    if node[KNOWN] != 0.0:
        return
    batch, s = probe_of(loop, k), node[NODE_PLACE]
    coord = imat(batch.coord, batch.count, batch.ncoord)[0]
    node[KNOWN] = 1.0
    node[NORMAL : NORMAL + 3] = 0.0
    if kind == STOP and int(mat(batch.par, batch.count, batch.npar)[0, SHAPES]) == ANGLE:
        return
    view = np.empty(3)
    look(workspace, method, loop, k, row, h, s, view)
    for i in range(2 if width == PLANAR_BODY else 3):
        at = coord[width + i]
        # what is fixed to the ground has no coordinates to move
        other = at >= workspace.n
        rate = rate_alone(workspace, loop, k, row, history_time(method, 0) + s * h, coord[i] if other else at)
        node[NORMAL + i] = -rate if other else rate


@internal
def stays_apart(
    workspace: Any,
    method: Any,
    loop: Any,
    k: int,
    kind: int,
    row: int,
    h: float,
    left: Any,
    right: Any,
    sign: float,
    slack: float,
) -> Any:
    """(is `sign` times the gap over -slack all the way between two nodes, is that known where it is so, how far it can
    bend there, m), of two rigid shapes."""
    width, batch, tau = width_of(kind), probe_of(loop, k), (right[NODE_PLACE] - left[NODE_PLACE]) * h
    par, place = mat(batch.par, batch.count, batch.npar)[0], np.empty((3, CONTROL_POINTS))
    arm_a, arm_b, point, extent = arms(kind, par)
    first, last = left[NODE_MOTION:], right[NODE_MOTION:]
    way, fast, bends, far = moves(first, last, width, tau, place)
    way_a, turn_a, bend_a = turns(first, last, width, tau, 0)
    way_b, turn_b, bend_b = turns(first, last, width, tau, 1)
    far += arm_b
    back = STEEPEST * BACK * (par[RADIUS_A] + par[RADIUS_B]) / par[TILT] if kind == SPHERE and par[TILT] > 0.0 else 0.0
    turning, angle = turn_a + turn_b, kind == STOP and int(par[SHAPES]) == ANGLE
    if angle:
        way, fast = 0.0, 0.0
    way += way_b * arm_b + way_a * min(arm_a, far) + back * (way_a + way_b)
    if sign * (left[1] + right[1]) > way:
        return True, True, 0.0
    speed, rest = fast + turn_b * arm_b, bend_b * arm_b
    if point:
        speed, rest = speed + turn_a * arm_a, rest + bend_a * arm_a + (turn_a * turn_b if angle else 0.0)
    else:
        # of n . x, n turned by no more than way_a, only what the first n makes of it is looked at itself
        rest += 2.0 * turn_a * speed + bend_a * far + min(way_a, 2.0) * bends
        speed += turn_a * far
    slide, known = 2.0 * (extent + back) * turning, True
    for end in range(2):
        node = left if end == 0 else right
        bent = curvature(kind, batch, node[1], sign)
        if bent == math.inf:
            known = False
            continue
        _find_normal(workspace, method, loop, k, kind, width, row, h, node)
        g, rate = sign * node[1], sign * tau * (node[2] if end == 0 else -node[2])
        n = node[NORMAL : NORMAL + 3]
        start, lowest, along = 0 if end == 0 else CONTROL_POINTS - 1, g, 0.0
        square = (rest + bent * speed * speed) / 20.0
        for i in range(1, CONTROL_POINTS):
            at = i if end == 0 else CONTROL_POINTS - 1 - i
            goes = 0.0
            for j in range(3):
                goes += sign * n[j] * (place[j, at] - place[j, start])
            if i == 1:
                # what of the rate does not come from the place alone
                along = 0.2 * (rate - slide) - goes
            lowest = min(lowest, g + goes + along * i - 0.5 * square * i * (i - 1))
        if lowest >= -slack:
            return True, True, rest
    return False, known, rest + slide
