"""History: the last accepted points, as rows (q, v, a, aux, lam) of a ring.

Rows hold the full coordinates, never only the independent ones: a new partition costs nothing.
"""

from typing import Any

from ..compiled.jit import compiled, inlined, internal
from ..compiled.views import ivec, mat, vec
from ..state.method_records import RING_SIZE


@inlined
def row_index(method: Any, back: int) -> int:
    """Ring position of the row `back` steps before the newest."""
    # a remainder would take longer than what is done with many a row
    place = ivec(method.ring, 2)[0] - back
    return place if place >= 0 else place + method.capacity


@inlined
def history_row(workspace: Any, method: Any, back: int) -> Any:
    """The row `back` steps before the newest."""
    return mat(method.history, method.capacity, workspace.row_length)[row_index(method, back)]


@inlined
def history_time(method: Any, back: int) -> float:
    """Its time."""
    return vec(method.times, method.capacity)[row_index(method, back)]


@internal
def push(workspace: Any, method: Any) -> None:
    """The current point of the workspace becomes the newest row.

    Multipliers of rows that are not active (open contacts) become zero. No stage solves for them, so what they had at
    the last release would be extrapolated from step to step, and grow with the formula's order until it overflows.
    """
    ring = ivec(method.ring, 2)
    ring[0] = (ring[0] + 1) % method.capacity
    ring[1] = min(ring[1] + 1, method.capacity)
    row = mat(method.history, method.capacity, workspace.row_length)[ring[0]]
    n = workspace.n_ext
    q, v, a, aux = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.aux, n)
    lam = vec(workspace.lam, workspace.m_ext)
    for i in range(n):
        row[i] = q[i]
        row[n + i] = v[i]
        row[2 * n + i] = a[i]
        row[3 * n + i] = aux[i]
    for i in range(workspace.m_ext):
        row[4 * n + i] = 0.0
    active = ivec(workspace.active, workspace.m_act + workspace.n_implied)
    for i in range(workspace.m_act + workspace.n_implied):
        row[4 * n + active[i]] = lam[active[i]]
    vec(method.times, method.capacity)[ring[0]] = vec(workspace.t, 1)[0]


@inlined
def bridge_rows(method: Any) -> int:
    """How many of the newest rows are the points of one long step over a singular position; 0: the newest step is an
    ordinary one."""
    return ivec(method.ring, RING_SIZE)[2]


@internal
def leave_bridge(method: Any) -> None:
    """Go on from the end of a long step: its other points are too far apart to be the history of a formula."""
    ring = ivec(method.ring, RING_SIZE)
    if ring[2] > 0:
        ring[1], ring[2] = 1, 0


@compiled
def restart(workspace: Any, method: Any) -> None:
    """Forget the history; the current point of the workspace is its only row."""
    ring = ivec(method.ring, RING_SIZE)
    ring[1], ring[2] = 0, 0
    push(workspace, method)


@internal
def replace(workspace: Any, method: Any) -> None:
    """The current point takes the place of the newest row, whose motion from the row before it was not smooth: rows
    further back are forgotten."""
    ring = ivec(method.ring, RING_SIZE)
    ring[0] = (ring[0] + method.capacity - 1) % method.capacity
    ring[1] = min(ring[1] - 1, 1)
    push(workspace, method)


@compiled
def recall(workspace: Any, method: Any, back: int) -> None:
    """The row `back` steps before the newest becomes the current point of the workspace."""
    row = history_row(workspace, method, back)
    n = workspace.n_ext
    q, v, a, aux = vec(workspace.q, n), vec(workspace.v, n), vec(workspace.a, n), vec(workspace.aux, n)
    lam = vec(workspace.lam, workspace.m_ext)
    for i in range(n):
        q[i] = row[i]
        v[i] = row[n + i]
        a[i] = row[2 * n + i]
        aux[i] = row[3 * n + i]
    for i in range(workspace.m_ext):
        lam[i] = row[4 * n + i]
    vec(workspace.t, 1)[0] = history_time(method, back)
