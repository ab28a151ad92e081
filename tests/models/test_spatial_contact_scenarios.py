"""Scenarios with contact in space: closed forms, momentum, and energy that never grows."""

import numpy as np
import pytest
from tlismni.core import simulate
from tlismni.models import ScenarioError, load

UP = np.array([0.0, 0.0, 1.0])


def run(name, method="ebdf", **parameters):
    """The scenario's run, which must meet its constraints at all levels."""
    scenario = load(name, **parameters)
    result = simulate(scenario.model, scenario.t_end, method, rtol=1e-9, atol=1e-11)
    for level, most in (("position", 1e-10), ("velocity", 1e-10), ("acceleration", 1e-10 * np.abs(result.a).max())):
        assert np.abs(result[f"residual.{level}"]).max() < max(most, 1e-10), level
    return scenario, result


def total(result):
    return result["energy.kinetic"] + result["energy.potential"] + result["energy.strain"]


def vector(result, name, at):
    return np.array([result[f"{name}{axis}"][at] for axis in "xyz"])


def test_spinning_sphere_bounces_slides_and_rolls():
    _, result = run("spinning_sphere")
    v, w, radius = np.array([2.0, -0.5, 0.0]), np.array([30.0, -60.0, 20.0]), 0.1
    rolls = (5.0 * v + 2.0 * radius * np.cross(w, UP)) / 7.0
    assert vector(result, "ball.v", -1) == pytest.approx(rolls, abs=1e-6)
    kinds = [event.kind for event in result.events]
    assert kinds.count("impact") > 10 and "rest" in kinds
    assert np.all(np.diff(total(result)) < 1e-7)
    assert result["floor.sliding_velocity"][-1] < 1e-12


def test_spinning_sphere_with_a_force_law_comes_near():
    _, hard = run("spinning_sphere")
    _, soft = run("spinning_sphere", law="hunt_crossley", stiffness=1e7, restitution=0.3)
    assert vector(soft, "ball.v", -1)[:2] == pytest.approx(vector(hard, "ball.v", -1)[:2], abs=0.02)


def test_spatial_cradle_keeps_energy_and_strikes_beside_the_middle():
    _, result = run("spatial_cradle")
    energy = total(result)
    assert np.abs(energy - energy[0]).max() < 1e-6 * abs(energy[0])
    blows = [event for event in result.events if event.kind == "impact"]
    assert len(blows) >= 4
    assert all(event.separation_speed == pytest.approx(event.approach_speed, rel=1e-8) for event in blows)
    assert abs(result["ball2.vy"]).max() > 1e-3


def test_spatial_cradle_without_a_pull_aside_stays_in_its_plane():
    _, result = run("spatial_cradle", aside=0.0)
    _, flat = run("newtons_cradle", balls=3, gap=2e-3, radius=0.02)
    assert np.abs(result["ball1.y"]).max() < 1e-12
    times = [[e.t for e in r.events if e.kind == "impact"][:4] for r in (result, flat)]
    assert times[0] == pytest.approx(times[1], abs=1e-7)


def test_arm_keeps_its_angular_momentum_about_the_vertical():
    """The shoulder's spring acts inside, the table has no friction."""
    scenario, result = run("arm_stop")
    assert [event for event in result.events if event.kind == "impact"]
    momentum = []
    for at in (0, -1):
        found = 0.0
        for body in scenario.model.bodies:
            x, v = vector(result, f"{body.name}.", at), vector(result, f"{body.name}.v", at)
            found += body.mass * np.cross(x, v)[2]
            e0, e = result[f"{body.name}.e0"][at], np.array([result[f"{body.name}.e{k}"][at] for k in (1, 2, 3)])
            tilde = np.array([[0.0, -e[2], e[1]], [e[2], 0.0, -e[0]], [-e[1], e[0], 0.0]])
            turn = (e0**2 - e @ e) * np.eye(3) + 2.0 * np.outer(e, e) + 2.0 * e0 * tilde
            w = vector(result, f"{body.name}.body_angular_velocity_", at)
            found += (turn @ np.diag(body.inertia) @ w)[2]
        momentum.append(found)
    assert momentum[1] == pytest.approx(momentum[0], rel=1e-7)
    assert np.all(np.diff(total(result)) < 1e-7)


