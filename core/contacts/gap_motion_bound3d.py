"""How far the gap of two shapes in space can go within a step, from how far the coordinates go."""

import math
from typing import Any

from ..compiled.jit import inlined, internal
from ..elements.measure3d import ANGLE, POINT_A, POINT_B
from .cable_foot3d import CABLE_AT, FOOT_LENGTH, FOOT_VECTORS
from .moving_point3d import POINT_OF_CABLE, on_plane
from .normal3d import EXTENT_A, EXTENT_B, GAP_KIND, PAIR_AT, RADIUS_A, RADIUS_B, TILT
from .parallel_axes3d import BACK, STEEPEST

TURN_BOUND = 2.0 * 1.01
"""|d(A u)| <= 2 |u| |dp| for |p| = 1; the dense output between two rows leaves that by less than the rest."""


@inlined
def _length(x: Any, first: int) -> float:
    return math.sqrt(x[first] ** 2 + x[first + 1] ** 2 + x[first + 2] ** 2)


@inlined
def _at(way: Any, coord: Any, first: int, count: int) -> float:
    """Length of the ways of `count` coordinates from `first`."""
    total = 0.0
    for i in range(count):
        total += way[coord[first + i]] ** 2
    return math.sqrt(total)


@internal
def way_of_sphere(q: Any, coord: Any, par: Any, way: Any) -> float:
    """Upper bound, m (or m/s for rates in `way`; of an angle rad)."""
    arm_a, arm_b = _length(par, PAIR_AT + POINT_A) + par[EXTENT_A], _length(par, PAIR_AT + POINT_B) + par[EXTENT_B]
    moves_a, moves_b = _at(way, coord, 0, 3), _at(way, coord, 7, 3)
    turns_a, turns_b = TURN_BOUND * _at(way, coord, 3, 4), TURN_BOUND * _at(way, coord, 10, 4)
    if int(par[GAP_KIND]) == ANGLE:
        return turns_a + turns_b
    total = moves_a + moves_b + arm_b * turns_b
    if not on_plane(int(par[GAP_KIND])):
        if par[TILT] > 0.0:
            total += STEEPEST * BACK * (par[RADIUS_A] + par[RADIUS_B]) / par[TILT] * (turns_a + turns_b)
        return total + arm_a * turns_a
    if turns_a > 0.0:
        far = 0.0
        for i in range(3):
            far += (q[coord[7 + i]] - q[coord[i]]) ** 2
        total += turns_a * (math.sqrt(far) + moves_a + moves_b + arm_b)
    return total


@internal
def way_of_cable(q: Any, coord: Any, par: Any, way: Any) -> float:
    """The same of a cable in space and another shape; coord and par are those of all its elements."""
    arm = _length(par[0], PAIR_AT + POINT_A)
    turns, moves, largest = TURN_BOUND * _at(way, coord[0], 3, 4), _at(way, coord[0], 0, 3), 0.0
    if int(par[0, GAP_KIND]) == POINT_OF_CABLE and turns > 0.0:
        far = 0.0
        for k in range(0, FOOT_VECTORS, 2):
            apart = 0.0
            for i in range(3):
                apart += (q[coord[0, CABLE_AT + 3 * k + i]] - q[coord[0, i]]) ** 2
            far = max(far, math.sqrt(apart))
        arm = far + par[0, FOOT_LENGTH] + moves
    for e in range(len(coord)):
        for k in range(0, FOOT_VECTORS, 2):
            at = CABLE_AT + 3 * k
            # the inner control point of the cubic
            goes = _at(way, coord[e], at, 3) + par[e, FOOT_LENGTH] / 3.0 * _at(way, coord[e], at + 3, 3)
            largest = max(largest, goes)
    return moves + largest + turns * (arm + (largest if int(par[0, GAP_KIND]) == POINT_OF_CABLE else 0.0))
