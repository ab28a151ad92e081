"""What a process of the matrix does: make a reference, or sweep a pair; and what is recorded if it dies of it."""

import signal
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from ..cases import Setting
from . import course as courses
from .measure import Measured, Sweep, first_sentence
from .problems import problem_of
from .records import MatrixRun, Pair, ReferenceFigures
from .references import make_reference

REFERENCE_LIMIT = 60.0
"""CPU time of a reference, s."""
LEAST_WALL_TIME = 1800.0
"""s that a job may take at least: its limits are of CPU time without compilation, and processes share the machine."""
SHARED = 4.0
"""Wall time over CPU time beyond which a job is taken to hang."""


@dataclass(frozen=True)
class Job:
    """A pair; without a setting: the reference of a scenario."""

    scenario: str
    sweep: Sweep
    folder: str
    """Where the courses of references are kept."""
    setting: Setting | None = None


Done = ReferenceFigures | Pair


def wall_limit(sweep: Sweep) -> float:
    """Wall time (s) after which a process with a job is ended."""
    return LEAST_WALL_TIME + SHARED * (len(sweep.tolerances) + 1) * sweep.limit


def do(job: Job, tell: Callable[[str], None] = lambda text: None) -> Done:
    """The figures of `job`; whatever it raises is a finding, and must not end the study."""
    try:
        if job.setting is None:
            return _reference(job)
        return _measured(job.scenario, job.folder).sweep(job.setting, job.sweep)
    except Exception as error:
        return broken(job, f"{type(error).__name__}: {first_sentence(error)}")


def died(job: Job, code: int | None, seconds: float) -> Done:
    """The record of a job whose process ended with an exit code, or hung (None)."""
    if code is None:
        return broken(job, f"its process was ended after {seconds:.0f} s")
    if code >= 0:
        return broken(job, f"its process ended with exit code {code}")
    known = {int(number): number.name for number in signal.Signals}
    hint = ", maybe for want of memory" if known.get(-code) == "SIGKILL" else ""
    return broken(job, f"its process was ended by {known.get(-code, f'signal {-code}')}{hint}")


def broken(job: Job, why: str) -> Done:
    """A scenario without reference, or a pair without figures (its one run stands for all of its tolerances)."""
    failure = f"broken: {why}"
    if job.setting is None:
        return ReferenceFigures(scenario=job.scenario, failure=failure)
    run = MatrixRun(tolerance=job.sweep.tolerances[0], kind="broken", failure=failure)
    return Pair(scenario=job.scenario, method=job.setting.method, options=dict(job.setting.options), runs=(run,))


def _reference(job: Job) -> ReferenceFigures:
    found = make_reference(problem_of(job.scenario), REFERENCE_LIMIT)
    if found.course is not None:
        courses.save(found.course, Path(job.folder) / f"{job.scenario}.npz")
    return found.figures


@lru_cache(maxsize=2)
def _measured(name: str, folder: str) -> Measured:
    course = courses.load(Path(folder) / f"{name}.npz")
    return Measured(problem_of(name).load(), course, float(course.t[-1]))
