"""Sequences of calls that hypothesis thinks of, on a binary with the solver in it: legal and illegal ones, NaN and huge
values. Whatever came before, an illegal call answers Error with a line in the log, no value is handed out that is not
finite, and after a reset the instance is as new.

TLISMNI_SEQUENCES=100000 sets how many (the default is a quick look); `-o log_cli=true --log-level=INFO` shows how far
a long run has come.
"""

import logging
import math
import os

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmu_helpers import Messages, ball_model
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, rule, run_state_machine_as_test
from tlismni.fmu_wrapper import export_fmu

logger = logging.getLogger(__name__)
SEQUENCES = int(os.environ.get("TLISMNI_SEQUENCES", "40"))
BATCH = 1000
"""Sequences between two fresh starts of hypothesis, which remembers all that it has tried."""
MAX_STEPS = 2000
"""Of a communication step: a force of 1e16 N would keep the solver for years."""
ERROR = 3
NUMBERS = st.sampled_from((0.0, 0.25, 1.0, -1.0, 1e-300, 1e12, 1e300, math.nan, math.inf, -math.inf)) | st.floats()
STEPS = st.sampled_from((1e-3, 0.05, 0.3)) | NUMBERS


class Host:
    """An FMU, opened once, and an instance whose callbacks do nothing."""

    def __init__(self, folder):
        path = export_fmu(ball_model(), folder / "x.fmu", "3.0", t_end=1.0, max_steps=MAX_STEPS)
        unzipped = fmpy.extract(str(path), unzipdir=str(folder / "unzipped"))
        description = fmpy.read_model_description(unzipped)
        self.messages = Messages()
        self.vr = {v.name: v.valueReference for v in description.modelVariables}
        self.fmu = FMU3Slave(
            guid=description.guid, unzipDirectory=unzipped, modelIdentifier=description.coSimulation.modelIdentifier
        )
        self.fmu.instantiate(
            eventModeUsed=True, earlyReturnAllowed=True,
            logMessage=lambda e, s, c, m: self.messages(s, c.decode(), m.decode()),
        )  # fmt: skip
        self.reference = self.check_run()

    def check_run(self):
        """Outputs of a short run of a new instance, with an impact in it."""
        fmu, rows, t = self.fmu, [], 0.0
        fmu.enterInitializationMode(startTime=0.0, stopTime=1.0)
        fmu.exitInitializationMode()
        fmu.updateDiscreteStates()
        fmu.enterStepMode()
        while t < 0.6:
            due, _, _, t = fmu.doStep(t, 0.6 - t)
            rows.append(fmu.getFloat64([self.vr[n] for n in ("time", "ball.y", "ball.vy", "energy.balance")]))
            if due:
                fmu.enterEventMode()
                fmu.updateDiscreteStates()
                fmu.enterStepMode()
        fmu.reset()
        return rows


class Calls(RuleBasedStateMachine):
    """Any call at any time."""

    host: Host
    calls = refused = 0

    def __init__(self):
        super().__init__()
        self.fmu, self.vr, self.states = self.host.fmu, self.host.vr, []
        self.now = 0.0

    def call(self, function):
        """Make a call; refused ones must say why."""
        self.host.messages.clear()
        Calls.calls += 1
        try:
            return function()
        except FMICallException as error:
            Calls.refused += 1
            assert error.status == ERROR
            assert len(self.host.messages.errors) == 1 and ":" in self.host.messages.errors[0]
            return None

    @rule()
    def start(self):
        self.call(lambda: self.fmu.enterInitializationMode(startTime=0.0))
        self.call(self.fmu.exitInitializationMode)
        self.call(self.fmu.updateDiscreteStates)
        self.call(self.fmu.enterStepMode)

    @rule(start=NUMBERS, stop=st.none() | NUMBERS, tolerance=st.none() | NUMBERS)
    def enter(self, start, stop, tolerance):
        self.call(lambda: self.fmu.enterInitializationMode(tolerance=tolerance, startTime=start, stopTime=stop))

    @rule(name=st.sampled_from(("exitInitializationMode", "enterEventMode", "updateDiscreteStates", "enterStepMode")))
    def mode(self, name):
        self.call(getattr(self.fmu, name))

    @rule(h=STEPS, own=st.booleans(), t=NUMBERS)
    def step(self, h, own, t):
        answer = self.call(lambda: self.fmu.doStep(self.now if own else t, h))
        if answer is not None:
            self.now = answer[3]
            assert math.isfinite(self.now)

    @rule(data=st.data(), value=NUMBERS)
    def set(self, data, value):
        name = data.draw(st.sampled_from(sorted(self.vr)))
        self.call(lambda: self.fmu.setFloat64([self.vr[name]], [value]))

    @rule(value=NUMBERS)
    def push(self, value):
        self.call(lambda: self.fmu.setFloat64([self.vr["push"]], [value]))

    @rule(data=st.data())
    def get(self, data):
        names = data.draw(st.lists(st.sampled_from(sorted(self.vr)), min_size=1, max_size=4))
        values = self.call(lambda: self.fmu.getFloat64([self.vr[name] for name in names]))
        if values is not None:
            assert np.isfinite(values).all()
            if "time" in names:
                self.now = values[names.index("time")]

    @rule(value=NUMBERS)
    def derivative(self, value):
        unknowns = [self.vr["ball.ay"], self.vr["ball.y"]]
        values = self.call(lambda: self.fmu.getDirectionalDerivative(unknowns, [self.vr["push"]], [value]))
        assert values is None or np.isfinite(list(values)).all()

    @rule()
    def store(self):
        state = self.call(self.fmu.getFMUState)
        if state is not None:
            self.states.append(state)

    @rule(data=st.data())
    def restore(self, data):
        if self.states:
            state = data.draw(st.sampled_from(range(len(self.states))))
            self.call(lambda: self.fmu.setFMUState(self.states[state]))

    @rule()
    def carry(self):
        if self.states:
            data = self.call(lambda: self.fmu.serializeFMUState(self.states[-1]))
            self.states.append(self.call(lambda: self.fmu.deserializeFMUState(data)))

    @rule(name=st.sampled_from(("terminate", "reset")))
    def end(self, name):
        self.call(getattr(self.fmu, name))

    def teardown(self):
        for state in self.states:
            self.fmu.freeFMUState(state)
        self.fmu.reset()
        assert self.host.check_run() == self.host.reference


@pytest.mark.filterwarnings("ignore:overflow")
def test_any_sequence_of_calls(tmp_path):
    Calls.host = Host(tmp_path)
    for done in range(0, SEQUENCES, BATCH):
        run_state_machine_as_test(
            Calls,
            settings=settings(
                max_examples=min(BATCH, SEQUENCES - done), stateful_step_count=15, deadline=None, database=None,
                suppress_health_check=list(HealthCheck),
            ),
        )  # fmt: skip
        logger.info("%d sequences, %d calls, %d of them refused", done + BATCH, Calls.calls, Calls.refused)
    Calls.host.fmu.freeInstance()
