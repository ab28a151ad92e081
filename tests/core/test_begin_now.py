"""A run that begins anew without Python (`core/simulation/begin_now.py`) is a new run, bit for bit: with other numbers
and at other times too."""

import numpy as np
import pytest
from tlismni.core import Simulation
from tlismni.core.events.records import DECLINED, SETTLED, SINGULAR_JOINTS
from tlismni.core.native.beginning import let_begin
from tlismni.core.simulation.begin import NO_POSITIONS, NO_VELOCITIES, OVERLAPS
from tlismni.core.simulation.begin_now import begin_now
from tlismni.core.simulation.blueprint import take_numbers
from tlismni.core.simulation.exchange_record import INITIAL_ENERGY
from tlismni.models import load

NOT_IN_STATE = ("control", "row_scale", "work_scale", "atol_q", "atol_v")


class Starts:
    """A run that begins anew with the numbers of other models."""

    def __init__(self, name, law=None, **more):
        self.name, scenario = name, load(name, **({"law": law} if law else {}))
        self.settings = {
            "method": scenario.method,
            "rtol": scenario.rtol,
            "atol": scenario.atol,
            **scenario.options,
            **more,
        }
        self.sim = Simulation(scenario.model, **self.settings)
        let_begin(self.sim, self.settings)
        self.beginning = self.sim.beginning

    def begin(self, model):
        take_numbers(self.sim, model, model.assemble())
        self.beginning.take_numbers(self.sim.assembly)
        while DECLINED < (code := int(begin_now(self.beginning.record.record))) < SINGULAR_JOINTS:
            self.sim.workspace.sync()
            self.sim.build_wanted(code)  # which runs without Python have before
        self.sim.workspace.sync()
        return code

    def check(self, model, **other):
        """It begins as a run of the model does."""
        assert self.begin(model) == SETTLED
        there, here = Simulation(model, **{**self.settings, **other}), self.sim
        for field in here.workspace.state.dtype.names:
            a, b = here.workspace.state[field], there.workspace.state[field]
            assert a.tobytes() == b.tobytes(), (self.name, field)
        for field in NOT_IN_STATE:
            assert here.workspace.arrays[field].tobytes() == there.workspace.arrays[field].tobytes(), field
        assert here.crossing.times[INITIAL_ENERGY] == there.table.initial_energy
        assert np.flatnonzero(here.drive.pending).tolist() == there.pending


@pytest.mark.parametrize(
    "name, parameters",
    [
        ("pendulum_stop", {"mass": 3.0, "length": 0.4, "gravity": 3.7}),
        ("slider_crank_stop", {"rod_length": 0.41, "crank_speed": 5.0, "rod_mass": 0.2}),
        ("rocking_block", {"width": 0.31, "mass": 3.0, "tilt": 0.1}),
        ("heavy_top", {"spin": 120.0, "mass": 11.0}),
        ("impact_oscillator", {"start_velocity": 1.0, "start_position": -0.2}),
    ],
)
def test_it_begins_as_in_python(name, parameters):
    starts_here = Starts(name)
    starts_here.check(load(name).model)
    for parameter, value in parameters.items():
        starts_here.check(load(name, **{parameter: value}).model)
    starts_here.check(load(name, **parameters).model)
    starts_here.check(load(name).model)  # and back


def test_it_begins_at_another_time():
    starts_here = Starts("split_striker")
    for t in (0.0, 0.37, -2.0):
        starts_here.beginning.numbers[0] = t
        starts_here.check(load("split_striker").model, t0=t)


@pytest.mark.parametrize("more", [{"step": 1e-3}, {"atol": 1e-8}, {"atol": {"length": 1e-7}}, {"first_step": 1e-5}])
def test_settings_count(more):
    Starts("slider_crank_stop", **more).check(load("slider_crank_stop", crank_length=0.1).model)


@pytest.mark.parametrize(
    "name, law, parameters",
    [
        ("bouncing_ball", "newton", {"height": 0.0}),  # lies on the ground
        ("bouncing_ball", "newton", {"height": 0.0, "restitution": 0.0}),
        ("bouncing_ball", "hertz", {"height": 0.0}),  # its weight presses it in: the force begins at the start
        ("stick_slip", "hertz", {"mass": 2.0}),
    ],
)
def test_what_touches_at_the_start(name, law, parameters):
    Starts(name, law).check(load(name, law=law, **parameters).model)


def test_starts_that_are_none():
    """The same that Python refuses, as codes."""
    starts_here = Starts("pendulum_stop")
    model = load("pendulum_stop").model
    (rod,) = model.bodies
    far = model.model_copy(update={"bodies": (rod.model_copy(update={"position": (0.9, 0.3)}),)})
    assert starts_here.begin(far) == NO_POSITIONS
    fast = model.model_copy(update={"bodies": (rod.model_copy(update={"velocity": (3.0, 3.0)}),)})
    assert starts_here.begin(fast) == NO_VELOCITIES
    starts_here.check(model)
    below = Starts("bouncing_ball")
    ball = load("bouncing_ball").model
    sunk = ball.model_copy(
        update={"bodies": tuple(b.model_copy(update={"position": (0.0, -0.2)}) for b in ball.bodies)}
    )
    assert below.begin(sunk) == OVERLAPS
