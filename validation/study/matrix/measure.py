"""One run of a method on a scenario, and the sweep over tolerances of a pair."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import BPoly

from ....core import ConsistencyError, ModelError, Simulation, SimulationError
from ....models import Scenario
from ..cases import Setting
from ..runs import COUNTS
from .course import Course, course_difference, event_errors, mean_difference
from .limited import LimitReached, run_limited
from .records import MatrixRun, Pair

KEPT_OPTIONS = ("max_step", "first_step", "redundant")
"""Options of a scenario that are no choice of a method."""
CONTACT_LOOPS = ("event", "contact", "impact")
REPEAT = 2.0
"""s: a first run that is shorter is run again, since it loads compiled code."""


@dataclass(frozen=True)
class Sweep:
    """What is run of each pair."""

    tolerances: tuple[float, ...] = tuple(10.0**-k for k in range(2, 11))
    """From loose to tight, in parts of how far a scenario moves."""
    levels: tuple[float, ...] = (1e-3, 1e-5)
    """Errors at which cost is compared."""
    limit: float = 10.0
    """CPU time of a run, s."""
    least_runs: int = 3
    """Before a sweep may end because the finest level is reached."""


QUICK = Sweep(tuple(10.0**-k for k in (2, 3, 4, 5, 6)), (1e-3,), 1.5, 2)
NEAR = 0.5
"""A sweep ends when the error is below this part of the finest level."""


class Measured:
    """A scenario with its reference: what runs need and are compared with."""

    def __init__(self, scenario: Scenario, course: Course, t_end: float) -> None:
        self.scenario, self.course, self.t_end = scenario, course, t_end
        self.scale = course.scale_of_coordinates(course.scales)
        self.spline: BPoly = course.spline()

    def sweep(self, setting: Setting, sweep: Sweep) -> Pair:
        """Run the pair from loose to tight, until it has reached the finest level or what it may cost."""
        runs: list[MatrixRun] = []
        for tolerance in sweep.tolerances:
            run = self.run(setting, tolerance, sweep.limit)
            if not runs and run.ok and run.cpu_time < REPEAT:
                run = self.run(setting, tolerance, sweep.limit)
            runs.append(run)
            reached = run.error is not None and run.error < NEAR * min(sweep.levels)
            if run.kind in ("limit", "refused") or (reached and len(runs) >= sweep.least_runs):
                break
        return Pair(scenario=self.scenario.name, method=setting.method, options=dict(setting.options), runs=tuple(runs))

    def run(self, setting: Setting, tolerance: float, limit: float) -> MatrixRun:
        """One run. Whatever it raises is a finding."""
        try:
            sim = self.simulation(setting, tolerance)
        except (ModelError, ConsistencyError) as error:
            return MatrixRun(tolerance=tolerance, kind="refused", failure=f"refused: {first_sentence(error)}")
        try:
            seconds = run_limited(sim, self.t_end, limit)
            return MatrixRun(tolerance=tolerance, cpu_time=seconds, **self._figures(sim))
        except LimitReached as error:
            return MatrixRun(tolerance=tolerance, kind="limit", failure=f"limit: {error}", **_counts(sim))
        except SimulationError as error:
            where = "at contact" if error.loop in CONTACT_LOOPS else f"in {error.loop}"
            text = f"failed {where}: {first_sentence(error)}"
            return MatrixRun(tolerance=tolerance, kind="failed", failure=text, **_counts(sim))
        except Exception as error:  # an error that is not the solver's own is a finding too: it must not end the study
            text = f"broken: {type(error).__name__}: {first_sentence(error)}"
            return MatrixRun(tolerance=tolerance, kind="broken", failure=text)

    def simulation(self, setting: Setting, tolerance: float) -> Simulation:
        """The run, ready to go."""
        return start(self.scenario, setting, *self.course.tolerances(tolerance))

    def _figures(self, sim: Simulation) -> dict[str, Any]:
        course, reference = Course.of(sim), self.course
        error = float(np.max(course_difference(course, self.spline, self.scale)))
        if not np.isfinite(error):
            return {**_counts(sim), "error": error}
        first, largest = event_errors(course, reference)
        unique = not (course.redundant or reference.redundant)
        return {
            **_counts(sim),
            "error": error,
            "residuals": course.residuals,
            "first_event_error": first,
            "event_error": largest,
            "events": len(course.event_times),
            "joint_force_error": mean_difference(course, reference, "joints") if unique else None,
            "impulse_error": mean_difference(course, reference, "impulses"),
            "energy_drift": course.balance / reference.kinetic if reference.kinetic > 0.0 else None,
        }


def start(scenario: Scenario, setting: Setting, rtol: float, atol: Mapping[str, float]) -> Simulation:
    """A simulation that records every step."""
    kept = {name: value for name, value in scenario.options.items() if name in KEPT_OPTIONS}
    return Simulation(scenario.model, setting.method, rtol, atol, record=True, **kept, **setting.options)


def first_sentence(error: Exception) -> str:
    """What went wrong, without what to do about it."""
    text = " ".join(str(error).split())
    return text.partition(". ")[0].rstrip(".") or type(error).__name__


def _counts(sim: Simulation) -> dict[str, Any]:
    return {name: int(sim.stats[key]) for name, key in COUNTS.items()}
