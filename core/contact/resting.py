"""Forces of the contacts that touch at one instant: which of them stay closed, and which stick, slide or are held.

With dependent directions (a body on two feet) sticking friction is not unique: one of them has the sliding distance
as a constraint, the others carry a constant share of their normal force (IDLE, with their RATIO) until the first
reaches its limit; then it keeps that limit and another takes the rest, or all let go.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from ..rounding import FORCE_ROUNDING, NO_ACCELERATION, NO_SLIDING, PERHAPS_REST
from .complementarity import MANY, RANK, ContactSolution, farthest, independent, solve_contacts
from .lcp import NoComplementarySolution
from .modes import CLOSED, IDLE, STICKS
from .painleve import no_solution, painleve
from .settling import AT_LIMIT, Settling, comes_back, unresolved_speed
from .touching import Touching

if TYPE_CHECKING:
    from ..integrate.engine import Engine

Vector = NDArray[np.float64]
Flags = NDArray[np.bool_]

NEARLY_SINGULAR = 1e-6
"""Part of a contact's inverse effective mass that friction leaves where it is about to jam."""
SPARE = 1e-6
"""Part of its limit that a new distribution of sticking friction must leave to each contact."""

RANK_OF_MANY, LOOSEST_RANK = 1e-6, 1e-4
"""Parts of an inverse mass: directions of many contacts that differ by less are taken for one; and at an instant that
does not settle. To bring rates of rounding's size to zero takes motions larger by one over the root of that."""
AHEAD, FARTHEST_AHEAD = 1e-9, 1e-6
"""How far the mechanism is moved, of its size, to see what holds a moment later: at the second event of an instant, and
ten times farther at each of the following ones, but not beyond."""


