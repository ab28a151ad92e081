"""A communication step ends with an error where it asks for too many steps, not never."""

import pytest
from fmu_helpers import ball_model
from tlismni.core import SimulationError
from tlismni.fmu_wrapper.run import MAX_STEPS
from tlismni.fmu_wrapper.slave import Slave


def started(**settings):
    slave = Slave(ball_model(), **settings)
    slave.enter_initialization()
    slave.exit_initialization()
    return slave


def test_a_force_out_of_proportion_is_followed():
    """It throws the ball far beyond all sizes of the model: by a parabola, which takes no more steps than any."""
    slave = started(max_steps=500)
    slave.set_by_name({"push": 1e12})
    slave.do_step(0.0, 0.05)
    assert slave["ball.vy"] == pytest.approx((1e12 / 2.0 - 9.81) * 0.05, rel=1e-9)
    assert slave["ball.y"] == pytest.approx(1.0 + 0.5 * (1e12 / 2.0 - 9.81) * 0.05**2, rel=1e-9)


def test_a_communication_step_of_too_many_steps_ends():
    """It bounces more than a dozen times."""
    slave = started(max_steps=50)
    with pytest.raises(SimulationError, match=r"max_steps = 50 .*load or a speed"):
        slave.do_step(0.0, 3.0)
    slave.reset()
    slave.enter_initialization()
    slave.exit_initialization()
    slave.do_step(0.0, 0.05)
    assert slave.time == 0.05


def test_a_slave_has_a_bound_of_its_own():
    slave = started()
    slave.do_step(0.0, 0.05)
    assert slave._run._simulation.settings.max_steps == MAX_STEPS
