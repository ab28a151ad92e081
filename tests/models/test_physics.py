"""The scenarios do what their descriptions say: closed forms, and minimal coordinates for the chain."""

import importlib.util
import math
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.special import ellipk
from tlismni.core import simulate
from tlismni.models import ScenarioError, load


def chain_reference() -> ModuleType:
    """The reference of the benchmarks, which are scripts and no package."""
    path = Path(__file__).parents[2] / "benchmarks" / "reference.py"
    spec = importlib.util.spec_from_file_location("chain_reference_of_benchmarks", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_bouncing_ball_bounces_at_the_times_of_the_closed_form_and_comes_to_rest() -> None:
    scenario = load("bouncing_ball", restitution=0.6, height=0.5)
    result = simulate(scenario.model, scenario.t_end)
    first = math.sqrt(2.0 * 0.5 / 9.81)
    times = [e.t for e in result.events if e.kind == "impact"]
    exact = [first * (1.0 + 2.0 * sum(0.6**k for k in range(1, n + 1))) for n in range(6)]
    assert times[:6] == pytest.approx(exact, rel=1e-6)
    rest = next(e.t for e in result.events if e.kind == "rest")
    assert rest == pytest.approx(first * 1.6 / 0.4, rel=1e-3)
    assert rest < scenario.t_end
    assert result["ball.y"][-1] == pytest.approx(0.0, abs=1e-9)
    assert result["floor.normal_force"][-1] == pytest.approx(9.81, rel=1e-6)


def test_ball_with_a_radius_touches_with_its_lowest_point() -> None:
    scenario = load("bouncing_ball", radius=0.2, height=0.5)
    result = simulate(scenario.model, 0.5)
    first = next(e for e in result.events if e.kind == "impact")
    assert first.t == pytest.approx(math.sqrt(2.0 * 0.5 / 9.81), rel=1e-7)
    assert result["ball.y"].min() == pytest.approx(0.2, abs=1e-7)


def test_pendulum_strikes_the_stop_three_times() -> None:
    scenario = load("pendulum_stop")
    result = simulate(scenario.model, scenario.t_end, rtol=1e-8, atol=1e-10)
    impacts = [e for e in result.events if e.kind == "impact"]
    assert len(impacts) >= 3
    assert impacts[0].t == pytest.approx(ellipk(0.5) / math.sqrt(1.5 * 9.81), rel=1e-7)
    assert impacts[0].approach_speed == pytest.approx(math.sqrt(3.0 * 9.81), rel=1e-7)
    # effective mass m/3 at the tip
    assert impacts[0].impulse == pytest.approx(1.7 * impacts[0].approach_speed / 3.0, rel=1e-7)
    for impact in impacts:
        assert impact.separation_speed == pytest.approx(0.7 * impact.approach_speed, rel=1e-7)


def test_impact_oscillator_settles_on_the_known_orbit() -> None:
    """One impact a period at phase 0.77427 with v+ = -4.15672 (both from the closed form of the flight)."""
    period = math.pi
    scenario = load("impact_oscillator", damping_ratio=0.02, frequency=2.0)
    result = simulate(scenario.model, 100.0 * period, rtol=1e-9, atol=1e-11, record=False)
    last = [e for e in result.events if e.kind == "impact"][-1]
    assert last.t % period == pytest.approx(0.7742709267, abs=1e-7)
    assert last.separation_speed == pytest.approx(4.1567220979, abs=1e-7)
    assert last.separation_speed == pytest.approx(0.8 * last.approach_speed, rel=1e-12)


def test_impact_oscillator_strikes_where_its_stop_is() -> None:
    result = simulate(load("impact_oscillator", stop_position=0.05).model, 20.0)
    impacts = [e.t for e in result.events if e.kind == "impact"]
    assert len(impacts) > 5
    assert result["mass.x"].max() == pytest.approx(0.05, abs=1e-9)
    assert result["mass.y"] == pytest.approx(0.0, abs=1e-12)


def test_impact_oscillator_starts_left_of_its_stop() -> None:
    with pytest.raises(ScenarioError, match="start_position = 1 lies behind the stop"):
        load("impact_oscillator", start_position=1.0)


@pytest.mark.parametrize("law", ["hertz", "kelvin_voigt", "gonthier"])
def test_force_laws_give_the_restitution_they_promise(law: str) -> None:
    """Stiff contact, so that weight does nothing to speak of while it lasts."""
    scenario = load("bouncing_ball", law=law, restitution=0.7, stiffness=1e8)
    result = simulate(scenario.model, 0.6, rtol=1e-8, atol=1e-11)
    opened = next(e for e in result.events if e.kind == "open")
    expected = 1.0 if law == "hertz" else 0.7
    assert opened.separation_speed / opened.approach_speed == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("links", [1, 2, 5])
def test_chain_follows_minimal_coordinates(links: int) -> None:
    times = np.linspace(0.0, 1.0, 11)
    exact = chain_reference().chain_reference(links, times)
    result = simulate(load("chain", links=links).model, 1.0, rtol=1e-9, atol=1e-11, t_eval=times)
    for k in range(links):
        assert np.abs(result[f"link{k + 1}.angle"] - exact.angles[k]).max() < 1e-6
        assert np.abs(result[f"link{k + 1}.angular_velocity"] - exact.rates[k]).max() < 1e-5


def test_chain_reference_keeps_its_energy_and_swings_as_a_pendulum() -> None:
    module = chain_reference()
    found = module.chain_reference(1, np.array([0.0, ellipk(0.5) / math.sqrt(1.5 * 9.81)]))
    assert found.angles[0, -1] == pytest.approx(-math.pi / 2, abs=1e-10)
    found = module.chain_reference(3, np.linspace(0.0, 2.0, 9), length=0.5, mass=2.0)
    x = y = vx = vy = np.zeros(9)
    energy = np.zeros(9)
    for angle, rate in zip(found.angles, found.rates, strict=True):
        for half in range(2):
            x, y = x + 0.25 * np.cos(angle), y + 0.25 * np.sin(angle)
            vx, vy = vx - 0.25 * np.sin(angle) * rate, vy + 0.25 * np.cos(angle) * rate
            if half == 0:
                energy = energy + 0.5 * 2.0 * (vx**2 + vy**2) + 0.5 * (2.0 * 0.25 / 12.0) * rate**2 + 2.0 * 9.81 * y
    assert np.abs(energy).max() < 1e-9
    assert np.allclose(found.tip, [x, y])


@pytest.mark.parametrize("start", [0.0, -math.pi])
def test_driven_and_plain_pendulum_move_alike(start: float) -> None:
    """The torque channel at rest adds nothing, from either side of the stop."""
    runs = [
        simulate(load("pendulum_stop", driven=driven, start_angle=start).model, 1.0, rtol=1e-9, atol=1e-11)
        for driven in (True, False)
    ]
    ends = [run["pendulum.angle"][-1] for run in runs]
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)
    assert len(runs[0].events) == len(runs[1].events) >= 1
