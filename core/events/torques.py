"""Torques against rolling and spinning at an instant: they come with the normal forces of lasting contacts.

A unit normal force of a contact moves the others by its gap's gradient and by its torque, whose direction is that of
the present turning. Impacts take no torque: so there is another matrix of inverse masses for forces.
"""

from typing import Any

from ..assembly.compatibility import solve_equations
from ..assembly.evaluate import evaluate_residuals
from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contacts.coulomb3d import TURNS_HARD
from ..event_detection.contact_evaluation import can_look, pull_alone
from ..state.modes import CLOSED, MEMORY_SIZE, MODE, OPEN
from .rates import masses
from .records import AXIS_NOW, FLAG, TURNS, clear, col, whole


@internal
def find_torques(ev: Any, ws: Any, lc: Any, count: int) -> None:
    """Of the touching contacts, which are open and whose residuals have been evaluated: the axes that their tangents
    are counted from, and whether they resist turning; then the residual by their normal forces, to `torques`."""
    contacts, monitor, turns = ivec(ev.contacts, ev.most), vec(ws.monitor, 2 * ws.n_contacts), col(ev, FLAG)
    memory, lam = mat(ws.memory, ws.n_contacts, MEMORY_SIZE), vec(ws.lam, ws.m_ext)
    rows, torques, r = ivec(ws.contact_rows, ws.n_contacts), mat(ev.torques, count, ws.n), vec(ws.r, ws.n_ext)
    whole(ev)[TURNS] = 0
    for i in range(count):
        # (`contacts/coulomb3d.py`: what an open contact says of its tangents)
        says = monitor[ws.n_contacts + contacts[i]] if in_space(ws, contacts[i]) else 0.0
        turns[i] = 1.0 if says >= TURNS_HARD else 0.0
        col(ev, AXIS_NOW)[i] = says - TURNS_HARD * turns[i]
        if turns[i] != 0.0:
            whole(ev)[TURNS] = 1
    if whole(ev)[TURNS] == 0:
        return
    for i in range(count):
        memory[contacts[i], MODE] = CLOSED
    for i in range(count):
        clear(torques[i], ws.n)
        if turns[i] == 0.0:
            continue
        row = rows[contacts[i]]
        if can_look(lc, contacts[i]):
            # (of its normal force alone)
            own, slide = vec(lc.probe_lam, ws.m_ext), ivec(ws.contact_slide_rows, ws.n_contacts)[contacts[i]]
            own[slide] = own[slide + 1] = 0.0
            pull_alone(ws, lc, contacts[i], row, torques[i])
            continue
        before = lam[row]
        for force in range(2):
            lam[row] = -1.0 * force
            evaluate_residuals(ws)
            for j in range(ws.n):
                torques[i, j] = torques[i, j] - r[j] if force == 1 else r[j]
        lam[row] = before
    for i in range(count):
        memory[contacts[i], MODE] = OPEN
    evaluate_residuals(ws)


@internal
def press_with_torques(ev: Any, ws: Any, count: int) -> None:
    """Inverse masses with the torques, where there are any, from `torques`, which hold the gradients too."""
    if whole(ev)[TURNS] == 0:
        return
    a, n, rhs = masses(ev, count), ws.n, vec(ws.rhs, ws.n + ws.m_act)
    pressing, torques = mat(ev.pressing_a, 3 * count, 3 * count), mat(ev.torques, count, n)
    directions = mat(ev.directions, 3 * count, n)
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
        for j in range(ws.m_act):
            rhs[n + j] = 0.0
        solve_equations(ws, ws.kkt_query)
        for k in range(3 * count):
            if a[k, k] == 0.0:
                continue
            for j in range(n):
                pressing[k, i] += directions[k, j] * rhs[j]
