"""An input out of proportion ends a communication step with an error, not never."""

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


def test_a_force_out_of_proportion_ends_the_step():
    slave = started(max_steps=500)
    slave.set_by_name({"push": 1e12})
    with pytest.raises(SimulationError, match=r"max_steps = 500 .*load or a speed"):
        slave.do_step(0.0, 0.05)
    slave.reset()
    slave.enter_initialization()
    slave.exit_initialization()
    slave.do_step(0.0, 0.05)
    assert slave.time == 0.05


def test_a_slave_has_a_bound_of_its_own():
    slave = started()
    slave.do_step(0.0, 0.05)
    assert slave._run._simulation.settings.max_steps == MAX_STEPS
