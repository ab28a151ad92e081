"""A verdict "differ" is about the models: what the comparison itself cannot decide is undecided, and says why."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tlismni.core import (
    CoordinateContact,
    CoordinateTerm,
    KelvinVoigt,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    SpringDamper2D,
)
from tlismni.validation import Row, crosscheck
from tlismni.validation.cases import CASES
from tlismni.validation.catalogue import Outcome
from tlismni.validation.comparisons.common import Touch
from tlismni.validation.comparisons.contact_count import contact_count
from tlismni.validation.comparisons.penalty_limit import LONGEST, PenaltyRun, Sides, duration, softest_stiffness
from tlismni.validation.comparisons.persistent_contact import Limits, _confirmed
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.exudyn_run import ExudynResult
from tlismni.validation.metrics import ContactInterval
from tlismni.validation.report import _sentence

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")


def row(verdicts: Any, part: str) -> Row:
    (match,) = [r for r in verdicts.rows if part in r.quantity]
    return match


def stopped_mass(mass: float, law: Any, deep: bool = False) -> Model:
    """A mass on a cushion (spring and damper) that falls onto a stop; `deep`: there is another far below."""

    def stop(name: str, height: float) -> CoordinateContact:
        return CoordinateContact(name=name, offset=-height, terms=(CoordinateTerm(body="m", coordinate="y"),), law=law)

    cushion = SpringDamper2D(
        name="oil", a=Marker2D(point=(0.0, -1.0)), b=Marker2D(body="m"), stiffness=30.0 * mass, damping=0.5 * mass,
        natural_length=1.0,
    )  # fmt: skip
    body = PointMass2D(name="m", mass=mass, position=(0.0, 0.0))
    stops = (stop("stop", -0.05), *((stop("deep", -0.2),) if deep else ()))
    return Model(name="stopped", gravity=(0.0, -9.81), bodies=(body,), forces=(cushion,), contacts=stops)


@needs_exudyn
def test_a_heavy_mass_on_a_stop_is_compared_with_stiffnesses_that_suit_it() -> None:
    """With 1e6 ... 1e8 N/m^1.5 its contacts take as long as its own motion: a limit of nothing."""
    found = crosscheck(stopped_mass(2000.0, NewtonImpact(restitution=0.7)), t_end=0.16)
    assert found.ok and not found.undecided
    assert row(found, "impulse").verdict == "agree"


@needs_exudyn
def test_another_restitution_on_a_heavy_mass_is_a_difference_of_the_models() -> None:
    scenario = stopped_mass(2000.0, NewtonImpact(restitution=0.7))
    wrong = stopped_mass(2000.0, NewtonImpact(restitution=0.71))
    found = crosscheck(scenario, t_end=0.16, exudyn_model=wrong)
    assert row(found, "separation speed").verdict == "differ"
    assert row(found, "approach speed").verdict == "agree"


@needs_exudyn
@pytest.mark.parametrize("restitution, verdict", [(0.7, "agree"), pytest.param(0.74, "differ", marks=pytest.mark.full)])
def test_whole_runs_of_a_heavy_mass_are_compared_with_stiffnesses_that_suit_it(
    restitution: float, verdict: str
) -> None:
    scenario, theirs = (stopped_mass(2000.0, NewtonImpact(restitution=e)) for e in (0.7, restitution))
    found = crosscheck(scenario, t_end=0.16, whole=True, exudyn_model=theirs)
    assert row(found, "m.vy up to").verdict == verdict


@pytest.mark.parametrize("mass", [1e-6, 1.0, 1e3, 1e7])
@pytest.mark.parametrize("speed", [1e-2, 1.0, 30.0])
def test_the_softest_contact_takes_a_small_part_of_the_time_to_the_next_impact(mass: float, speed: float) -> None:
    first = Touch("c", 0.3, 0.3, speed, 0.5 * speed, 1.5 * mass * speed)
    again = Touch("c", 0.7, 0.7, speed, 0.5 * speed, 1.5 * mass * speed)
    assert duration(first, softest_stiffness([first, again], 2.0)) <= LONGEST * 0.4 * (1.0 + 1e-9)


def sides(values: list[float], intervals: list[tuple[float, float | None]], touches: list[Touch]) -> tuple[Sides, Any]:
    """Penalty runs with one contact each, and what they found of one quantity."""
    runs = []
    for k, (start, end) in enumerate(intervals):
        result = ExudynResult(np.array([0.0, 1.0]), {}, 1e-3, 0.0, 0, "none")
        runs.append(PenaltyRun(10.0 ** (6 + k), result, [("c", ContactInterval(start, end, 1, 2))]))
    nothing: Any = SimpleNamespace()
    built = Sides(nothing, touches, nothing, nothing, runs, runs[0])
    return built, built.limit([np.array([v]) for v in values], np.array([values[0]]))


IMPACT = Touch("c", 0.5, 0.5, 1.0, 0.7, 1.7)


def test_a_limit_that_moves_with_the_next_stiffness_is_not_exact() -> None:
    """Values that are no power series yet: the three softest happen to lie on a line that leads nowhere."""
    x = [10.0 ** (-0.4 * (6 + k)) for k in range(4)]
    values = [1.0 + 100.0 * x[0], 1.0 + 100.0 * x[1], 1.0 + 100.0 * x[2], 2.0]
    times: list[tuple[float, float | None]] = [(0.5, 0.51)] * 4
    _, (limit, bar) = sides(values[:3], times[:3], [IMPACT])
    assert bar[0] < 1e-9 and limit[0] == pytest.approx(1.0)
    confirmed, (limit, bar) = sides(values, times, [IMPACT])
    assert confirmed.confirmed and bar[0] >= abs(limit[0] - 1.0) > 0.5


@pytest.mark.parametrize("theirs, verdict", [([1.0, 1.0, 1.0, 1.0], "differ"), ([1.0, 1.0, 1.0, 2.0], "undecided")])
def test_a_limit_of_short_contacts_can_differ_only_when_it_has_been_found_twice(
    theirs: list[float], verdict: str
) -> None:
    """Values of exudyn for each T; ours is 0, and far from what they tend to or within what the limit moves."""
    t = np.linspace(0.0, 1.0, 3)

    def run(time: float, factor: float = 1.0) -> ExudynResult:
        value = theirs[round(-math.log2(time))]
        return ExudynResult(t, {"x": np.full(3, value)}, factor * time, 0.0, 0, "none")

    def compared(limits: Limits) -> list[Row]:
        limit, bar = limits.of("x", t)
        return [Row("x", "m", 0.0, float(limit[0]), 1e-3, "relative", float(bar[0]))]

    times = [1.0, 0.5, 0.25]
    first = Limits(times, [run(time) for time in times], [run(time, 2.0) for time in times])
    limits, (found,) = _confirmed(first, compared, run)
    assert found.verdict == verdict and bool(found.doubt) == (verdict == "undecided")
    assert limits.times == [1.0, 0.5, 0.25, 0.125]


@pytest.mark.parametrize(
    "intervals, touches, words",
    [
        ([(0.5, 0.51), (0.5, 0.505), (0.5, None)], [IMPACT], "is not over"),
        ([(0.5, 0.51)] * 3, [IMPACT, Touch("d", 0.508, 0.508, 1.0, 0.5, 1.0)], "two impacts of ours are one"),
        ([(0.5, 0.51)] * 3, [IMPACT, Touch("d", 0.5, 0.5, 1.0, 0.5, 1.0)], ""),
        ([(0.5, 0.51)] * 3, [IMPACT], ""),
    ],
)
def test_contacts_of_a_penalty_that_are_not_our_impact_are_named(
    intervals: list[tuple[float, float | None]], touches: list[Touch], words: str
) -> None:
    built, _ = sides([1.0, 1.0, 1.0], intervals, touches)
    (*_, told) = ["", *built.doubts()]
    assert words in told and bool(words) == bool(told)


def test_a_doubt_makes_a_difference_undecided_and_leaves_an_agreement() -> None:
    given: dict[str, Any] = {"tolerance": 1e-3, "tolerance_kind": "relative"}
    assert Row("x", "m", 1.0, 2.0, **given).verdict == "differ"
    assert Row("x", "m", 1.0, 2.0, **given, doubt="the run ends").verdict == "undecided"
    assert Row("x", "m", 1.0, 1.0, **given, doubt="the run ends").verdict == "agree"


class Course(dict[str, np.ndarray]):
    """A run of ours: channels over t, and events."""

    def __init__(self, touches: list[Touch]) -> None:
        self.t = np.linspace(0.0, 2.0, 20001)
        gap = np.full(len(self.t), 1e-3)
        for touch in touches:
            gap[(self.t >= touch.start) & (self.t <= touch.end)] = -1e-3
        super().__init__({"c.gap": gap})
        self.events = [
            SimpleNamespace(kind=kind, contact="c", t=t, approach_speed=1.0, separation_speed=0.7, impulse=1.7)
            for touch in touches
            for kind, t in (("close", touch.start), ("open", touch.end))
        ]


def force_sides(gaps: list[list[tuple[float, float]]], touches: list[Touch]) -> Any:
    """exudyn's runs of 1 s with three steps and given contacts (from, to), and touches of ours."""
    runs = []
    for k, contacts in enumerate(gaps):
        t = np.linspace(0.0, 1.0, 1 + 1000 * 2**k)
        gap = np.full(len(t), 1e-3)
        for start, end in contacts:
            inside = (t > start) & (t < end)
            gap[inside] = -1e-3 * np.sin(math.pi * (t[inside] - start) / (end - start))
        channels = {"c.gap": gap, "c.gap_rate": np.gradient(gap, t)}
        runs.append(ExudynResult(t, channels, t[1], 0.0, 0, "none"))
    ours = Course(touches)
    return SimpleNamespace(found=touches, ours=ours, loose=ours, levels=SimpleNamespace(runs=runs))


