"""Fully implicit Runge-Kutta methods: their tableaus, their sweeps, and what they do with mechanisms."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, ball_over_floor, events, on, order, pendulum_angles, point_pendulum, residuals
from test_bouncing_ball import impact_time
from test_orders import ANGLE, RATE, exact, global_errors, slope, swing
from test_state import CASES, trajectory
from tlismni.core import (
    EquationSystem,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Simulation,
    SimulationError,
    SpringDamper2D,
    simulate,
)
from tlismni.core.methods.tableaus import TABLEAUS
from tlismni.models import load

NAMES = tuple(TABLEAUS)
every_tableau = pytest.mark.parametrize("tableau", NAMES)


# ---- coefficients ------------------------------------------------------------------------------------------


@every_tableau
def test_quadrature_and_collocation_conditions(tableau):
    """B(p): sum b_i c_i^(k-1) = 1/k up to k = p, not beyond; C(s): sum_j a_ij c_j^(k-1) = c_i^k / k up to k = s."""
    t = TABLEAUS[tableau]
    a, b, c = (np.array(x) for x in (t.a, t.b, t.c))
    for k in range(1, t.order + 1):
        assert b @ c ** (k - 1) == pytest.approx(1.0 / k, abs=1e-14)
    assert abs(b @ c**t.order - 1.0 / (t.order + 1)) > 1e-4
    for k in range(1, len(b) + 1):
        assert a @ c ** (k - 1) == pytest.approx(c**k / k, abs=1e-14)


@every_tableau
def test_amplification_of_stiff_components(tableau):
    """R(inf) = 1 - b^T A^-1 1: 0 for Radau IIA, of magnitude 1 for Gauss."""
    t = TABLEAUS[tableau]
    at_infinity = 1.0 - np.array(t.b) @ np.linalg.solve(np.array(t.a), np.ones(len(t.b)))
    assert abs(at_infinity) == pytest.approx(0.0 if t.stiffly_accurate else 1.0, abs=1e-13)
    assert t.stiffly_accurate == (t.a[-1] == t.b)


@every_tableau
def test_embedded_formula_has_its_order_and_no_more(tableau):
    t = TABLEAUS[tableau]
    start, weights = t.embedded()
    nodes = np.concatenate([[0.0], t.c, [1.0]])
    all_weights = np.concatenate([[start], weights, [t.gamma]])
    for k in range(1, t.order_of_estimate + 1):
        assert all_weights @ nodes ** (k - 1) == pytest.approx(1.0 / k, abs=1e-13)
    p = t.order_of_estimate
    assert abs(all_weights @ nodes**p - 1.0 / (p + 1)) > 1e-4


@every_tableau
def test_data_of_a_step_are_those_of_the_tableau(tableau):
    t, s = TABLEAUS[tableau], len(TABLEAUS[tableau].b)
    a, sweep = np.array(t.a), np.array(t.sweep)
    squares, shift, shift2, inverse = (np.array(t.data()[k]).reshape(3, 3)[:s, :s] for k in (1, 2, 3, 6))
    assert squares == pytest.approx(a @ a, abs=1e-15)
    assert np.diag(sweep) == pytest.approx(np.full(s, t.gamma), abs=0.0)
    assert shift + t.gamma * np.eye(s) == pytest.approx(sweep, abs=1e-15)
    assert shift2 + t.gamma**2 * np.eye(s) == pytest.approx(sweep @ sweep, abs=1e-15)
    assert inverse @ a == pytest.approx(np.eye(s), abs=1e-13)
    c, b, of_q, to_end = np.array(t.data()[4]).reshape(4, 3)[:, :s]
    assert np.array_equal(c, t.c) and np.array_equal(b, t.b)
    # sum (b^T A)_i p''(c_i) = 1/(k (k - 1)) for p = x^k, and x^k is extrapolated to 1
    for k in range(2, s + 2):
        assert of_q @ c ** (k - 2) == pytest.approx(1.0 / (k * (k - 1)), abs=1e-14)
        assert to_end @ c ** (k - 2) == pytest.approx(1.0, abs=1e-13)


@pytest.mark.parametrize("tableau, bound", [("radau3", 0.39), ("gauss2", 0.18), ("gauss3", 0.36)])
def test_sweeps_contract_for_all_vibrations_damped_or_not(tableau, bound):
    """z1, z2 in the closed left half plane, conjugate or real; d = -(z1 + z2), k = z1 z2."""
    size, angle = np.meshgrid(np.logspace(-2.0, 7.0, 361), np.linspace(0.5 * np.pi, np.pi, 46))
    real = np.concatenate([[0.0], np.logspace(-2.0, 7.0, 91)])
    first, second = np.meshgrid(real, real)
    d = np.concatenate([np.maximum(-2.0 * size * np.cos(angle), 0.0).ravel(), (first + second).ravel()])
    k = np.concatenate([(size**2).ravel(), (first * second).ravel()])
    radius = np.abs(np.linalg.eigvals(TABLEAUS[tableau].sweep_error(d, k))).max(axis=1)
    assert radius.max() <= bound
    # E = d (S - A) + k (S^2 - A^2) for small d, k: no more than a hundredth for h omega = 0.3
    assert radius[(d == 0.0) & (k <= 0.09)].max() < 0.01


# ---- order and error control ---------------------------------------------------------------------------------


@pytest.mark.parametrize("tableau, steps", [("radau3", (20, 40)), ("gauss2", (20, 40)), ("gauss3", (16, 32))])
def test_observed_order_of_coordinates_and_velocities(tableau, steps):
    errors = global_errors(*swing(0.5, 1.5), 1.5, steps, "irk", tableau=tableau)
    assert errors[-1] > 1e-11, "rounding: choose larger steps"
    assert order(errors) == pytest.approx(TABLEAUS[tableau].order, abs=0.2)


@pytest.mark.parametrize("tableau, steps", [("radau3", (20, 40)), ("gauss2", (20, 40)), ("gauss3", (12, 24))])
def test_multipliers_have_the_full_order(tableau, steps):
    """Tension of the rod: G x + rate^2, x along gravity."""
    start, t_end = 0.5, 1.5
    system, expected = swing(start, t_end)
    rate = pendulum_angles([t_end], start - math.pi / 2, 0.0)[0][1]
    tension = G * expected[0] + rate**2
    errors = []
    for count in steps:
        run = simulate(system, t_end, "irk", step=t_end / count, newton_tolerance=1e-13, record=False, tableau=tableau)
        errors.append(abs(run.multipliers[-1, 0] - tension))
    assert errors[-1] > 1e-11, "rounding: choose larger steps"
    assert order(errors) == pytest.approx(TABLEAUS[tableau].order, abs=0.2)


@pytest.mark.parametrize(
    "tableau, steps",
    [("radau3", (200, 300, 450, 675)), ("gauss2", (300, 450, 675, 1000)), ("gauss3", (150, 225, 340, 500))],
)
def test_order_survives_full_turns_and_the_new_partitions_that_they_need(tableau, steps):
    angle, rate, t_end = -math.pi / 2, 8.0, 2.0
    system = point_pendulum(angle, rate)
    errors = global_errors(system, exact(t_end, angle, rate), t_end, steps, "irk", tableau=tableau)
    assert slope(steps, errors) > TABLEAUS[tableau].order - 0.3
    turns = (pendulum_angles([t_end], angle, rate)[0][0] - angle) / (2.0 * math.pi)
    run = simulate(system, t_end, "irk", step=t_end / steps[0], record=False, tableau=tableau)
    assert turns > 2.0 and run.stats["partitions"] >= 4.0 * turns - 1.0


@pytest.mark.parametrize("tableau, bound", [("radau3", 1.0), ("gauss2", 50.0), ("gauss3", 1.0)])
def test_error_control_follows_the_tolerance(tableau, bound):
    """h goes as rtol^(1/(estimate's order + 1)), the error of the formula as h^order; of a step the sweeps may leave
    a hundredth of rtol."""
    exponent = TABLEAUS[tableau].order / (TABLEAUS[tableau].order_of_error + 1)
    errors = []
    for rtol in (1e-5, 1e-7, 1e-9):
        run = simulate(point_pendulum(ANGLE, RATE), 1.0, "irk", rtol, rtol * 1e-2, record=False, tableau=tableau)
        errors.append(np.abs(np.concatenate([run.q[-1], run.v[-1]]) - exact(1.0)).max())
        assert errors[-1] < bound * rtol
        assert errors[-1] > 1e-2 * rtol**exponent
    assert errors[0] > errors[1] > errors[2]


@pytest.mark.sampled(2)
@every_tableau
@pytest.mark.parametrize("damping", [0.0, 0.5])
def test_the_estimate_sees_the_error_of_a_linear_equation(tableau, damping):
    """A collocation polynomial satisfies its own quadrature: an embedded formula of too high an order sees nothing."""
    frequency = math.sqrt(40.0 - 0.25 * damping**2)

    def exact_position(t):
        phase = frequency * t
        swing = 0.1 * math.cos(phase) + (0.3 + 0.05 * damping) / frequency * math.sin(phase)
        return math.exp(-0.5 * damping * t) * swing

    oscillator = EquationSystem(
        mass=np.eye(1), force=lambda t, q, v: np.array([-40.0 * q[0] - damping * v[0]]), q0=[0.1], v0=[0.3]
    )
    for rtol in (1e-3, 1e-6):
        run = simulate(
            oscillator, 5.0, "irk", rtol, 1e-2 * rtol, tableau=tableau, first_step=1.0, step_records=True, record=False
        )
        assert run.stats["rejected"] > 0
        assert run.q[-1, 0] == pytest.approx(exact_position(5.0), abs=rtol)
        assert np.all(run.steps["error"] > 0.0)


def test_higher_orders_take_fewer_steps_than_the_diagonal_method():
    steps = {
        name: simulate(point_pendulum(ANGLE, RATE), 1.0, "irk", 1e-9, 1e-11, tableau=name).stats["steps"]
        for name in ("gauss3", "sdirk4")
    }
    assert steps["gauss3"] < 0.5 * steps["sdirk4"]


# ---- constraints, energy, work ---------------------------------------------------------------------------------


@every_tableau
@pytest.mark.parametrize("scenario", ["chain", "pendulum_stop"])
def test_constraints_hold_at_all_three_levels(tableau, scenario):
    """To 1e-12 of the largest entry of q, v, a, or of 1: the inner loop's tolerance."""
    result = simulate(load(scenario).model, 1.5, "irk", tableau=tableau)
    for level, x in (("position", result.q), ("velocity", result.v), ("acceleration", result.a)):
        largest = np.maximum(1.0, np.abs(x).max(axis=1))
        assert (np.abs(result[f"residual.{level}"]) / largest).max() <= 1.001e-12
    if scenario == "pendulum_stop":
        assert max(residuals(result)) <= 1e-11


@pytest.mark.sampled(1)
@every_tableau
def test_driven_constraint(tableau):
    """Bead on a rotating rod: r = r0 cosh(w t), the rod pushes with 2 m w r'."""
    w, r0 = 1.5, 0.2
    system = EquationSystem(
        mass=np.eye(2),
        force=np.zeros(2),
        constraint=lambda t, q: -math.sin(w * t) * q[0] + math.cos(w * t) * q[1],
        q0=[r0, 0.0],
        v0=[0.0, w * r0],
    )
    result = simulate(system, 2.0, "irk", rtol=1e-9, atol=1e-12, tableau=tableau)
    r = r0 * np.cosh(w * result.t)
    expected = np.stack([r * np.cos(w * result.t), r * np.sin(w * result.t)], axis=1)
    assert np.abs(result.q - expected).max() < 1e-7
    assert np.abs(result.multipliers[:, 0] + 2.0 * w * r0 * w * np.sinh(w * result.t)).max() < 1e-6
    assert max(residuals(result)) <= 1e-11


@pytest.mark.parametrize("tableau, bound", [("gauss2", 2e-7), ("gauss3", 1e-9)])
def test_gauss_keeps_the_energy_over_a_hundred_swings(tableau, bound):
    """Symmetric formula, reversible motion, one partition: the error of the energy swings, and does not grow."""
    system = swing(0.3, 1.0)[0]
    run = simulate(system, 200.0, "irk", step=0.05, newton_tolerance=1e-13, tableau=tableau)
    energy = 0.5 * (run.v**2).sum(axis=1) - G * run.q[:, 0]
    off = np.abs(energy - energy[0])
    tenth = len(off) // 10
    assert off.max() < bound
    assert off[-tenth:].max() < 1.1 * off[:tenth].max()
    assert run.stats["partitions"] == simulate(system, 0.05, "irk", step=0.05).stats["partitions"]


def test_radau_loses_energy_where_gauss_keeps_it():
    run = simulate(swing(0.3, 1.0)[0], 200.0, "irk", step=0.05, newton_tolerance=1e-13, tableau="radau3")
    energy = 0.5 * (run.v**2).sum(axis=1) - G * run.q[:, 0]
    assert energy[-1] - energy[0] < -1e-6


@every_tableau
def test_work_accounts_close_the_balance(tableau):
    """A damped oscillator turns half its energy into heat; the account of the damper is integrated with the step."""
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=40.0, damping=0.5, natural_length=1.0)
    model = Model(gravity=(0.0, 0.0), bodies=[PointMass2D(name="p", mass=1.0, position=(1.2, 0.0))], forces=[spring])
    result = simulate(model, 2.0, "irk", rtol=1e-8, atol=1e-10, tableau=tableau)
    start = 0.5 * 40.0 * 0.2**2
    stretch, speed = result.q[-1, 0] - 1.0, result.v[-1, 0]
    left = 0.5 * 40.0 * stretch**2 + 0.5 * speed**2
    # e^(-c t / m) of an oscillator with c = 0.5, up to what swings with the phase
    assert left / start == pytest.approx(math.exp(-1.0), rel=0.1)
    assert np.abs(result["energy.balance"]).max() < 1e-7 * start


# ---- stiffness -------------------------------------------------------------------------------------------------


def stiff_oscillator(h_omega, h, stretch=1e-6):
    """Stretched so little that the spring stays linear."""
    w = h_omega / h
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=w * w, natural_length=1.0)
    body = PointMass2D(name="p", mass=1.0, position=(1.0 + stretch, 0.0))
    return Model(gravity=(0.0, 0.0), bodies=[body], forces=[spring]), w


