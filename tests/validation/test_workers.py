"""Cases in processes of their own: a crash ends its own case only; and the error bars of the comparisons."""

import json
import math
import multiprocessing
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tlismni.core import simulate
from tlismni.models import load
from tlismni.validation import Case, crosscheck_all
from tlismni.validation.catalogue import Outcome, _died, _Order
from tlismni.validation.comparisons.common import Comparison, Row, Touch, own_bar
from tlismni.validation.comparisons.force_rows import Levels
from tlismni.validation.comparisons.force_steps import aligned
from tlismni.validation.comparisons.rod_impact import MESHES, blow_of_ours, mesh_limit
from tlismni.validation.crosscheck import CrossCheck
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.workers import Workers


def job(item: str, tell: Callable[[str], None]) -> str:
    """What the processes of these tests do."""
    tell(f"begun {item}")
    if item == "crash":
        os._exit(3)
    if item == "hang":
        time.sleep(60.0)
    return item.upper()


def test_a_process_that_ends_or_hangs_takes_its_own_item_only() -> None:
    told: list[tuple[str, str]] = []
    pool: Workers[str, str] = Workers(job, 2, lambda item, code, seconds: f"{item}: {code}", limit=2.0)
    found = dict(pool.run(["a", "crash", "hang", "b", "c"], lambda item, text: told.append((item, text))))
    assert found == {"a": "A", "b": "B", "c": "C", "crash": "crash: 3", "hang": "hang: None"}
    assert {item for item, text in told if text == f"begun {item}"} == set(found)


def test_a_crash_is_a_failed_outcome_that_says_what_to_do() -> None:
    outcome = _died(_Order(Case("pendulum"), None, True), -11, 2.0)
    assert isinstance(outcome, Outcome) and outcome.verdict == "failed"
    assert "exit code -11" in outcome.reason and "tlismni crosscheck pendulum" in outcome.reason


@pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
def test_what_is_done_is_written_before_the_next_is_begun(tmp_path: Path) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    seen: list[int] = []

    def interrupt(text: str) -> None:
        page = tmp_path / "overview.json"
        if page.exists():
            seen.append(json.loads(page.read_text(encoding="utf-8"))["done"])
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        crosscheck_all(tmp_path, interrupt, scenarios=["split_wall", "pendulum"], coarse=True)
    assert seen == [1]
    numbers = json.loads((tmp_path / "overview.json").read_text(encoding="utf-8"))
    assert numbers["planned"] == 2 and len(numbers["cases"]) == 1
    with pytest.raises(ValueError, match="workers = 0"):
        crosscheck_all(workers=0)


def test_bars_hold_the_error_of_a_method_of_first_order_and_the_limit_removes_it() -> None:
    exact, steps = 2.0, np.array([4.0, 2.0, 1.0]) * 1e-2
    regular = [np.asarray(exact + 0.3 * h + 0.05 * h**2) for h in steps]
    plain, extrapolated = Levels(()), Levels((), extrapolated=True)
    assert abs(plain.value(regular) - exact) <= 1.01 * plain.bar(regular)
    assert abs(extrapolated.value(regular) - exact) <= extrapolated.bar(regular) < 1e-4
    # a value that stands still by chance does not count as exact
    assert plain.bar([np.asarray(2.4), np.asarray(2.1), np.asarray(2.1)]) == pytest.approx(0.15)


@pytest.mark.parametrize("order", [0.5, 2.0 / 3.0, 1.0, 2.0])
def test_the_limit_of_meshes_finds_the_order_that_they_show(order: float) -> None:
    values = [3.0 + 0.2 * (100.0 * 2.0**k) ** -order for k in range(3)]
    limit, bar = mesh_limit(values)
    assert limit == pytest.approx(3.0, abs=1e-12) and abs(values[-1] - 3.0) <= bar * (1.0 + 1e-9)
    # without an order: the finest, and no bar below the largest of the changes
    for changing in ([1.0, 1.2, 1.1], [1.0, 1.1, 1.1], [1.0, 1.2, 1.18, 1.16]):
        limit, bar = mesh_limit(changing)
        assert limit == changing[-1] and bar >= np.abs(np.diff(changing)).max()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("coarsest", [10, 25])
