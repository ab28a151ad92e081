"""Contacts with two tangents that touch at one instant: their directions, and how an impulse at one moves the others.

The room for directions and responses holds a third block, the second tangents' behind
the first ones'; inverse masses of all three are in `masses`. The tangents of a contact are those of
`contacts/frame3d.py`. A contact of the plane has a second tangent without a gradient: as joints may hold one, it takes
no friction.
"""

from typing import Any

from ..assembly.compatibility import analyze_equations, solve_equations
from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.sticking_force import in_space
from ..assembly.structure_switch import engage_modes
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.contact_evaluation import can_look, tell_gradients
from ..linalg.record import WANT_ROOM
from ..rounding import IMMOVABLE
from ..state.modes import AXIS, CLOSED, MEMORY_SIZE, MODE, OPEN, RATIO, SLIDE
from ..state.modes import STICKS as STUCK
from ..state.run_records import loop_at
from ..state.workspace_records import OK
from .rates import masses, read_all_rates
from .records import ALONE, COUNT, SINGULAR_JOINTS, WANT_MEMORY, clear, delassus, whole
from .spins import read_spins
from .torques import find_torques, press_with_torques
from .touching import entries_of, find_gradient, refuse_immovable, tell_touching


@internal
def open_touching(ev: Any, dr: Any, ws: Any, ms: Any) -> int:
    """Open the touching contacts, and find how impulses at them, along normals and both tangents, move the others."""
    count, contacts, n = whole(ev)[COUNT], ivec(ev.contacts, ev.most), ws.n
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)
    for i in range(count):
        k = contacts[i]
        memory[k, MODE], memory[k, SLIDE], memory[k, RATIO] = OPEN, STUCK, 0.0
        if in_space(ws, k):
            # directions and rates are to speak of the same tangents
            memory[k, AXIS] = 0.0
    if engage_modes(ws) != OK:
        return WANT_MEMORY
    # the rows of those that slid or stuck now tell both velocities
    evaluate_residuals(ws)
    lc = loop_at(dr.loop)
    find_torques(ev, ws, lc, count)
    read_spins(ev, dr, ws)
    for i in range(count):
        memory[contacts[i], MODE] = CLOSED
    tell_touching(ev, ws, lc)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    static, directions = vec(ws.contact_sticking, ws.n_contacts), mat(ev.directions, 3 * count, n)
    for i in range(count):
        k = contacts[i]
        if can_look(lc, k):
            tell_gradients(ws, lc, k)
        find_gradient(ws, lc, k, rows[k], directions[i])
        for block in range(2):
            to = directions[(block + 1) * count + i]
            if slides[k] >= 0 and static[k] > 0.0 and (block == 0 or in_space(ws, k)):
                find_gradient(ws, lc, k, slides[k] + block, to)
            else:
                clear(to, n)
        memory[k, MODE] = OPEN
    evaluate_tangent(ws, 0.0, 0.0)
    code = analyze_equations(ws, ws.kkt_query)
    if code != OK:
        return WANT_MEMORY if code == WANT_ROOM else SINGULAR_JOINTS
    _respond(ev, ws, count)
    read_all_rates(ev, ws)
    return refuse_immovable(ev, ws, count)


@internal
def _respond(ev: Any, ws: Any, count: int) -> None:
    n, directions, responses = ws.n, mat(ev.directions, 3 * count, ws.n), mat(ev.responses, 3 * count, ws.n)
    a, plane, rhs = masses(ev, count), delassus(ev, count), vec(ws.rhs, n + ws.m_act)
    for i in range(3 * count):
        for j in range(n):
            rhs[j] = directions[i, j]
        for j in range(ws.m_act):
            rhs[n + j] = 0.0
        solve_equations(ws, ws.kkt_query)
        for j in range(n):
            responses[i, j] = rhs[j]
    some = ivec(ev.columns, n)
    alone = whole(ev)[ALONE] != 0
    for i in range(3 * count):
        entries = entries_of(directions[i], n, some)
        for j in range(i if alone else 0, i + 1 if alone else 3 * count):
            product = 0.0
            for e in range(entries):
                product += directions[i, some[e]] * responses[j, some[e]]
            a[i, j] = product
    for i in range(0 if alone else 3 * count):
        for j in range(i):
            a[i, j] = a[j, i] = 0.5 * (a[i, j] + a[j, i])
    # a tangent that joints hold takes no friction
    largest = 0.0
    for i in range(3 * count):
        largest = max(largest, a[i, i])
    for i in range(count, 3 * count):
        if a[i, i] <= IMMOVABLE * largest:
            a[i, i] = 0.0
            for j in range(0 if alone else 3 * count):
                a[i, j] = a[j, i] = 0.0
    for i in range(2 * count):
        for j in range(i if alone else 0, i + 1 if alone else 2 * count):
            plane[i, j] = a[i, j]
    if not alone:
        press_with_torques(ev, ws, count)
