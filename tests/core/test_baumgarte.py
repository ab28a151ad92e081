"""Baumgarte's method against the same ODE written independently, and against the theory of the violation."""

import numpy as np
import pytest
from helpers import G, point_pendulum, rod_pendulum
from scipy.integrate import DOP853, RK23, RK45
from tlismni.core import AppliedTorque2D, Simulation, SimulationError, Step, simulate

SOLVERS = {"rk23": RK23, "rk45": RK45, "dop853": DOP853}
ANGLE, RATE = -0.4, 1.5


def right_hand_side(alpha, beta):
    """(v, a) of the unit pendulum with Phi = (x^2 + y^2 - 1)/2, Phi'' + 2 alpha Phi' + beta^2 Phi = 0."""

    def rhs(t, y):
        q, v = y[:2], y[2:]
        g = np.array([0.0, -G])
        multiplier = (q @ g + v @ v + 2.0 * alpha * (q @ v) + beta**2 * 0.5 * (q @ q - 1.0)) / (q @ q)
        return np.concatenate([v, g - multiplier * q])

    return rhs


def steps_of_scipy(scheme, rhs, times, y):
    """States after each step of scipy's formula on the grid `times`, and the last solver of each step."""
    states, solvers = [y], []
    for k in range(len(times) - 1):
        h = times[k + 1] - times[k]
        fun = rhs(h) if rhs.__code__.co_argcount == 1 else rhs
        solver = SOLVERS[scheme](fun, times[k], states[-1], times[k + 1], first_step=h, rtol=1e3, atol=1e9)
        solver.step()
        assert solver.status == "finished"
        states.append(solver.y)
        solvers.append(solver)
    return np.array(states), solvers


@pytest.mark.parametrize("scheme", SOLVERS)
@pytest.mark.parametrize("step", [0.02, None])
def test_explicit_schemes_make_scipys_steps(scheme, step):
    result = simulate(
        point_pendulum(ANGLE, RATE), 1.0, "baumgarte", 1e-6, 1e-8, scheme=scheme, alpha=4.0, beta=7.0, step=step
    )
    start = np.concatenate([result.q[0], result.v[0]])
    states, _ = steps_of_scipy(scheme, right_hand_side(4.0, 7.0), result.t, start)
    assert np.abs(np.hstack([result.q, result.v]) - states).max() < 1e-12
    accelerations = np.array([right_hand_side(4.0, 7.0)(0.0, y)[2:] for y in states])
    assert np.abs(result.a[1:] - accelerations[1:]).max() < 1e-10


@pytest.mark.parametrize("scheme", ["rk23", "rk45"])
def test_error_norm_is_that_of_scipys_estimate(scheme):
    rtol, atol = 1e-6, 1e-8
    result = simulate(
        point_pendulum(ANGLE, RATE), 1.0, "baumgarte", rtol, atol, scheme=scheme, alpha=4.0, beta=7.0, step_records=True
    )
    start = np.concatenate([result.q[0], result.v[0]])
    states, solvers = steps_of_scipy(scheme, right_hand_side(4.0, 7.0), result.t, start)
    for k, (y, solver) in enumerate(zip(states, solvers, strict=False)):
        error = (result.t[k + 1] - result.t[k]) * (solver.K.T @ solver.E) / (atol + rtol * np.abs(y))
        norm = max(np.sqrt(np.mean(error[:2] ** 2)), np.sqrt(np.mean(error[2:] ** 2)))
        assert result.steps["error"][k] == pytest.approx(norm, rel=1e-6)


def test_rule_step_takes_alpha_and_beta_from_the_step():
    h = 0.02
    result = simulate(point_pendulum(ANGLE, RATE), 1.0, "baumgarte", scheme="rk45", rule="step", step=h, alpha=1.0)
    start = np.concatenate([result.q[0], result.v[0]])
    by_step = lambda h: right_hand_side(1.0 / h, np.sqrt(2.0) / h)  # noqa: E731
    states, _ = steps_of_scipy("rk45", by_step, result.t, start)
    assert np.abs(np.hstack([result.q, result.v]) - states).max() < 1e-12


