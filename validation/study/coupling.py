"""`coupling_study`: a mechanism in two halves that touch, against its whole: what each master algorithm makes of it.

Error against communication step, its order, and the steps of the instances that it costs, for a blow; the longest
stable step for a contact that stays; a controlled step against equal ones.
"""

import logging
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...core import simulate
from ...fmu_wrapper.master import MasterError, SystemResult
from .coupling_problems import (
    AITKEN,
    APPROACH_SPEED,
    BLOW_END,
    CONTACT_FREQUENCY,
    CONTENDERS,
    DAMPING,
    DISTURBANCE,
    GAUSS_SEIDEL_LINEAR,
    GRAVITY,
    HAMMER,
    LONG_END,
    STIFFNESS,
    Contender,
    blow,
    couple,
    press,
)

STEPS = tuple(BLOW_END / (15 * 2**k) for k in range(6))
"""s: 2 ms and its halves."""
QUICK_STEPS = STEPS[1:4]
LONG_STEPS = (2e-3, 1e-3, 5e-4, 2.5e-4)
"""s: equal ones, beside the controlled step."""
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
"""Of the controlled step."""
CONTROLLED = ((GAUSS_SEIDEL_LINEAR, "doubling"), (AITKEN, "doubling"), (AITKEN, "iteration"))
"""With the estimate of the error."""
SHORTEST, LONGEST = 2e-5, 1.6e-2
"""s: limits of the search for the longest stable step."""
LEVEL = 7e-3
"""Error at which costs are compared: runs of all contenders enclose it."""
PERIODS, FEWEST = 8.0, 80
"""A run on the press lasts so many periods of the contact, and so many steps."""
_SHRINK = 1e-8 ** (1.0 / 50)
"""By what each of 50 passes must reduce the error for the iterations' tolerance."""
FIXED_POINT_LIMIT = (math.sqrt(DAMPING**2 + 4.0 * HAMMER * _SHRINK * STIFFNESS) - DAMPING) / STIFFNESS
"""s. With the mean of both ends held, a pass makes of an error dF of the force h^2 dF/(4 m) in position, h dF/(2 m) in
velocity, k and c times that in force: in 50 passes it vanishes for (k h^2/2 + c h)/(2 m) < 0.69, the anvil at rest."""


@dataclass(frozen=True)
class CouplingRow:
    """One run of the blow, or why there was none."""

    contender: Contender
    step: float
    """Communication step, s; the mean one if it is controlled."""
    tolerance: float | None = None
    """Of the controlled step."""
    estimate: str = ""
    """By which it is controlled."""
    error: float = math.nan
    """Of the hammer's velocity after the blow, in parts of the approach speed."""
    energy: float = math.nan
    """Kinetic and strain energy of both halves after the blow less that of the whole, in parts of that at the start."""
    steps: int = 0
    """Communication steps."""
    passes: int = 0
    instance_steps: int = 0
    """What it costs."""
    failure: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {**vars(self), "contender": self.contender.label}


@dataclass(frozen=True)
class StabilityRow:
    """The longest step (s) with which the press stays at rest; at the ends of the search, None if it is beyond."""

    contender: Contender
    limit: float | None
    beyond: str
    """ "" or what is known: "none up to" or "below"."""
    fails: str
    """How it ends: "grows" or "does not converge"."""

    @property
    def limit_angle(self) -> float | None:
        """The limit times the contact's frequency, rad."""
        return None if self.limit is None else self.limit * CONTACT_FREQUENCY

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {**vars(self), "contender": self.contender.label, "limit_angle": self.limit_angle}


@dataclass(frozen=True)
class CouplingStudy:
    """All figures of the study."""

    rows: tuple[CouplingRow, ...]
    controlled: tuple[CouplingRow, ...]
    """Of the longer run, with equal steps too."""
    stability: tuple[StabilityRow, ...]

    def of(self, contender: Contender) -> list[CouplingRow]:
        """The runs of a contender that came to their end, from the longest step."""
        return [row for row in self.rows if row.contender == contender and not row.failure]

    def order(self, contender: Contender) -> float:
        """Slope of the error through the runs with the shortest steps: an octave of them, or two if there are."""
        rows = self.of(contender)[-3:]
        if len(rows) < 2:
            return math.nan
        return float(np.polyfit(np.log([r.step for r in rows]), np.log([r.error for r in rows]), 1)[0])

    def cost(self, contender: Contender, error: float) -> float:
        """Instance steps for an error, between runs in logarithms; NaN if the runs do not enclose it."""
        rows = sorted(self.of(contender), key=lambda r: r.error)
        if len(rows) < 2 or not rows[0].error <= error <= rows[-1].error:
            return math.nan
        x, y = (np.log([getattr(r, name) for r in rows]) for name in ("error", "instance_steps"))
        return float(np.exp(np.interp(math.log(error), x, y)))

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "rows": [row.to_dict() for row in self.rows],
            "controlled": [row.to_dict() for row in self.controlled],
            "stability": [row.to_dict() for row in self.stability],
            "orders": {c.label: self.order(c) for c in CONTENDERS},
            "fixed_point_limit": FIXED_POINT_LIMIT,
            "contact_frequency": CONTACT_FREQUENCY,
        }


