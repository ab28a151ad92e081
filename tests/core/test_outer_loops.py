"""The outer loops: newton, the accelerated fixed point, Jacobian-free Newton-Krylov, and falling back."""

import logging
import math
import re

import numpy as np
import pytest
from helpers import GROUND, G, on, residuals, rod_pendulum
from test_simple_iteration import oscillator
from tlismni.core import Model, ModelError, PointMass2D, Simulation, SimulationError, SpringDamper2D, State, simulate
from tlismni.models import load

STEP = 0.01
METHOD_NAMES = {"sdirk4": ("irk", {"tableau": "sdirk4"})}
ACCELERATED = ({"acceleration": "aitken"}, {"acceleration": "anderson"}, {"acceleration": "anderson", "depth": 1})


def stiffness(contraction):
    """Of an oscillator of mass 1 for which Newmark's simple iteration contracts by `contraction` at STEP."""
    return 4.0 * contraction / STEP**2


@pytest.mark.sampled(8)
@pytest.mark.parametrize("method", ["newmark", "hht", "bdf", "ebdf", "adams", "sdirk4"])
@pytest.mark.parametrize("options", [{"outer": "jfnk"}, *({"outer": "simple", **o} for o in ACCELERATED)])
def test_every_outer_loop_finds_the_same_solution(method, options):
    system = load("chain", links=3).model
    method, own = METHOD_NAMES.get(method, (method, {}))
    runs = [
        simulate(system, 0.2, method, step=0.004, newton_tolerance=1e-12, **chosen, **own)
        for chosen in ({"outer": "newton"}, options)
    ]
    assert np.array_equal(runs[0].t, runs[1].t)
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-10
    assert np.abs(runs[0].v - runs[1].v).max() < 1e-9
    assert np.abs(runs[0].multipliers - runs[1].multipliers).max() < 1e-6
    assert max(residuals(runs[1])) < 1e-10


@pytest.mark.parametrize("options", ACCELERATED)
def test_acceleration_saves_iterations(options):
    """A linear oscillator has one mode: two iterations of a secant method solve it."""
    plain, accelerated = (
        simulate(oscillator(stiffness(0.5)), 0.2, "newmark", step=STEP, outer="simple", **chosen)
        for chosen in ({}, options)
    )
    assert accelerated.stats["outer_iterations"] < 0.3 * plain.stats["outer_iterations"]
    assert accelerated.q[-1] == pytest.approx(plain.q[-1], abs=1e-8)


def test_anderson_of_greater_depth_serves_several_modes():
    system = load("chain", links=6).model
    counts = [
        simulate(system, 0.5, "newmark", step=0.03, outer="simple", acceleration="anderson", depth=depth).stats
        for depth in (1, 4)
    ]
    assert counts[1]["outer_iterations"] < counts[0]["outer_iterations"]


def spring_pendulum(stiff):
    """A bob on a stiff spring at 0.3 rad, stretched so that the spring carries the weight: the motion is smooth."""
    length, angle = 1.0 + G * math.cos(0.3) / stiff, 0.3
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=stiff, natural_length=1.0)
    body = PointMass2D(name="p", mass=1.0, position=(length * math.sin(angle), -length * math.cos(angle)))
    return Model(gravity=(0.0, -G), bodies=[body], forces=[spring])


@pytest.mark.parametrize("stiff", [1e4, 1e6, 1e9])
@pytest.mark.parametrize("method", ["newmark", "ebdf", "bdf", "sdirk4"])
def test_jfnk_does_not_mind_stiffness(method, stiff):
    """Steps beyond 2/omega, up to 150 times; the result is that of newton."""
    system = spring_pendulum(stiff)
    method, own = METHOD_NAMES.get(method, (method, {}))
    newton, jfnk = (simulate(system, 0.3, method, step=STEP, outer=outer, **own) for outer in ("newton", "jfnk"))
    assert STEP > 0.99 / math.sqrt(stiff)
    assert newton.t[-1] == jfnk.t[-1] == 0.3
    assert np.abs(newton.q - jfnk.q).max() < 3e-8


def test_jfnk_needs_fewer_factorisations_than_newton():
    """Krylov vectors take the place of new tangents."""
    system = load("chain", links=6).model
    newton, jfnk = (simulate(system, 1.0, "hht", 1e-4, outer=outer).stats for outer in ("newton", "jfnk"))
    assert jfnk["krylov_iterations"] > 0 and newton["krylov_iterations"] == 0
    assert jfnk["factorizations"] < newton["factorizations"]