def test_arm_strikes_its_end_stop_and_the_table():
    """Each blow of one contact alone has its own restitution; behind the stop the elbow does not go."""
    _, result = run("arm_stop")
    first = next(event for event in result.events if event.kind == "impact")
    assert first.contact == "elbow_stop"
    assert first.separation_speed == pytest.approx(0.3 * first.approach_speed, rel=1e-8)
    table = next(event for event in result.events if event.contact == "table")
    assert table.separation_speed == pytest.approx(0.4 * table.approach_speed, rel=1e-8)
    assert result["elbow.angle"].min() > -0.4 - 1e-9
    _, free = run("arm_stop", elbow_limit=None)
    assert free["elbow.angle"].min() < -1.0 and not any(e.contact == "elbow_stop" for e in free.events)
    _, soft = run("arm_stop", law="hunt_crossley", stop_stiffness=1e6)
    start = next(event.t for event in soft.events if event.contact == "elbow_stop")
    assert start == pytest.approx(first.t, abs=1e-8)
    with pytest.raises(ScenarioError, match="at or beyond the end stop"):
        load("arm_stop", elbow_angle=-0.4)
    with pytest.raises(ScenarioError, match="in the table"):
        load("arm_stop", shoulder_angle=1.5)


def test_arm_with_friction_on_the_table_loses_turning():
    _, smooth = run("arm_stop")
    _, rough = run("arm_stop", friction=0.3)
    assert np.all(np.diff(total(rough)) < 1e-7)
    rates = [result["column.angular_velocity_z"][-1] for result in (smooth, rough)]
    assert abs(rates[1] - rates[0]) > 1e-2


@pytest.mark.parametrize(
    "name, parameters",
    [
        ("arm_stop", {"shoulder_angle": -0.5, "elbow_angle": 0.3, "shoulder_rate": 1.0, "elbow_rate": -2.0}),
        ("heavy_top", {"tilt_x": 0.5, "tilt_y": -0.3, "tilt_z": 1.0, "spin": 20.0}),
        ("universal_pendulum", {"rate_x": 0.7, "rate_y": -1.1}),
        ("bricard", {"rate": 1.5}),
        ("spatial_cradle", {"angle_rate": -1.0, "aside_rate": 2.0, "friction": 0.2}),
        ("dropped_box", {"velocity_y": 0.3, "velocity_z": 1.0, "spin_x": 1.0, "spin_y": 2.0, "inertia_x": 0.02}),
    ],
)
def test_other_starts_meet_the_joints(name, parameters):
    """The builder's kinematics: nothing has to be moved at the start, and energy is kept or lost."""
    scenario = load(name, **parameters)
    result = simulate(scenario.model, 0.2, rtol=1e-9, atol=1e-11)
    states = [body.initial_state() for body in scenario.model.bodies]
    assert result.q[0] == pytest.approx(np.concatenate([q for q, _ in states]), abs=1e-13)
    assert result.v[0] == pytest.approx(np.concatenate([v for _, v in states]), abs=1e-13)
    assert np.all(np.diff(total(result)) < 1e-7 * np.abs(total(result)).max())


def test_starts_say_the_rates_of_the_joints():
    arm = simulate(load("arm_stop", shoulder_angle=-0.5, elbow_angle=0.3, elbow_rate=-2.0).model, 1e-3)
    assert [arm[f"{name}.angle"][0] for name in ("shoulder", "elbow")] == pytest.approx([-0.5, 0.3])
    assert [arm[f"{name}.angular_velocity"][0] for name in ("shoulder", "elbow")] == pytest.approx([0.0, -2.0])
    loop = simulate(load("bricard", rate=1.5).model, 1e-3)
    assert [loop[f"hinge{k}.angular_velocity"][0] for k in range(6)] == pytest.approx([1.5, -1.5] * 3)


def test_a_heavy_top_that_starts_turned_about_the_vertical_moves_turned():
    turn = 0.7
    c, s = np.cos(turn), np.sin(turn)
    times = [0.1, 0.3]
    one, other = (
        simulate(load("heavy_top", tilt_z=z).model, 0.3, "irk", rtol=1e-11, atol=1e-13, t_eval=times)
        for z in (0.0, turn)
    )
    assert other["top.x"] == pytest.approx(c * one["top.x"] - s * one["top.y"], abs=1e-8)
    assert other["top.y"] == pytest.approx(s * one["top.x"] + c * one["top.y"], abs=1e-8)
    assert other["top.z"] == pytest.approx(one["top.z"], abs=1e-8)


def test_a_hollow_sphere_rolls_off_slower():
    """k = m R^2/J: it rolls with (k v + R w x n)/(1 + k)."""
    v, w, radius, inertia = np.array([2.0, -0.5, 0.0]), np.array([30.0, -60.0, 20.0]), 0.1, 2.0 / 3.0 * 0.01
    _, result = run("spinning_sphere", inertia=inertia, velocity_z=0.5)
    k = radius**2 / inertia
    assert vector(result, "ball.v", -1) == pytest.approx((k * v + radius * np.cross(w, UP)) / (1.0 + k), abs=1e-6)


