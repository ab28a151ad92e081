"""How far chaotic runs are compared, and the impulse by a constraint that is switched on in exudyn."""

import math

import pytest
from tlismni.core import Model, NewtonImpact, simulate
from tlismni.core.contacts.contact2d import Disk2D, DiskOnDisk2D
from tlismni.core.elements import PointMass2D
from tlismni.core.model.markers import Marker2D
from tlismni.models import load
from tlismni.validation import crosscheck
from tlismni.validation.comparisons.toggled import plastic_impulse
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.predictability import MULTIPLE, Predictability, _by_neighbours, predictability

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")


def test_the_limit_is_a_multiple_of_the_lyapunov_time() -> None:
    found = Predictability(0.5, 0.1, "tangent")
    assert found.time == 2.0 and found.limit == MULTIPLE * 2.0
    assert "Lyapunov time 2 s" in found.text()
    assert math.isinf(Predictability(-0.1, 0.01, "tangent").limit)


def test_tangent_and_near_by_runs_see_the_same_growth() -> None:
    """Of a pendulum on its head: neighbours part with sqrt(g/L) while it stays up."""
    scenario = load("pendulum", angle=0.5 * math.pi + 1e-7, gravity=40.0)
    scenario = type(scenario)(**{**scenario.__dict__, "t_end": 1.5})
    rate = math.sqrt(40.0)
    tangent, near = predictability(scenario), _by_neighbours(scenario)
    assert tangent.how == "tangent" and near.how == "two near-by runs"
    assert tangent.exponent == pytest.approx(rate, rel=0.1)
    assert near.exponent == pytest.approx(rate, rel=0.1)


@needs_exudyn
def test_a_whole_run_is_compared_up_to_the_limit_and_not_after_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a limit of one Lyapunov time, a short run goes on beyond it; by three a run of 25 s with `-m full`."""
    monkeypatch.setattr("tlismni.validation.predictability.MULTIPLE", 1.0)
    found = crosscheck("impact_oscillator", t_end=4.0, whole=True)
    before = [row for row in found.rows if "Lyapunov times" in row.quantity]
    after = [row for row in found.rows if "after that" in row.quantity]
    assert found.ok and len(before) == 2 and len(after) == 2
    assert all(row.verdict in ("agree", "undecided") and row.third is not None for row in before)
    assert all("Lyapunov time" in row.reason and not row.required for row in after)
    assert any("Lyapunov exponent" in note for note in found.comparison.notes)


@needs_exudyn
def test_two_balls_that_a_constraint_stops() -> None:
    """Along the line of centres at 30 degrees: m1 m2/(m1 + m2) times the approach."""
    m1, m2, speed = 2.0, 3.0, 1.5
    c, s = math.cos(math.pi / 6.0), 0.5
    a = PointMass2D(name="a", mass=m1, velocity=(speed, 0.0))
    b = PointMass2D(name="b", mass=m2, position=(0.2 * c, 0.2 * s))
    contact = DiskOnDisk2D(
        name="c", a=Disk2D(marker=Marker2D(body="a"), radius=0.1), b=Disk2D(marker=Marker2D(body="b"), radius=0.1),
        law=NewtonImpact(restitution=0.0),
    )  # fmt: skip
    model = Model(gravity=(0.0, 0.0), bodies=(a, b))
    assert plastic_impulse(model, contact) == pytest.approx(m1 * m2 / (m1 + m2) * speed * c, rel=1e-6)


@needs_exudyn
def test_the_impulse_by_a_constraint_is_newtons() -> None:
    found = crosscheck("pendulum_stop", t_end=1.0, step=1e-4)
    (row,) = [row for row in found.rows if "switched on" in row.quantity]
    assert row.verdict == "agree"
    ours = simulate(load("pendulum_stop").model, 1.0, "irk", 1e-9, 1e-11)
    (impact,) = [e for e in ours.events if e.kind == "impact"]
    assert row.exudyn == pytest.approx(impact.impulse, rel=1e-6)
