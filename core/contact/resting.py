"""Forces of the contacts that touch at one instant: which of them stay closed, and which stick, slide or are held.

With dependent directions (a body on two feet) sticking friction is not unique: one of them has the sliding distance
as a constraint, the others carry a constant share of their normal force (IDLE, with their RATIO) until the first
reaches its limit; then it keeps that limit and another takes the rest, or all let go.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from .complementarity import ContactSolution, independent, solve_contacts
from .lcp import NoComplementarySolution
from .modes import CLOSED, IDLE, MODE, RATIO, SLIDE, STICKS
from .touching import Touching

if TYPE_CHECKING:
    from ..integrate.engine import Engine

Vector = NDArray[np.float64]
Flags = NDArray[np.bool_]

NO_FORCE = 1e-12
"""A contact force below this part of the largest is none."""
NO_ACCELERATION = 1e-11
"""A gap's acceleration below this part of what weights and forces make is none."""
NEARLY_SINGULAR = 1e-6
"""Part of a contact's inverse effective mass that friction leaves where it is about to jam."""
AT_LIMIT = 1e-9
"""Friction within this part of its limit has reached it."""
SPARE = 1e-6
"""Part of its limit that a new distribution of sticking friction must leave to each contact."""
UNRESOLVED = 1e-14
"""Of the largest coordinate (or of 1 m): bounces that are lower than this are not told from rest."""
PERHAPS_REST = 1e-3
"""Of the largest speed (or of 1 m/s): gaps that open faster than this are not at rest."""


def speed(sim: "Engine") -> float:
    """The largest of the present velocities."""
    return float(np.max(np.abs(sim.workspace.arrays["v"][: sim.assembly.n])))


def unresolved_speed(sim: "Engine", falls: Vector) -> Vector:
    """Speed of separation below which a gap with the acceleration -falls (m/s^2) cannot be seen to open, m/s."""
    size = max(1.0, float(np.max(np.abs(sim.workspace.arrays["q"][: sim.assembly.n]))))
    return np.asarray(np.sqrt(2.0 * UNRESOLVED * size * np.maximum(falls, 0.0)))


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
    no_force, rounding = sim.no_force(), sim.rate_rounding()
    for i, k in enumerate(contacts):
        contact = sim.assembly.contacts[k]
        if was[i] != CLOSED:
            continue
        if contact.coulomb is not None and abs(slid[i]) == 1.0:
            rate, acceleration = (float(arrays[level][contact.slide_row]) for level in ("phid", "phidd"))
            # what moves with another that stops does so at the same time
            stops[i] = abs(rate) <= rounding and slid[i] * acceleration < 0.0
        if k not in pending:
            continue
        force = -float(arrays["lam"][contact.row])
        # a method that does not meet the constraints at all levels may end a little before its force is zero
        leaves[i] = contact.coulomb is None or slid[i] == IDLE or force <= no_force
        if leaves[i] or contact.coulomb is None:
            continue
        if slid[i] == STICKS:
            friction = -float(arrays["lam"][contact.slide_row])
            if abs(friction) >= contact.coulomb.sticking_coefficient * force * (1.0 - AT_LIMIT):
                slips[i] = -np.sign(friction)
        elif abs(slid[i]) == 1.0:
            stops[i] = True
    falls = -arrays["phidd"][[sim.assembly.contacts[k].row for k in contacts]]
    return Settling(contacts, was, slid, memory[contacts, RATIO].copy(), leaves, slips, stops, falls)


