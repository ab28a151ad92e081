"""Mechanisms in minimal coordinates with contacts, by scipy: what third opinions are made of.

Nothing here comes from the solver: M(q) q'' = Q(t, q, q') is integrated by DOP853 from event to event. A contact with
a restitution e is an impact in an instant, J = -(1 + e) g'/(G M^-1 G^T); a contact with a force pushes by it until it
lets go.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

RTOL, ATOL = 1e-12, 1e-13
LONGEST_STEP = 1.0 / 200.0
"""In parts of the run: so that no contact is passed over between two ends of steps."""
CLOSED = 1e-12
"""m; contacts that start closed are no farther apart."""
MOST_TOUCHES = 40
"""Impacts that accumulate have no end."""
SAMPLES = 4001
Array = np.ndarray
Force = Callable[[float, float, float], float]
"""(penetration m, its rate m/s, approach speed m/s) -> N, positive where it pushes."""
Friction = Callable[[float, float], float]
"""(sliding speed m/s, normal force N) -> N along the sliding direction."""


@dataclass(frozen=True)
class Law:
    """A contact's law: a restitution, or a force that ends at zero ("force") or with the penetration ("gap")."""

    restitution: float | None = None
    force: Force | None = None
    release: str = "gap"
    friction: Friction | None = None


@dataclass(frozen=True)
class Mechanism:
    """M(q) q'' = force(t, q, v), with gaps g(q) (k,), their gradients G(q) (k, n), and sliding speeds S(q) v + s.

    Friction goes with contacts that are forces.
    """

    mass: Callable[[Array], Array]
    force: Callable[[float, Array, Array], Array]
    gaps: Callable[[Array], Array] = lambda q: np.zeros(0)
    gradients: Callable[[Array], Array] = lambda q: np.zeros((0, len(q)))
    laws: Sequence[Law] = ()
    slides: Callable[[Array], Array] | None = None
    belt: Array | float = 0.0
    """s (k,), m/s."""


@dataclass(frozen=True)
class Blow:
    """One contact from touch to release; s, m/s, N s, N (0 for an impact in an instant)."""

    contact: int
    start: float
    end: float
    approach_speed: float
    separation_speed: float
    impulse: float
    peak_force: float = 0.0


@dataclass
class Course:
    """What became of a mechanism: its state at any time until `end`, and its blows."""

    starts: list[float] = field(default_factory=list)
    pieces: list[Callable[[Any], Array]] = field(default_factory=list)
    blows: list[Blow] = field(default_factory=list)
    end: float = 0.0
    size: int = 0

    def go_on(
        self,
        rates: Callable[[float, Array], Any],
        y: Array,
        t_end: float,
        events: Sequence[Callable[[float, Array], float]],
        longest: float = math.inf,
    ) -> tuple[Array, int | None]:
        """Integrate y = (q, v, ...) on to `t_end` (s) or the first of the events, with steps of at most `longest` (s).

        Returns y there and the event's number, None at `t_end`.
        """
        part = solve_ivp(
            rates, (self.end, t_end), y, "DOP853", events=events, rtol=RTOL, atol=ATOL, dense_output=True,
            max_step=longest,
        )  # fmt: skip
        self.starts.append(self.end)
        self.pieces.append(part.sol)
        self.end = float(part.t[-1])
        happened = (number for number, times in enumerate(part.t_events) if times.size)
        return part.y[:, -1].copy(), next(happened) if part.status == 1 else None

    def state(self, t: float) -> tuple[Array, Array]:
        """(q, v) at t; NaN after the end. At an impact: after it."""
        n = self.size
        if t > self.end * (1.0 + 1e-12):
            return np.full(n, math.nan), np.full(n, math.nan)
        y = self.pieces[max(bisect_right(self.starts, t) - 1, 0)](min(t, self.end))
        return y[:n], y[n : 2 * n]

    def q(self, k: int) -> Callable[[float], float]:
        """Coordinate k as a function of time."""
        return lambda t: float(self.state(t)[0][k])

    def v(self, k: int) -> Callable[[float], float]:
        """Its rate."""
        return lambda t: float(self.state(t)[1][k])


