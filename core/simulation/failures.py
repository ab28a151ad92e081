"""Why pending events could not be settled, as the error that says so."""

from typing import TYPE_CHECKING

import numpy as np

from ..assembly.partition import prepare
from ..assembly.structure_switch import ENGAGED, HELD, STRUCTURE_KINDS
from ..errors import ConsistencyError, SimulationError
from ..events.records import (
    ENDLESS_BLOWS,
    ENDLESS_ROUNDS,
    IMMOVABLE_CONTACT,
    JAMS,
    NO_ACCELERATIONS,
    NO_FORCES,
    NO_FREE_ACCELERATIONS,
    NO_IMPACT,
    NO_SLOT,
    NOT_MET,
    REPEATED_ROWS,
    SINGULAR_JOINTS,
    SINGULAR_MATRIX,
)
from ..state.modes import ACTIVE, CLOSED, OPEN
from .painleve import painleve

if TYPE_CHECKING:
    from .contact_side import ContactSide

_OF_IMPACT = {
    NO_IMPACT: "neither pivoting nor Newton's method find forces of the contacts",
    ENDLESS_ROUNDS: "impacts of the touching contacts at one instant do not end",
    ENDLESS_BLOWS: "blows one after another do not end",
}


def failure_of(sim: "ContactSide", status: int) -> SimulationError | ConsistencyError:
    """The error for a status of `events/records.py`; the simulation is as it was before the instant."""
    t, instant, contacts = sim.t_internal, sim.drive.instant, sim.assembly.contacts
    names = ", ".join(f"'{contacts[k].name}'" for k in instant.touching)
    where = f"t = {t:.9g} s"
    if status == NO_SLOT:
        return no_slot(sim)
    if status == SINGULAR_JOINTS:
        return SimulationError(
            f"contact {names}, {where}: the matrix [M Phi_q^T; Phi_q 0] of the joints is singular there (a coordinate "
            "without mass, or a singular position): impulses cannot be computed",
            t=t,
            loop="impact",
        )
    if status == IMMOVABLE_CONTACT:
        return SimulationError(
            f"contact '{contacts[instant.who].name}', {where}: joints and drivers hold both shapes, so that no impulse "
            "can keep them apart. Give one of them a force instead of a prescribed motion",
            t=t,
            loop="impact",
        )
    if status in _OF_IMPACT:
        return SimulationError(
            f"impact of contacts {names} at {where}: {_OF_IMPACT[status]}. With large friction coefficients the impact "
            "laws may have no solution: use PoissonImpact, less friction, or force laws",
            t=t,
            loop="impact",
        )
    if status == JAMS or (status == NO_FORCES and instant.who >= 0):
        contact = contacts[instant.who]
        mu = contact.coulomb.coefficient if contact.coulomb else 0.0
        return SimulationError(painleve(contact.name, t, mu), t=t, loop="contact")
    if status == NO_FORCES:
        return SimulationError(
            f"contacts {names}, {where}: no contact forces satisfy complementarity and friction at once (Painleve's "
            "paradox of several contacts): use smaller friction coefficients, or force laws",
            t=t,
            loop="contact",
        )
    if status == NOT_MET:
        return SimulationError(
            f"at {where} the closed contacts cannot be met together with the joints", t=t, loop="contact"
        )
    if status == NO_FREE_ACCELERATIONS:
        return SimulationError(f"no accelerations at {where}: a force is not finite there", t=t, loop="impact")
    if status in (REPEATED_ROWS, SINGULAR_MATRIX):
        return _inconsistent(sim)
    if status == NO_ACCELERATIONS:
        return sim.no_accelerations()
    raise RuntimeError(f"status {status} of an instant is not known")


def no_slot(sim: "ContactSide") -> SimulationError:
    """The error where more pairs of a pool are near than it has slots."""
    pool = sim.assembly.pool
    rooms = [] if pool is None else list(zip(pool.names, pool.groups["slots"].tolist(), strict=True))
    return SimulationError(
        f"at t = {sim.t_internal:.9g} s more pairs of shapes are near each other than there is room for: "
        f"{', '.join(f'most_contacts of group {name!r} is {room}' for name, room in rooms)}. Give a larger number",
        t=sim.t_internal,
        loop="contact",
    )


def _inconsistent(sim: "ContactSide") -> ConsistencyError:
    """What `prepare` says of the structure that was tried."""
    key, modes = sim.workspace.key, sim.memory.mode.copy()
    try:
        sim.workspace.engage_wanted()
        # (a contact that is open has no gradients)
        kinds = sim.workspace.arrays["wanted"][: len(sim.assembly.contacts)] % STRUCTURE_KINDS
        sim.memory.mode[: len(kinds)] = np.select([kinds >= HELD, kinds == ENGAGED], [CLOSED, ACTIVE], OPEN)
        prepare(sim.workspace)
    except ConsistencyError as error:
        return error
    finally:
        sim.memory.mode = modes
        sim.workspace.engage(*key)
    return ConsistencyError(
        f"at t = {sim.t_internal:.9g} s the constraints of the closed contacts are inconsistent, or a derivative of a "
        "force is not finite (a root or a quotient in a formula of your own, whose argument comes to zero there)"
    )
