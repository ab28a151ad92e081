"""Observed orders: errors on the swing, whose solution is known, over a sequence of fixed steps.

Error: root mean square over all steps of a run, for positions, velocities and multipliers each. Every case runs with
the same sequence of step counts, each 2^(1/4) times the one before. Its order is the slope of the straight line
through the finest errors (one octave of the step, five runs) that stand clear of rounding. The choice of these errors
does not look at the theory.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...core import Result, SimulationError, simulate
from .cases import OrderCase, order_cases
from .swing import Swing

QUANTITIES = ("position", "velocity", "multiplier")
NEWTON_TOLERANCE = 1e-13
MARGIN = 0.2
"""How far an observed order may lie from the theory."""
COUNTS = tuple(round(34 * 2.0 ** (0.25 * j)) for j in range(30))
QUICK_COUNTS = COUNTS[:24]
"""Coarser: the errors of the lowest orders stay large, but every order shows."""
OCTAVE, POINTS = 2.0, 3
"""An order is taken from the runs whose step is at most OCTAVE times the finest one, if they are at least POINTS."""
FLOOR = (3e-14, 1e-13, 1.2e-12)
"""Rounding of positions (m), velocities (m/s) and multipliers (N), times the number of steps: what double precision
and NEWTON_TOLERANCE leave adds up from step to step, and accelerations, hence multipliers, are known to that
tolerance over h. Found by refining the step beyond where errors fall; errors below are not read."""


@dataclass(frozen=True)
class OrderRow:
    """One case: its errors, and what they say."""

    case: OrderCase
    t_end: float
    steps: tuple[float, ...]
    """Step sizes, s, coarse to fine; steps at which the method fails are left out."""
    errors: tuple[tuple[float, float, float], ...]
    """Errors at each step size: m, m/s, N."""
    failed: tuple[str, ...] = ()
    """What happened at the steps that failed."""

    def window(self, quantity: int) -> slice:
        """The runs from which the order of a quantity is taken: the finest before the first below rounding."""
        stop = next((k for k in range(len(self.steps)) if self._at_rounding(k, quantity)), len(self.steps))
        start = next((k for k in range(stop) if self.steps[k] <= 1.02 * OCTAVE * self.steps[stop - 1]), stop)
        return slice(start, stop)

    def _at_rounding(self, run: int, quantity: int) -> bool:
        return self.errors[run][quantity] < FLOOR[quantity] * self.t_end / self.steps[run]

    def order(self, quantity: int) -> float:
        """The observed order of a quantity; NaN if too few runs tell."""
        window = self.window(quantity)
        steps, errors = self.steps[window], [e[quantity] for e in self.errors[window]]
        if len(steps) < POINTS:
            return math.nan
        return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])

    @property
    def orders(self) -> tuple[float, float, float]:
        """Observed, of positions, velocities, multipliers."""
        return self.order(0), self.order(1), self.order(2)

    @property
    def verdict(self) -> str:
        """ "agree" if all three lie within MARGIN of the theory, "higher" if one lies above it and none below,
        "differ"; "open" where there is no theory here."""
        if self.case.order is None:
            return "open"
        off = [found - known for found, known in zip(self.orders, self.case.theory, strict=True) if known is not None]
        if all(abs(x) <= MARGIN for x in off):
            return "agree"
        return "higher" if all(x >= -MARGIN for x in off) else "differ"

    @property
    def ok(self) -> bool:
        """False if the case contradicts its theory."""
        return self.verdict in ("agree", "open")

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        setting = self.case.setting
        return {
            "method": setting.method,
            "options": dict(setting.options),
            "label": setting.label,
            "theory": dict(zip(QUANTITIES, self.case.theory, strict=True)),
            "observed": dict(zip(QUANTITIES, self.orders, strict=True)),
            "window": {
                name: {
                    "steps": list(self.steps[self.window(k)]),
                    "errors": [e[k] for e in self.errors[self.window(k)]],
                }
                for k, name in enumerate(QUANTITIES)
            },
            "steps": list(self.steps),
            "errors": {name: [e[k] for e in self.errors] for k, name in enumerate(QUANTITIES)},
            "failed": list(self.failed),
            "verdict": self.verdict,
        }


def order_table(
    methods: Iterable[str] | None = None,
    *,
    quick: bool = False,
    swing: Swing | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[OrderRow, ...]:
    """The order of every case of the given methods, or of all.

    Parameters
    ----------
    methods : names of methods; None: all of the core.
    quick : coarser steps only.
    swing : the problem; None: its defaults.
    progress : called with the number of cases done.

    Raises
    ------
    ModelError : for an unknown method.
    """
    rows = []
    for case in order_cases(methods):
        rows.append(measure(case, QUICK_COUNTS if quick else COUNTS, swing or Swing()))
        if progress is not None:
            progress(float(len(rows)))
    return tuple(rows)


def measure(case: OrderCase, counts: Sequence[int], swing: Swing) -> OrderRow:
    """Run one case with each number of steps, until its errors are at rounding."""
    steps, errors, failed = [], [], []
    for count in counts:
        h = swing.t_end / count
        try:
            result = _run(case, swing, h)
        except SimulationError as error:
            failed.append(str(error))
            continue
        if result.stats["divided_steps"]:
            failed.append(f"{result.stats['divided_steps']:.0f} of {count} steps of {h:.3g} s do not converge")
            continue
        found = _errors(result, swing)
        steps.append(h)
        errors.append(found)
        if all(error < floor * count for error, floor in zip(found, FLOOR, strict=True)):
            break
    return OrderRow(case, swing.t_end, tuple(steps), tuple(errors), tuple(failed))


def _run(case: OrderCase, swing: Swing, h: float) -> Result:
    """With fixed steps h."""
    setting = case.setting
    return simulate(
        swing.model(), swing.t_end, setting.method, step=h, newton_tolerance=NEWTON_TOLERANCE, **setting.options
    )


def _errors(result: Result, swing: Swing) -> tuple[float, float, float]:
    """Root mean square errors: m, m/s, N."""
    q, v, multipliers = swing.exact(result.t)
    return _rms(result.q - q), _rms(result.v - v), _rms(result.multipliers - multipliers)


def _rms(x: np.ndarray) -> float:
    return math.sqrt(float(np.mean(x**2)))
