"""fmpy drives the slave in process, and the FMU through its binary: the same calls, the same answers.

On the fake simulation; `test_fmu_real.py` repeats the essential with the solver.
"""

import math
from ctypes import byref
from itertools import pairwise

import fmpy
import numpy as np
import pytest
from fake_simulation import FakeSimulation
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2Discard,
    fmi2DoStepStatus,
    fmi2FMUstate,
    fmi2LastSuccessfulTime,
    fmi2Terminated,
)
from fmu_helpers import METHODS, ball_model
from tlismni.fmu_wrapper.in_process import InProcess

HOSTS = ("in process", "binary")
ERROR = 3


class Host:
    """One FMU as seen by fmpy, in process or as a binary."""

    def __init__(self, kind, path, folder, messages):
        self.kind = kind
        self.messages = messages
        self.unzipped = fmpy.extract(str(path), unzipdir=str(folder / f"unzipped_{path.stem}"))
        self.description = fmpy.read_model_description(self.unzipped)
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.instances = []

    def instance(self, logging_on=False):
        if self.kind == "in process":
            fmu = InProcess.of(self.unzipped, name="it", on_log=self.messages, logging_on=logging_on)
        else:
            fmu = self.binary(self.description.guid)
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
            fmu.instantiate(callbacks=callbacks, loggingOn=logging_on)
        self.instances.append(fmu)
        return fmu

    def binary(self, guid, **changes):
        return FMU2Slave(
            guid=guid, unzipDirectory=self.unzipped, instanceName="it",
            modelIdentifier=self.description.coSimulation.modelIdentifier, **changes,
        )  # fmt: skip

    def _log(self, environment, name, status, category, message):
        assert name == b"it"
        self.messages(status, category.decode(), message.decode().replace("%%", "%"))

    def started(self, start=0.0, logging_on=False, **reals):
        fmu = self.instance(logging_on)
        fmu.setupExperiment(startTime=start)
        for name, value in reals.items():
            fmu.setReal([self.vr[name]], [value])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        return fmu

    def read(self, fmu):
        names = ("time", "ball.y", "ball.vy", "ball.ay")
        return [*fmu.getReal([self.vr[n] for n in names]), *fmu.getInteger([self.vr["solver.events"]])]

    def run(self, fmu, times):
        rows = []
        for t0, t1 in pairwise(times):
            fmu.setReal([self.vr["push"]], [math.sin(t0)])
            fmu.doStep(t0, t1 - t0)
            rows.append(self.read(fmu))
        return rows

    def simulate(self, **arguments):
        instance = self.instance()
        return fmpy.simulate_fmu(
            self.unzipped,
            fmu_instance=instance,
            fmi_type="CoSimulation",
            start_values={"restitution": 0.8},
            output=[name for name in self.vr if name not in ("time", "solver.method")],
            **arguments,
        )


@pytest.fixture(params=HOSTS)
def make_host(request, fake_fmu, tmp_path, messages):
    hosts = []

    def make(path=None):
        host = Host(request.param, path or fake_fmu(), tmp_path, messages)
        hosts.append(host)
        return host

    yield make
    for host in hosts:
        for fmu in host.instances:
            fmu.freeInstance()


@pytest.fixture
def host(make_host):
    return make_host()


def check(result):
    """The result equals the simulation stepped by hand to the same times with the inputs that fmpy set."""
    simulation = FakeSimulation(ball_model().with_parameters({"restitution": 0.8}))
    pushes = result["push"]  # each recorded after the step that it held in
    simulation.set_inputs({"push": pushes[0]})
    rows = [simulation.values()]
    for (t0, t1), push in zip(pairwise(result["time"]), pushes[1:], strict=True):
        simulation.set_inputs({"push": push})
        simulation.advance(t0 + (t1 - t0))
        rows.append(simulation.values())
    for name, column in zip(("ball.y", "ball.vy", "ball.ay"), np.array(rows).T, strict=False):
        assert (result[name] == column).all(), name
    assert (result["floor.mode"] == np.array(rows)[:, 4]).all()
    assert result["solver.events"][-1] == len(simulation.events) >= 2


def test_fixed_grid(host):
    result = host.simulate(output_interval=0.05)
    assert len(result) == 41
    check(result)