class _Run:
    """The integration: y = (q, v, impulses of the contacts since they touched)."""

    def __init__(self, mechanism: Mechanism, q: Sequence[float], t_end: float) -> None:
        self.m, self.n, self.k, self.t_end = mechanism, len(q), len(mechanism.laws), t_end
        self.pushing: dict[int, tuple[float, float]] = {}
        """Contact -> (since when, with which approach speed)."""

    def push(self, contact: int, y: Array) -> float:
        """Force of a contact that touches, N."""
        n, law = self.n, self.m.laws[contact]
        gap, rate = self.m.gaps(y[:n])[contact], self.m.gradients(y[:n])[contact] @ y[n : 2 * n]
        if law.force is None:
            return 0.0
        force = law.force(max(-gap, 0.0), -rate, self.pushing[contact][1])
        return max(force, 0.0) if law.release == "force" else force

    def rates(self, t: float, y: Array) -> Array:
        n = self.n
        q, v = y[:n], y[n : 2 * n]
        force, pushed = np.array(self.m.force(t, q, v), dtype=float), np.zeros(self.k)
        for contact in self.pushing:
            pushed[contact] = normal = self.push(contact, y)
            force += normal * self.m.gradients(q)[contact]
            rubs = self.m.laws[contact].friction
            if rubs is not None and self.m.slides is not None and normal > 0.0:
                along = self.m.slides(q)[contact]
                force += rubs(float(along @ v) + np.broadcast_to(self.m.belt, self.k)[contact], normal) * along
        return np.concatenate([v, np.linalg.solve(self.m.mass(q), force), pushed])

    def event(self, contact: int) -> Callable[[float, Array], float]:
        """Zero where an open contact touches, or a closed one lets go."""
        n = self.n
        since = self.pushing.get(contact)
        law = self.m.laws[contact]
        if since is not None and law.release == "force" and law.force is not None:
            raw, start, speed = law.force, *since

            def falls(t: float, y: Array) -> float:
                gap, rate = self.m.gaps(y[:n])[contact], self.m.gradients(y[:n])[contact] @ y[n : 2 * n]
                return raw(max(-gap, 0.0), -rate, speed) if t > start else 1.0

            found = falls
        else:
            found = lambda t, y: float(self.m.gaps(y[:n])[contact])  # noqa: E731
        found.terminal = True  # type: ignore[attr-defined]
        found.direction = 1.0 if since is not None and law.release == "gap" else -1.0  # type: ignore[attr-defined]
        return found


def run(
    mechanism: Mechanism, q: Sequence[float], v: Sequence[float], t_end: float, blows: int = MOST_TOUCHES
) -> Course:
    """Integrate from (q, v) at t = 0 to `t_end` (s), or to the end of so many blows."""
    work = _Run(mechanism, q, t_end)
    n, k = work.n, work.k
    course = Course(size=n)
    y = np.concatenate([np.asarray(q, dtype=float), np.asarray(v, dtype=float), np.zeros(k)])
    for contact in np.flatnonzero(np.abs(mechanism.gaps(y[:n])) < CLOSED).tolist():
        rate = float(mechanism.gradients(y[:n])[contact] @ y[n : 2 * n])
        if rate <= 0.0 and mechanism.laws[contact].force is not None:
            work.pushing[contact] = (0.0, -rate)
    while course.end < t_end and len(course.blows) < blows:
        y, touched = course.go_on(work.rates, y, t_end, [work.event(c) for c in range(k)], LONGEST_STEP * t_end)
        if touched is None:
            break
        y = _switched(work, course, touched, course.end, y)
    return course


def _switched(work: _Run, course: Course, contact: int, t: float, y: Array) -> Array:
    """The state after an event of a contact."""
    n, law = work.n, work.m.laws[contact]
    row = work.m.gradients(y[:n])[contact]
    rate = float(row @ y[n : 2 * n])
    if contact in work.pushing:
        start, speed = work.pushing.pop(contact)
        top = _top(work, course, contact, start, speed, t)
        course.blows.append(Blow(contact, start, t, speed, rate, float(y[2 * n + contact]), top))
    elif law.restitution is not None:
        answer = np.linalg.solve(work.m.mass(y[:n]), row)
        impulse = -(1.0 + law.restitution) * rate / float(row @ answer)
        y[n : 2 * n] += impulse * answer
        course.blows.append(Blow(contact, t, t, -rate, -law.restitution * rate, impulse))
    else:
        work.pushing[contact] = (t, -rate)
        y[2 * n + contact] = 0.0
    return y


def _top(work: _Run, course: Course, contact: int, start: float, speed: float, end: float) -> float:
    """Largest force of a blow, by sampling its course (error: the square of a sample's distance)."""
    work.pushing[contact] = (start, speed)
    forces = []
    for t in np.linspace(start, end, SAMPLES)[:-1]:
        piece = course.pieces[max(bisect_right(course.starts, t) - 1, 0)]
        forces.append(work.push(contact, piece(t)))
    del work.pushing[contact]
    return max(forces)
