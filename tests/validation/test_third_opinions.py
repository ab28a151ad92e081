"""Third opinions: against closed forms, and the solver against them on whole runs."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tlismni.core import simulate
from tlismni.models import load
from tlismni.validation.comparisons.common import touches
from tlismni.validation.opinions.mechanism import Law, Mechanism, run
from tlismni.validation.opinions.rods import struck_rod
from tlismni.validation.third_opinion import third_opinion

LAW = {"law": "hunt_crossley"}
RUNS: list[tuple[str, dict[str, Any], float | None]] = [
    ("bouncing_ball", {}, 2.5),
    ("bouncing_ball", LAW, 1.3),
    ("pendulum_stop", {}, 2.0),
    ("pendulum_stop", LAW, 1.5),
    ("slider_crank_stop", {}, 0.6),
    ("slider_crank_stop", LAW, None),
    ("double_pendulum_wall", {}, None),
    ("double_pendulum_wall", LAW, 1.3),
    ("impact_oscillator", {}, None),
    ("impact_oscillator", LAW, 3.0),
    ("newtons_cradle", {"gap": 2e-3, "balls": 3}, 0.4),
    ("split_whole", {}, None),
    ("slider_crank", {}, 0.5),
    ("four_bar", {}, 0.6),
    ("chain", {"links": 4}, 1.0),
    ("stick_slip", {}, None),
    ("stick_slip", {"law": "kelvin_voigt_gap", "stiffness": 1e5, "damping": 600.0, "transition_speed": 1e-2}, 1.0),
    ("rocking_block", {}, 2.0),
    ("woodpecker", {}, 0.3),
    ("free_body", {}, 2.0),
    ("heavy_top", {}, 0.3),
    ("heavy_top", {"tilt_x": 0.4, "spin": 20.0}, 1.0),
    ("universal_pendulum", {}, 3.0),
    ("universal_pendulum", {"rate_x": 1.0, "rate_y": -0.5, "tilt": 1.0}, 2.0),
    ("spatial_slider_crank", {}, 1.0),
    ("spatial_slider_crank_stop", {}, 0.6),
    ("spatial_slider_crank_stop", {**LAW, "stiffness": 1e6}, 0.4),
    ("rolling_disk", {}, 1.0),
    ("rolling_disk", {"tilt_rate": 1.0}, 1.0),
    ("spinning_sphere", {}, None),
    ("spinning_sphere", {"inertia": 0.005, "velocity_z": 0.5, "restitution": 0.8}, 1.5),
    ("spinning_sphere", {**LAW, "transition_speed": 1e-2}, 0.6),
    ("tippe_top", {}, 0.2),
    ("tippe_top", {"patch_radius": 0.0, "spin_tilt": 0.1}, 0.1),
    ("tippe_top", {"law": "hertz"}, 0.05),
    ("spatial_cradle", {}, 0.4),
    ("arm_stop", {}, 0.29),
    ("arm_stop", {"elbow_limit": None, "shoulder_angle": -0.3, "elbow_rate": 1.0}, 0.45),
    ("arm_stop", LAW, 0.25),
    ("spatial_cradle", {"law": "hertz", "stiffness": 1e7, "angle_rate": -1.0, "aside_rate": 1.0}, 0.25),
]


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name, parameters, t_end", RUNS, ids=lambda x: x if isinstance(x, str) else "")
def test_the_solver_follows_the_third_opinion(name: str, parameters: dict[str, Any], t_end: float | None) -> None:
    scenario = load(name, **parameters)
    scenario = replace(scenario, t_end=t_end or scenario.t_end)
    found = third_opinion(scenario)
    assert found is not None and found.channels
    result = simulate(scenario.model, scenario.t_end, "irk", 1e-9, 1e-11, t_eval=np.linspace(0.0, scenario.t_end, 97))
    compared = 0
    for channel, function in found.channels.items():
        apart = np.array([function(t) for t in result.t]) - result[channel]
        known = np.isfinite(apart)
        compared += int(known.sum())
        # an instant at which both strike may be on different sides of the jump
        worst = np.sort(np.abs(apart[known]))[:-1].max()
        size = 1e-3 * max(1.0, np.abs(result[channel]).max())
        assert worst < 2e-6 * max(np.ptp(result[channel]), size), channel
    assert compared > 50
    blows = touches(result.events)
    for contact in {blow.contact for blow in blows}:
        speed = found.values.get(f"{contact}: approach speed")
        first = next(blow for blow in blows if blow.contact == contact)
        if speed:
            assert speed == pytest.approx(first.approach_speed, rel=1e-6)
            assert found.values[f"{contact}: impulse"] == pytest.approx(first.impulse, rel=1e-6)


def test_a_ball_bounces_as_its_closed_form_says() -> None:
    height, gravity, e = 0.7, 9.81, 0.6
    ball = Mechanism(
        mass=lambda q: np.eye(1), force=lambda t, q, v: np.array([-gravity]), gaps=lambda q: q,
        gradients=lambda q: np.eye(1), laws=(Law(restitution=e),),
    )  # fmt: skip
    course = run(ball, (height,), (0.0,), 1.0)
    fall, speed = math.sqrt(2.0 * height / gravity), math.sqrt(2.0 * height * gravity)
    assert course.blows[0].start == pytest.approx(fall, rel=1e-11)
    assert course.blows[1].start == pytest.approx(fall + 2.0 * e * speed / gravity, rel=1e-11)
    assert course.blows[0].impulse == pytest.approx((1.0 + e) * speed, rel=1e-11)


def test_a_linear_spring_as_contact_takes_half_its_period() -> None:
    stiffness, speed = 1e4, 2.0
    mass = Mechanism(
        mass=lambda q: np.eye(1), force=lambda t, q, v: np.zeros(1), gaps=lambda q: q, gradients=lambda q: np.eye(1),
        laws=(Law(force=lambda d, dd, v0: stiffness * d),),
    )  # fmt: skip
    (blow,) = run(mass, (0.01,), (-speed,), 0.1).blows
    assert blow.end - blow.start == pytest.approx(math.pi / math.sqrt(stiffness), rel=1e-9)
    assert blow.peak_force == pytest.approx(speed * math.sqrt(stiffness), rel=1e-6)
    assert blow.impulse == pytest.approx(2.0 * speed, rel=1e-9)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("ratio, ends", [(1.0, 3.0677), (2.0, 4.7086), (4.0, 5.8996), (6.0, 7.4076)])
def test_a_mass_leaves_a_struck_rod_when_st_venant_says(ratio: float, ends: float) -> None:
    """In units of L/c: Goldsmith, Impact (1960), 3.4."""
    t, force = struck_rod(1.0, 1.0 / ratio, 2.0)
    assert t[-1] == pytest.approx(ends, abs=2e-3)
    assert force[0] == pytest.approx(1.0)


def test_where_the_block_would_slip_there_is_no_opinion() -> None:
    assert third_opinion(load("rocking_block", friction=0.15)) is None
    assert third_opinion(load("rocking_block", restitution=0.3)) is None
    assert third_opinion(load("newtons_cradle")) is None
