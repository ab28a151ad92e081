"""The rolling disk against closed forms: circles, energy, stability of the upright motion."""

import numpy as np
import pytest
from tlismni.core import simulate
from tlismni.models import load
from tlismni.models.rolling_disk import steady_spin

METHODS = ("ebdf", "bdf", "mebdf", "irk", "adams", "newmark", "hht")


def check_levels(result, most=1e-10):
    """Rolling and norm at all levels; accelerations in parts of the largest one."""
    assert np.abs(result["residual.position"]).max() < most
    assert np.abs(result["residual.velocity"]).max() < most
    assert np.abs(result["residual.acceleration"]).max() < most * max(1.0, np.abs(result.a).max())


@pytest.mark.parametrize("method, most", [(m, 3e-4 if m in ("newmark", "hht", "bdf") else 1e-5) for m in METHODS])
def test_steady_rolling_in_a_circle(method, most):
    """The centre goes round with the precession on the circle of radius v/W."""
    sc = load("rolling_disk")
    times = np.linspace(0.0, sc.t_end, 9)
    result = simulate(sc.model, sc.t_end, method, rtol=1e-8, atol=1e-10, t_eval=times)
    speed = sc.model.bodies[0].velocity[1]
    rate = sc.parameters["precession"]
    radius = speed / rate
    x, y, z = (result[f"disk.{axis}"] for axis in "xyz")
    assert np.abs(x - radius * (np.cos(rate * times) - 1.0)).max() < most * abs(radius)
    assert np.abs(y - radius * np.sin(rate * times)).max() < most * abs(radius)
    assert np.ptp(z) < most * z[0]
    # the plane carries the weight and turns the velocity
    assert result["rolling.force_z"] == pytest.approx(9.81, rel=10.0 * most)
    along = result["rolling.force_x"] * np.cos(rate * times) + result["rolling.force_y"] * np.sin(rate * times)
    assert along == pytest.approx(-radius * rate**2, rel=100.0 * most)
    check_levels(result)


@pytest.mark.parametrize("tilt, precession, rim", [(0.6, 5.0, 0.0), (1.4, -2.0, 0.0), (2.2, 4.0, 0.0)])
def test_other_circles(tilt, precession, rim):
    spin = steady_spin(2.0, 0.5, 0.3, 0.2, 9.0, tilt, precession)
    sc = load(
        "rolling_disk", mass=2.0, radius=0.5, axial_inertia=0.3, transverse_inertia=0.2, gravity=9.0, tilt=tilt,
        precession=precession, spin=spin, end_time=1.0,
    )  # fmt: skip
    result = simulate(sc.model, 1.0, "irk", rtol=1e-10, atol=1e-12, t_eval=[1.0])
    assert result["disk.z"][0] == pytest.approx(0.5 * np.sin(tilt), abs=1e-8)
    assert result["disk.angular_velocity_z"][0] == pytest.approx(spin * np.cos(tilt) + precession * np.sin(tilt) ** 2)


@pytest.mark.parametrize("rim_radius", [0.0, 0.05])
def test_wobbling_disk_keeps_its_energy(rim_radius):
    sc = load("rolling_disk", tilt_rate=1.0, rim_radius=rim_radius)
    result = simulate(sc.model, 2.0, "irk", rtol=1e-10, atol=1e-12)
    energy = result["energy.kinetic"] + result["energy.potential"]
    assert np.ptp(result["disk.z"]) > 0.01
    assert np.ptp(energy) < 1e-8 * energy[0]
    check_levels(result)


