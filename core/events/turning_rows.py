"""Rows of a step of impulses against rolling and spinning: the angular velocity of one shape on the other.

Two across the normal, whose torques share a circle with the radius rho P_N, and one along it, within sigma P_N
(`laws/friction/turning.py`, without its transition); on a patch of friction radius r it shares a ball of radius mu P_N
with the tangents, which its arm of -r says. The torque of a row is its own unknown: what rests on another
shape is held against turning within the step, whichever way its load would turn it.
"""

import math
from typing import Any

from ..assembly.redundant_reactions import solve_equations
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contacts.normal3d import PAIR_SIZE, pair_of
from ..contacts.turning3d import FRICTION_RADIUS, ROLLING, SPINNING, turning_gradient
from ..event_detection.contact_evaluation import probe_of
from ..model.rotation3d import cross, times
from .records import clear, scalars

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
def find_turning_rows(instant: Any, workspace: Any, loop: Any, first: int, arms: Any) -> None:
    """Gradients of the angular velocities of the touching contacts, to `directions` from row `first` on, the motions
    that unit torques cause, to `responses`, and rho and sigma or -r, m, to arms (rows,). Zeros where nothing
    resists."""
    count, n, rhs = scalars(instant).count, workspace.n, vec(workspace.rhs, workspace.n + workspace.m_act)
    rows = first + TURNING_ROWS * count
    directions, responses = mat(instant.directions, rows, n), mat(instant.responses, rows, n)
    for i in range(count):
        k, turns = ivec(instant.contacts, instant.most)[i], vec(instant.turns, instant.most)[i] != 0.0
        batch = probe_of(loop, k)
        coord, par = ivec(batch.coord, PAIR_SIZE), vec(batch.par, FRICTION_RADIUS + 1)
        for block in range(TURNING_ROWS):
            row = first + block * count + i
            arms[row] = (par[ROLLING] if block < 2 else par[SPINNING] - par[FRICTION_RADIUS]) if turns else 0.0
            clear(directions[row], n)
            clear(responses[row], n)
            if arms[row] == 0.0:
                continue
            a, b, c = axes_of_contact(coord, directions[i], n)
            axis = a if block == 0 else b if block == 1 else c
            turning_gradient(vec(workspace.q, workspace.n_ext), coord, pair_of(batch, 0), axis, n, directions[row])
            for j in range(n):
                rhs[j] = directions[row, j]
            for j in range(workspace.m_act):
                rhs[n + j] = 0.0
            solve_equations(workspace, workspace.kkt_query)
            for j in range(n):
                responses[row, j] = rhs[j]
