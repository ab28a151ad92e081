"""Intermediate update of FMI 3.0: where the solver's steps end, the master looks, sets inputs, or ends the step."""

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmu_helpers import ball_model
from test_input_slopes import MASS, mass_model
from tlismni.core import Simulation
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.in_process3 import InProcess3
from tlismni.fmu_wrapper.intermediate import Updates

HOSTS = ["binary", "in process"]


class Fmu:
    """An FMU whose updates go to `self.at(time)`, which may answer with the time at which the step shall end."""

    def __init__(
        self, host, folder, source, t_end=2.0, early_return=False, event_mode=False, required=("push",), **solver
    ):
        path = export_fmu(source, folder / "x.fmu", "3.0", t_end=t_end, **solver)
        self.unzipped = fmpy.extract(str(path), unzipdir=str(folder / "unzipped"))
        self.description = fmpy.read_model_description(self.unzipped)
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.times, self.t, self.messages = [], 0.0, []
        self.at = lambda time: None
        wanted = [self.vr[name] for name in required]
        if host == "in process":
            self.fmu = InProcess3.of(
                self.unzipped, updates=Updates(self._update, frozenset(wanted)), early_return=early_return,
                event_mode=event_mode, on_log=lambda *m: self.messages.append(m[2]),
            )  # fmt: skip
        else:
            self.fmu = FMU3Slave(
                guid=self.description.guid, unzipDirectory=self.unzipped,
                modelIdentifier=self.description.coSimulation.modelIdentifier,
            )  # fmt: skip
            self.fmu.instantiate(
                earlyReturnAllowed=early_return, eventModeUsed=event_mode, intermediateUpdate=self._called,
                requiredIntermediateVariables=wanted, logMessage=lambda e, s, c, m: self.messages.append(m.decode()),
            )  # fmt: skip
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        if event_mode:
            self.fmu.updateDiscreteStates()
            self.fmu.enterStepMode()

    def _called(self, environment, time, set_requested, get_allowed, finished, can_return, wanted, end):
        assert set_requested and get_allowed and finished
        answer = self._update(time, can_return)
        if answer is not None:
            wanted[0], end[0] = True, answer

    def _update(self, time, can_return):
        self.times.append(time)
        return self.at(time)

    def get(self, *names):
        return self.fmu.getFloat64([self.vr[name] for name in names])

    def set(self, name, value):
        self.fmu.setFloat64([self.vr[name]], [value])

    def step(self, h):
        answer = self.fmu.doStep(self.t, h)
        self.t = answer[3]
        return answer


@pytest.mark.parametrize("host", HOSTS)
def test_updates_come_where_the_solvers_steps_end_and_change_nothing(host, tmp_path):
    fmu = Fmu(host, tmp_path, ball_model(), rtol=1e-8)
    values = []
    fmu.at = lambda time: values.append(fmu.get("time", "ball.y"))
    assert fmu.description.coSimulation.providesIntermediateUpdate
    simulation = Simulation(ball_model(), rtol=1e-8, record=True)
    for k in range(5):
        fmu.step(0.25)
        simulation.advance(0.25 * (k + 1))
        simulation.flush()
        ends = {row[0] for block in simulation.samples for row in block if row[0] < simulation.t}
        assert {t for t in fmu.times if t > 0.0} == {t for t in ends if t > 0.0 and t not in (0.25, 0.5, 0.75, 1.0)}
    column = [c.name for c in simulation.channels].index("ball.y")
    assert fmu.get("ball.y")[0] == simulation.values()[column]
    assert [v[0] for v in values] == fmu.times == sorted(fmu.times)
    plain = Simulation(ball_model(), rtol=1e-8)
    for time, y in values[:20]:
        plain.advance(time)
        assert y == plain.values()[column]