def test_residuals_hold_with_every_outer_loop_under_error_control():
    for options in ({"outer": "jfnk"}, {"outer": "simple"}, {"outer": "simple", "acceleration": "anderson"}):
        result = simulate(rod_pendulum(0.3), 1.0, "ebdf", 1e-8, 1e-10, **options)
        energy = result["energy.kinetic"] + result["energy.potential"]
        assert np.ptp(energy) < 1e-6 * G
        assert max(residuals(result)) < 3e-11


class TestFallBack:
    def test_newton_takes_over_and_it_is_reported(self, caplog):
        with caplog.at_level(logging.WARNING):
            result = simulate(oscillator(1e8), 0.2, "newmark", step=STEP, outer="simple", fallback=True)
        assert result.t[-1] == 0.2
        (taken,) = result.fallbacks
        assert taken.outer == "simple" and taken.t == 0.0
        assert result.stats["fallbacks"] == 1
        assert "gave way to 'newton'" in caplog.text
        # the measured limit of the simple iteration: 2/omega for Newmark
        limit = float(taken.reason.split("limit is about ")[1].split(" s")[0])
        assert limit == pytest.approx(2.0 / 1e4, rel=0.05)

    def test_it_takes_over_at_once_under_error_control(self):
        """Without falling back the steps stay below the limit of the fixed point."""
        omega = 1e4
        system = oscillator(omega**2)
        # of positions alone: the velocities of a vibration that has been resolved would hold the steps in either
        atol = {"length": 1e-2, "speed": 1e3}
        slow = simulate(system, 0.02, "hht", 1e-2, atol, outer="simple", alpha=-0.3)
        quick = simulate(system, 0.02, "hht", 1e-2, atol, outer="simple", alpha=-0.3, fallback=True)
        assert np.diff(slow.t).max() < 3.0 / omega < np.diff(quick.t).max()
        assert len(quick.fallbacks) == 1

    def test_nothing_is_reported_if_it_was_not_needed(self):
        result = simulate(oscillator(100.0), 0.2, "newmark", step=STEP, outer="simple", fallback=True)
        assert result.fallbacks == () and result.stats["fallbacks"] == 0

    def test_it_is_part_of_the_state(self):
        build = {"method": "newmark", "step": STEP, "outer": "simple", "fallback": True}
        sim, other = Simulation(oscillator(1e8), **build), Simulation(oscillator(1e8), **build)
        sim.advance(0.1)
        other.restore(State.from_bytes(sim.state().to_bytes()))
        assert other.fallbacks == sim.fallbacks and other.outer == "newton"
        for s in (sim, other):
            s.advance(0.2)
        assert sim.state() == other.state()


def test_the_limit_is_named_when_the_simple_iteration_is_refused():
    """c_q omega^2 < 1 with c_q = h^2/4: h < 2/omega; the factor is measured, at a spring that is not quite linear."""
    with pytest.raises(SimulationError, match=r"omega\^2 < 1") as caught:
        simulate(oscillator(1e8), 0.2, "newmark", step=STEP, outer="simple")
    named = re.search(r"the largest step here is about (\S+) s", str(caught.value))
    assert named is not None and float(named[1]) == pytest.approx(2.0 / math.sqrt(1e8), rel=0.05)


@pytest.mark.parametrize("options", [{"outer": "jfnk"}, {"outer": "simple", "acceleration": "aitken"}])
def test_coupled_stages_say_which_outer_loops_they_know(options):
    with pytest.raises(ModelError, match=r"'irk' with these options .* knows only outer = 'newton' or 'simple'"):
        simulate(rod_pendulum(), 0.1, "irk", **options)


@pytest.mark.parametrize(
    "options, word",
    [
        ({"acceleration": "anderson"}, "belongs to outer = 'simple'"),
        ({"outer": "simple", "acceleration": "shanks"}, "acceleration"),
        ({"outer": "simple", "acceleration": "anderson", "depth": 9}, "depth"),
        ({"outer": "simple", "depth": True}, "depth"),
        ({"fallback": 1}, "fallback"),
        ({"controller": "pid"}, "controller"),
    ],
)
def test_bad_options_are_named(options, word):
    with pytest.raises(ModelError, match=word):
        simulate(rod_pendulum(), 0.1, **options)
