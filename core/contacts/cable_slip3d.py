"""How a shape slides on a cable in space: `tangent3d.py` for the point that touches, with the moves of its foot.

The friction acts on the cable's axis: the cable does not turn about it, and has no lever but its radius to the axis.
"""

from typing import Any

import numpy as np

from ..compiled.jit import inlined, internal
from ..compiled.views import vec
from ..model.rotation3d import plus, times
from .cable_foot3d import (
    AT,
    CABLE_AT,
    FIRST_SLOPE,
    FOOT_WIDTH,
    OWN_COORDINATES,
    SLOPE,
    WAY,
    gather,
    share,
    slope_of,
    source,
)
from .moving_point3d import PAIR_SIZE, measured
from .normal3d import RADIUS_A, RADIUS_B
from .tangent3d import NORMAL, ROWS, U, W, add_directions, column, put, tangent_motion

SLOTS = np.arange(PAIR_SIZE * PAIR_SIZE).reshape(PAIR_SIZE, PAIR_SIZE)


@inlined
def _forward(work: Any, first: int, way: Any) -> Any:
    """Three rows of the pair's work times a way of the cable's point."""
    found = times(way[0], column(work, first, CABLE_AT))
    found = plus(found, times(way[1], column(work, first, CABLE_AT + 1)))
    return plus(found, times(way[2], column(work, first, CABLE_AT + 2)))


@internal
def _of_pair(kind: int, b: Any, par: Any, coord: Any, held: Any, moves: Any, q: Any, own: Any) -> Any:
    """`tangent_motion` of the pair: its places to q (14,), its matrices to own (ROWS, 14)."""
    v = np.empty(PAIR_SIZE)
    gather(vec(b.q, b.n_extended), coord, moves, q)
    gather(vec(b.v, b.n_extended), coord, moves, v)
    return tangent_motion(measured(kind), q, v, OWN_COORDINATES, held, moves, par[RADIUS_A], par[RADIUS_B], own)


@internal
def slip_on_cable(kind: int, b: Any, par: Any, coord: Any, held: Any, moves: Any, work: Any) -> Any:
    """(n, u, beta_a, beta_b, s); W, U and the derivatives of the normal go to work (rows, FOOT_WIDTH)."""
    q, own = np.empty(PAIR_SIZE), np.empty((ROWS, PAIR_SIZE))
    found = _of_pair(kind, b, par, coord, held, moves, q, own)
    first = (moves[AT, FIRST_SLOPE], moves[AT, FIRST_SLOPE + 1], moves[AT, FIRST_SLOPE + 2])
    by_x = plus(_forward(own, U, first), _forward(own, W, slope_of(vec(b.v, b.n_extended), coord, moves)))
    turns = _forward(own, NORMAL, first)
    for j in range(FOOT_WIDTH):
        w, x, at = share(j, moves), moves[WAY, j], source(j)
        put(work, W, j, times(w, column(own, W, at)))
        put(work, U, j, plus(times(w, column(own, U, at)), times(x, by_x)))
        put(work, NORMAL, j, plus(times(w, column(own, NORMAL, at)), times(x, turns)))
    return found


@internal
def add_cable_slip(
    kind: int, b: Any, par: Any, values: Any, slot: Any, coord: Any, held: Any, moves: Any, force: Any, factor: float
) -> None:
    """values += factor d(W^T force)/dq, the force held."""
    q, own, changes = np.empty(PAIR_SIZE), np.empty((ROWS, PAIR_SIZE)), np.zeros(PAIR_SIZE * PAIR_SIZE)
    _, _, beta_a, beta_b, size = _of_pair(kind, b, par, coord, held, moves, q, own)
    add_directions(
        measured(kind), changes, SLOTS, q, OWN_COORDINATES, held, moves, own, beta_a, beta_b, size, force, factor
    )  # fmt: skip
    for i in range(FOOT_WIDTH):
        at = PAIR_SIZE * source(i)
        along = 0.0
        for c in range(3):
            along += changes[at + CABLE_AT + c] * moves[AT, FIRST_SLOPE + c]
        along *= share(i, moves)
        if i >= CABLE_AT:
            along += factor * size * moves[AT, SLOPE + (i - CABLE_AT) // 3] * force[(i - CABLE_AT) % 3]
        for j in range(FOOT_WIDTH):
            values[slot[i, j]] += share(i, moves) * changes[at + source(j)] * share(j, moves) + along * moves[WAY, j]