def test_forces_of_the_plane_move_the_disk():
    sc = load("rolling_disk", tilt_rate=1.0, rim_radius=0.04)
    result = simulate(sc.model, 1.0, "irk", rtol=1e-10, atol=1e-12)
    force = np.stack([result[f"rolling.force_{axis}"] for axis in "xyz"], axis=1)
    assert np.abs(force - (result.a[:, :3] + [0.0, 0.0, 9.81])).max() < 1e-7 * np.abs(force).max()
    # moments about the centre of mass: J w' + w x J w, in the body's axes
    inertia = np.array([0.0225, 0.0225, 0.045])
    w = np.stack([result[f"disk.body_angular_velocity_{axis}"] for axis in "xyz"], axis=1)
    turn = np.stack([result[f"disk.angular_acceleration_{axis}"] for axis in "xyz"], axis=1)
    torque = np.stack([result[f"rolling.torque_{axis}"] for axis in "xyz"], axis=1)
    e0, e = result["disk.e0"], np.stack([result[f"disk.e{k}"] for k in (1, 2, 3)], axis=1)

    def in_body(x):
        """A^T x."""
        back = 2.0 * np.sum(e * x, axis=1)[:, None] * e - 2.0 * e0[:, None] * np.cross(e, x)
        return (e0**2 - np.sum(e * e, axis=1))[:, None] * x + back

    left = inertia * in_body(turn) + np.cross(w, inertia * w)
    assert np.abs(left - in_body(torque)).max() < 1e-7 * np.abs(left).max()


@pytest.mark.parametrize("faster, grows", [(1.05, False), (0.95, True)])
def test_upright_rolling_is_stable_above_its_speed(faster, grows):
    """A disk rolls upright stably for v^2 > g r/3 (Neimark and Fufaev)."""
    speed = faster * np.sqrt(9.81 * 0.3 / 3.0)
    sc = load("rolling_disk", tilt=0.5 * np.pi + 1e-6, precession=0.0, spin=speed / 0.3)
    result = simulate(sc.model, 6.0, "irk", rtol=1e-11, atol=1e-13)
    lean = np.abs(result["disk.z"] - 0.3)
    assert (lean.max() > 1e-10) == grows


@pytest.mark.parametrize(
    "method, options, expected, steps",
    [
        ("newmark", {}, 2, (200, 400)),
        ("hht", {"alpha": -0.1}, 2, (200, 400)),
        ("bdf", {"order": 2}, 2, (400, 800)),
        ("bdf", {"order": 3}, 3, (200, 400)),
        ("bdf", {"order": 4}, 4, (200, 400)),
        ("ebdf", {"k": 2}, 3, (200, 400)),
        ("ebdf", {"k": 3}, 4, (100, 200)),
        ("mebdf", {"k": 3}, 4, (100, 200)),
        ("adams", {"order": 4}, 4, (100, 200)),
        ("irk", {"tableau": "sdirk4"}, 4, (50, 100)),
        ("irk", {"tableau": "radau3"}, 5, (20, 40)),
        # with alpha < 0 both are of order 1 in space: M(q) and a belong to two times (the heavy top too)
        ("hht_i3", {"alpha": 0.0}, 2, (200, 400)),
        ("hht_ggl", {"alpha": 0.0}, 2, (200, 400)),
        ("hht_i3", {"alpha": -0.2}, 2, (200, 400)),
        ("hht_ggl", {"alpha": -0.2}, 2, (200, 400)),
        ("generalized_alpha", {"form": "index3"}, 2, (200, 400)),
        ("generalized_alpha", {"form": "index2"}, 2, (200, 400)),
        ("baumgarte", {"scheme": "rk23"}, 3, (100, 200)),
        ("baumgarte", {"scheme": "sdirk4"}, 4, (50, 100)),
    ],
)
def test_order_with_velocity_level_rows(method, options, expected, steps):
    """A wobbling disk after 0.5 s: its coordinates and velocities against a much finer run."""
    model = load("rolling_disk", tilt_rate=1.0).model
    fine = simulate(model, 0.5, "irk", rtol=1e-13, atol=1e-14, t_eval=[0.5])
    exact = np.concatenate([fine.q[-1], fine.v[-1]])
    errors = []
    for count in steps:
        found = simulate(model, 0.5, method, step=0.5 / count, newton_tolerance=1e-13, record=False, **options)
        errors.append(np.abs(np.concatenate([found.q[-1], found.v[-1]]) - exact).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(expected, abs=0.25), errors
