"""Gradients of the rows of a step of impulses, and the motions that impulses along them cause, contact by contact.

A contact moves the bodies that it joins, and those that joints connect to them. So its gradients and motions have
entries there alone: they are found with the pivots of these, and kept as blocks (`contact_solvers/contact_blocks.py`).
"""

from typing import Any

import numpy as np

from ..assembly.redundant_reactions import solve_equations
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, uvec, vec
from ..contact_solvers.contact_blocks import HEAD, WIDE, pack_block
from ..event_detection.contact_evaluation import add_gradient, can_look, tell_gradients
from ..linalg import lu_at
from ..linalg.components import find_components, solve_component
from ..linalg.record import DENSE
from ..rounding import IMMOVABLE
from .records import IMMOVABLE_CONTACT, OF_BLOCKS, SETTLED, WANTS_ROOM, scalars
from .turning_rows import add_turning_rows

SOME, MARKS, MOVED, COMPONENT, PLACE, PIVOTS, START = range(7)
"""Lists of integers: coordinates of a contact's gradients; the contact for which each was listed last; coordinates of
its motions; component of each pivot, pivot of each equation, pivots of each component, and where these begin."""


def opening_wholes(n: int, m: int) -> int:
    """Integers that `find_blocks` works with, for n coordinates and m constraints."""
    return 7 * (n + m) + 1


def opening_reals(n: int, m: int) -> int:
    """Numbers that it works with."""
    return WIDE * (2 * n + n + m) + n


@internal
def blocks_of(instant: Any) -> Any:
    """Both arrays of the blocks."""
    most, coordinates = instant.most, instant.block_coordinates
    wholes = ivec(instant.block_wholes, most * (2 + HEAD + coordinates))
    return wholes, vec(instant.block_reals, most * (WIDE * WIDE + WIDE * coordinates))


@internal
def _list(instant: Any, workspace: Any, k: int) -> Any:
    size = workspace.n + workspace.m_ext
    return ivec(instant.opening_wholes + 8 * size * k, size + 1)


@internal
def _gradients(instant: Any, n: int) -> Any:
    """(WIDE, n)."""
    return mat(instant.opening_reals, WIDE, n)


@internal
def _motions(instant: Any, n: int) -> Any:
    """(n, WIDE)."""
    return mat(instant.opening_reals + 8 * WIDE * n, n, WIDE)


@internal
def find_blocks(instant: Any, workspace: Any, loop: Any, arms: Any) -> int:
    """The blocks of the touching contacts, which are closed, after `tell_touching` and with the factors of the open
    ones' equations; how far turning rows may go, to their places in arms (rows,). A status of `records`."""
    count, n, place, lu = scalars(instant).count, workspace.n, 0, lu_at(workspace.kkt_query)
    gradients, at = _gradients(instant, n), 2 * scalars(instant).count
    some, marks = _list(instant, workspace, SOME), _list(instant, workspace, MARKS)
    wholes, reals = blocks_of(instant)
    for j in range(n):
        marks[j] = -1
        for k in range(WIDE):
            gradients[k, j] = 0.0
    largest = _read_masses(instant, workspace)
    if lu.kind != DENSE:
        find_components(
            lu, _list(instant, workspace, COMPONENT), _list(instant, workspace, START),
            _list(instant, workspace, PIVOTS), _list(instant, workspace, PLACE),
        )  # fmt: skip
    for i in range(count):
        width = _find_gradients(instant, workspace, loop, i, arms, gradients)
        others = _find_motions(instant, workspace, gradients, width)
        at, place = pack_block(
            i, count, at, place, gradients, some, width, _motions(instant, n), _list(instant, workspace, MOVED), others,
            wholes, reals,
        )  # fmt: skip
        if at < 0:
            scalars(instant).short_of = OF_BLOCKS
            return WANTS_ROOM
        if not _can_move(instant, workspace, gradients[0], width, reals[wholes[count + i]], largest):
            scalars(instant).failed_contact = ivec(instant.contacts, instant.most)[i]
            return IMMOVABLE_CONTACT
        for e in range(width):
            for k in range(WIDE):
                gradients[k, some[e]] = 0.0
    return SETTLED


