"""The coupling study: its problems rest and strike as mechanics says, and its limits are those of theory."""

import math
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("fmpy")

from tlismni.core import simulate
from tlismni.fmu_wrapper.master import CouplingError
from tlismni.validation.study.coupling import (
    FIXED_POINT_LIMIT,
    CouplingRow,
    CouplingStudy,
    Reference,
    StabilityRow,
    growth,
    observations,
    strike,
)
from tlismni.validation.study.coupling_plots import plot_coupling
from tlismni.validation.study.coupling_problems import (
    AITKEN,
    CONTACT_FREQUENCY,
    CONTENDERS,
    DISTURBANCE,
    GRAVITY,
    HAMMER,
    ITERATED,
    JACOBI,
    NEWTON,
    STIFFNESS,
    blow,
    couple,
    press,
)


def test_the_undisturbed_press_carries_the_hammer_whole_and_in_halves() -> None:
    whole, *halves = press(disturbance=0.0)
    force = simulate(whole, 0.05)["blow.normal_force"]
    np.testing.assert_allclose(force, HAMMER * GRAVITY, rtol=1e-6)
    found = couple(halves, JACOBI, 1e-3, 0.05, ("wall.blow.normal_force", "*.vx"))
    np.testing.assert_allclose(found["wall.blow.normal_force"], HAMMER * GRAVITY, rtol=1e-6)


def test_the_disturbed_press_swings_with_the_frequency_of_its_contact() -> None:
    whole = press()[0]
    t = np.linspace(0.0, 0.02, 2001)
    force = simulate(whole, 0.02, rtol=1e-9, atol=1e-13, t_eval=t)["blow.normal_force"] - HAMMER * GRAVITY
    assert force[0] == pytest.approx(-STIFFNESS * DISTURBANCE, rel=1e-6)
    crossings = t[:-1][np.diff(np.sign(force)) != 0]
    assert math.pi / (crossings[1] - crossings[0]) == pytest.approx(CONTACT_FREQUENCY, rel=0.05)


def test_the_fixed_point_ends_where_theory_says_and_newton_does_not() -> None:
    assert growth(ITERATED, 0.7 * FIXED_POINT_LIMIT) == ""
    assert growth(ITERATED, 1.15 * FIXED_POINT_LIMIT) == "does not converge"
    assert growth(NEWTON, 1.15 * FIXED_POINT_LIMIT) == "" and growth(NEWTON, 2.5 * FIXED_POINT_LIMIT) == ""
    with pytest.raises(CouplingError):
        couple(press()[1:], ITERATED, 2.0 * FIXED_POINT_LIMIT, 0.1, ("*",))


def test_held_forces_that_lag_feed_energy_in() -> None:
    """Two half steps of lag act as a damper of -k h/2: more than the contact's and the anvil's take beyond a step."""
    assert growth(JACOBI, 3e-4) == "" and growth(JACOBI, 1e-3) == "grows"


def test_momentum_passes_through_the_cut() -> None:
    """What the hammer gains is the integral of the force that the wall shows, less the impulse of its spring."""
    h, t_end = 2.5e-4, 0.03
    found = couple(blow()[1:], NEWTON, h, t_end, ("*.normal_force", "*.hammer.x", "*.hammer.vx"))
    contact = np.trapezoid(found["wall.blow.normal_force"], found.t)
    spring = -(20.0**2) * np.trapezoid(found["striker.hammer.x"], found.t)
    gained = found["striker.hammer.vx"][-1] - found["striker.hammer.vx"][0]
    # held means of both ends are the trapezoidal rule to the contact's impulse, as it is exact; the spring's needs the
    # rule's correction by the ends (Euler and Maclaurin)
    spring += 20.0**2 * h**2 / 12.0 * gained
    assert gained == pytest.approx(contact + spring, abs=1e-7)


@pytest.fixture(scope="module")
def study() -> CouplingStudy:
    reference = Reference()
    chosen = (JACOBI, NEWTON)
    rows = tuple(strike(c, h, reference) for c in chosen for h in (1e-3, 5e-4, 2.5e-4))
    longer = Reference(0.06)
    controlled = (
        strike(AITKEN, 1e-3, longer),
        *(strike(AITKEN, 1e-3, longer, tolerance, "iteration") for tolerance in (1e-1, 1e-3)),
    )
    stability = tuple(StabilityRow(c, 1e-3 if c == JACOBI else None, "" if c == JACOBI else "none up to", "grows")
                      for c in CONTENDERS)  # fmt: skip
    return CouplingStudy(rows, controlled, stability)


def test_orders_energy_and_cost(study: CouplingStudy) -> None:
    assert study.order(JACOBI) == pytest.approx(1.0, abs=0.3)
    assert study.order(NEWTON) == pytest.approx(2.0, abs=0.25)
    for jacobi, newton in zip(study.of(JACOBI), study.of(NEWTON), strict=True):
        assert jacobi.energy > 0.01 and abs(newton.energy) < 0.1 * jacobi.energy
    rows = study.of(NEWTON)
    assert rows[1].instance_steps < study.cost(NEWTON, 2e-4) < rows[2].instance_steps
    assert math.isnan(study.cost(NEWTON, 1.0))
    _, loose, tight = study.controlled
    assert tight.error < 0.2 * loose.error and tight.instance_steps > loose.instance_steps
    assert any("orders" in line for line in observations(study))


def test_a_run_that_fails_is_told(study: CouplingStudy, tmp_path: Path) -> None:
    lost = CouplingRow(JACOBI, 1e-3, failure="it diverges")
    more = CouplingStudy((*study.rows, lost), study.controlled, study.stability)
    assert len(more.of(JACOBI)) == 3
    assert more.to_dict()["rows"][-1]["failure"] == "it diverges"
    assert plot_coupling(more, tmp_path / "x.png").stat().st_size > 10_000
