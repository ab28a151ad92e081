"""HHT on index 3 and 2, and generalized-alpha: damping, limit cases, consistent start, error estimates."""

import numpy as np
import pytest
from helpers import GROUND, G, on, order, pendulum_angles, point_pendulum
from tlismni.core import Model, PointMass2D, SpringDamper2D, simulate

H = 0.01


def oscillator(stiffness, deflection=0.01, speed=0.0):
    """A unit mass on a spring along x, at rest at x = 1: linear as long as the spring keeps its direction."""
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=stiffness, natural_length=1.0)
    body = PointMass2D(name="p", mass=1.0, position=(1.0 + deflection, 0.0), velocity=(speed, 0.0))
    return Model(gravity=(0.0, 0.0), bodies=[body], forces=[spring])


def spectral_radius(method, frequency_step=3e3, **options):
    """Largest root of the recurrence that the displacements of a linear oscillator obey, from 12 fixed steps."""
    system = oscillator((frequency_step / H) ** 2, 1e-7)
    result = simulate(system, 14 * H, method, step=H, newton_tolerance=1e-13, **options)
    x = result["p.x"] - 1.0
    rows = np.array([x[k : k + 4] / np.abs(x[k : k + 4]).max() for k in range(2, 11)])
    known, *_ = np.linalg.lstsq(rows[:, :3], -rows[:, 3], rcond=None)
    return np.abs(np.roots([1.0, *known[::-1]])).max()


@pytest.mark.parametrize("form", ["index2", "index3"])
@pytest.mark.parametrize("rho", [0.3, 0.5, 0.8, 0.9, 1.0])
def test_spectral_radius_of_generalized_alpha_for_infinite_frequency_is_rho(rho, form):
    """All three roots meet at -rho (Chung and Hulbert 1993): a triple root, known to the cube root of the rounding."""
    assert spectral_radius("generalized_alpha", rho=rho, form=form) == pytest.approx(rho, abs=0.02)


@pytest.mark.parametrize("method", ["hht_i3", "hht_ggl"])
@pytest.mark.parametrize("alpha, expected", [(0.0, 1.0), (-0.05, 0.95 / 1.05), (-0.1, 0.9 / 1.1), (-1.0 / 3.0, 0.5)])
def test_spectral_radius_of_hht_for_infinite_frequency(method, alpha, expected):
    """(1 + alpha)/(1 - alpha) (Hilber, Hughes and Taylor 1977)."""
    assert spectral_radius(method, alpha=alpha) == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize("method, options", [("generalized_alpha", {"rho": 1.0}), ("hht_i3", {"alpha": 0.0})])
def test_without_damping_and_constraints_they_are_newmarks_formula(method, options):
    system = oscillator(40.0)
    runs = [
        simulate(system, 2.0, m, step=0.05, newton_tolerance=1e-13, **o)
        for m, o in ((method, options), ("newmark", {}))
    ]
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-13
    assert np.abs(runs[0].a - runs[1].a).max() < 1e-10


@pytest.mark.parametrize("method", ["hht_i3", "hht_ggl"])
@pytest.mark.parametrize("alpha", [-0.1, -0.3])
def test_without_constraints_hht_is_the_one_of_a_textbook(method, alpha):
    """The linear oscillator x'' + w^2 x = 0, M a_{n+1} + (1 + alpha) K x_{n+1} - alpha K x_n = 0, step by step."""
    k, h = 40.0, 0.05
    result = simulate(oscillator(k), 1.0, method, step=h, alpha=alpha, newton_tolerance=1e-13)
    beta, gamma = (1.0 - alpha) ** 2 / 4.0, 0.5 - alpha
    x, v, a = 0.01, 0.0, -k * 0.01
    for n in range(20):
        predicted = x + h * v + h * h * (0.5 - beta) * a
        new = -(k * (1.0 + alpha) * predicted - alpha * k * x) / (1.0 + (1.0 + alpha) * k * beta * h * h)
        x, v, a = predicted + beta * h * h * new, v + h * ((1.0 - gamma) * a + gamma * new), new
        assert result["p.x"][n + 1] - 1.0 == pytest.approx(x, abs=1e-13)
        assert result["p.ax"][n + 1] == pytest.approx(a, abs=1e-11)


def multiplier_errors(steps, count, **options):
    """Largest error of the multiplier over the first `count` steps."""
    found = []
    for h in steps:
        result = simulate(
            point_pendulum(-0.4, 1.5), count * h, "generalized_alpha", step=h, newton_tolerance=1e-13, **options
        )
        angle, rate = pendulum_angles(np.maximum(result.t, 1e-12), -0.4, 1.5).T
        exact = -G * np.sin(angle) + rate**2
        found.append(np.abs(result.multipliers[1:, 0] - exact[1:]).max())
    return found