def test_the_bars_of_meshes_hold_the_waves_that_no_mesh_resolves(coarsest: int) -> None:
    # the force EA v/c for 2 L/c (d'Alembert); three meshes whose changes pass zero by chance look converged
    blows = []
    for factor in MESHES:
        scenario = load("rod_wall", elements=coarsest * factor)
        run = simulate(scenario.model, scenario.t_end, scenario.method, **scenario.options)
        blows.append(blow_of_ours(run, "wall"))
    (rod,) = scenario.model.bodies
    force, duration = rod.axial_stiffness * abs(rod.velocity) / rod.wave_speed, 2.0 * rod.length / rod.wave_speed
    for field, exact in (("mean", force), ("duration", 0.9 * duration), ("impulse", force * duration)):
        limit, bar = mesh_limit([getattr(blow, field) for blow in blows])
        assert abs(limit - exact) <= bar < 0.03 * exact, field


def test_aligned_steps_begin_just_before_the_touch_on_every_grid() -> None:
    touch = Touch("c", 0.4517, 0.46, 1.0, 0.5, 1.0)
    for halvings in range(4):
        step = aligned(1e-3, touch, 1e-4) / 2**halvings
        since = touch.start - step * math.floor(touch.start / step)
        assert 0.0 < since < 1e-7
    assert aligned(1.0, touch, 1e-4) == 1.0


def test_our_error_bar_is_never_below_rounding() -> None:
    assert own_bar(2.0, 2.0) == pytest.approx(2e-14) and own_bar(2.0, 2.1) == pytest.approx(0.1)


@pytest.mark.parametrize(
    "rows, verdict",
    [
        ((), "not comparable"),
        ((Row("x", "m", 1.0, 9.0, 1e-3, "relative", reason="chaos", required=False),), "not comparable"),
        ((Row("x", "m", 1.0, 1.0, 1e-3, "relative", required=False),), "not comparable"),
        ((Row("x", "m", 1.0, 1.0, 1e-3, "relative"),), "agree"),
        ((Row("x", "m", 1.0, 1.0, 1e-3, "relative"), Row("y", "m", 1.0, 1.1, 1e-3, "relative", 0.2)), "undecided"),
        ((Row("x", "m", 1.0, 1.0, 1e-3, "relative"), Row("y", "m", 1.0, 1.1, 1e-3, "relative")), "differ"),
    ],
)
def test_a_case_in_which_nothing_decisive_agrees_does_not_agree(rows: tuple[Row, ...], verdict: str) -> None:
    found = CrossCheck("pendulum", "", {}, Comparison("motion", rows, (), (), (), "1.13", 0.0, 0.0))
    assert Outcome(Case("pendulum"), found, "", 0.0).verdict == verdict


def _left_behind(item: str) -> int:
    """Number of a worker whose parent was killed."""
    parent = multiprocessing.get_context("spawn").Process(target=_parent, args=(item,))
    parent.start()
    while not Path(item).exists() or not Path(item).read_text():
        time.sleep(0.05)
    parent.kill()
    parent.join()
    return int(Path(item).read_text())


def own_number(item: str, tell: Callable[[str], None]) -> None:
    """Writes the number of its process, and hangs."""
    Path(item).write_text(str(os.getpid()))
    time.sleep(60.0)


def _parent(item: str) -> None:
    list(Workers(own_number, 1, lambda item, code, seconds: None).run([item], lambda item, text: None))


@pytest.mark.skipif(not hasattr(os, "setsid"), reason="needs POSIX signals")
def test_a_process_ends_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    number = _left_behind(str(tmp_path / "number"))
    for _ in range(100):
        try:
            os.kill(number, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    os.kill(number, signal.SIGKILL)
    pytest.fail("the process outlived its parent by ten seconds")