@internal
def _find_gradients(instant: Any, workspace: Any, loop: Any, i: int, arms: Any, gradients: Any) -> int:
    """Gradients of the rows of the i-th touching contact, and the coordinates that they are of, to `SOME`: how many."""
    k, count, width = ivec(instant.contacts, instant.most)[i], scalars(instant).count, 0
    some, marks = _list(instant, workspace, SOME), _list(instant, workspace, MARKS)
    row, slide = (
        ivec(workspace.contact_rows, workspace.n_contacts)[k],
        ivec(workspace.contact_slide_rows, workspace.n_contacts)[k],
    )
    if can_look(loop, k):
        tell_gradients(workspace, loop, k)
    width = add_gradient(workspace, loop, k, row, gradients[0], i, some, marks, width)
    if slide >= 0 and vec(workspace.contact_sticking, workspace.n_contacts)[k] > 0.0:
        for block in range(2 if in_space(workspace, k) else 1):
            width = add_gradient(workspace, loop, k, slide + block, gradients[1 + block], i, some, marks, width)
    if scalars(instant).contact_torques != 0:
        turns = vec(instant.turns, instant.most)[i] != 0.0
        width = add_turning_rows(workspace, loop, k, i, count, turns, arms, gradients, some, marks, width)
    return width


@internal
def _find_motions(instant: Any, workspace: Any, gradients: Any, width: int) -> int:
    """What unit impulses along the gradients, of the first `width` coordinates of `SOME`, do to the motion: the
    coordinates that move, to `MOVED`, how many."""
    n, size, lu, others = workspace.n, workspace.n + workspace.m_ext, lu_at(workspace.kkt_query), 0
    motions, rhs = _motions(instant, n), vec(workspace.rhs, n + workspace.m_act)
    some, moved = _list(instant, workspace, SOME), _list(instant, workspace, MOVED)
    if lu.kind == DENSE:
        for k in range(WIDE):
            for j in range(n + workspace.m_act):
                rhs[j] = gradients[k, j] if j < n else 0.0
            solve_equations(workspace, workspace.kkt_query)
            for j in range(n):
                motions[j, k] = rhs[j]
        for j in range(n):
            moved[j] = j
        return int(n)
    y = mat(instant.opening_reals + 16 * WIDE * n, size, WIDE)
    component, start = _list(instant, workspace, COMPONENT), _list(instant, workspace, START)
    pivots, place, col_at = _list(instant, workspace, PIVOTS), _list(instant, workspace, PLACE), uvec(lu.col_at, lu.n)
    for e in range(width):
        c = component[place[some[e]]]
        done = False
        for before in range(e):
            done = done or component[place[some[before]]] == c
        if done:
            continue
        first, last = start[c], start[c + 1]
        for r in range(first, last):
            for k in range(WIDE):
                y[pivots[r], k] = 0.0
        for other in range(e, width):
            j = some[other]
            if component[place[j]] == c:
                for k in range(WIDE):
                    y[place[j], k] = gradients[k, j]
        solve_component(lu, pivots, first, last, y)
        for r in range(first, last):
            j = int(col_at[pivots[r]])
            if j < n:
                moved[others] = j
                others += 1
                for k in range(WIDE):
                    motions[j, k] = y[pivots[r], k]
    return others


@internal
def _read_masses(instant: Any, workspace: Any) -> float:
    """Diagonal of the mass matrix in units of the coordinates' scales; its largest element."""
    n, values, slots = (
        workspace.n,
        vec(workspace.values, workspace.n_values),
        ivec(workspace.mass_slot, workspace.n_mass),
    )
    entry_row, entry_col = ivec(workspace.entry_row, workspace.n_values), ivec(workspace.entry_col, workspace.n_values)
    mass, scale, largest = _masses(instant, workspace), vec(workspace.scale, n), 0.0
    for j in range(n):
        mass[j] = 0.0
    for e in range(workspace.n_mass):
        j = entry_row[slots[e]]
        if j == entry_col[slots[e]]:
            mass[j] += values[slots[e]] * scale[j] ** 2
    for j in range(n):
        largest = max(largest, mass[j])
    return largest


@internal
def _masses(instant: Any, workspace: Any) -> Any:
    n = workspace.n
    return vec(instant.opening_reals + 8 * WIDE * (2 * n + n + workspace.m_ext), n)


@internal
def _can_move(instant: Any, workspace: Any, gradient: Any, width: int, inverse: float, largest: float) -> bool:
    """False for a contact whose shapes joints and drivers hold both, which takes no impulse.

    Without joints its inverse mass is at least (g . x)^2/(x . M x) for x = S^2 g with the scales S of the coordinates
    (Cauchy and Schwarz), and x . M x at most the square of the sum of |x_j| sqrt(M_jj). Whatever the unit of length,
    what Euler parameters add along themselves is no more. (A frame without mass of its own counts as the heaviest.)
    """
    some, scale, mass = (
        _list(instant, workspace, SOME),
        vec(workspace.scale, workspace.n),
        _masses(instant, workspace),
    )
    length, of_mass = 0.0, 0.0
    for e in range(width):
        j = some[e]
        x = abs(scale[j] * gradient[j])
        length += x * x
        of_mass += x * np.sqrt(mass[j])
    free = length * length / (of_mass * of_mass if of_mass != 0.0 else largest * length)
    return bool(inverse > IMMOVABLE * free)