@pytest.mark.parametrize("form", ["index2", "index3"])
@pytest.mark.parametrize("rho", [0.2, 0.5, 0.9])
def test_multipliers_are_of_second_order_from_the_first_step_on(form, rho):
    assert order(multiplier_errors((0.01, 0.005, 0.0025), 10, form=form, rho=rho)) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("rho", [0.2, 0.5, 0.9])
def test_plain_start_costs_an_order_of_the_multipliers_in_index_3(rho):
    plain = multiplier_errors((0.01, 0.005, 0.0025), 10, form="index3", start="plain", rho=rho)
    assert order(plain) == pytest.approx(1.0, abs=0.2)
    shifted = multiplier_errors((0.0025,), 10, form="index3", rho=rho)
    assert plain[-1] > 5.0 * shifted[0]


@pytest.mark.parametrize(
    "method, options",
    [("generalized_alpha", {"rho": r, "form": f}) for r in (0.2, 0.9, 1.0) for f in ("index2", "index3")],
)
def test_error_estimate_is_the_error_of_a_step(method, options):
    """(beta + (am - af)/2 - 1/6) h^2 (a_1 - a_0), at a place where a' does not vanish. The larger norm of positions and
    velocities counts: that of positions where no error of a velocity counts, and nowhere less."""
    k, rtol, atol, speed = 40.0, 1e-6, 1e-8, 0.05

    def steps(h, tolerance):
        return simulate(
            oscillator(k, 0.0, speed), h, method, rtol, tolerance, first_step=h, max_step=h, step_records=True,
            newton_tolerance=1e-8, **options,
        )  # fmt: skip

    for h in (0.02, 0.01, 0.005):
        result, controlled = steps(h, {"length": atol, "speed": 1e3}), steps(h, atol)
        if len(result.t) != 2:
            continue
        error = abs(result["p.x"][-1] - 1.0 - speed / np.sqrt(k) * np.sin(np.sqrt(k) * h))
        weight = atol + rtol
        assert result.steps["error"][0] == pytest.approx(error / weight / np.sqrt(2.0), rel=0.1)
        assert len(controlled.t) > 2 or controlled.steps["error"][0] >= result.steps["error"][0]
        return
    pytest.fail("no step was accepted: choose smaller ones")


@pytest.mark.parametrize(
    "method, options",
    [
        ("newmark", {}),
        ("hht", {"alpha": -0.2}),
        ("hht_i3", {"alpha": 0.0}),
        ("hht_i3", {"alpha": -0.2}),
        ("hht_ggl", {"alpha": -0.2}),
        ("generalized_alpha", {"rho": 0.5}),
        ("baumgarte", {"scheme": "trapezoidal"}),
    ],
)
def test_error_estimate_of_velocities_is_the_error_of_a_step(method, options):
    """Once three accelerations are known: against the exact flow of the oscillator from the point before."""
    frequency, h, atol = np.sqrt(40.0), 0.005, 1e-3
    result = simulate(
        oscillator(40.0, 0.02, 0.1), 8 * h, method, 1e-12, {"length": 1e3, "speed": atol}, first_step=h, max_step=h,
        step_records=True, newton_tolerance=1e-8, **options,
    )  # fmt: skip
    assert np.allclose(np.diff(result.t), h)
    x, v = result["p.x"] - 1.0, result["p.vx"]
    flow = v[-2] * np.cos(frequency * h) - frequency * x[-2] * np.sin(frequency * h)
    assert result.steps["error"][-1] == pytest.approx(abs(v[-1] - flow) / atol / np.sqrt(2.0), rel=0.1)


def test_algorithmic_accelerations_survive_a_change_of_the_step():
    """A_n - a_n goes with h: in index 2 the multiplier does not feel that the last step is shorter."""
    h = 0.01
    result = simulate(point_pendulum(-0.4, 1.5), 20.3 * h, "generalized_alpha", step=h, newton_tolerance=1e-13, rho=0.5)
    assert result.t[-1] - result.t[-2] == pytest.approx(0.3 * h, rel=1e-9)
    angle, rate = pendulum_angles(np.maximum(result.t, 1e-12), -0.4, 1.5).T
    error = np.abs(result.multipliers[:, 0] + G * np.sin(angle) - rate**2)
    assert error[-1] < 3.0 * error[-8:-1].max()
