"""The limit of contacts that take less and less time, and the error bar that goes with it."""

from collections.abc import Callable

import numpy as np
import pytest
from tlismni.core import Disk2D, DiskOnHalfPlane2D, HalfPlane2D, Marker2D, Model, NewtonImpact, RigidBody2D
from tlismni.models import load
from tlismni.validation import crosscheck
from tlismni.validation.comparisons.persistent_contact import TIMES, WEIGHTS, Limits
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.exudyn_run import ExudynResult, run_exudyn

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
STEPS = 7.0


def limits(value: Callable[[float, float], float], coarse: tuple[float, ...]) -> Limits:
    """Runs whose channel y is `value` of T and of the step."""

    def run(time: float, factor: float) -> ExudynResult:
        t, step = np.array([0.0, 1.0]), factor * time / STEPS
        return ExudynResult(t, {"body.y": np.full(2, value(time, step))}, step, 0.0, 0, "none")

    return Limits(list(TIMES), [run(time, 1.0) for time in TIMES], [run(time, 2.0) for time in coarse])


def test_what_a_step_changes_leaves_with_the_time_where_it_is_regular() -> None:
    found, bar = limits(lambda time, step: 2.0 + 3.0 * time - time**2 + 5.0 * step + step**2, TIMES).of(
        "body.y", np.array([0.5])
    )
    assert found[0] == pytest.approx(2.0, abs=1e-13)
    # the distance to the line through the two shortest times is all that is left in doubt
    assert bar[0] == pytest.approx(abs(1.0 - 1.0 / STEPS**2) * TIMES[1] * TIMES[2], rel=1e-9)


def test_an_irregular_error_of_the_step_is_within_the_bar() -> None:
    rng = np.random.default_rng(3)
    inside = []
    for _ in range(200):
        found, bar = limits(lambda time, step: 2.0 + 3.0 * time + 1e-2 * rng.uniform(-step, step), TIMES[-1:]).of(
            "body.y", np.array([0.5])
        )
        inside.append(abs(found[0] - 2.0) <= bar[0])
    assert np.mean(inside) > 0.8
    found, bar = limits(lambda time, step: 2.0 + step, TIMES[-1:]).of("body.y", np.array([0.5]))
    assert bar[0] >= WEIGHTS * TIMES[-1] / STEPS


@needs_exudyn
def test_sticking_is_extrapolated_with_all_steps_twice_and_blows_are_not() -> None:
    sticking = crosscheck("stick_slip", t_end=0.4, step=2.5e-4)
    assert any("what twice the step changes in it" in note for note in sticking.comparison.notes)
    struck = crosscheck("rocking_block", t_end=0.4, step=5e-4)
    assert any("a blow begins anywhere in a step" in note for note in struck.comparison.notes)


@needs_exudyn
def test_exudyn_writes_nothing_on_stdout(capfd: pytest.CaptureFixture[str]) -> None:
    """It warns of the memory that user functions take, after some thousand steps."""
    model = load("stick_slip", law="kelvin_voigt_gap", stiffness=1e5, damping=600.0, transition_speed=1e-2).model
    run_exudyn(model, 1.6, 2e-4)
    assert capfd.readouterr().out == ""


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize(("offset", "alone"), [(0.0, False), (0.05, True)])
def test_a_blow_that_two_contacts_share_is_not_laid_on_one_constraint(offset: float, alone: bool) -> None:
    """A bar lands on both ends at once, or on one that hangs lower."""

    def end(name: str, x: float, y: float) -> DiskOnHalfPlane2D:
        disk = Disk2D(marker=Marker2D(body="bar", point=(x, y)))
        return DiskOnHalfPlane2D(name=name, plane=HalfPlane2D(), disk=disk, law=NewtonImpact(restitution=0.6))

    bar = RigidBody2D(name="bar", mass=1.0, inertia=0.1, position=(0.0, 0.05))
    contacts = (end("left", -0.4, 0.0), end("right", 0.4, offset))
    found = crosscheck(Model(name="bar", gravity=(0.0, -9.81), bodies=(bar,), contacts=contacts), t_end=0.115)
    assert found.ok
    assert any("switched on" in row.quantity for row in found.rows) == alone
