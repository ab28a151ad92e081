"""Identification from synthetic measurements: what was put in comes out, as surely as is said."""

import math

import numpy as np
import pytest
from helpers import G, ball_over_floor
from tlismni.core import ModelError, NewtonImpact, simulate
from tlismni.core.analysis import Measurement, fit
from tlismni.models import load

WITHIN = {"stop.law.restitution": (0.05, 0.5, 0.99), "spring.damping": (0.0, 0.2, 1.0)}
TRUE = {"stop.law.restitution": 0.7, "spring.damping": 0.08}


def oscillator():
    """The impact oscillator, started away from its stop; 20 s with several impacts."""
    model = load("impact_oscillator", frequency=2.0, restitution=0.5, damping_ratio=0.1).model
    return model, model.with_parameters(TRUE)


def course(times):
    _, true = oscillator()
    result = simulate(true, float(times[-1]), rtol=1e-10, atol=1e-12, t_eval=times)
    return result["mass.x"], [e.t for e in result.events if e.kind == "impact"]


def test_without_noise_the_parameters_come_back():
    times = np.linspace(0.1, 6.0, 60)
    x, impacts = course(times)
    assert len(impacts) >= 2
    model, _ = oscillator()
    found = fit(model, Measurement(times, {"mass.x": x}), WITHIN)
    for name, value in TRUE.items():
        assert found[name] == pytest.approx(value, abs=1e-6)
    assert found.noise < 1e-6 and found.model == model.with_parameters({name: found[name] for name in found.names})
    assert "stop.law.restitution = 0.7" in str(found)


def test_times_of_impacts_tell_the_restitution_of_a_ball():
    """Closed form: t_k = t_1 (1 + 2 e + 2 e^2 + ...)."""
    e, t1 = 0.75, math.sqrt(2.0 / G)
    times = t1 * np.array([1.0, 1.0 + 2.0 * e, 1.0 + 2.0 * e + 2.0 * e**2])
    data = Measurement([0.1], {"ball.y": [np.nan]}, {"ball.y": 1.0}, {"floor": times}, 1e-3)
    found = fit(ball_over_floor(NewtonImpact(restitution=0.5)), data, {"floor.law.restitution": (0.0, 0.5, 1.0)})
    assert found.simultaneous == pytest.approx(found.intervals)  # one parameter is all of them
    assert found["floor.law.restitution"] == pytest.approx(e, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("trials, least, both", [(20, 16, 18), pytest.param(100, 90, 95, marks=pytest.mark.full)])
def test_intervals_hold_what_they_say(trials, least, both):
    """Seeded trials with noise of 1 % of the motion: each interval of 95 % holds the truth in about 95 % of them, and
    the wider ones hold both parameters at once."""
    times = np.linspace(0.1, 6.0, 60)
    x, _ = course(times)
    sigma, rng, (model, _) = 0.01 * float(np.ptp(x)), np.random.default_rng(7), oscillator()
    inside, at_once = np.zeros(2, dtype=int), 0
    noises = []
    for _ in range(trials):
        data = Measurement(times, {"mass.x": x + rng.normal(0.0, sigma, len(x))}, {"mass.x": sigma})
        found = fit(model, data, WITHIN, rtol=1e-8)
        low, high = found.intervals.T
        true = np.array(list(TRUE.values()))
        inside += (low <= true) & (true <= high)
        below, above = found.simultaneous.T
        assert np.all(below < low) and np.all(high < above)
        at_once += bool(np.all((below <= true) & (true <= above)))
        noises.append(found.noise)
    # binomial spreads: 1.0 of 19, 2.2 of 95; 500 trials give 95.0 and 95.6 % of each, 96.6 % of both at once
    assert np.all(inside >= least), inside
    assert at_once >= both, at_once
    assert np.mean(noises) == pytest.approx(1.0, abs=0.3 / trials**0.5)


def test_refusals():
    model, _ = oscillator()
    times, x = np.linspace(0.1, 1.0, 5), np.zeros(5)
    good = Measurement(times, {"mass.x": x})
    for data, parameters, said in (
        (good, {}, "at least one parameter"),
        (good, {"spring.damping": (0.5, 0.1, 1.0)}, "between its bounds"),
        (good, {"spring.damp": 0.1}, "no field 'damp'"),
        (Measurement(times, {"mass.z": x}), {"spring.damping": 0.1}, "no channels"),
        (Measurement(times, {"mass.x": x[:3]}), {"spring.damping": 0.1}, "3 values for 5 times"),
        (Measurement(times, {"mass.x": x, "mass.vx": x}), {"spring.damping": 0.1}, "several things were measured"),
        (Measurement(times[:1], {"mass.x": x[:1]}), {"spring.damping": (0.0, 0.1, 1.0)}, "more are needed"),
        (good, {"mass.inertia": 1.0, "spring.damping": (0.0, 0.1, 1.0)}, "do not tell"),
        (Measurement(times, {"mass.x": x}, impacts={"wall": [1.0]}, impact_sigma=1.0, sigma={"mass.x": 1.0}),
         {"spring.damping": 0.1}, "no contacts"),
    ):  # fmt: skip
        with pytest.raises(ModelError, match=said):
            fit(model, data, parameters)