class Resting:
    """The touching contacts at acceleration level, after what the velocities tell.

    Attributes
    ----------
    at_rest : neither separating nor approaching, (contacts,).
    direction : +-1 where the contact slides, 0 where friction decides, (contacts,).
    """

    def __init__(
        self, sim: "Engine", touching: Touching, now: Settling, rounding: float, accelerations: float = 0.0
    ) -> None:
        self.sim, self.touching, self.now = sim, touching, now
        gap_rate, slide_rate = touching.rates()
        self.at_rest: Flags = np.abs(gap_rate) <= rounding
        if np.any(np.abs(gap_rate) <= PERHAPS_REST * max(1.0, speed(sim))) or not now.struck:
            self._prepare(accelerations)
            self.at_rest |= (gap_rate > 0.0) & (gap_rate <= unresolved_speed(sim, -self.b_n))
        self.direction: Vector = np.where(np.abs(slide_rate) > rounding, np.sign(slide_rate), 0.0)
        laws = [c.coulomb for c in touching.infos]
        self.kinetic = np.array([law.coefficient if law else 0.0 for law in laws])
        self.static = np.array([law.sticking_coefficient if law else 0.0 for law in laws])
        if now.struck:
            return
        closed = now.was == CLOSED
        # a constraint that holds does not separate, however much its method drifts
        self.at_rest |= closed
        slides = closed & (np.abs(now.slid) == 1.0) & ~now.stops
        self.direction[closed] = np.where(slides, now.slid, 0.0)[closed]

    # ---- forces -----------------------------------------------------------------------------------------------------

    def forces(self) -> ContactSolution:
        """Forces of all touching contacts (zero where they separate); `direction` is completed by those that begin to
        slide.

        Raises
        ------
        SimulationError : if there are none (Painleve's paradox).
        """
        slips, self.full = self.now.slips, np.zeros(len(self.direction), dtype=bool)
        if np.any(slips):
            found = self._held()
            if found is not None:
                return found
            self.direction = np.where(slips != 0.0, slips, self.direction)
        for _ in range(len(slips) + 1):
            mu = np.where(self.direction != 0.0, self.kinetic, self.static)
            found = self._solve(self.direction, mu)
            begins = self._begins(found)
            again = bool(np.any(begins & (self.kinetic != self.static)))
            self.direction = np.where(begins, -np.sign(found.tangential), self.direction)
            if not again:
                break
        self._refuse_jam(found)
        return found

    def _prepare(self, accelerations: float) -> None:
        """Free accelerations of gaps and sliding distances, with zero for what is rounding."""
        touching = self.touching
        b_n, b_t = touching.free_accelerations()
        arrays, n = self.sim.workspace.arrays, self.sim.assembly.n
        level = max(float(np.max(np.abs(arrays["a"][:n]), initial=0.0)), accelerations, 1e-300)
        self.none = NO_ACCELERATION * level
        self.size = np.max(np.abs(touching.normal), axis=1)
        self.b_n = np.where(np.abs(b_n) <= self.none * self.size, 0.0, b_n)
        along = np.max(np.abs(touching.tangential), axis=1)
        self.b_t = np.where(np.abs(b_t) <= self.none * along, 0.0, b_t)

    def _solve(self, direction: Vector, mu: Vector) -> ContactSolution:
        takes = self.at_rest & ~self.now.leaves
        for _ in range(2):
            try:
                found = self._with(takes, direction, mu)
            except NoComplementarySolution as error:
                raise SimulationError(self._no_solution(), t=self.sim.t_internal, loop="contact") from error
            # one that leaves does so unless the others' forces press it together again
            back = self.at_rest & ~takes & (found.normal_motion < -1e3 * self.none * self.size)
            if not (self.sim.formula.exact and np.any(back)):
                break
            takes |= back
        return found

    def _with(self, takes: Flags, direction: Vector, mu: Vector) -> ContactSolution:
        """The solution with the contacts `takes`; the others get no force."""
        a, some, b_n, b_t = self.touching.a, np.flatnonzero(takes), self.b_n, self.b_t
        found = solve_contacts(a.among(some), b_n[some], b_t[some], mu[some], direction[some])
        normal, tangential = np.zeros(len(b_n)), np.zeros(len(b_n))
        normal[some], tangential[some] = found.normal, found.tangential
        return ContactSolution(
            normal, tangential, b_n + a.nn @ normal + a.nt @ tangential, b_t + a.nt.T @ normal + a.tt @ tangential,
            found.sticks,
        )  # fmt: skip

    def _held(self) -> ContactSolution | None:
        """Contacts that reach the limit of their friction need not slide: others may hold them. The solution for that,
        or None if they slide."""
        now = self.now
        at_limit = (now.was == CLOSED) & (now.slid == IDLE) & (np.abs(now.ratio) >= self.static * (1.0 - AT_LIMIT))
        full = np.where(now.slips != 0.0, now.slips, np.where(at_limit, -np.sign(now.ratio), 0.0))
        # those at their limit keep it, others take the rest; or all is distributed anew
        for known, spare in ((full, AT_LIMIT), (np.zeros(len(full)), SPARE)):
            direction = np.where(self.direction != 0.0, self.direction, known)
            mu = np.where(self.direction != 0.0, self.kinetic, self.static)
            try:
                found = self._with(self.at_rest & ~now.leaves, direction, mu)
            except NoComplementarySolution:
                continue
            loaded = self._loaded(found)
            free = loaded & (direction == 0.0) & (self.static > 0.0)
            if np.any(np.abs(found.tangential[free]) >= self.static[free] * found.normal[free] * (1.0 - spare)):
                continue
            sticking = np.flatnonzero(free)
            if not np.any(free) or any(self._moves(found, sticking, i) for i in np.flatnonzero(known * loaded)):
                continue
            self.full = known != 0.0
            return found
        return None

    def _loaded(self, found: ContactSolution) -> Flags:
        return np.asarray(found.normal > NO_FORCE * max(1.0, float(np.max(found.normal, initial=0.0))))

    def sticking(self, found: ContactSolution) -> NDArray[np.intp]:
        """Contacts with friction below its limit (or below it in any case: the least distribution was found); those
        with the highest limits first."""
        limit = self.static * found.normal
        below = found.sticks | (np.abs(found.tangential) < limit * (1.0 - AT_LIMIT)) | (limit == 0.0)
        some = np.flatnonzero((self.static > 0.0) & (self.direction == 0.0) & below & ~self.full & self.at_rest)
        return some[np.argsort(-limit[some], kind="stable")]

    def _begins(self, found: ContactSolution) -> Flags:
        """Contacts at the limit of their friction that no others hold."""
        loaded, sticking = self._loaded(found), self.sticking(found)
        begins = loaded & (self.static > 0.0) & (self.direction == 0.0)
        begins[sticking] = False
        sticking = sticking[loaded[sticking]]
        for i in np.flatnonzero(begins):
            begins[i] = self._moves(found, sticking, i)
        return begins

    def _moves(self, found: ContactSolution, sticking: NDArray[np.intp], i: int) -> bool:
        """True if closed gaps and those that stick leave contact i free to slide."""
        normals = np.flatnonzero(self._loaded(found))
        return len(sticking) in independent(self.touching.a, normals, np.append(sticking, i))[1]

    # ---- what it means ----------------------------------------------------------------------------------------------

    def choose(self) -> dict[int, tuple[float, float]]:
        """The contacts that stay closed, and how each moves along its tangent: values of SLIDE and RATIO."""
        if not np.any(self.at_rest):
            return {}
        now, found = self.now, self.forces()
        closed = self._loaded(found)
        if not now.struck:
            # touching without force: as it was
            closed |= (now.was == CLOSED) & ~now.leaves & (np.abs(found.normal_motion) <= self.none)
        sticking = self.sticking(found)
        sticking = sticking[closed[sticking]]
        normals = np.flatnonzero(closed)[np.argsort(-found.normal[closed], kind="stable")]
        kept_n, kept_t = independent(self.touching.a, normals, sticking)
        sticks = {int(sticking[j]) for j in kept_t}
        chosen: dict[int, tuple[float, float]] = {}
        for i in (int(normals[j]) for j in kept_n):
            if i in sticks:
                slide, ratio = STICKS, 0.0
            elif self.direction[i] != 0.0 and self.touching.infos[i].coulomb is not None:
                slide, ratio = self.direction[i], -self.kinetic[i] * self.direction[i]
            else:
                slide, ratio = IDLE, found.tangential[i] / found.normal[i] if found.normal[i] > 0.0 else 0.0
            chosen[now.contacts[i]] = float(slide), float(ratio)
        return chosen

    # ---- refusals ---------------------------------------------------------------------------------------------------

    def _refuse_jam(self, found: ContactSolution) -> None:
        """Painleve's paradox: friction turns the effect of the normal force round."""
        a = self.touching.a
        for i in np.flatnonzero((self.direction != 0.0) & (self.kinetic > 0.0)):
            left = a.nn[i, i] - self.kinetic[i] * self.direction[i] * a.nt[i, i]
            if left > NEARLY_SINGULAR * a.nn[i, i]:
                continue
            if found.normal[i] > 0.0 or self.now.was[i] == CLOSED:
                message = self._painleve(self.touching.infos[i].name, float(self.kinetic[i]))
                raise SimulationError(message, t=self.sim.t_internal, loop="contact")

    def _painleve(self, name: str, mu: float) -> str:
        return (
            f"contact '{name}', t = {self.sim.t_internal:.9g} s: Painleve's paradox. Sliding with mu = {mu:g}, the "
            "friction presses the bodies together more than the normal force keeps them apart, so that rigid bodies "
            "with Coulomb friction have no (or no unique) accelerations here: use a smaller coefficient, or a force "
            "law with regularised friction for this contact"
        )

    def _no_solution(self) -> str:
        a = self.touching.a
        for i, contact in enumerate(self.touching.infos):
            if self.kinetic[i] > 0.0 and a.nn[i, i] <= self.kinetic[i] * abs(a.nt[i, i]):
                return self._painleve(contact.name, float(self.kinetic[i]))
        names = ", ".join(f"'{c.name}'" for c in self.touching.infos)
        return (
            f"contacts {names}, t = {self.sim.t_internal:.9g} s: no contact forces satisfy complementarity and "
            "friction at once (Painleve's paradox of several contacts): use smaller friction coefficients, or force "
            "laws"
        )