@pytest.mark.parametrize("host", HOSTS)
def test_inputs_set_in_updates_act_from_there_on(host, tmp_path):
    """A force that the master sets anew in each update: constant in between, so that the motion is known."""
    fmu = Fmu(host, tmp_path, mass_model(), step=0.04)
    course = [(0.0, 0.0)]

    def follow(time):
        fmu.set("push", 10.0 * time)
        course.append((time, 10.0 * time))

    fmu.at = follow
    for _ in range(4):
        fmu.set("push", course[-1][1])  # the value that holds
        fmu.step(0.25)
    x = v = 0.0
    for (t, u), (end, _) in zip(course, [*course[1:], (1.0, 0.0)], strict=True):
        h = end - t
        x, v = x + h * v + 0.5 * u / MASS * h * h, v + u / MASS * h
    assert len(course) > 20
    assert fmu.get("p.x", "p.vx") == pytest.approx([x, v], abs=1e-9)


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize("ahead", [0.0, 0.003])
def test_a_step_ends_where_the_master_wants(host, ahead, tmp_path):
    fmu = Fmu(host, tmp_path, ball_model(), rtol=1e-8, early_return=True)
    fmu.at = lambda time: time + ahead if time > 0.1 else None
    event, _, early, last = fmu.step(0.4)
    assert early and not event
    assert last == fmu.times[-1] if ahead == 0.0 else fmu.times[0] < last < 0.4
    assert fmu.get("time") == [last]
    fmu.at = lambda time: None
    assert fmu.step(0.4 - last)[2:] == (False, pytest.approx(0.4))
    plain = Simulation(ball_model(), rtol=1e-8)
    plain.advance(fmu.t)
    column = [c.name for c in plain.channels].index("ball.y")
    assert fmu.get("ball.y")[0] == plain.values()[column]


@pytest.mark.parametrize("host", HOSTS)
def test_without_early_return_the_wish_is_not_granted(host, tmp_path):
    fmu = Fmu(host, tmp_path, ball_model())
    fmu.at = lambda time: time
    assert fmu.step(0.4)[2:] == (False, 0.4)


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize("early_return", [False, True])
@pytest.mark.parametrize("event_mode", [False, True])
def test_impacts_are_where_they_are_without_updates(host, early_return, event_mode, tmp_path):
    fmu = Fmu(host, tmp_path, ball_model(), rtol=1e-9, early_return=early_return, event_mode=event_mode)
    plain = Simulation(ball_model(), rtol=1e-9)
    plain.advance(1.5)
    first = plain.events[0].t
    event, _, early, last = fmu.step(1.0)
    if early_return:
        assert (event, early, last) == (event_mode, True, pytest.approx(first, abs=1e-14))
        if event_mode:
            fmu.fmu.enterEventMode()
            fmu.fmu.updateDiscreteStates()
            fmu.fmu.enterStepMode()
    else:
        assert (event, early, last) == (False, False, 1.0)
    assert all(t < last for t in fmu.times)
    assert fmu.fmu.getInt32([fmu.vr["solver.events"]])[0] >= 1


@pytest.mark.parametrize("host", HOSTS)
def test_what_is_not_allowed_in_an_update(host, tmp_path):
    fmu = Fmu(host, tmp_path, ball_model(), required=())
    refused = []

    def misuse(time):
        calls = (
            lambda: fmu.set("push", 1.0),
            lambda: fmu.fmu.doStep(time, 0.1),
            lambda: fmu.fmu.getFMUState(),
            lambda: fmu.fmu.reset(),
            lambda: fmu.fmu.terminate(),
        )
        for call in calls:
            with pytest.raises(FMICallException):
                call()
            refused.append(fmu.messages[-1])

    fmu.at = lambda time: None if refused else misuse(time)
    fmu.step(0.3)
    assert "only the required intermediate variables can be set, not ['push']" in refused[0]
    assert all("in phase 'intermediate update': return from the callback" in text for text in refused[1:])
    assert np.isfinite(fmu.get("ball.y")).all()


def test_a_callback_that_raises_fails_the_step_and_the_instance_can_be_reset(tmp_path):
    fmu = Fmu("in process", tmp_path, ball_model())

    def fail(time):
        raise ValueError("the master's own fault")

    fmu.at = fail
    with pytest.raises(FMICallException):
        fmu.step(0.3)
    assert "the master's own fault" in fmu.messages[-1]
    fmu.at = lambda time: None
    fmu.fmu.reset()
    fmu.fmu.enterInitializationMode()
    fmu.fmu.exitInitializationMode()
    fmu.t = 0.0
    fmu.step(0.3)