def coupling_study(*, quick: bool = False, progress: Callable[[float], None] | None = None) -> CouplingStudy:
    """Run every contender with every step, then controlled, then on the press; `progress` gets the share done."""
    steps = QUICK_STEPS if quick else STEPS
    long_steps, tolerances = (LONG_STEPS[:2], TOLERANCES[1:3]) if quick else (LONG_STEPS, TOLERANCES)
    short, long = Reference(BLOW_END), Reference(LONG_END)
    plan: list[tuple[Any, ...]] = [(c, h, short) for c in CONTENDERS for h in steps]
    plan += [(c, h, long) for c in dict.fromkeys(c for c, _ in CONTROLLED) for h in long_steps]
    plan += [(c, LONG_STEPS[0], long, tol, how) for c, how in CONTROLLED for tol in tolerances]
    total = len(plan) + 2 * len(CONTENDERS)
    rows: list[CouplingRow] = []
    stability: list[StabilityRow] = []
    with _without_warnings():
        for case in plan:
            rows.append(strike(*case))
            if progress is not None:
                progress(len(rows) / total)
        for contender in CONTENDERS:
            stability.append(longest_stable(contender, halvings=3 if quick else 6))
            if progress is not None:
                progress((len(plan) + 2 * len(stability)) / total)
    return CouplingStudy(
        tuple(rows[: len(CONTENDERS) * len(steps)]),
        tuple(rows[len(CONTENDERS) * len(steps) :]),
        tuple(stability),
    )


class Reference:
    """The whole at `t_end`, s, after the blow."""

    def __init__(self, t_end: float = BLOW_END) -> None:
        whole = blow()[0]
        result = simulate(whole.model, t_end, "irk", rtol=1e-12, atol=1e-15)
        self.t_end = t_end
        energy = result["energy.kinetic"] + result["energy.strain"]
        self.velocity = float(result["hammer.vx"][-1])
        self.start, self.end = float(energy[0]), float(energy[-1])


RECORD = ("*.hammer.vx", "*.energy.kinetic", "*.energy.strain")


def strike(
    contender: Contender, step: float, reference: Reference, tolerance: float | None = None, estimate: str = ""
) -> CouplingRow:
    """One run of the blow, with equal steps (s) or a controlled one that starts with it."""
    control = {"tolerance": tolerance, "absolute": 1e-6, "estimate": estimate}
    more = {} if tolerance is None else {"control": control}
    try:
        result = couple(blow()[1:], contender, step, reference.t_end, RECORD, **more)
    except MasterError as error:
        return CouplingRow(contender, step, tolerance, estimate, failure=str(error))
    counts = result.stats
    return CouplingRow(
        contender, reference.t_end / counts["communication_steps"], tolerance, estimate,
        abs(float(result["striker.hammer.vx"][-1]) - reference.velocity) / APPROACH_SPEED,
        (_energy(result) - reference.end) / reference.start,
        counts["communication_steps"], counts["passes"], counts["instance_steps"],
    )  # fmt: skip


def _energy(result: SystemResult) -> float:
    return float(sum(result[f"{i}.energy.{kind}"][-1] for i in ("striker", "wall") for kind in ("kinetic", "strain")))


def longest_stable(contender: Contender, halvings: int = 6) -> StabilityRow:
    """Search between SHORTEST and LONGEST, by halving in logarithms after a search by factors of 2."""
    stable, unstable, fails = None, None, ""
    h = SHORTEST * 2.0 ** math.floor(math.log2(LONGEST / SHORTEST))
    while h >= SHORTEST * 0.999:
        how = growth(contender, h)
        if how:
            unstable, fails = h, how
        else:
            stable = h
            break
        h *= 0.5
    if unstable is None or stable is None:
        return StabilityRow(contender, None, "none up to" if unstable is None else "below", fails)
    for _ in range(halvings):
        h = math.sqrt(stable * unstable)
        how = growth(contender, h)
        if how:
            unstable, fails = h, how
        else:
            stable = h
    return StabilityRow(contender, stable, "", fails)


def growth(contender: Contender, h: float) -> str:
    """What goes wrong on the press with steps of h, s: "" if the disturbance dies out."""
    count = max(FEWEST, math.ceil(PERIODS * 2.0 * math.pi / CONTACT_FREQUENCY / h))
    try:
        result = couple(press()[1:], contender, h, count * h, ("wall.blow.normal_force",))
    except MasterError as error:
        return "does not converge" if "converge" in str(error) else "fails"
    swing = np.abs(result["wall.blow.normal_force"] - HAMMER * GRAVITY)
    part = len(swing) // 4
    early, late = float(np.max(swing[1:part])), float(np.max(swing[-part:]))
    start = STIFFNESS * DISTURBANCE
    # one that has come off the anvil may look calm later
    return "grows" if late > early + 1e-3 * start or float(np.max(swing)) > 8.0 * start else ""


@contextmanager
def _without_warnings() -> Iterator[None]:
    """Runs that blow up make the halves warn of motions that jump: here that is what is looked for."""
    logger = logging.getLogger("tlismni")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(level)


def observations(study: CouplingStudy) -> list[str]:
    """What the figures say, in sentences."""
    orders = [f"{c.label} {study.order(c):.2f}" for c in CONTENDERS if len(study.of(c)) > 1]
    lines = [f"observed orders: {', '.join(orders)}"] if orders else []
    costs = {c.label: study.cost(c, LEVEL) for c in CONTENDERS}
    known = [f"{label} {cost:.0f}" for label, cost in costs.items() if not math.isnan(cost)]
    if known:
        lines.append(f"instance steps for an error of {LEVEL:g}: {', '.join(known)}")
    gains = [max(study.of(c), key=lambda r: r.step) for c in CONTENDERS if study.of(c)]
    if gains:
        told = ", ".join(f"{r.contender.label} {r.energy:+.2g} at {1e3 * r.step:g} ms" for r in gains)
        lines.append(f"energy added to the blow, parts of that at the start: {told}")
    return lines
