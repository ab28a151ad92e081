"""Every example runs, meets its closed form, and draws its figure."""

import importlib.util
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.py"))
SMALLER: dict[str, tuple[int, ...]] = {"disks_in_a_box": (10,), "oscillator_sweeps": (7, 4)}
"""Arguments of `run` for a figure, where the whole takes long and is run by a test of its own."""


@cache
def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"example_{name}", EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@cache
def figures(name: str) -> dict[str, Any]:
    """Each example is run once."""
    found: dict[str, Any] = example(name).run()
    return found


def test_bouncing_ball_strikes_when_the_closed_form_says() -> None:
    f = figures("bouncing_ball")
    assert len(f["impacts"]) > 40
    assert np.max(np.abs(f["impacts"] - f["expected_impacts"])) < 1e-9


def test_bouncing_ball_comes_to_rest_on_its_weight() -> None:
    f = figures("bouncing_ball")
    # the rest rule ends the sequence where the rebound is a millionth of the first approach speed
    assert 0.0 < f["expected_rest"] - f["rest"] < 1e-5
    assert f["force_at_rest"] == pytest.approx(2.0 * 9.81, rel=1e-12)
    assert f["largest_energy_balance"] < 1e-8 * 2.0 * 9.81


def test_pendulum_strikes_at_the_time_of_the_quadrature_and_rests_in_static_equilibrium() -> None:
    f = figures("pendulum_stop")
    assert f["impacts"][0].t == pytest.approx(f["expected_first_impact"], abs=1e-6)
    assert f["force_at_rest"] == pytest.approx(f["expected_force_at_rest"], rel=1e-9)
    assert f["result"].events[-1].kind == "rest"


def test_pendulum_meets_its_constraints_at_all_levels() -> None:
    f = figures("pendulum_stop")
    assert max(f["residuals"].values()) < 1e-9
    assert f["velocity_increment_residual"] < 1e-13


def test_pendulum_keeps_its_energy_ledger() -> None:
    f = figures("pendulum_stop")
    lost = sum(event.energy_loss for event in f["impacts"])
    # all the energy from the start angle to the stop is lost: m g L/2 sin(1)
    assert lost == pytest.approx(0.5 * 9.81 * np.sin(1.0), rel=1e-5)
    assert f["largest_energy_balance"] < 1e-5


def test_bead_on_the_turning_rod_follows_the_closed_form() -> None:
    f = figures("own_equations")
    first, second = f["impacts"][:2]
    assert f["largest_radius_error"] < 1e-6
    assert first.t == pytest.approx(f["expected_first_impact"], abs=1e-6)
    assert first.approach_speed == pytest.approx(f["expected_approach_speed"], rel=1e-6)
    assert second.t == pytest.approx(f["expected_second_impact"], abs=1e-5)
    assert f["force_at_rest"] == pytest.approx(f["expected_force_at_rest"], rel=1e-6)
    assert max(f["residuals"].values()) < 1e-9


def test_swinging_atwood_machine_keeps_its_second_integral() -> None:
    f = figures("own_elements")
    assert f["integral"] == pytest.approx(np.full_like(f["integral"], f["expected_integral"]), abs=1e-6)
    assert f["tension"] == pytest.approx(f["expected_tension"], rel=1e-8)
    assert np.ptp(f["result"]["weight.y"]) > 0.5
    assert f["largest_energy_balance"] < 1e-6
    assert max(f["residuals"].values()) < 1e-8


def test_impact_oscillator_is_stable_or_chaotic_and_loses_what_damping_and_impacts_take() -> None:
    f = figures("impact_oscillator")
    assert f["closure"] < 1e-7
    assert np.max(np.abs(f["multipliers"])) < 0.8
    assert f["product"] == pytest.approx(f["expected_product"], rel=1e-7)
    assert f["chaos"].exponents[0] > 3.0 * f["chaos"].errors[0]
    assert f["sum"] == pytest.approx(f["expected_sum"], abs=1e-6)


