"""Orders through impacts: does a method keep its order when its run is cut by blows?

The scenario `double_pendulum_wall` with fixed steps, six blows in each run, against `DoublePendulum`. Every blow ends a
step before its time, makes the velocities jump and starts the formula anew, so a starter or an event location of low
order would show as that order. Errors are root mean squares over all blows of twelve starts (one run alone has steps
at which an error changes its sign): of the times of the blows, and of their impulses.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ...core import SimulationError, simulate
from ...models import Scenario, load
from .cases import OrderCase, order_cases
from .double_pendulum import Blow, DoublePendulum

STARTS = (
    (-0.66, -0.993), (-0.638, -1.023), (-0.634, -0.923), (-0.624, -0.927), (-0.591, -0.931), (-0.597, -1.011),
    (-0.547, -0.939), (-0.595, -1.018), (-0.554, -0.885), (-0.547, -0.892), (-0.631, -0.887), (-0.635, -0.892),
)  # fmt: skip
"""Angles of upper and lower rod, rad: none of the blows grazes, and small changes of the angles move no blow by more
than 1.05 s/rad (rounding grows as they do)."""
COUNTS = tuple(round(160 * 2.0 ** (0.5 * j)) for j in range(14))
QUICK_COUNTS = COUNTS[:10]
NEWTON_TOLERANCE = 1e-15
QUANTITIES = ("time", "impulse")
NOISY = (1e-10, 1e-9)
"""Errors (s, N s) below which rounding and NEWTON_TOLERANCE may show."""
ROUNDING = 20.0
"""Of a case that comes there, errors below this multiple of its least one are not read: they may be rounding."""
OCTAVE, POINTS = 2.0, 3
"""An order is taken from the runs whose step is at most OCTAVE times the finest that is read; at least POINTS."""
LOST = 0.2
"""An order that far below its theory, relative to it, counts as lost: methods of order 6 and more come to rounding with
steps that are not small yet. A starter of order 4 or an event location of order 3 would show as these orders."""


@dataclass(frozen=True)
class ImpactOrderRow:
    """One case: its errors at each step size, and its orders."""

    case: OrderCase
    steps: tuple[float, ...]
    """s, coarse to fine; steps at which the method fails or another number of blows comes out are left out."""
    errors: tuple[tuple[float, float], ...]
    """Of times (s) and impulses (N s)."""
    failed: tuple[str, ...] = ()

    def floor(self, quantity: int) -> float:
        """Errors of a quantity below this may be rounding; 0 where no step comes to it."""
        least = min((e[quantity] for e in self.errors), default=math.inf)
        return ROUNDING * least if least < NOISY[quantity] else 0.0

    def window(self, quantity: int) -> slice:
        """The runs from which the order of a quantity is taken."""
        floor = self.floor(quantity)
        stop = next((k for k, e in enumerate(self.errors) if e[quantity] < floor), len(self.errors))
        start = next((k for k in range(stop) if self.steps[k] <= 1.02 * OCTAVE * self.steps[stop - 1]), stop)
        return slice(min(start, max(0, stop - POINTS)), stop)

    def order(self, quantity: int) -> float:
        """The observed order of a quantity; NaN if too few runs tell."""
        window = self.window(quantity)
        steps, errors = self.steps[window], [e[quantity] for e in self.errors[window]]
        if len(steps) < POINTS:
            return math.nan
        return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])

    @property
    def orders(self) -> tuple[float, float]:
        """Observed, of times and impulses."""
        return self.order(0), self.order(1)

    @property
    def verdict(self) -> str:
        """ "kept" if neither order lies LOST below the theory, "lost" if one does; "open" where there is no theory
        here, or where all but a few errors are at rounding."""
        if self.case.order is None or any(math.isnan(x) for x in self.orders):
            return "open"
        return "kept" if min(self.orders) >= (1.0 - LOST) * self.case.order else "lost"

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        setting = self.case.setting
        return {
            "method": setting.method, "options": dict(setting.options), "label": setting.label,
            "theory": self.case.order, "observed": dict(zip(QUANTITIES, self.orders, strict=True)),
            "steps": list(self.steps), "failed": list(self.failed), "verdict": self.verdict,
            "errors": {name: [e[k] for e in self.errors] for k, name in enumerate(QUANTITIES)},
        }  # fmt: skip


def impact_orders(
    methods: Iterable[str] | None = None, *, quick: bool = False, progress: Callable[[float], None] | None = None
) -> tuple[ImpactOrderRow, ...]:
    """The orders through impacts of every case of the given methods, or of all.

    `progress` is called with the number of cases done. Raises ModelError for an unknown method.
    """
    rows = []
    for case in order_cases(methods):
        rows.append(measure(case, QUICK_COUNTS if quick else COUNTS))
        if progress is not None:
            progress(float(len(rows)))
    return tuple(rows)


def measure(
    case: OrderCase, counts: Sequence[int] = COUNTS, starts: Sequence[tuple[float, float]] = STARTS
) -> ImpactOrderRow:
    """Run one case with each number of steps."""
    steps, errors, failed = [], [], []
    problems = tuple(_problem(start) for start in starts)
    t_end = problems[0][0].t_end
    for count in counts:
        try:
            found = _errors(case, t_end / count, problems)
        except SimulationError as error:
            failed.append(str(error))
            continue
        if found is None:
            failed.append(f"step {t_end / count:.3g} s: another number of blows, or steps that do not converge")
            continue
        steps.append(t_end / count)
        errors.append(found)
    return ImpactOrderRow(case, tuple(steps), tuple(errors), tuple(failed))


Problem = tuple[Scenario, tuple[Blow, ...]]


def _errors(case: OrderCase, h: float, problems: Sequence[Problem]) -> tuple[float, float] | None:
    """Root mean square errors of times and impulses; None if some run has another number of blows, or divides steps."""
    times, impulses = [], []
    for scenario, blows in problems:
        result = simulate(
            scenario.model, scenario.t_end, case.setting.method, step=h, newton_tolerance=NEWTON_TOLERANCE,
            record=False, **case.setting.options,
        )  # fmt: skip
        impacts = [event for event in result.events if event.kind == "impact"]
        if len(impacts) != len(blows) or result.stats["divided_steps"]:
            return None
        times += [impact.t - blow.t for impact, blow in zip(impacts, blows, strict=True)]
        impulses += [impact.impulse - blow.impulse for impact, blow in zip(impacts, blows, strict=True)]
    return math.sqrt(float(np.mean(np.square(times)))), math.sqrt(float(np.mean(np.square(impulses))))


@cache
def _problem(start: tuple[float, float]) -> Problem:
    """The scenario from these angles, and the blows of its reference."""
    scenario = load("double_pendulum_wall", upper_angle=start[0], lower_angle=start[1])
    return scenario, DoublePendulum.of(scenario).solve(scenario.t_end).blows
