"""Fixed steps that do not converge are divided inside, counted and said once."""

import logging

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import EquationSystem, Simulation, SimulationError, simulate
from tlismni.core.simulation.state import State

H = 1e-3


def system(force, q0=0.0, v0=0.0):
    return EquationSystem(mass=np.eye(1), force=force, q0=[q0], v0=[v0])


def friction(width):
    """A load to and fro against friction in a thin layer: Newton's iteration jumps across it from side to side."""
    return lambda t, q, v: [3.0 * np.sin(5.0 * t) - 2.0 * np.tanh(v[0] / width)]


def reference(force, t_end, q0=0.0):
    found = solve_ivp(
        lambda t, y: [y[1], force(t, y[:1], y[1:])[0]], (0.0, t_end), [q0, 0.0], "Radau", rtol=1e-9, atol=1e-12
    )
    return found.y[:, -1]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("method", ["hht", "newmark", "bdf", "irk", "ebdf", "generalized_alpha"])
def test_a_step_that_fails_is_made_of_smaller_ones(method, caplog):
    """And the result is that of a stiff integrator of another kind."""
    force = friction(1e-6)
    with caplog.at_level(logging.WARNING):
        result = simulate(system(force), 1.0, method, step=H)
    expected = reference(force, 1.0)
    assert [result.q[-1, 0], result.v[-1, 0]] == pytest.approx(expected, abs=2e-3)
    said = [record for record in caplog.records if "does not converge" in record.message]
    assert len(said) == min(result.stats["divided_steps"], 1)
    if method == "hht":
        assert 0 < result.stats["divided_steps"] < 20


@pytest.mark.parametrize("seed", range(4))
def test_the_grid_of_whole_steps_goes_on(seed):
    """Rows at every multiple of the step, whatever is divided between, and the same whatever times are asked for."""
    draw = np.random.default_rng(seed)
    width, h = 10.0 ** draw.uniform(-8.0, -6.0), float(draw.choice([1e-2, 2e-3, 1e-3]))
    force = friction(width)
    whole = simulate(system(force), 1.0, "hht", step=h)
    assert whole.stats["divided_steps"] > 0
    grid = np.arange(0.0, 1.0 + 0.5 * h, h)
    nearest = np.abs(whole.t[:, None] - grid).min(axis=0)
    assert np.max(nearest) < 1e-9
    asked = simulate(system(force), 1.0, "hht", step=h, t_eval=np.sort(draw.uniform(0.0, 1.0, 50)))
    assert asked.stats["steps"] == whole.stats["steps"]


def test_steps_that_converge_are_not_touched():
    result = simulate(system(lambda t, q, v: [-q[0]], q0=1.0), 1.0, "hht", step=H)
    assert result.stats["divided_steps"] == 0 and result.stats["steps"] == 1000


@pytest.mark.sampled(4)
@pytest.mark.parametrize("method", ["irk", "ebdf", "newmark", "generalized_alpha"])
@pytest.mark.parametrize("seed", range(3))
def test_parts_that_end_a_rounding_before_the_whole_step_end_it(method, seed):
    """Sums of parts miss its end by some 1e-17 s, as those of the first of these runs; no step fits between."""
    draw = np.random.default_rng(seed)
    h, rate = (1e-2, 5.0) if seed == 0 else (1.0 / draw.integers(60, 400), draw.uniform(3.0, 7.0))
    result = simulate(
        system(lambda t, q, v: [3.0 * np.sin(rate * t) - 2.0 * np.tanh(v[0] / 1e-8)]), 1.0, method, step=h
    )
    assert result.stats["divided_steps"] > 0 and result.t[-1] == 1.0


def restless(t, q, v):
    """Friction against a load that turns round some three times a step."""
    return [3.0 * np.sin(1e4 * t) - 2.0 * np.tanh(v[0] / 1e-8)]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["hht", "bdf", "irk"])
def test_a_run_most_of_whose_steps_fail_ends_and_says_so(method):
    """Division is for rare instants: ten steps, and a tenth of all."""
    sim = Simulation(system(restless), method, step=H)
    with pytest.raises(SimulationError, match=r"did not converge and were divided.*Use a smaller step") as caught:
        sim.run_to(10.0)
    assert f"; {sim.stats['divided_steps']} of {caught.value.t / H:.0f} steps so far did" in str(caught.value)
    assert 10 <= sim.stats["divided_steps"] < 11 + 0.1 * caught.value.t / H
    assert sim.clock.fixed_step == H


def test_a_master_that_goes_back_does_not_use_up_what_may_be_divided():
    sim = Simulation(system(friction(1e-6)), "hht", step=H)
    start = sim.state()
    sim.run_to(1.0)
    once = sim.stats["divided_steps"]
    for _ in range(20):
        sim.restore(start)
        assert sim.stats["divided_steps"] == 0
        sim.run_to(1.0)
    assert sim.stats["divided_steps"] == once > 0
    other = Simulation(system(friction(1e-6)), "hht", step=H)
    other.restore(State.from_bytes(sim.state().to_bytes()))
    assert other.stats["divided_steps"] == once


def test_what_no_division_mends_ends_as_before():
    """A force that jumps back whenever the mass follows it has no solution at any step."""
    with pytest.raises(SimulationError, match=r"divided into parts down to .*Use a smaller step"):
        simulate(system(lambda t, q, v: [np.where(q[0] + 1e3 * v[0] > 0.1, -1e12, 1e12)]), 1.0, "hht", step=H)


def test_advance_and_run_to_divide_alike():
    """Whoever asks in small portions gets the steps of one run."""
    one, other = (Simulation(system(friction(1e-6)), "hht", step=H) for _ in range(2))
    one.run_to(1.0)
    for t in np.linspace(0.0, 1.0, 257)[1:]:
        other.run_to(1.0, until=t)
    assert other.stats["steps"] == one.stats["steps"]
    assert other.values().tobytes() == one.values().tobytes()
