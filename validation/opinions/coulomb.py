"""Impacts and Coulomb's friction between coordinates of constant mass matrix, by scipy: event to event.

M q'' = f(q, v) + G^T n + S^T r, with gaps g = g0 + G q, sliding speeds S q', and Coulomb's r in -mu n Sgn(S q'). Which
contacts hold, stick or slip is found by trying all combinations: at an impact for the velocities after it, with
Newton's G v+ >= -e G v-, and after every event for the accelerations.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from .mechanism import LONGEST_STEP, Array, Course

TOUCHES, RESTS = 1e-11, 1e-9
"""m and m/s: below, a gap or a speed is zero, after the event that made it so."""
ROUNDING = 1e-9
"""Of impulses and forces, relative."""
OPEN, STICK, AHEAD, BACK = "open", "stick", "ahead", "back"
SIGN = {AHEAD: 1.0, BACK: -1.0}
MOST_EVENTS = 2000


@dataclass(frozen=True)
class Rubbing:
    """M (n, n), f(q, v) (n,), gaps g0 (k,) + G (k, n) q, slides S (k, n), mu (k,), restitution e (k,)."""

    mass: Array
    force: Callable[[Array, Array], Array]
    offsets: Array
    gradients: Array
    slides: Array
    friction: Array
    restitution: Array


@dataclass
class RubbingCourse(Course):
    """A course with the impulse of each contact over the whole run, N s."""

    impulses: Array = field(default_factory=lambda: np.zeros(0))


def run(system: Rubbing, q: Sequence[float], v: Sequence[float], t_end: float) -> RubbingCourse:
    """Integrate from (q, v) at t = 0 to `t_end` (s). Raises ArithmeticError where no combination of modes fits."""
    n, k = len(q), len(system.offsets)
    inverse = np.linalg.inv(system.mass)
    course = RubbingCourse(size=n)
    y = np.concatenate([np.asarray(q, dtype=float), np.asarray(v, dtype=float), np.zeros(k)])
    ended: tuple[int, str] | None = None
    for _ in range(MOST_EVENTS):
        y = _struck(system, inverse, y)
        modes = _modes(system, inverse, y, ended)
        ways, watches = _watches(system, inverse, modes, course.end)

        def rates(t: float, y: Array, modes: dict[int, str] = modes) -> Array:
            return _rates(system, inverse, y, modes)

        y, event = course.go_on(rates, y, t_end, watches, LONGEST_STEP * t_end)
        if event is None:
            break
        ended = ways[event]
    course.impulses = y[2 * n :]
    return course


def _struck(system: Rubbing, inverse: Array, y: Array) -> Array:
    """The state after the impact of the contacts that touch, if any of them approaches."""
    n = len(inverse)
    q, v = y[:n], y[n : 2 * n]
    touching: list[int] = np.flatnonzero(system.offsets + system.gradients @ q < TOUCHES).tolist()
    before = system.gradients @ v
    if not any(before[c] < -RESTS for c in touching):
        return y

    def fits(modes: dict[int, str], impulse: Array, rub: Array, after: Array) -> bool:
        return all(
            system.gradients[c] @ after >= -system.restitution[c] * before[c] - RESTS if modes[c] == OPEN else True
            for c in modes
        )

    goal = {c: -system.restitution[c] * min(float(before[c]), 0.0) for c in touching}
    speeds = dict.fromkeys(touching)
    _, push, after = _solved(system, inverse, v, goal, speeds, fits)
    found = y.copy()
    found[n : 2 * n] = after
    found[2 * n :] += push
    return found


def _modes(system: Rubbing, inverse: Array, y: Array, ended: tuple[int, str] | None) -> dict[int, str]:
    """Mode of every contact, from the accelerations that fit; `ended` is the way of a contact that can not go on."""
    n = len(inverse)
    q, v = y[:n], y[n : 2 * n]
    gaps, rates, speeds = system.offsets + system.gradients @ q, system.gradients @ v, system.slides @ v
    closed = [c for c in range(len(gaps)) if gaps[c] < TOUCHES and rates[c] < RESTS]
    free = inverse @ system.force(q, v)
    known = {c: None if abs(speeds[c]) < RESTS else float(np.sign(speeds[c])) for c in closed}

    def fits(modes: dict[int, str], push: Array, rub: Array, after: Array) -> bool:
        return all(system.gradients[c] @ after >= -RESTS if modes[c] == OPEN else True for c in modes)

    modes, _, _ = _solved(system, inverse, free, dict.fromkeys(closed, 0.0), known, fits, ended)
    return {c: modes.get(c, OPEN) for c in range(len(gaps))}


def _solved(
    system: Rubbing,
    inverse: Array,
    free: Array,
    goal: dict[int, float],
    slips: dict[int, float | None],
    fits: Callable[[dict[int, str], Array, Array, Array], bool],
    ended: tuple[int, str] | None = None,
) -> tuple[dict[int, str], Array, Array]:
    """(modes, pushes (k,), motion (n,)): contacts that hold reach `goal` along G, those with known slip keep it."""
    contacts, k = sorted(goal), len(system.offsets)
    choices = [(STICK, AHEAD, BACK, OPEN) if slips[c] is None else (AHEAD if (slips[c] or 0.0) > 0.0 else BACK, OPEN)
               for c in contacts]  # fmt: skip
    for tried in product(*choices):
        modes = dict(zip(contacts, tried, strict=True))
        if (
            ended is not None
            and ended[0] in modes
            and (modes[ended[0]] == STICK if ended[1] == STICK else modes[ended[0]] != OPEN)
        ):
            continue
        push, rub, motion = _answer(system, inverse, free, goal, modes)
        scale = ROUNDING * max(1e-6, float(np.abs(push).max(initial=0.0)))
        good = fits(modes, push, rub, motion)
        for c in contacts:
            limit, along = system.friction[c] * push[c], float(system.slides[c] @ motion)
            good = good and push[c] >= -scale
            if modes[c] == STICK:
                good = good and abs(rub[c]) <= limit + scale
            elif modes[c] in SIGN and slips[c] is None:
                good = good and SIGN[modes[c]] * along >= -RESTS
        if good:
            found = np.zeros(k)
            found[contacts] = push[contacts]
            return modes, found, motion
    raise ArithmeticError(f"no modes of the contacts {contacts} fit: free motion {free.tolist()}, goals {goal}")


def _answer(
    system: Rubbing, inverse: Array, free: Array, goal: dict[int, float], modes: dict[int, str]
) -> tuple[Array, Array, Array]:
    """(pushes, friction, motion): velocities after impulses or accelerations under forces, both are linear."""
    k = len(system.offsets)
    holding = [c for c in modes if modes[c] != OPEN]
    sticking = [c for c in holding if modes[c] == STICK]
    # a contact that slips pushes along G - sign mu S
    ways = [system.gradients[c] - SIGN.get(modes[c], 0.0) * system.friction[c] * system.slides[c] for c in holding]
    ways += [system.slides[c] for c in sticking]
    wanted = [system.gradients[c] for c in holding] + [system.slides[c] for c in sticking]
    push, rub = np.zeros(k), np.zeros(k)
    if not ways:
        return push, rub, free
    left, right = np.array(wanted), np.array(ways)
    target = np.array([goal[c] for c in holding] + [0.0] * len(sticking)) - left @ free
    found = np.linalg.solve(left @ inverse @ right.T, target)
    push[holding] = found[: len(holding)]
    rub[sticking] = found[len(holding) :]
    return push, rub, free + inverse @ right.T @ found


def _rates(system: Rubbing, inverse: Array, y: Array, modes: dict[int, str]) -> Array:
    n = len(inverse)
    push, _, motion = _forces(system, inverse, y, modes)
    return np.concatenate([y[n : 2 * n], motion, push])


def _forces(system: Rubbing, inverse: Array, y: Array, modes: dict[int, str]) -> tuple[Array, Array, Array]:
    n = len(inverse)
    free = inverse @ system.force(y[:n], y[n : 2 * n])
    return _answer(system, inverse, free, dict.fromkeys(modes, 0.0), modes)


def _watches(
    system: Rubbing, inverse: Array, modes: dict[int, str], start: float
) -> tuple[list[tuple[int, str] | None], list[Callable[[float, Array], float]]]:
    """Gaps that close, forces that end, sticking that gives way, sliding that stops; and what each rules out."""
    n = len(inverse)
    ways: list[tuple[int, str] | None] = []
    watches: list[Callable[[float, Array], float]] = []

    def add(way: tuple[int, str] | None, function: Callable[[Array, int], float], contact: int) -> None:
        def watch(t: float, y: Array) -> float:
            # what starts at zero has to leave it first
            return function(y, contact) if t > start else 1.0

        watch.terminal, watch.direction = True, -1.0  # type: ignore[attr-defined]
        ways.append(way)
        watches.append(watch)

    def gap(y: Array, c: int) -> float:
        return float(system.offsets[c] + system.gradients[c] @ y[:n])

    def push(y: Array, c: int) -> float:
        return float(_forces(system, inverse, y, modes)[0][c])

    def margin(y: Array, c: int) -> float:
        return _margin(system, inverse, y, modes, c)

    def sliding(y: Array, c: int) -> float:
        return SIGN[modes[c]] * float(system.slides[c] @ y[n : 2 * n])

    for c, mode in modes.items():
        if mode == OPEN:
            add(None, gap, c)
            continue
        add((c, OPEN), push, c)
        if mode == STICK:
            add((c, STICK), margin, c)
        else:
            add(None, sliding, c)
    return ways, watches


def _margin(system: Rubbing, inverse: Array, y: Array, modes: dict[int, str], c: int) -> float:
    """What sticking can still hold, N."""
    push, rub, _ = _forces(system, inverse, y, modes)
    return float(system.friction[c] * push[c] - abs(rub[c]))