def test_irregular_grid(host):
    # fmpy steps to the instants where an input jumps, and from there on to its own grid
    jumps = np.sort(np.random.default_rng(5).uniform(0.01, 1.99, 60))
    times = np.concatenate([[0.0], np.repeat(jumps, 2), [2.0]])
    pushes = np.repeat(np.arange(61.0) / 10.0, 2)
    signal = np.array(list(zip(times, pushes, strict=True)), dtype=[("time", float), ("push", float)])
    result = host.simulate(output_interval=0.05, input=signal)
    assert len(result) > 90 and np.unique(np.diff(result["time"])).size > 50
    assert np.unique(result["push"]).size > 50
    check(result)


def test_rollback(host):
    fmu = host.started()
    times = np.linspace(0.0, 2.0, 21).tolist()
    host.run(fmu, times[:9])
    state = fmu.getFMUState()
    first = host.run(fmu, times[8:])
    fmu.setFMUState(state)
    assert host.run(fmu, times[8:]) == first
    data = fmu.serializeFMUState(state)
    fmu.freeFMUState(state)
    assert not state.value
    fmu.freeFMUState(state)  # NULL is allowed
    other = host.started(restitution=0.3)
    other.setFMUState(other.deserializeFMUState(data))
    assert host.run(other, times[8:]) == first


def test_a_state_can_be_overwritten(host):
    fmu = host.started()
    state = fmu.getFMUState()
    handle = state.value
    fmu.doStep(0.0, 0.5)
    fmu.fmi2GetFMUstate(fmu.component, byref(state))
    assert state.value == handle
    row = host.read(fmu)
    fmu.doStep(0.5, 0.5)
    fmu.setFMUState(state)
    assert host.read(fmu) == row


def test_fmpy_continues_from_a_serialised_state(host):
    whole = host.simulate(output_interval=0.05, stop_time=2.0)
    fmu = host.started(restitution=0.8)
    for k in range(20):
        fmu.doStep(k * 0.05, (k + 1) * 0.05 - k * 0.05)
    data = fmu.serializeFMUState(fmu.getFMUState())
    rest = fmpy.simulate_fmu(
        host.unzipped, fmu_instance=host.instance(), fmi_type="CoSimulation", fmu_state=data, initialize=False,
        start_time=1.0, stop_time=2.0, output_interval=0.05,
    )  # fmt: skip
    assert rest["ball.y"].tolist() == pytest.approx(whole["ball.y"][20:].tolist(), abs=1e-12)


def test_reset_equals_a_new_instance(host):
    times = np.linspace(0.0, 2.0, 21).tolist()
    used = host.started(restitution=0.3)
    host.run(used, times)
    used.reset()
    used.setupExperiment(startTime=0.0)
    used.enterInitializationMode()
    used.exitInitializationMode()
    assert host.run(used, times) == host.run(host.started(), times)


def test_two_instances_and_two_fmus_do_not_touch_each_other(make_host, fake_fmu):
    hosts = [make_host(fake_fmu("one.fmu")), make_host(fake_fmu("two.fmu", source=ball_model("other", height=2.0)))]
    times = np.linspace(0.0, 2.0, 21).tolist()
    cases = [(host, e) for host in hosts for e in (0.5, 0.9)]
    alone = [host.run(host.started(restitution=e), times) for host, e in cases]
    together = [(host, host.started(restitution=e)) for host, e in cases]
    rows = [[] for _ in cases]
    for step in pairwise(times):
        for (host, fmu), out in zip(together, rows, strict=True):
            out += host.run(fmu, list(step))
    assert rows == alone
    assert len({str(row) for row in rows}) == 4