def test_block_on_the_belt_sticks_and_slips_when_the_closed_form_says() -> None:
    f = figures("stick_slip")
    assert f["kinds"] == ["slip", "stick"] * 5 + ["slip"]
    assert np.max(np.abs(f["times"] - f["expected_times"])) < 1e-9
    assert f["largest_energy_balance"] < 1e-8


def test_rod_bounces_off_the_wall_as_st_venant_says() -> None:
    f = figures("rod_wall")
    assert f["duration"] == pytest.approx(f["expected_duration"], rel=0.01)
    assert f["force"] == pytest.approx(f["expected_force"], rel=1e-3)
    assert f["loss"] == pytest.approx(f["expected_loss"], rel=1e-6) and f["massless_loss"] == 0.0
    assert f["impulse"] == pytest.approx(2.0, rel=0.01)
    fields = f["fields"]
    # half way through the contact the rod stands still, under the same stress everywhere
    middle = np.argmin(np.abs(fields.t - f["touch"] - f["unit"]))
    assert np.max(np.abs(fields.velocity[middle, 20:])) < 0.2 * 0.1
    assert np.mean(fields.axial_force[middle]) == pytest.approx(-f["expected_force"], rel=0.02)


def test_hub_is_thrown_back_by_the_same_impulse_in_all_formulations() -> None:
    f = figures("hub_beam_stop")
    impulses = np.array(list(f["impulses"].values()))
    assert np.ptp(impulses) < 1e-3 * impulses.mean()
    # what hub and beam carry, by points along the beam
    assert f["start"] == pytest.approx(f["expected_start"], rel=1e-6)
    assert f["impulses"]["floating frame, CCM"] == pytest.approx(f["expected_impulse"], rel=1e-3)
    assert f["largest_energy_balance"] < 1e-5 * f["energy"]


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", NAMES)
def test_every_example_draws_its_figure(name: str, tmp_path: Path) -> None:
    path = tmp_path / "figure.png"
    found = example(name).run(*SMALLER[name]) if name in SMALLER else figures(name)
    example(name).plot(found, path)
    assert path.read_bytes().startswith(b"\x89PNG")


def test_rope_on_the_ground_loses_energy_at_impacts_and_in_the_material_only() -> None:
    f = figures("cable_ground")
    assert f["impacts"] > 8
    assert f["largest_balance"] < 2e-3 * f["start"]
    assert f["deepest"] > -1e-8
    assert 0.0 < f["lost_at_impacts"] < f["start"] and 0.0 < f["lost_in_material"] < f["start"]
    assert abs(f["shapes"][0, -1, 0] - 1.0) < 1e-12 and f["shapes"][:, :, 1].min() > -0.05


def test_halves_that_touch_come_to_the_whole_with_the_order_of_their_coupling() -> None:
    pytest.importorskip("fmpy")
    f = figures("split_mechanism")
    first, second = (example("split_mechanism").STEPS[k] for k in (1, 2))
    for algorithm, order in (("jacobi", 1.0), ("newton", 2.0)):
        errors = [f["errors"][algorithm, step] for step in (first, second)]
        assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.35)
    assert f["errors"]["newton", second] < 0.01 * f["errors"]["jacobi", second]


def test_a_late_force_gives_energy_to_the_blow_and_one_in_time_does_not() -> None:
    pytest.importorskip("fmpy")
    f = figures("split_mechanism")
    step = example("split_mechanism").STEPS[1]
    whole = f["whole"]["energy.kinetic"][-1] + f["whole"]["energy.strain"][-1]
    gained = {}
    for algorithm in ("jacobi", "newton"):
        r = f["runs"][algorithm, step]
        gained[algorithm] = sum(r[f"{i}.energy.{k}"][-1] for i in ("striker", "wall") for k in ("kinetic", "strain"))
        gained[algorithm] -= whole
    assert gained["jacobi"] > 0.01 and abs(gained["newton"]) < 0.1 * gained["jacobi"]