def disturbed(scheme, alpha, beta, size=1e-3):
    """A run that begins off the constraint by `size`, along the rod."""
    sim = Simulation(point_pendulum(ANGLE, RATE), "baumgarte", 1e-9, 1e-11, scheme=scheme, alpha=alpha, beta=beta)
    row = sim.method_arrays["history"][sim.method_arrays["ring"][0]]
    row[:2] *= 1.0 + size
    return sim, 0.5 * ((1.0 + size) ** 2 - 1.0)


@pytest.mark.parametrize("scheme", ["rk45", "dop853", "sdirk4"])
@pytest.mark.parametrize("alpha, beta", [(5.0, 5.0), (5.0, 3.0), (2.0, 6.0)])
def test_violation_decays_as_the_linear_equation_says(scheme, alpha, beta):
    """Phi'' + 2 alpha Phi' + beta^2 Phi = 0 holds exactly along the solution: over-, critically and underdamped."""
    sim, first = disturbed(scheme, alpha, beta)
    times = np.linspace(0.1, 1.5, 8)
    found = []
    for t in times:
        sim.advance(t)
        q = sim.workspace.arrays["q"][:2] if sim.sample() is not None else None
        found.append(0.5 * (q @ q - 1.0))
    root = np.sqrt(complex(alpha**2 - beta**2))
    if root == 0.0:
        expected = first * (1.0 + alpha * times) * np.exp(-alpha * times)
    else:
        expected = (
            first * np.exp(-alpha * times) * (np.cosh(root * times) + alpha / root * np.sinh(root * times))
        ).real
    assert np.abs(np.array(found) - expected).max() < 2e-8


def test_without_stabilisation_a_violation_of_the_velocity_grows_linearly():
    """Phi'' = 0 along the solution."""
    sim = Simulation(point_pendulum(ANGLE, RATE), "baumgarte", 1e-9, 1e-11, alpha=0.0, beta=0.0)
    row = sim.method_arrays["history"][sim.method_arrays["ring"][0]]
    n_ext = sim.assembly.n_extended
    row[n_ext : n_ext + 2] += 1e-3 * row[:2]
    for t in (0.5, 1.0, 2.0):
        sim.advance(t)
        sim.sample()
        assert float(sim.workspace.arrays["phi"][0]) == pytest.approx(1e-3 * t, rel=1e-3)


def test_large_coefficients_are_too_stiff_for_an_explicit_scheme_but_not_for_an_implicit_one():
    """alpha h = 10 lies beyond the real stability limit (about 3) of any of them; sdirk4 is L-stable."""
    options = {"alpha": 1000.0, "beta": 1000.0, "step": 0.01}
    for scheme in SOLVERS:
        with pytest.raises(SimulationError, match=r"infinite or NaN|singular|pivots"):
            simulate(point_pendulum(ANGLE, RATE), 10.0, "baumgarte", scheme=scheme, **options)
    result = simulate(point_pendulum(ANGLE, RATE), 10.0, "baumgarte", scheme="sdirk4", **options)
    assert result["residual.position"].max() < 1e-4


def test_implicit_and_explicit_schemes_solve_the_same_equation():
    runs = [
        simulate(point_pendulum(ANGLE, RATE), 1.0, "baumgarte", 1e-9, 1e-11, scheme=s, record=False)
        for s in ("dop853", "sdirk4")
    ]
    assert np.abs(runs[0].q[-1] - runs[1].q[-1]).max() < 1e-8
    assert runs[0].multipliers[-1] == pytest.approx(runs[1].multipliers[-1], rel=1e-6)


@pytest.mark.parametrize("method, options", [("baumgarte", {"alpha": 0.0, "beta": 0.0}), ("hht_i3", {})])
def test_velocities_that_miss_their_constraint_are_no_jump_where_a_force_jumps(method, options):
    """A breakpoint begins a new history; it must not repair what the method has left, or book it as work."""
    system = rod_pendulum(
        ANGLE, RATE, forces=[AppliedTorque2D(name="T", body="rod", torque=Step(time=0.5, before=0.0, after=2.0))]
    )
    result = simulate(system, 1.0, method, 1e-4, 1e-6, **options)
    (at,) = np.flatnonzero(np.diff(result.t) < 1e-12)
    assert result.t[at + 1] == 0.5
    assert result["residual.velocity"][at] > 1e-7
    assert np.array_equal(result.v[at], result.v[at + 1])
    assert result["rod.angular_acceleration"][at + 1] - result["rod.angular_acceleration"][at] > 3.0