def test_all_kinds_of_values(make_host, fake_fmu):
    host = make_host(fake_fmu("kinds.fmu", order=4, variant="b", light=False))
    fmu, vr = host.instance(), host.vr
    fmu.setInteger([vr["solver.order"]], [5])
    fmu.setBoolean([vr["solver.light"]], [True])
    fmu.setString([vr["solver.variant"]], ["grün %d"])
    fmu.setInteger([vr["solver.method"]], [METHODS.index("auto")])
    fmu.setReal([vr["mass"], vr["push"]], [1.0, 2.0])
    fmu.enterInitializationMode()
    assert fmu.getInteger([vr["solver.order"], vr["solver.events"]]) == [5, 0]
    assert fmu.getInteger([vr["solver.method"], vr["floor.law"]]) == [METHODS.index("auto"), 0]
    assert fmu.getBoolean([vr["solver.light"], vr["floor.in_contact"]]) == [1, 0]
    assert fmu.getString([vr["solver.variant"]] * 2) == ["grün %d".encode()] * 2
    assert fmu.getReal([vr["mass"], vr["ball.ay"]]) == [1.0, 2.0 / 0.5 - 9.81]
    assert fmu.getReal([]) == [] and fmu.getString([]) == []
    fmu.setReal([], [])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda f, vr: f.doStep(0.3, 0.1),
         "fmi2DoStep: FmuValueError: the communication point is 0.3 s, but this slave is at 0.0 s: step from there"),
        (lambda f, vr: f.doStep(0.0, -0.1), "fmi2DoStep: FmuValueError: the communication step is -0.1 s"),
        (lambda f, vr: f.setReal([vr["push"]], [math.nan]),
         "fmi2SetReal: FmuValueError: 'push' (value reference {vr[push]}) was set to nan, which is not finite"),
        (lambda f, vr: f.setReal([4711], [1.0]), "fmi2SetReal: FmuValueError: value reference 4711 is unknown"),
        (lambda f, vr: f.getReal([vr["solver.events"]]),
         "fmi2GetReal: FmuValueError: value reference {vr[solver.events]} is 'solver"),
        (lambda f, vr: f.getString([4711]), "fmi2GetString: FmuValueError: value reference 4711 is unknown"),
        (lambda f, vr: f.setReal([vr["mass"]], [1.0]), "fmi2SetReal: CallOrderError: parameter 'mass' is fixed"),
        (lambda f, vr: f.setupExperiment(), "fmi2SetupExperiment: CallOrderError: cannot setup in phase 'step'"),
        (lambda f, vr: f.exitInitializationMode(), "fmi2ExitInitializationMode: CallOrderError: cannot exit"),
        (lambda f, vr: f.setFMUState(fmi2FMUstate(99)), "fmi2SetFMUstate: SnapshotError: FMU state 0x63 is unknown to"),
        (lambda f, vr: f.freeFMUState(fmi2FMUstate(99)), "fmi2FreeFMUstate: SnapshotError: FMU state 0x63 is unknown"),
        (lambda f, vr: f.serializeFMUState(fmi2FMUstate(99)), "fmi2SerializedFMUstateSize: SnapshotError: FMU state"),
        (lambda f, vr: f.deserializeFMUState(b"some bytes"), "fmi2DeSerializeFMUstate: SnapshotError: these 10 bytes"),
        (lambda f, vr: f.setDebugLogging(True, ["logPoems"]),
         "fmi2SetDebugLogging: FmuValueError: unknown log categories ['logPoems']; known are"),
        (lambda f, vr: f.getDirectionalDerivative([vr["ball.y"]], [vr["mass"]], [1.0]),
         "fmi2GetDirectionalDerivative: FmuValueError: 'mass' is of role parameter: derivatives are with respect to"),
        (lambda f, vr: f.getDirectionalDerivative([vr["push"]], [vr["push"]], [1.0]),
         "fmi2GetDirectionalDerivative: FmuValueError: 'push' is of role input: derivatives are those of outputs"),
        (lambda f, vr: f.getDirectionalDerivative([vr["ball.y"]], [vr["push"]], [math.nan]),
         "fmi2GetDirectionalDerivative: FmuValueError: the seed [nan] is not finite"),
        (lambda f, vr: f.setRealInputDerivatives([vr["mass"]], [1], [1.0]),
         "fmi2SetRealInputDerivatives: FmuValueError: 'mass' is of role parameter: only inputs take derivatives"),
        (lambda f, vr: f.setRealInputDerivatives([vr["push"]], [3], [1.0]),
         "fmi2SetRealInputDerivatives: FmuValueError: a derivative of order 3 of input 'push' was given: orders"),
        (lambda f, vr: f.setRealInputDerivatives([vr["push"]], [1], [math.inf]),
         "fmi2SetRealInputDerivatives: FmuValueError: a derivative of input 'push' is inf: a finite number is needed"),
        (lambda f, vr: f.getRealOutputDerivatives([vr["ball.ay"]], [1]),
         "fmi2GetRealOutputDerivatives: UnavailableError: the time derivatives of ball.ay are not known exactly"),
        (lambda f, vr: f.getRealOutputDerivatives([vr["ball.y"]], [2]),
         "fmi2GetRealOutputDerivatives: FmuValueError: a derivative of order 2 of 'ball.y' was asked"),
        (lambda f, vr: f.getRealOutputDerivatives([vr["push"]], [1]),
         "fmi2GetRealOutputDerivatives: FmuValueError: 'push' is of role input"),
        (lambda f, vr: f.cancelStep(), "fmi2CancelStep: UnavailableError: steps never run in the background"),
    ],
)  # fmt: skip
def test_errors_are_statuses_with_one_line_in_the_log_and_the_instance_lives_on(host, messages, call, message):
    fmu = host.started()  # logging is off
    before = host.read(fmu)
    with pytest.raises(FMICallException) as caught:
        call(fmu, host.vr)
    assert caught.value.status == ERROR
    assert len(messages) == 1 and "\n" not in messages[0][2]
    assert messages.errors[0].startswith(message.format(vr=host.vr))
    assert host.read(fmu) == before
    fmu.doStep(0.0, 0.125)


