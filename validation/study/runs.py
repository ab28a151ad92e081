"""The runs of `study iterations`: every contender on every problem, with both outer loops and several tolerances."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ...core import ModelError, SimulationError, simulate
from ...models import Scenario
from .cases import Setting
from .reference import ATOL_SHARE, Reference

LOOPS = ("newton", "simple")
"""Outer loops: the default, and the fixed point of the method's papers."""
TOLERANCES = tuple(10.0**-k for k in range(3, 10))
QUICK_TOLERANCES = (1e-3, 1e-5, 1e-7)
COUNTS = {
    "steps": "steps",
    "rejected": "rejected",
    "outer_iterations": "outer_iterations",
    "evaluations": "residual_evaluations",
    "factorizations": "factorizations",
}
"""Names in a `Run` and in the statistics of a result."""


@dataclass(frozen=True)
class Run:
    """One run: what was set, what it took, what it achieved."""

    problem: str
    setting: Setting
    loop: str
    tolerance: float
    """rtol; atol is a hundredth of it."""
    steps: int = 0
    rejected: int = 0
    outer_iterations: int = 0
    evaluations: int = 0
    factorizations: int = 0
    wall_time: float = 0.0
    """s; of one run, so no more than a hint."""
    error: float = float("nan")
    """Against the reference, see `Reference.error`."""
    failure: str = ""
    """Why there are no figures; empty if there are."""

    @property
    def ok(self) -> bool:
        """True if the run came to its end."""
        return not self.failure

    @property
    def per_step(self) -> float:
        """Outer iterations per accepted step."""
        return self.outer_iterations / max(self.steps, 1)

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "problem": self.problem, "method": self.setting.method, "options": dict(self.setting.options),
            "label": self.setting.label, "outer": self.loop, "tolerance": self.tolerance, "ok": self.ok,
            "failure": self.failure, **{name: getattr(self, name) for name in COUNTS}, "per_step": self.per_step,
            "wall_time": self.wall_time, "error": self.error,
        }  # fmt: skip


def run_all(
    scenario: Scenario,
    problem: str,
    t_end: float,
    reference: Reference,
    settings: Sequence[Setting],
    tolerances: Sequence[float],
    done: Callable[[], None],
) -> list[Run]:
    """All runs of one problem; `done` is called after each."""
    found = []
    for setting in settings:
        for loop in LOOPS:
            _warm_up(scenario, t_end, setting, loop)
            for tolerance in tolerances:
                found.append(_run(scenario, problem, t_end, reference, setting, loop, tolerance))
                done()
    return found


def _warm_up(scenario: Scenario, t_end: float, setting: Setting, loop: str) -> None:
    """Load compiled code, so that it does not stand in the first wall time."""
    try:
        simulate(scenario.model, 1e-3 * t_end, setting.method, outer=loop, record=False, **setting.options)
    except (ModelError, SimulationError):
        # the runs proper say what is the matter
        return


def _run(
    scenario: Scenario, problem: str, t_end: float, reference: Reference, setting: Setting, loop: str, rtol: float
) -> Run:
    try:
        result = simulate(scenario.model, t_end, setting.method, rtol, ATOL_SHARE * rtol, outer=loop, **setting.options)
    except (ModelError, SimulationError) as stop:
        # a method with an iteration of its own refuses other outer loops; a run may fail: both are findings
        return Run(problem, setting, loop, rtol, failure=str(stop))
    error = reference.error(result)
    run = Run(problem, setting, loop, rtol, wall_time=float(result.stats["wall_time"]), error=error)
    if not math.isfinite(error):
        run = replace(run, failure="blew up")
    counts: dict[str, Any] = {name: int(result.stats[key]) for name, key in COUNTS.items()}
    return replace(run, **counts)