@every_tableau
def test_vibration_of_a_thousand_radians_a_step(tableau):
    """Radau damps it, Gauss keeps its amplitude; the sweeps converge at the rate of the sweep matrix."""
    h = 0.01
    model, w = stiff_oscillator(1e3, h)
    run = simulate(model, 0.5, "irk", step=h, newton_tolerance=1e-12, tableau=tableau)
    energy = (w * (run.q[:, 0] - 1.0)) ** 2 + run.v[:, 0] ** 2
    if tableau == "radau3":
        assert energy[1] < 1e-4 * energy[0] and energy[-1] < 1e-8 * energy[0]
    else:
        assert energy == pytest.approx(energy[0], rel=1e-5)
    # 0.315 a sweep from an error as large as the motion to 1e-12 of it, and a few sweeps until that rate shows
    assert run.stats["outer_iterations"] <= 28 * run.stats["stages"]
    assert run.stats["rejected"] == 0


def test_stiff_component_at_rest_does_not_limit_the_steps():
    """A pendulum on a spring of 1e5 rad/s that is stretched as it must be: steps of hundreds of radians. Its error is
    that of stiff curved motion (the order falls towards that of the stages), not that of stability."""
    w = 1e5
    stretch = G * math.cos(0.5) / w**2
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=w * w, damping=2.0 * w, natural_length=1.0)
    position = ((1.0 + stretch) * math.sin(0.5), -(1.0 + stretch) * math.cos(0.5))
    model = Model(gravity=(0.0, -G), bodies=[PointMass2D(name="p", mass=1.0, position=position)], forces=[spring])
    result = simulate(model, 2.0, "irk", rtol=1e-6, atol=1e-9, tableau="radau3")
    assert result.stats["steps"] < 1000
    angle = pendulum_angles([2.0], 0.5 - math.pi / 2.0)[0][0]
    assert result.q[-1] == pytest.approx([math.cos(angle), math.sin(angle)], abs=1e-5)


