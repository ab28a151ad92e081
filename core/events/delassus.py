"""Contacts with two tangents that touch at one instant: their directions, and how an impulse at one moves the others.

The room for directions and responses holds a third block, the second tangents' behind
the first ones'; inverse masses of all three are in `masses`. The tangents of a contact are those of
`contacts/frame3d.py`. A contact of the plane has a second tangent without a gradient: as joints may hold one, it takes
no friction.
"""

from typing import Any

from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..assembly.redundant_reactions import analyze_equations, solve_equations
from ..assembly.sticking_force import in_space
from ..assembly.structure_switch import engage_modes
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..event_detection.contact_evaluation import can_look, tell_gradients
from ..linalg.record import WANT_ROOM
from ..rounding import IMMOVABLE
from ..state.modes import CLOSED, OPEN, memories_at
from ..state.modes import STICKS as STUCK
from ..state.run_records import loop_at
from ..state.workspace_records import OK
from .rates import masses, read_all_rates
from .records import SINGULAR_JOINTS, WANT_MEMORY, clear, delassus, scalars
from .spins import read_spins
from .torques import find_torques, press_with_torques
from .touching import entries_of, find_gradient, refuse_immovable, tell_touching


@internal
def open_touching(instant: Any, drive: Any, workspace: Any, method: Any) -> int:
    """Open the touching contacts, and find how impulses at them, along normals and both tangents, move the others."""
    count, contacts, n = scalars(instant).count, ivec(instant.contacts, instant.most), workspace.n
    memory = memories_at(workspace.memory, workspace.n_contacts)
    for i in range(count):
        k = contacts[i]
        memory[k].mode, memory[k].slide_mode, memory[k].friction_ratio = OPEN, STUCK, 0.0
        if in_space(workspace, k):
            # directions and rates are to speak of the same tangents
            memory[k].tangent_axis = 0.0
    if engage_modes(workspace) != OK:
        return WANT_MEMORY
    # the rows of those that slid or stuck now tell both velocities
    evaluate_residuals(workspace)
    loop = loop_at(drive.loop)
    find_torques(instant, workspace, loop, count)
    read_spins(instant, drive, workspace)
    for i in range(count):
        memory[contacts[i]].mode = CLOSED
    tell_touching(instant, workspace, loop)
    rows, slides = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    static, directions = vec(workspace.contact_sticking, workspace.n_contacts), mat(instant.directions, 3 * count, n)
    for i in range(count):
        k = contacts[i]
        if can_look(loop, k):
            tell_gradients(workspace, loop, k)
        find_gradient(workspace, loop, k, rows[k], directions[i])
        for block in range(2):
            to = directions[(block + 1) * count + i]
            if slides[k] >= 0 and static[k] > 0.0 and (block == 0 or in_space(workspace, k)):
                find_gradient(workspace, loop, k, slides[k] + block, to)
            else:
                clear(to, n)
        memory[k].mode = OPEN
    evaluate_tangent(workspace, 0.0, 0.0)
    code = analyze_equations(workspace, workspace.kkt_query)
    if code != OK:
        return WANT_MEMORY if code == WANT_ROOM else SINGULAR_JOINTS
    _respond(instant, workspace, count)
    read_all_rates(instant, workspace)
    return refuse_immovable(instant, workspace, count)


@internal
def _respond(instant: Any, workspace: Any, count: int) -> None:
    n, directions, responses = (
        workspace.n,
        mat(instant.directions, 3 * count, workspace.n),
        mat(instant.responses, 3 * count, workspace.n),
    )
    a, plane, rhs = masses(instant, count), delassus(instant, count), vec(workspace.rhs, n + workspace.m_act)
    for i in range(3 * count):
        for j in range(n):
            rhs[j] = directions[i, j]
        for j in range(workspace.m_act):
            rhs[n + j] = 0.0
        solve_equations(workspace, workspace.kkt_query)
        for j in range(n):
            responses[i, j] = rhs[j]
    some = ivec(instant.columns, n)
    for i in range(3 * count):
        entries = entries_of(directions[i], n, some)
        for j in range(3 * count):
            product = 0.0
            for e in range(entries):
                product += directions[i, some[e]] * responses[j, some[e]]
            a[i, j] = product
    for i in range(3 * count):
        for j in range(i):
            a[i, j] = a[j, i] = 0.5 * (a[i, j] + a[j, i])
    # a tangent that joints hold takes no friction
    largest = 0.0
    for i in range(3 * count):
        largest = max(largest, a[i, i])
    for i in range(count, 3 * count):
        if a[i, i] <= IMMOVABLE * largest:
            a[i, i] = 0.0
            for j in range(3 * count):
                a[i, j] = a[j, i] = 0.0
    for i in range(2 * count):
        for j in range(2 * count):
            plane[i, j] = a[i, j]
    press_with_torques(instant, workspace, count)
