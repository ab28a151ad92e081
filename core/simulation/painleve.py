"""Painleve's paradox: sliding friction that presses bodies together more than the normal force keeps them apart.

The gap's acceleration due to the forces of sliding contacts is (A_NN - A_NT diag(mu s)) F_N, s = +-1 the directions of
sliding. Where that matrix loses its positive determinant there are no accelerations, or several (Painleve 1895; Genot
and Brogliato 1999); on the way there the forces grow without bound.
"""

from contextlib import suppress
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from ..errors import SimulationError
from ..linalg import SingularMatrixError
from ..methods.history import recall
from ..rounding import DIRECTION_RANK
from ..stage.joints import factor_joints, solve_joints
from ..state.modes import AT_LIMIT, CLOSED, IDLE

if TYPE_CHECKING:
    from .engine import Engine

JAMS = 1e-2
"""Part of the determinant without friction that is left where a run that failed is said to have jammed."""


def painleve(name: str, t: float, mu: float) -> str:
    """What to tell of contact `name`."""
    return (
        f"contact '{name}', t = {t:.9g} s: Painleve's paradox. Sliding with mu = {mu:g}, the friction presses the "
        "bodies together more than the normal force keeps them apart, so that rigid bodies with Coulomb friction have "
        "no (or no unique) accelerations here: use a smaller coefficient, or a force law with regularised friction "
        "for this contact"
    )


def sliding_contacts(sim: "Engine") -> list[int]:
    """Closed contacts whose friction is in proportion to their normal force because they slide."""
    memory = sim.memory
    slides = (memory.mode == CLOSED) & (np.abs(memory.slide_mode) == 1.0) & (memory.friction_ratio != 0.0)
    return [int(k) for k in np.flatnonzero(slides)]


def refuse_passed_jam(sim: "Engine") -> NoReturn:
    """Raise SimulationError: the step that ended at the workspace's current point went over a place where sliding
    contacts jam. Of several it names the one whose force has become the most sensitive, with the wrong sign if one has:
    behind that place, its force pulls the gap's acceleration down."""
    workspace, n, sliding, memory = sim.workspace, sim.assembly.n, sliding_contacts(sim), sim.memory
    # constant shares of contacts that others hold are given forces, as for the determinant (`repivoting.py`)
    held = (memory.slide_mode == IDLE) | (memory.slide_mode == AT_LIMIT)
    shares = memory.friction_ratio[held]
    memory.friction_ratio[held] = 0.0
    singular = factor_joints(workspace.record) != 0
    if singular:
        with suppress(SingularMatrixError):
            workspace.structure.kkt_query.analyze(workspace.arrays["values"])
            singular = factor_joints(workspace.record) != 0
    memory.friction_ratio[held] = shares
    rows, rhs, worst, most = workspace.structure.multiplier_rows, workspace.arrays["rhs"], sliding[0], (False, 0.0)
    for k in sliding:
        row = n + int(np.flatnonzero(rows == sim.assembly.contacts[k].row)[0])
        rhs[: n + len(rows)] = 0.0
        rhs[row] = 1.0
        # multiplier that gives the gap a unit acceleration: -1/(A_NN + F_T/F_N A_NT), other contacts included
        if not singular:
            solve_joints(workspace.record)
        found = (not rhs[row] < 0.0, abs(float(rhs[row])))
        if found > most:
            worst, most = k, found
    message = painleve(sim.assembly.contacts[worst].name, sim.t_internal, abs(float(memory.friction_ratio[worst])))
    raise SimulationError(message, t=sim.t_internal, loop="contact")


def jam(sim: "Engine") -> str | None:
    """Why a run cannot go on from the newest row, if its sliding contacts jam there; else None."""
    memory, sliding = sim.memory, sliding_contacts(sim)
    if not sliding or not sim.method_arrays["ring"][1]:
        return None
    ratio = memory.friction_ratio[sliding]
    recall(sim.workspace.record, sim._method.record, 0)
    try:
        a, count = sim.inverse_masses(sliding), len(sliding)
    except SimulationError:
        return None
    of_normals = a[:count, :count]
    with_friction = of_normals + a[:count, count:] * ratio
    # contacts that repeat each other share their load: their forces have no part along what A_NN does not see
    sizes, forces = np.linalg.eigh(of_normals)
    forces = forces[:, sizes > DIRECTION_RANK * sizes[-1]]
    if np.linalg.det(forces.T @ with_friction @ forces) > JAMS * np.linalg.det(forces.T @ of_normals @ forces):
        return None
    worst = int(np.argmin(np.diag(with_friction) / np.diag(of_normals)))
    return painleve(sim.assembly.contacts[sliding[worst]].name, sim.t_internal, abs(float(ratio[worst])))