def test_the_trolley_loses_at_the_buffer_what_the_buffer_pushes(tmp_path: Path) -> None:
    f = figures("see_it_move")
    assert f["momentum_before"] == pytest.approx(np.full(len(f["momentum_before"]), f["expected_momentum"]), rel=1e-9)
    assert f["result"].events[0].t == pytest.approx(f["expected_strike"], abs=1e-9)
    assert len(f["impulses"]) > 1
    assert f["losses"][: len(f["impulses"])] == pytest.approx(f["impulses"], rel=1e-6, abs=1e-9)
    assert f["largest_energy_balance"] < 1e-4
    assert np.array_equal(f["stored"]["load.angle"], f["result"]["load.angle"])
    assert f["rest"].q[-1] == pytest.approx(f["result"].q[-1], abs=1e-5)
    example("see_it_move").animate(f, tmp_path / "crane.html")
    assert "A trolley strikes a buffer" in (tmp_path / "crane.html").read_text(encoding="utf-8")


def test_the_oscillator_doubles_its_period_and_two_motions_live_side_by_side() -> None:
    """Two velocities, then four, then many; the free motion is reached from where it is, and not from everywhere."""
    pytest.importorskip("pyarrow")
    f = figures("oscillator_sweeps")
    count = {e: example("oscillator_sweeps").velocities(f, e) for e in (0.36, 0.5, 0.9)}
    assert count[0.36] == 2 and count[0.5] == 4 and count[0.9] > 8
    assert not f["basin"].failures and 0.05 < np.mean(f["free"]) < 0.95
    near = np.hypot(f["basin"]["start.mass.x"] - f["free_motion"][0], f["basin"]["start.mass.vx"] - f["free_motion"][1])
    assert f["free"][np.argmin(near)]


def test_identification_finds_restitution_and_damping() -> None:
    f = figures("identification")
    found = f["found"]
    for name, value in f["true"].items():
        k = found.names.index(name)
        assert abs(found.values[k] - value) < 4.0 * found.errors[k]
    assert found.noise == pytest.approx(1.0, abs=0.35)


def test_the_boom_rests_on_its_stop_as_statics_say() -> None:
    f = figures("cylinder_linkage")
    assert f["stop_torque"] == pytest.approx(f["expected_stop_torque"], rel=1e-6)
    assert np.degrees(f["result"]["boom.angle"][-1]) == pytest.approx(40.0, abs=1e-6)


def test_the_follower_lifts_off_where_its_force_on_the_cam_vanishes() -> None:
    """Height of the roller on the circle, its second derivative with speed and acceleration of the cam."""
    e = example("cam_follower")
    t = np.linspace(0.2, 2.0, 400_001)
    p, rate = 0.5 * e.GAIN * t**2, e.GAIN * t
    s, c = e.OFFSET * np.sin(p), e.OFFSET * np.cos(p)
    root = np.sqrt(e.REACH**2 - c**2)
    slope, bend = c + c * s / root, -s + (c**2 - s**2) / root - (c * s) ** 2 / root**3
    pressed = e.MASS * (e.G + bend * rate**2 + slope * e.GAIN) + e.STIFFNESS * (s + root) > 0.0
    assert figures("cam_follower")["lift_off"] == pytest.approx(t[np.argmin(pressed)], abs=1e-3)


def test_the_slack_rope_jerks_as_the_closed_form_says() -> None:
    f = figures("slack_rope")
    assert f["jerk"].t == pytest.approx(f["expected_time"], abs=1e-9)
    assert f["jerk"].impulse == pytest.approx(f["expected_impulse"], rel=1e-8)
    assert f["jerk"].energy_loss == pytest.approx(f["expected_loss"], rel=1e-8)
    assert f["longest"] < 1.0 + 1e-8 and f["balance"] < 1e-7
    assert any(event.kind == "open" for event in f["result"].events)


def test_forty_disks_come_to_rest_on_floor_and_walls() -> None:
    f = figures("disks_in_a_box")
    # friction that is smooth lets them creep
    assert f["carried"] == pytest.approx(f["weight"], rel=0.02) and f["kinetic"] < 2e-3
    # a part of Hertz's overlap under the weight of a column, and the ledger
    assert 0.0 < f["overlap"] < 0.1 * example("disks_in_a_box").RADIUS and f["balance"] < 5e-3


