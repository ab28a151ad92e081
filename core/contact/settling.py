"""What is known of the touching contacts while the state machine settles an instant: modes before, and their events."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..rounding import NEAR_ZERO, UNRESOLVED
from .modes import CLOSED, IDLE, MODE, RATIO, SLIDE, STICKS

if TYPE_CHECKING:
    from ..integrate.contact_side import ContactSide
    from ..integrate.engine import Engine

Vector = NDArray[np.float64]
Flags = NDArray[np.bool_]

BRAKED = 1e-9
"""Of the largest acceleration: what slides with no speed and is braked by less begins to slide, it does not stop."""
AT_LIMIT = 1e-9
"""Friction within this part of its limit has reached it."""


def unresolved_height(sim: "ContactSide", contacts: Sequence[int]) -> Vector:
    """Heights of gaps that cannot be told from zero, (contacts,), m."""
    return UNRESOLVED * sim.gap_size(contacts)


def unresolved_speed(sim: "ContactSide", contacts: Sequence[int], falls: Vector) -> Vector:
    """Speeds of separation below which gaps with the accelerations -falls (m/s^2) cannot be seen to open, m/s."""
    return np.asarray(np.sqrt(2.0 * unresolved_height(sim, contacts) * np.maximum(falls, 0.0)))


def comes_back(sim: "ContactSide", contacts: Sequence[int], jerks: Vector, motion: Vector) -> Flags:
    """Gaps at rest that, with these accelerations (m/s^2) and their rates (m/s^3), do not open, or less than could be
    told from zero before they close again: a node of an elastic body that has come to rest while its neighbours still
    approach. g = b t^2/2 + j t^3/6, j < 0, is highest at t = -2 b/j."""
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.where(jerks < 0.0, 2.0 * np.maximum(motion, 0.0) ** 3 / (3.0 * jerks**2), np.inf)
    return np.asarray(height <= unresolved_height(sim, contacts))


@dataclass
class Settling:
    """What is known of the touching contacts (their numbers in `contacts`) while an instant is settled."""

    contacts: list[int]
    was: Vector
    """Modes before, (contacts,)."""
    slid: Vector
    """SLIDE before, (contacts,)."""
    ratio: Vector
    """RATIO before, (contacts,)."""
    leaves: Flags
    """The event is that the contact's force became zero."""
    slips: Vector
    """+-1 where the event is that a sticking contact reached its limit: the direction in which it goes; else 0."""
    stops: Flags
    """A sliding contact has come to a stop."""
    falls: Vector
    """Acceleration with which the gap closes before any impact, m/s^2."""
    struck: bool = False
    rests: set[int] = field(default_factory=set)

    def forget_events(self) -> None:
        """The velocities have jumped: only they say what moves how."""
        self.struck = True
        self.leaves[:], self.stops[:], self.slips[:] = False, False, 0.0


def read(sim: "Engine", contacts: list[int], pending: list[int]) -> Settling:
    """What the touching contacts were, and which events those in `pending` have, at the workspace's current point."""
    memory, arrays = sim.memory, sim.workspace.arrays
    was, slid = memory[contacts, MODE].copy(), memory[contacts, SLIDE].copy()
    count = len(contacts)
    leaves, stops, slips = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool), np.zeros(count)
    no_force, rounding = sim.no_force(contacts), sim.rate_rounding(contacts)
    strongest, fastest = sim.force_size(contacts), sim.rate_size(contacts)
    scale = sim.assembly.coordinate_scale
    braked = BRAKED * float(np.max(np.abs(arrays["a"][: sim.assembly.n]) / scale, initial=0.0))
    for i, k in enumerate(contacts):
        contact = sim.assembly.contacts[k]
        if was[i] != CLOSED:
            continue
        if contact.coulomb is not None and abs(slid[i]) == 1.0:
            rate, acceleration = (float(arrays[level][contact.slide_row]) for level in ("phid", "phidd"))
            # what moves with another that stops does so at the same time
            slow = braked * float(arrays["row_scale"][contact.slide_row])
            stops[i] = abs(rate) <= rounding[i] and slid[i] * acceleration < -slow
        if k not in pending:
            continue
        force, coulomb = -float(arrays["lam"][contact.row]), contact.coulomb
        # a method that does not meet the constraints at all levels may end a little before its force is zero
        leaves[i] = coulomb is None or slid[i] == IDLE or force <= no_force[i]
        if leaves[i] or coulomb is None:
            continue
        # a force is found less finely than a velocity: the event is of what is nearer to zero
        part = force / strongest[i]
        if slid[i] == STICKS:
            friction = -float(arrays["lam"][contact.slide_row])
            if abs(friction) >= coulomb.sticking_coefficient * force * (1.0 - AT_LIMIT):
                slips[i] = -np.sign(friction)
            else:
                leaves[i] = part <= NEAR_ZERO
        elif abs(slid[i]) == 1.0:
            leaves[i] = part <= NEAR_ZERO and part < abs(float(arrays["phid"][contact.slide_row])) / fastest[i]
            stops[i] |= not leaves[i]
    falls = -arrays["phidd"][[sim.assembly.contacts[k].row for k in contacts]]
    return Settling(contacts, was, slid, memory[contacts, RATIO].copy(), leaves, slips, stops, falls)
