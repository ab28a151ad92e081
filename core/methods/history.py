"""History: the last accepted points, as rows (q, v, a, aux, lam) of a ring.

Rows hold the full coordinates, never only the independent ones: a new partition costs nothing.
"""

from typing import Any

from ..compiled.jit import compiled, inlined, internal
from ..compiled.views import ivec, mat, vec
from ..state.method_records import RING_SIZE


@inlined
def row_index(ms: Any, back: int) -> int:
    """Ring position of the row `back` steps before the newest."""
    # a remainder would take longer than what is done with many a row
    place = ivec(ms.ring, 2)[0] - back
    return place if place >= 0 else place + ms.capacity


@inlined
def history_row(ws: Any, ms: Any, back: int) -> Any:
    """The row `back` steps before the newest."""
    return mat(ms.history, ms.capacity, ws.row_length)[row_index(ms, back)]


@inlined
def history_time(ms: Any, back: int) -> float:
    """Its time."""
    return vec(ms.times, ms.capacity)[row_index(ms, back)]


@internal
def push(ws: Any, ms: Any) -> None:
    """The current point of the workspace becomes the newest row.

    Multipliers of rows that are not active (open contacts) become zero. No stage solves for them, so what they had at
    the last release would be extrapolated from step to step, and grow with the formula's order until it overflows.
    """
    ring = ivec(ms.ring, 2)
    ring[0] = (ring[0] + 1) % ms.capacity
    ring[1] = min(ring[1] + 1, ms.capacity)
    row = mat(ms.history, ms.capacity, ws.row_length)[ring[0]]
    n = ws.n_ext
    q, v, a, aux = vec(ws.q, n), vec(ws.v, n), vec(ws.a, n), vec(ws.aux, n)
    lam = vec(ws.lam, ws.m_ext)
    for i in range(n):
        row[i] = q[i]
        row[n + i] = v[i]
        row[2 * n + i] = a[i]
        row[3 * n + i] = aux[i]
    for i in range(ws.m_ext):
        row[4 * n + i] = 0.0
    active = ivec(ws.active, ws.m_act + ws.n_implied)
    for i in range(ws.m_act + ws.n_implied):
        row[4 * n + active[i]] = lam[active[i]]
    vec(ms.times, ms.capacity)[ring[0]] = vec(ws.t, 1)[0]


@inlined
def bridge_rows(ms: Any) -> int:
    """How many of the newest rows are the points of one long step over a singular position; 0: the newest step is an
    ordinary one."""
    return ivec(ms.ring, RING_SIZE)[2]


@internal
def leave_bridge(ms: Any) -> None:
    """Go on from the end of a long step: its other points are too far apart to be the history of a formula."""
    ring = ivec(ms.ring, RING_SIZE)
    if ring[2] > 0:
        ring[1], ring[2] = 1, 0


@compiled
def restart(ws: Any, ms: Any) -> None:
    """Forget the history; the current point of the workspace is its only row."""
    ring = ivec(ms.ring, RING_SIZE)
    ring[1], ring[2] = 0, 0
    push(ws, ms)


@internal
def replace(ws: Any, ms: Any) -> None:
    """The current point takes the place of the newest row, whose motion from the row before it was not smooth: rows
    further back are forgotten."""
    ring = ivec(ms.ring, RING_SIZE)
    ring[0] = (ring[0] + ms.capacity - 1) % ms.capacity
    ring[1] = min(ring[1] - 1, 1)
    push(ws, ms)


@compiled
def recall(ws: Any, ms: Any, back: int) -> None:
    """The row `back` steps before the newest becomes the current point of the workspace."""
    row = history_row(ws, ms, back)
    n = ws.n_ext
    q, v, a, aux = vec(ws.q, n), vec(ws.v, n), vec(ws.a, n), vec(ws.aux, n)
    lam = vec(ws.lam, ws.m_ext)
    for i in range(n):
        q[i] = row[i]
        v[i] = row[n + i]
        a[i] = row[2 * n + i]
        aux[i] = row[3 * n + i]
    for i in range(ws.m_ext):
        lam[i] = row[4 * n + i]
    vec(ws.t, 1)[0] = history_time(ms, back)