def test_directional_derivatives(host):
    fmu = host.started()
    fmu.doStep(0.0, 0.25)
    before = host.read(fmu)
    outputs = [host.vr[name] for name in ("ball.ay", "ball.y", "ball.ay")]
    assert fmu.getDirectionalDerivative(outputs, [host.vr["push"]], [3.0]) == pytest.approx([1.5, 0.0, 1.5], rel=1e-14)
    assert fmu.getDirectionalDerivative(outputs, [], []) == [0.0] * 3
    assert host.read(fmu) == before


def test_output_derivatives(host):
    fmu = host.started()
    fmu.doStep(0.0, 0.25)
    v, a = fmu.getReal([host.vr["ball.vy"], host.vr["ball.ay"]])
    found = fmu.getRealOutputDerivatives([host.vr["ball.y"], host.vr["ball.vy"]], [1, 1])
    assert list(found) == [v, a]


def test_a_failed_step(make_host, fake_fmu, messages):
    host = make_host(fake_fmu("fails.fmu", fail_at=0.5))
    fmu = host.started()
    fmu.doStep(0.0, 0.25)
    state = fmu.getFMUState()
    for message in ("fmi2DoStep: SimulationError: the outer loop diverged", "fmi2DoStep: CallOrderError: cannot do st"):
        with pytest.raises(FMICallException):
            fmu.doStep(0.25, 0.25)
        assert messages.errors[-1].startswith(message)
    fmu.setFMUState(state)
    fmu.doStep(0.25, 0.125)


def test_traceback_and_events_go_to_their_categories(host, messages):
    fmu = host.started(logging_on=True)
    fmu.doStep(0.0, 0.5)
    with pytest.raises(FMICallException):
        fmu.doStep(0.0, 0.5)
    assert [category for _, category, _ in messages] == ["logEvents", "logStatusError", "logTraceback"]
    assert "raise FmuValueError" in messages[-1][2]
    messages.clear()
    fmu.setDebugLogging(False, ["logTraceback"])
    with pytest.raises(FMICallException):
        fmu.doStep(0.0, 0.5)
    assert [category for _, category, _ in messages] == ["logStatusError"]


def test_status_figures(host):
    fmu = host.started()
    fmu.doStep(0.0, 0.5)
    assert fmu.getRealStatus(fmi2LastSuccessfulTime) == 0.5
    assert fmu.getBooleanStatus(fmi2Terminated) is False
    asked = (fmu.getStatus, fmu.getIntegerStatus, fmu.getStringStatus, fmu.getRealStatus)
    for ask in asked:
        with pytest.raises(FMICallException) as caught:
            ask(fmi2DoStepStatus)
        assert caught.value.status == fmi2Discard
    fmu.terminate()
    assert host.read(fmu)[0] == 0.5


def test_a_message_with_percent_signs_arrives_whole(host, messages):
    fmu = host.instance()
    with pytest.raises(FMICallException):
        fmu.setDebugLogging(True, ["100%s%n"])
    assert "unknown log categories ['100%s%n']" in messages.errors[0]
