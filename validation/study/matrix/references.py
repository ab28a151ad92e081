"""The reference of a scenario: a tight run, checked against a tight run of another family."""

from dataclasses import dataclass

import numpy as np

from ....core import TlismniError, simulate
from ....models import Scenario
from ..cases import Setting
from ..problems import Problem
from .course import Course, course_difference
from .limited import LimitReached, run_limited
from .measure import first_sentence, start
from .records import ReferenceFigures

TOLERANCE, LEAST_RTOL = 1e-10, 1e-11
FAMILIES = (
    (Setting("ebdf", {"k": 6}), Setting("ebdf", {"k": 3})),
    (Setting("irk", {"tableau": "gauss3"}), Setting("irk", {"tableau": "radau3"})),
)
"""One reference of each: the first that comes to the end."""
AGREE = 1e-6
"""Difference of the two beyond which there is no reference: a chaotic course, seen up to there."""
MARGIN = 0.95
"""Of the time until then."""
LEAST_SHARE = 0.05
"""Of the time that was asked for."""


@dataclass(frozen=True)
class Reference:
    """The course of a scenario, with what is known about it."""

    figures: ReferenceFigures
    course: Course | None


def make_reference(problem: Problem, limit: float) -> Reference:
    """Integrate tightly, twice. If there is no reference, `figures.failure` says why; no TlismniError is raised."""
    scenario = problem.load()
    t_end = problem.t_end or scenario.t_end
    try:
        first_look = _first_look(scenario, t_end)
    except TlismniError as error:
        return _none(scenario, f"its own settings fail: {first_sentence(error)}", t_end)
    courses, labels, seconds = [], [], 0.0
    for family in FAMILIES:
        reasons = []
        for setting in family:
            try:
                sim = start(scenario, setting, *first_look.tolerances(TOLERANCE, LEAST_RTOL))
                seconds += run_limited(sim, t_end, limit)
            except (TlismniError, LimitReached) as error:
                reasons.append(f"{setting.label}: {first_sentence(error)}")
                continue
            courses.append(Course.of(sim))
            labels.append(setting.label)
            break
        else:
            return _none(scenario, "; ".join(reasons), t_end)
    return _compared(scenario, courses[0], courses[1], labels, t_end, seconds)


def _compared(
    scenario: Scenario, first: Course, second: Course, labels: list[str], asked: float, seconds: float
) -> Reference:
    difference = course_difference(second, first.spline(), first.scale_of_coordinates(first.scales))
    apart = np.flatnonzero(~(difference <= AGREE))
    t_end = asked if not len(apart) else MARGIN * float(second.t[apart[0]])
    if t_end < LEAST_SHARE * asked:
        return _none(scenario, f"{labels[0]} and {labels[1]} part at t = {t_end / MARGIN:.4g} s", asked)
    course = first.until(t_end)
    figures = ReferenceFigures(
        scenario=scenario.name, first=labels[0], second=labels[1],
        accuracy=float(np.max(difference[second.t <= t_end])), t_end=t_end, asked=asked,
        events=len(course.event_times), scales=course.scales, cpu_time=seconds,
    )  # fmt: skip
    return Reference(figures, course)


def _first_look(scenario: Scenario, t_end: float) -> Course:
    """How far the scenario moves, from a run with its own settings."""
    result = simulate(scenario.model, t_end, scenario.method, scenario.rtol, scenario.atol, **scenario.options)
    n = result.q.shape[1]
    sim = start(scenario, Setting("irk"), 1e-3, {})
    angle = np.asarray(sim.assembly.is_angle, dtype=bool)[:n]
    nothing = np.zeros((len(result), 0))
    return Course(
        result.t, result.q, result.v, result.a, nothing, nothing, angle, np.zeros(0), (), (0.0, 0.0, 0.0), 0.0,
        float(np.max(result["energy.kinetic"])), False,
    )  # fmt: skip


def _none(scenario: Scenario, why: str, asked: float) -> Reference:
    return Reference(ReferenceFigures(scenario=scenario.name, failure=why, asked=asked), None)
