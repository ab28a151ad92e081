"""Rows of a step of impulses against rolling and spinning: the angular velocity of one shape on the other.

Two across the normal, whose torques share a circle with the radius rho P_N, and one along it, within sigma P_N
(`laws/friction/turning.py`, without its transition); on a patch of friction radius r it shares a ball of radius mu P_N
with the tangents, which its arm of -r says. The torque of a row is its own unknown: what rests on another
shape is held against turning within the step, whichever way its load would turn it.
"""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..contacts.normal3d import PAIR_SIZE, pair_of
from ..contacts.turning3d import FRICTION_RADIUS, ROLLING, SPINNING, turning_gradient
from ..event_detection.contact_evaluation import probe_of
from ..model.rotation3d import cross, times

TURNING_ROWS = 3


@internal
def axes_of_contact(coord: Any, gradient: Any, n: int) -> Any:
    """Two axes across the normal, and it: what the gap's gradient is by the place of a body."""
    first = 7 if coord[7] < n else 0
    x, y, z = gradient[coord[first]], gradient[coord[first + 1]], gradient[coord[first + 2]]
    normal = times(1.0 / math.sqrt(x * x + y * y + z * z), (x, y, z))
    least = min(abs(normal[0]), abs(normal[1]), abs(normal[2]))
    e = (1.0, 0.0, 0.0) if abs(normal[0]) == least else (0.0, 1.0, 0.0) if abs(normal[1]) == least else (0.0, 0.0, 1.0)
    t = cross(normal, e)
    t = times(1.0 / math.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), t)
    return t, cross(normal, t), normal


@internal
def add_turning_rows(
    workspace: Any, loop: Any, k: int, i: int, count: int, turns: bool, arms: Any, gradients: Any, some: Any,
    marks: Any, width: int,
) -> int:  # fmt: skip
    """Gradients of the angular velocity of contact k, the i-th of `count` that touch, after its gap's and tangents' in
    gradients (rows of a contact, n), and rho and sigma or -r, m, to its places in arms (rows,); zeros where nothing
    resists. The coordinates to `some`, of which there are `width`: how many there are then."""
    batch = probe_of(loop, k)
    coord, par = ivec(batch.coord, PAIR_SIZE), vec(batch.par, FRICTION_RADIUS + 1)
    for block in range(TURNING_ROWS):
        arm = (par[ROLLING] if block < 2 else par[SPINNING] - par[FRICTION_RADIUS]) if turns else 0.0
        arms[(3 + block) * count + i] = arm
        if arm == 0.0:
            continue
        a, b, c = axes_of_contact(coord, gradients[0], workspace.n)
        axis = a if block == 0 else b if block == 1 else c
        turning_gradient(
            vec(workspace.q, workspace.n_ext), coord, pair_of(batch, 0), axis, workspace.n, gradients[3 + block]
        )
        for e in range(PAIR_SIZE):
            j = coord[e]
            if j < workspace.n and marks[j] != i:
                marks[j], some[width] = i, j
                width += 1
    return width