def test_start_far_from_the_equilibrium_of_a_stiff_spring():
    """The accelerations of the start would carry the mass through the anchor of the spring: they are no guess."""
    h = 0.01
    model, w = stiff_oscillator(20.0, h, stretch=0.01)
    for tableau in ("radau3", "gauss2", "gauss3"):
        run = simulate(model, 0.2, "irk", step=h, tableau=tableau)
        energy = (w * (run.q[:, 0] - 1.0)) ** 2 + run.v[:, 0] ** 2
        assert energy.max() <= energy[0] * (1.0 + 1e-6)


@every_tableau
def test_simple_iteration_gives_the_same_solution_or_says_why_not(tableau):
    runs = [
        simulate(point_pendulum(0.2, 1.0), 0.3, "irk", step=0.01, newton_tolerance=1e-12, outer=outer, tableau=tableau)
        for outer in ("simple", "newton")
    ]
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-10
    assert np.abs(runs[0].v - runs[1].v).max() < 1e-9
    model, _ = stiff_oscillator(20.0, 0.01)
    with pytest.raises(SimulationError, match=r"simple iteration contracts only if c_q omega\^2 < 1"):
        simulate(model, 1.0, "irk", step=0.01, outer="simple", tableau=tableau)


# ---- contacts and state ----------------------------------------------------------------------------------------