class Resting:
    """The touching contacts at acceleration level, after what the velocities tell.

    Attributes
    ----------
    at_rest : neither separating nor approaching, (contacts,).
    known : +-1 where the contact slides, 0 where friction decides, (contacts,).
    direction : the same after `forces`, which finds those that begin to slide.
    """

    def __init__(
        self, sim: "Engine", touching: Touching, now: Settling, rounding: Vector, accelerations: float = 0.0
    ) -> None:
        self.sim, self.touching, self.now = sim, touching, now
        self.rounding = rounding
        laws = [c.coulomb for c in touching.infos]
        self.kinetic = np.array([law.coefficient if law else 0.0 for law in laws])
        self.static = np.array([law.sticking_coefficient if law else 0.0 for law in laws])
        self._look()
        self.at_rest: Flags = np.abs(self.gap_rate) <= rounding
        if not now.struck:
            # a constraint that holds does not separate, however much its method drifts
            self.at_rest |= now.was == CLOSED
        slow = np.abs(self.gap_rate) <= PERHAPS_REST * sim.rate_size(now.contacts)
        if np.any(slow) or not now.struck:
            self._prepare(accelerations)
            self._hold(self._soon_back(self.b_n))

    def _look(self) -> None:
        """Read the velocities."""
        now = self.now
        self.gap_rate, self.slide_rate = self.touching.rates()
        self.known: Vector = np.where(np.abs(self.slide_rate) > self.rounding, np.sign(self.slide_rate), 0.0)
        if not now.struck:
            closed = now.was == CLOSED
            # one that did not slide by itself, since others held it, may already go the other way by a little
            turned = self.sim.formula.exact & (now.slid * self.slide_rate < -self.rounding)
            slides = closed & (np.abs(now.slid) == 1.0) & (turned | ~now.stops)
            ways = np.where(turned, np.sign(self.slide_rate), now.slid)
            self.known[closed] = np.where(slides, ways, 0.0)[closed]

    def _soon_back(self, motion: Vector) -> Flags:
        """Gaps that open but, with these accelerations, less than could be told from zero."""
        slow = (self.gap_rate > 0.0) & (self.gap_rate <= unresolved_speed(self.sim, self.now.contacts, -motion))
        return np.asarray(slow & ~self.at_rest)

    def _hold(self, back: Flags) -> None:
        """Contacts `back` are at rest too: take what is left of their rates away."""
        if not np.any(back):
            return
        self.at_rest = self.at_rest | back
        if not self.sim.formula.exact:
            return
        normals = np.flatnonzero(self.at_rest)
        stuck = np.flatnonzero(self.at_rest & (self.static > 0.0) & (self.known == 0.0))
        rates = np.concatenate([self.gap_rate[normals], self.slide_rate[stuck]])
        impulses = -np.linalg.lstsq(self.touching.a.rows(normals, stuck), rates, rcond=RANK)[0]
        push, along = np.zeros(len(back)), np.zeros(len(back))
        push[normals], along[stuck] = impulses[: len(normals)], impulses[len(normals) :]
        self.touching.push(push, along)
        self._look()

    # ---- forces -----------------------------------------------------------------------------------------------------

    def forces(self) -> ContactSolution:
        """Forces of all touching contacts (zero where they separate).

        Raises
        ------
        SimulationError : if there are none (Painleve's paradox).
        """
        self.takes: Flags = self.at_rest & ~self.now.leaves
        self.direction: Vector = self.known
        self.full: Flags = np.zeros(len(self.direction), dtype=bool)
        self.slipping = False
        found = self._balance()
        for _ in range(len(self.at_rest)):
            # one that opens so slowly that it falls back at once
            back = self._soon_back(found.normal_motion)
            if not np.any(back):
                break
            self._hold(back)
            self.takes = self.takes | back
            found = self._balance()
        spread = self._spread(found)
        if spread is not None:
            first = self.direction, self.full, self.takes, self.slipping
            self.takes = spread
            again = self._balance()
            if np.all(self._loaded(again)[spread]):
                found = again
            else:
                self.direction, self.full, self.takes, self.slipping = first
        self._refuse_jam(found)
        return found

    def _balance(self) -> ContactSolution:
        """Forces of the contacts `takes`."""
        slips = self.now.slips
        self.direction, self.full, self.slipping = self.known, np.zeros(len(slips), dtype=bool), False
        if np.any(slips):
            held = self._held()
            if held is not None:
                return held
            self.slipping = True
            self.direction = np.where(slips != 0.0, slips, self.direction)
        for _ in range(len(slips) + 1):
            mu = np.where(self.direction != 0.0, self.kinetic, self.static)
            found = self._solve(self.direction, mu)
            begins = self._begins(found)
            again = bool(np.any(begins & (self.kinetic != self.static)))
            self.direction = np.where(begins, -np.sign(found.tangential), self.direction)
            if not again:
                break
        return found

    def _spread(self, found: ContactSolution) -> Flags | None:
        """Of contacts whose normals repeat each other, those that lie farthest apart: on them a body stands firmly.
        None if there are none, or if nothing asks for a new choice."""
        loaded = self._loaded(found)
        if not (self.now.struck or np.any(loaded & (self.now.was != CLOSED))):
            return None
        still = np.flatnonzero(self.takes & (np.abs(found.normal_motion) <= 1e3 * self.none * self.size))
        apart = farthest(self.touching.a.nn, still)
        if len(apart) == len(still) or np.all(loaded[apart]):
            return None
        flags = np.zeros(len(loaded), dtype=bool)
        flags[apart] = True
        return flags

    def _ahead(self) -> float:
        """How far ahead accelerations are looked at, s: where a geometry's curvature jumps (a corner is passed), the
        present point may lie before the jump by rounding, and what holds behind it decides. 0 at first."""
        again = self.sim.events_here - 1
        if again < 1:
            return 0.0
        workspace, assembly = self.sim.workspace, self.sim.assembly
        speed = float(np.max(np.abs(workspace.arrays["v"][: assembly.n]) / assembly.coordinate_scale))
        if speed == 0.0:
            return 0.0
        return min(AHEAD * 10.0 ** (again - 1), FARTHEST_AHEAD) / speed

    def _prepare(self, accelerations: float) -> None:
        """Free accelerations of gaps and sliding distances, with zero for what is rounding."""
        touching = self.touching
        b_n, b_t = touching.free_accelerations(self._ahead())
        arrays, n = self.sim.workspace.arrays, self.sim.assembly.n
        scale = self.sim.assembly.coordinate_scale
        level = max(float(np.max(np.abs(arrays["a"][:n]) / scale, initial=0.0)), accelerations, 1e-300)
        self.none = NO_ACCELERATION * level
        self.size = np.max(np.abs(touching.normal) * scale, axis=1)
        noise_n, noise_t = touching.motion_noise(self.sim.force_noise())
        self.b_n = np.where(np.abs(b_n) <= np.maximum(self.none * self.size, noise_n), 0.0, b_n)
        along = np.max(np.abs(touching.tangential) * scale, axis=1)
        self.b_t = np.where(np.abs(b_t) <= np.maximum(self.none * along, noise_t), 0.0, b_t)

    def _solve(self, direction: Vector, mu: Vector) -> ContactSolution:
        for _ in range(2):
            try:
                found = self._with(self.takes, direction, mu)
            except NoComplementarySolution as error:
                message = no_solution(self.touching, self.kinetic)
                raise SimulationError(message, t=self.sim.t_internal, loop="contact") from error
            # one that leaves does so unless the others' forces press it together again
            back = self.at_rest & ~self.takes & (found.normal_motion < -1e3 * self.none * self.size)
            if not (self.sim.formula.exact and np.any(back)):
                break
            self.takes = self.takes | back
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
                found = self._with(self.takes, direction, mu)
            except NoComplementarySolution:
                continue
            loaded = self._loaded(found)
            free = loaded & (direction == 0.0) & (self.static > 0.0)
            if np.any(np.abs(found.tangential[free]) >= self.static[free] * found.normal[free] * (1.0 - spare)):
                continue
            sticking = np.flatnonzero(free)
            if not np.any(free) or any(self._moves(found, sticking, int(i)) for i in np.flatnonzero(known * loaded)):
                continue
            self.full = known != 0.0
            return found
        return None

    def _loaded(self, found: ContactSolution) -> Flags:
        size = self.sim.gap_size(self.now.contacts)
        largest = max(self.sim.scales.energy, float(np.max(found.normal * size, initial=0.0)))
        return np.asarray(found.normal > FORCE_ROUNDING * largest / size)

    def sticking(self, found: ContactSolution) -> NDArray[np.intp]:
        """Contacts with friction below its limit (or below it in any case: the least distribution was found); those
        with the highest limits first."""
        limit = self.static * found.normal
        below = (np.abs(found.tangential) < limit * (1.0 - AT_LIMIT)) | (limit == 0.0)
        if not self.slipping:
            # blocks that ride on one another need just the limit
            below |= self._stays(found)
        if found.sticks and not self.slipping:
            below[:] = True
        some = np.flatnonzero((self.static > 0.0) & (self.direction == 0.0) & below & ~self.full & self.at_rest)
        return some[np.argsort(-limit[some], kind="stable")]

    def _stays(self, found: ContactSolution) -> Flags:
        """Contacts without an acceleration along their tangent but for rounding."""
        a = self.touching.a
        terms = np.abs(self.b_t) + np.abs(a.nt.T) @ found.normal + np.abs(a.tt) @ np.abs(found.tangential)
        return np.asarray(np.abs(found.tangential_motion) <= NO_SLIDING * terms)

    def _begins(self, found: ContactSolution) -> Flags:
        """Contacts at the limit of their friction that no others hold."""
        loaded, sticking = self._loaded(found), self.sticking(found)
        begins = loaded & (self.static > 0.0) & (self.direction == 0.0)
        begins[sticking] = False
        sticking = sticking[loaded[sticking]]
        for i in np.flatnonzero(begins):
            begins[i] = self._moves(found, sticking, int(i))
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
            closed |= (now.was == CLOSED) & ~now.leaves & (np.abs(found.normal_motion) <= self.none * self.size)
        idle = self.at_rest & ~closed & ~now.leaves
        if np.any(idle):
            # or left open at this very instant, and every step closes them at once
            again = (self.b_n == 0.0) & (found.normal_motion == 0.0) & (self.sim.events_here > 2)
            closed |= idle & (
                again | comes_back(self.sim, now.contacts, self.touching.free_jerks(), found.normal_motion)
            )
        self._found, self._closed = found, closed
        first = RANK if len(self.takes) <= MANY else RANK_OF_MANY
        return self.keep(min(first * 100.0 ** max(self.sim.events_here - 2, 0), LOOSEST_RANK))

    def keep(self, rank: float) -> dict[int, tuple[float, float]]:
        """Those that `choose` has found which do not repeat each other, to `rank`. Contacts that do so nearly need
        large forces against each other to move as constraints say: where an instant does not settle, more and more of
        them count as one."""
        now, found, closed, self.rank = self.now, self._found, self._closed, rank
        sticking = self.sticking(found)
        sticking = sticking[closed[sticking]]
        normals = np.flatnonzero(closed)[np.argsort(-found.normal[closed], kind="stable")]
        kept_n, kept_t = independent(self.touching.a, normals, sticking, rank)
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
                t = self.sim.t_internal
                raise SimulationError(
                    painleve(self.touching.infos[i].name, t, float(self.kinetic[i])), t=t, loop="contact"
                )