BLOW = Touch("c", 0.3, 0.32, 1.0, 0.7, 1.7)


@pytest.mark.parametrize(
    "gaps, touches, verdict, words",
    [
        ([[(0.3, 0.32)]] * 3, [BLOW], None, ""),
        ([[]] * 3, [Touch("c", 1.3, 1.32, 1.0, 0.7, 1.7)], "undecided", "run ends"),
        ([[(0.3, 0.311), (0.313, 0.32)]] * 3, [BLOW], "undecided", "in pieces"),
        ([[(0.3, 0.32)], [], []], [BLOW], "undecided", "depends on its step"),
        ([[]] * 3, [BLOW], "differ", ""),
    ],
)
def test_contacts_that_are_counted_otherwise_say_why(
    gaps: Any, touches: list[Touch], verdict: str | None, words: str
) -> None:
    found = contact_count(force_sides(gaps, touches), "c")
    assert [r.verdict for r in found] == ([] if verdict is None else [verdict])
    assert all(words in r.doubt for r in found)


@needs_exudyn
def test_a_contact_that_exudyn_does_not_come_to_is_no_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass bounces between two stops, another comes to a wall later; exudyn's run, bound in its steps, ends before.
    Without weight, of which exudyn's idea of the approach speed would ask for a tenth of the steps."""
    monkeypatch.setattr("tlismni.validation.comparisons.force_steps.MANY_STEPS", 2000)
    law = KelvinVoigt(stiffness=1e6, damping=20.0)
    stops = (("floor", "ball", "y", 0.0, 1.0), ("top", "ball", "y", 0.05, -1.0), ("of_late", "late", "x", 1.0, -1.0))
    contacts = tuple(
        CoordinateContact(
            name=name, offset=offset, terms=(CoordinateTerm(body=body, coordinate=coordinate, factor=sign),), law=law
        )
        for name, body, coordinate, offset, sign in stops
    )
    bodies = (
        PointMass2D(name="ball", mass=5.0, position=(0.0, 0.01), velocity=(0.0, -1.0)),
        PointMass2D(name="late", mass=5.0, velocity=(3.0, 0.0)),
    )
    model = Model(name="late", gravity=(0.0, 0.0), bodies=bodies, contacts=contacts)
    found = crosscheck(model, t_end=0.5)
    assert found.ok, [(r.quantity, r.doubt) for r in found.rows if r.verdict == "differ"]
    assert "run ends" in row(found, "of_late").doubt and row(found, "of_late").verdict == "undecided"


