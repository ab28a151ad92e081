"""Impacts of elastic rods against St. Venant's solutions and against the figures of the semi-discrete equations.

Units of the comparisons: L/c for times, EA v/c for forces, the speed v and the kinetic energy at the start.
"""

import math

import numpy as np
import pytest
from tlismni.core import Result, simulate
from tlismni.models import load

SPEED, AREA, DENSITY, MODULUS = 0.1, 3.14e-4, 7800.0, 210e9
WAVE = math.sqrt(MODULUS / DENSITY)
FORCE, ENERGY, MOMENTUM = MODULUS * AREA * SPEED / WAVE, 0.5 * DENSITY * AREA * SPEED**2, DENSITY * AREA * SPEED


def run(name: str, **parameters) -> Result:
    s = load(name, **parameters)
    result = simulate(s.model, s.t_end, s.method, s.rtol, s.atol, **s.options)
    assert np.max(np.abs(result["energy.balance"])) < 1e-8 * ENERGY
    return result


def closings(result: Result) -> list[float]:
    return [e.t * WAVE for e in result.events if e.kind == "close"]


def openings(result: Result) -> list[float]:
    return [e.t * WAVE for e in result.events if e.kind == "open"]


def duration(result: Result) -> float:
    (start,), (end,) = closings(result), openings(result)
    return end - start


def plateau(result: Result, start: float = 0.5, end: float = 1.5) -> np.ndarray:
    """Contact force, less its theoretical value, while waves travel in the middle of the rod."""
    t = result.t * WAVE - closings(result)[0]
    return result["wall.normal_force"][(t > start) & (t < end)] / FORCE - 1.0


@pytest.mark.parametrize(
    "mass_matrix, elements, end, rebound, lost, overshoot",
    [
        ("consistent", 25, 1.976, 0.968, 0.5 / math.sqrt(3.0), 0.55),
        ("consistent", 50, 1.984, 0.980, 0.5 / math.sqrt(3.0), 0.55),
        ("lumped", 25, 2.032, 0.963, 0.5, 0.095),
        ("lumped", 50, 2.020, 0.9775, 0.5, 0.095),
    ],
)
def test_rod_against_a_wall(
    mass_matrix: str, elements: int, end: float, rebound: float, lost: float, overshoot: float
) -> None:
    result = run("rod_wall", elements=elements, mass_matrix=mass_matrix)
    # the reference ends its contact with the step, 0.2 L/(c N), in which the force vanishes
    assert end - 0.2 / elements - 5e-4 < duration(result) < end + 5e-4
    assert result["wall.impulse"][-1] / MOMENTUM - 1.0 == pytest.approx(rebound, abs=1e-3)
    (impact,) = (e for e in result.events if e.kind == "impact")
    assert impact.energy_loss / ENERGY * elements == pytest.approx(lost, rel=1e-6)
    assert abs(np.mean(plateau(result))) < 0.01
    assert np.max(result["wall.normal_force"]) / FORCE - 1.0 == pytest.approx(overshoot, rel=0.05)


def test_duration_and_rebound_converge_to_st_venant() -> None:
    errors = []
    for elements in (25, 50, 100):
        result = run("rod_wall", elements=elements)
        errors.append((abs(duration(result) - 2.0), abs(result["wall.impulse"][-1] / MOMENTUM - 2.0)))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all((orders > 0.5) & (orders < 1.0))


@pytest.mark.parametrize("mass_matrix", ["consistent", "lumped"])
def test_a_massless_contact_node_takes_no_energy_and_calms_the_force(mass_matrix: str) -> None:
    result = run("rod_wall", elements=50, mass_matrix=mass_matrix, massless_contact=True)
    assert [e.kind for e in result.events] == ["close", "open"]
    assert result["energy.impact_loss"][-1] == 0.0 and result.events[0].approach_speed == pytest.approx(SPEED)
    stored = result["energy.kinetic"] + result["energy.strain"]
    assert np.max(np.abs(stored / ENERGY - 1.0)) < 1e-8
    assert np.max(np.abs(plateau(result))) < (0.02 if mass_matrix == "consistent" else 1e-3)
    if mass_matrix == "consistent":
        assert np.max(np.abs(plateau(run("rod_wall", elements=50)))) > 0.1
    assert duration(result) == pytest.approx(2.0, abs=0.05)


def test_the_massless_end_follows_its_neighbour_and_its_force_is_the_contacts() -> None:
    s = load("rod_wall", elements=20, massless_contact=True)
    result = simulate(s.model, s.t_end, s.method, **s.options)
    stretch = result["rod.x20"] - result["rod.x19"] - 1.0 / 20
    closed = result["wall.in_contact"] > 0.0
    scale = MODULUS * AREA * 20
    assert np.max(np.abs(scale * stretch[~closed])) < 1e-9 * scale
    assert np.max(np.abs(scale * stretch + result["wall.normal_force"])[closed]) < 1e-9 * scale
    assert np.max(np.abs(result["rod.right_end_force"])) < 1e-9 * scale


def test_unequal_rods_separate_with_the_ratio_of_their_lengths() -> None:
    result = run("rod_rod", elements=200, mass_matrix="lumped", length_ratio=0.5)
    assert duration(result) == pytest.approx(2.0, rel=0.02)
    impulse = result["contact.impulse"][-1]
    separation = impulse / MOMENTUM * (1.0 + 0.5) - 1.0
    assert separation == pytest.approx(0.5, rel=0.02)


def test_equal_rods_exchange_their_velocities() -> None:
    result = run("rod_rod", elements=200, length_ratio=1.0)
    assert duration(result) == pytest.approx(2.0, rel=0.02)
    assert result["contact.impulse"][-1] / MOMENTUM == pytest.approx(1.0, rel=0.01)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("mass_ratio, end", [(1.0, 3.0677), (2.0, 4.7086), (4.0, 5.8996), (6.0, 7.4076)])
def test_mass_on_a_rod(mass_ratio: float, end: float) -> None:
    """Near its end the force grazes zero: contact has ended when mass and rod stay apart for more than a few of the
    times in which a wave passes an element."""
    result = run("mass_on_rod", elements=200, mass_ratio=mass_ratio)
    closed, opened = closings(result), openings(result)
    apart = [t for t, again in zip(opened, [*closed[1:], math.inf], strict=False) if again - t > 10.0 / 200]
    assert apart[0] - closed[0] == pytest.approx(end, rel=0.01)


@pytest.mark.parametrize("method", ["ebdf", "hht", "irk", "baumgarte"])
def test_what_the_errors_of_the_steps_leave_in_a_rod_does_not_make_its_contact_chatter(method: str) -> None:
    """Right after its impact the contact's force is zero, and pressed or pulled by what truncation has left in the rod;
    then the pressure grows with the waves. Whatever the sign of that rest is, there is one contact of 2 L/c."""
    s = load("rod_wall", elements=20)
    for rtol in (1e-4, 1e-6, 3e-7, 3e-8):
        result = simulate(s.model, s.t_end, method, rtol, 1e-3 * rtol)
        assert [event.kind for event in result.events] == ["impact", "close", "open"]
        if rtol <= 1e-6:
            assert duration(result) == pytest.approx(1.975, abs=0.02)
            assert result["wall.normal_force"].min() >= -1e-3 * FORCE
