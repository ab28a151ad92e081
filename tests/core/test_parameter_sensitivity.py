"""Derivatives of channels by parameters against closed forms, through impacts too."""

import math

import numpy as np
import pytest
from helpers import G, ball_over_floor
from tlismni.core import ModelError, NewtonImpact, Parameter, SimulationError
from tlismni.core.analysis import parameter_sensitivities
from tlismni.core.analysis.parameter_sensitivity import ordered


def ball(restitution=0.8):
    return ball_over_floor(
        NewtonImpact(restitution=restitution),
        parameters=[Parameter(name="restitution", targets=("floor.law.restitution",))],
    )


def test_a_bounce_answers_to_restitution():
    """y = e v s - g s^2/2 with s the time since the impact at v = sqrt(2 g): dy/de = v s, d vy/de = v."""
    t1, t = math.sqrt(2.0 / G), np.array([0.3, 0.6, 0.9])
    found = parameter_sensitivities(ball(), 1.0, ["restitution"], ["ball.y", "ball.vy"], t_eval=t)
    s, v = np.maximum(t - t1, 0.0), math.sqrt(2.0 * G)
    assert found.of("ball.y", "restitution") == pytest.approx(v * s, abs=1e-7)
    assert found.of("ball.vy", "restitution") == pytest.approx(np.where(s > 0.0, v, 0.0), abs=1e-6)
    assert np.all(found.errors < 1e-4)


def test_places_of_numbers_and_what_matters():
    """Places of numbers without a name: restitution matters, the mass of a falling ball does not."""
    t, e = 0.6, 0.8
    found = parameter_sensitivities(ball(e), t, ["floor.law.restitution", "ball.mass"], ["ball.y"])
    assert found.of("ball.y", "ball.mass") == pytest.approx([0.0], abs=1e-8)
    assert ordered(found, "ball.y")[0][0] == "floor.law.restitution"
    v, s = math.sqrt(2.0 * G), t - math.sqrt(2.0 / G)
    assert found.relative[0, 0, 0] == pytest.approx(e * v * s, rel=1e-6)


def test_an_impact_that_comes_and_goes_shows_as_uncertainty():
    """At the time of the impact the velocity jumps: there is no derivative by the height, and the error says so."""
    model, t1 = ball_over_floor(NewtonImpact(restitution=0.8), height=1.5), math.sqrt(2.0 / G)
    lifted = model.model_copy(update={"contacts": (model.contacts[0].model_copy(update={
        "disk": model.contacts[0].disk.model_copy(update={"radius": 0.5})}),)})  # fmt: skip
    for time, unsure in ((0.9 * t1, False), (t1, True)):
        found = parameter_sensitivities(lifted, 0.9, ["floor.disk.radius"], ["ball.vy"], t_eval=[time])
        assert (found.errors.max() > 1e2) == unsure


def test_refusals():
    with pytest.raises(ModelError, match="has no parameter 'mass'"):
        parameter_sensitivities(ball(), 1.0, ["mass"], ["ball.y"])
    with pytest.raises(ModelError, match="at least one"):
        parameter_sensitivities(ball(), 1.0, [], ["ball.y"])
    with pytest.raises(SimulationError, match="the run as it is failed: max_steps"):
        parameter_sensitivities(ball(), 1.0, ["restitution"], ["ball.y"], max_steps=3)