def test_slider_crank_in_space_strikes_its_stop():
    _, free = run("spatial_slider_crank_stop", stop=0.5)
    assert not free.events
    _, result = run("spatial_slider_crank_stop")
    first = next(event for event in result.events if event.kind == "impact")
    assert first.separation_speed == pytest.approx(0.6 * first.approach_speed, rel=1e-8)
    assert result["stop.gap"].min() > -1e-9
    assert np.all(np.diff(total(result)) < 1e-6)
    with pytest.raises(ScenarioError, match="behind the stop"):
        load("spatial_slider_crank_stop", stop=0.1)


def test_dropped_box_lies_flat_in_the_end():
    _, result = run("dropped_box")
    assert np.all(np.diff(total(result)) < 1e-6 * total(result)[0])
    assert min(result[f"floor_ground_box_{k}.gap"].min() for k in range(1, 9)) > -1e-9
    assert abs(result["box.vz"][-1]) < 1e-8


def test_dropped_box_with_friction_of_a_force_law_comes_to_rest():
    _, result = run("dropped_box", law="hunt_crossley", friction=0.3, stiffness=1e5, transition_speed=1e-2)
    assert result["energy.kinetic"][-1] < 1e-4
    assert np.ptp(result["energy.balance"]) < 1e-6


@pytest.mark.sampled(1)
@pytest.mark.parametrize("law", ["newton", "hunt_crossley"])
def test_tippe_top_turns_over_and_rises_on_its_stem(law):
    """On a point Jellett's quantity of the sphere that touches alone is constant, energy falls, the centre of mass
    rises."""
    scenario, result = run(
        "tippe_top", law=law, restitution=0.0 if law == "newton" else 0.3, patch_radius=0.0, spin_tilt=0.1
    )
    (top,) = scenario.model.bodies
    e = np.stack([result[f"top.e{k}"] for k in range(4)])
    up = e[0] ** 2 - e[1] ** 2 - e[2] ** 2 + e[3] ** 2
    axis = np.stack([2.0 * (e[1] * e[3] + e[0] * e[2]), 2.0 * (e[2] * e[3] - e[0] * e[1]), up])
    w = np.stack([result[f"top.angular_velocity_{k}"] for k in "xyz"])
    across, _, along = top.inertia
    momentum = across * w + (along - across) * result["top.body_angular_velocity_z"] * axis

    def jellett(centre, radius):
        return np.sum(momentum * (centre * axis - radius * UP[:, None]), axis=0)

    stem = next(event.t for event in result.events if event.contact == "stem")
    first = jellett(3e-3, 15e-3)
    assert np.ptp(first[result.t < stem]) < 1e-7 * abs(first[0])
    last = max(event.t for event in result.events if event.contact == "floor")
    second = jellett(16e-3, 5e-3)[result.t > last]
    assert len(second) > 100 and np.ptp(second) < 1e-7 * abs(second[0])
    if law == "newton":  # both spheres touch
        assert np.interp(stem, result.t, up) == pytest.approx((5.0 - 15.0) / (16.0 - 3.0), abs=1e-6)
    assert up[0] > 0.99 and up[-1] < -0.95 and result["top.z"][-1] > result["top.z"][0] + 3e-3
    assert np.all(np.diff(total(result)) < 1e-7 * total(result)[0])
    assert np.ptp(result["energy.balance"]) < 1e-6 * total(result)[0]


def test_a_patch_slows_the_spin_of_a_tippe_top():
    """The torque (2/3) mu N eps takes from the angular momentum about the vertical, friction of a point does not here:
    upright on a sphere about its axis, C w' = -(2/3) mu m g eps."""
    eps = 5e-4
    _, result = run("tippe_top", tilt=0.0, patch_radius=eps)
    slows = 2.0 / 3.0 * 0.3 * 6e-3 * 9.81 * eps / 7e-7
    assert result["top.body_angular_velocity_z"] == pytest.approx(180.0 - slows * result.t, abs=1e-4)


def test_a_top_that_spins_about_its_axis_soon_rolls():
    """The torque of friction at a point rights it before it turns over; then nothing slides any more."""
    _, result = run("tippe_top", patch_radius=0.0)
    tilt = 2.0 * np.arcsin(np.hypot(result["top.e1"], result["top.e2"]))
    assert tilt.max() < 0.11 and tilt[-1] < 0.06
    assert [event.kind for event in result.events] == ["close", "stick"]


def test_a_flat_top_stays_upright():
    """Upright spin of a top on a sphere of radius R at e over its centre of mass is stable where A/C < 1 - e/R."""
    _, result = run("tippe_top", inertia_across=0.7 * 7e-7)
    tilt = 2.0 * np.arcsin(np.hypot(result["top.e1"], result["top.e2"]))
    assert tilt.max() < 0.25 and tilt[-1] < 0.12 and not any(event.contact == "stem" for event in result.events)


def test_a_stem_in_the_floor_is_refused():
    with pytest.raises(ScenarioError, match="in the floor"):
        load("tippe_top", stem_radius=0.1)
