"""Torques against rolling and spinning at an instant: they come with the normal forces of lasting contacts.

A unit normal force of a contact moves the others by its gap's gradient and by its torque, whose direction is that of
the present turning. Impacts take no torque: so there is another matrix of inverse masses for forces.
"""

from typing import Any

from ..assembly.evaluate import evaluate_residuals
from ..assembly.redundant_reactions import solve_equations
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contacts.coulomb3d import TURNS_HARD
from ..event_detection.contact_evaluation import can_look, pull_alone
from ..state.modes import CLOSED, OPEN, memories_at
from .rates import masses
from .records import clear, scalars, touching


@internal
def resist_turning(instant: Any, workspace: Any, count: int) -> None:
    """Which of the touching contacts, which are open and whose residuals have been evaluated, resist turning, and the
    axes that their tangents are counted from."""
    contacts, monitor, turns = (
        ivec(instant.contacts, instant.most),
        vec(workspace.monitor, 2 * workspace.n_contacts),
        vec(instant.turns, instant.most),
    )
    scalars(instant).contact_torques = 0
    for i in range(count):
        # (`contacts/coulomb3d.py`: what an open contact says of its tangents)
        says = monitor[workspace.n_contacts + contacts[i]] if in_space(workspace, contacts[i]) else 0.0
        turns[i] = 1.0 if says >= TURNS_HARD else 0.0
        touching(instant)[i].tangent_axis = says - TURNS_HARD * turns[i]
        if turns[i] != 0.0:
            scalars(instant).contact_torques = 1


@internal
def find_torques(instant: Any, workspace: Any, loop: Any, count: int) -> None:
    """`resist_turning`, and the residual by the normal forces of contacts that do, to `torques`."""
    contacts, turns = ivec(instant.contacts, instant.most), vec(instant.turns, instant.most)
    memory, lam = memories_at(workspace.memory, workspace.n_contacts), vec(workspace.lam, workspace.m_ext)
    rows, torques, r = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        mat(instant.torques, count, workspace.n),
        vec(workspace.r, workspace.n_ext),
    )
    resist_turning(instant, workspace, count)
    if scalars(instant).contact_torques == 0:
        return
    for i in range(count):
        memory[contacts[i]].mode = CLOSED
    for i in range(count):
        clear(torques[i], workspace.n)
        if turns[i] == 0.0:
            continue
        row = rows[contacts[i]]
        if can_look(loop, contacts[i]):
            # (of its normal force alone)
            own, slide = (
                vec(loop.probe_lam, workspace.m_ext),
                ivec(workspace.contact_slide_rows, workspace.n_contacts)[contacts[i]],
            )
            own[slide] = own[slide + 1] = 0.0
            pull_alone(workspace, loop, contacts[i], row, torques[i])
            continue
        before = lam[row]
        for force in range(2):
            lam[row] = -1.0 * force
            evaluate_residuals(workspace)
            for j in range(workspace.n):
                torques[i, j] = torques[i, j] - r[j] if force == 1 else r[j]
        lam[row] = before
    for i in range(count):
        memory[contacts[i]].mode = OPEN
    evaluate_residuals(workspace)


@internal
def press_with_torques(instant: Any, workspace: Any, count: int) -> None:
    """Inverse masses with the torques, where there are any, from `torques`, which hold the gradients too."""
    if scalars(instant).contact_torques == 0:
        return
    a, n, rhs = masses(instant, count), workspace.n, vec(workspace.rhs, workspace.n + workspace.m_act)
    pressing, torques = mat(instant.pressing_a, 3 * count, 3 * count), mat(instant.torques, count, n)
    directions = mat(instant.directions, 3 * count, n)
    for i in range(3 * count):
        for j in range(3 * count):
            pressing[i, j] = a[i, j]
    for i in range(count):
        some = False
        for j in range(n):
            some = some or torques[i, j] != 0.0
        if not some:
            continue
        for j in range(n):
            rhs[j] = torques[i, j] - directions[i, j]
        for j in range(workspace.m_act):
            rhs[n + j] = 0.0
        solve_equations(workspace, workspace.kkt_query)
        for k in range(3 * count):
            if a[k, k] == 0.0:
                continue
            for j in range(n):
                pressing[k, i] += directions[k, j] * rhs[j]