@every_tableau
def test_bouncing_ball(tableau):
    result = simulate(ball_over_floor(NewtonImpact(restitution=0.8)), 4.0, "irk", tableau=tableau)
    times = [event.t for event in events(result, "impact")]
    assert np.abs(np.array(times[:10]) - [impact_time(n, 0.8) for n in range(1, 11)]).max() < 1e-10
    resting = simulate(load("bouncing_ball", restitution=0.5).model, 3.0, "irk", tableau=tableau)
    assert resting.events[-1].kind == "rest"
    assert np.abs(resting["floor.gap"][resting.t > resting.events[-1].t]).max() < 1e-14


@pytest.mark.sampled(8)
@every_tableau
@pytest.mark.parametrize("case", CASES)
def test_restored_run_repeats_itself_bit_for_bit(tableau, case):
    build, stored_at, end = CASES[case]
    sims = [Simulation(build(), "irk", rtol=1e-7, atol=1e-10, tableau=tableau) for _ in range(2)]
    times = np.linspace(stored_at, end, 5)[1:]
    sims[0].advance(stored_at)
    state = sims[0].state()
    first = trajectory(sims[0], times)
    sims[0].restore(state)
    assert trajectory(sims[0], times) == first
    sims[1].restore(state)
    assert trajectory(sims[1], times) == first


# ---- options ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", ["gauss4", "", 3, None, True, ["radau3"]])
def test_unknown_tableau_is_refused_with_the_known_ones(wrong):
    with pytest.raises(ModelError, match=r"tableau .*radau3.*gauss2.*gauss3.*sdirk4"):
        simulate(point_pendulum(), 1.0, "irk", tableau=wrong)


def test_default_is_radau():
    runs = [simulate(point_pendulum(), 0.5, "irk", **options) for options in ({}, {"tableau": "radau3"})]
    assert runs[0].q.tobytes() == runs[1].q.tobytes()
