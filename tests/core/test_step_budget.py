"""A run that would not end says so, and what it has reached stays."""

import pytest
from tlismni.core import ModelError, Simulation, SimulationError, simulate
from tlismni.models import load


def test_steps_are_counted_between_two_times():
    model = load("bouncing_ball").model
    free = Simulation(model, step=1e-3)
    free.advance(0.4)
    bounded = Simulation(model, step=1e-3, max_steps=101)
    for k in range(1, 5):  # each of them within its own budget, all together beyond it
        bounded.advance(0.1 * k)
    assert bounded.values().tolist() == free.values().tolist()


def test_too_many_steps_are_refused_where_they_end():
    model = load("bouncing_ball").model
    sim = Simulation(model, step=1e-3, max_steps=50)
    with pytest.raises(SimulationError, match=r"max_steps = 50 .* reach t = 0.1 s.* last was 0.001 s") as caught:
        sim.advance(0.1)
    assert caught.value.t == pytest.approx(0.05, rel=1e-9)
    assert caught.value.loop == "step size"


def test_what_a_run_has_computed_is_not_lost():
    with pytest.raises(SimulationError) as caught:
        simulate(load("bouncing_ball").model, 0.1, step=1e-3, max_steps=50)
    assert caught.value.partial.t[-1] == pytest.approx(0.05, rel=1e-9)


@pytest.mark.parametrize("value", [0, -3, 2.5, True, "many"])
def test_what_is_no_number_of_steps_is_refused(value):
    with pytest.raises(ModelError, match="max_steps"):
        Simulation(load("bouncing_ball").model, max_steps=value)