@pytest.mark.parametrize(
    ("difference", "bars", "doubt", "said"),
    [
        (0.5e-3, 5e-3, "", "error bars of 0.005 m are 5 times the tolerance"),
        (2e-3, 5e-3, "", "the difference is 0.002 m, within error bars of 0.005 m"),
        (2e-3, 0.0, "the limit is not reached", "the limit is not reached"),
    ],
)
def test_an_undecided_case_says_in_the_overview_which_quantity_and_why(
    difference: float, bars: float, doubt: str, said: str
) -> None:
    one = Row("tip", "m", 1.0 + difference, 1.0, 1e-3, "absolute", bars, doubt=doubt)
    sure = Row("time", "s", 1.0, 1.0, 1e-3, "absolute")
    assert one.verdict == "undecided" and one.why == said and sure.why == ""
    less = Row("hip", "m", 1.0 + 0.9 * difference, 1.0, 1e-3, "absolute", bars, doubt=doubt)
    found: Any = SimpleNamespace(ok=True, rows=(sure, less, one), to_dict=dict)
    outcome = Outcome(CASES["bouncing_ball"][0], found, "", 1.0)
    assert outcome.verdict == "undecided"
    assert outcome.remark == outcome.to_dict()["reason"] == f"tip: {said} (and 1 more)"


def test_sentences_of_reports_begin_with_a_capital_but_for_names() -> None:
    said = {"the limit": "The limit.", "disk.z: far": "disk.z: far.", "exudyn: steps.": "exudyn: steps.", "": ""}
    assert {text: _sentence(text) for text in said} == said