def test_disks_whose_contacts_are_constraints_do_not_overlap() -> None:
    f = example("disks_in_a_box").run(6, hard=True)
    assert f["carried"] == pytest.approx(f["weight"], rel=1e-9)
    assert f["kinetic"] < 1e-12 and f["overlap"] < 1e-9 and f["balance"] < 1e-5


def test_thrown_shapes_end_on_the_floor_and_friction_gives_no_energy() -> None:
    f = figures("thrown_shapes")
    assert f["deepest"] > -1e-9 and f["gained"] < 1e-6
    assert f["box_height"] == pytest.approx(0.5 * example("thrown_shapes").BOX[2], abs=1e-9) and f["box_speed"] < 1e-9
    assert f["ball_slips"] == pytest.approx(0.0, abs=1e-9)


def test_the_elbow_stays_in_its_range_and_only_blows_take_energy() -> None:
    f = figures("joint_limits")
    low, high = example("joint_limits").RANGE
    assert f["elbow"].min() > low - 1e-9 and f["elbow"].max() < high + 1e-9
    assert f["lost"] > 1.0 and f["missing"] == pytest.approx(f["lost"], abs=1e-5)


def test_the_pulled_block_slips_when_friction_below_it_is_used_up() -> None:
    f = figures("pulled_block")
    assert f["slip"] == pytest.approx(f["expected_slip"], abs=1e-9)
    assert f["balance"] < 1e-6


def test_a_rod_that_bends_is_struck_as_the_law_says_and_hardly_otherwise_than_a_stiff_one() -> None:
    f = figures("flexible_slider_crank")
    assert f["separation_over_approach"] == pytest.approx(0.5, rel=1e-8)
    assert f["blow"].t == pytest.approx(f["stiff_blow"].t, abs=1e-4)
    assert f["balance"] < 1e-4 * f["energy"]


def test_gears_with_play_strike_by_one_flank_and_then_by_the_other() -> None:
    f, e = figures("gear_backlash"), example("gear_backlash")
    # the driver, a sine, has used up half the play: r a sin(w t) = b/2
    assert f["first"].t == pytest.approx(np.arcsin(0.5 * e.BACKLASH / (e.RADII[0] * e.SWING)) / e.RATE, abs=1e-9)
    assert np.abs(f["play"]).max() < 0.5 * e.BACKLASH + 1e-9
    assert {event.contact for event in f["result"].events if event.kind == "impact"} == {"front", "back"}


def test_the_pole_is_struck_as_the_law_says_and_the_cart_brings_it_back() -> None:
    f, e = figures("cart_pole"), example("cart_pole")
    (blow,) = f["result"].events
    assert blow.kind == "impact" and blow.separation_speed == pytest.approx(0.6 * blow.approach_speed, rel=1e-8)
    # what moves cart and pole along the rail is no more than both controllers give
    assert 10.0 < np.abs(f["force"]).max() <= 25.0 + 5.0 + 1e-6
    assert np.degrees(np.abs(f["lean"]).max()) > 3.0
    assert np.degrees(np.abs(f["lean"][-1])) < 0.1 and abs(f["result"]["cart.x"][-1]) < 0.3
    assert f["balance"] < 1e-6 * e.G


@pytest.mark.parametrize(
    "name", ["cam_follower", "cylinder_linkage", "disks_in_a_box", "flexible_slider_crank", "gear_backlash",
             "joint_limits", "pulled_block", "slack_rope"],
)  # fmt: skip
def test_a_model_that_shows_something_is_a_short_script_with_a_moving_picture(name: str) -> None:
    assert len((EXAMPLES / f"{name}.py").read_text(encoding="utf-8").splitlines()) < 60
    assert (EXAMPLES.parent / "docs" / "gallery" / f"{name}.gif").is_file()


@pytest.mark.parametrize("name", sorted(path.stem for path in EXAMPLES.glob("*.py")))
def test_every_example_has_a_picture(name: str) -> None:
    docs = EXAMPLES.parent / "docs"
    places = (docs / "gallery" / f"{name}.gif", docs / "gallery" / f"{name}.png", docs / "images" / f"{name}.png")
    assert any(place.is_file() for place in places)
