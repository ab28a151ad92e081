"""FMI 3.0 as fmpy sees it, in process and through the binary: values, states, errors, the four ways of events.

On the fake simulation; `test_fmi3_real.py` repeats the essential with the solver.
"""

import math
from ctypes import byref, c_bool, c_double, c_size_t, c_uint64
from itertools import pairwise

import fmpy
import numpy as np
import pytest
from fake_simulation import FakeSimulation
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave, fmi3FMUState
from fmu_helpers import METHODS, ball_model
from tlismni.fmu_wrapper.fmi3_calls import REFUSED
from tlismni.fmu_wrapper.in_process3 import InProcess3

WAYS = [(False, False), (False, True), (True, False), (True, True)]
ERROR = 3


class Host:
    """One FMU as seen by fmpy, in process or as a binary."""

    def __init__(self, kind, path, folder, messages):
        self.kind, self.messages = kind, messages
        self.unzipped = fmpy.extract(str(path), unzipdir=str(folder / f"unzipped_{path.stem}"))
        self.description = fmpy.read_model_description(self.unzipped)
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}

    def instance(self, event_mode=False, early_return=False, logging_on=False, token=None):
        if self.kind == "in process":
            flags = {"event_mode": event_mode, "early_return": early_return, "logging_on": logging_on}
            return InProcess3.of(self.unzipped, name="it", on_log=self.messages, token=token, **flags)
        identifier = self.description.coSimulation.modelIdentifier
        fmu = FMU3Slave(
            guid=token or self.description.guid, unzipDirectory=self.unzipped, instanceName="it",
            modelIdentifier=identifier,
        )  # fmt: skip
        fmu.instantiate(
            eventModeUsed=event_mode, earlyReturnAllowed=early_return, loggingOn=logging_on,
            logMessage=lambda e, s, c, m: self.messages(s, c.decode(), m.decode()),
        )  # fmt: skip
        return fmu

    def started(self, event_mode=False, early_return=False, logging_on=False, stop=None, **reals):
        fmu = self.instance(event_mode, early_return, logging_on)
        for name, value in reals.items():
            fmu.setFloat64([self.vr[name]], [value])
        fmu.enterInitializationMode(startTime=0.0, stopTime=stop)
        fmu.exitInitializationMode()
        if event_mode:
            update(fmu)
        return fmu

    def read(self, fmu):
        names = ("time", "ball.y", "ball.vy", "ball.ay")
        return [*fmu.getFloat64([self.vr[n] for n in names]), *fmu.getInt32([self.vr["solver.events"]])]

    def run(self, fmu, times):
        rows = []
        for t0, t1 in pairwise(times):
            fmu.setFloat64([self.vr["push"]], [math.sin(t0)])
            fmu.doStep(t0, t1 - t0)
            rows.append(self.read(fmu))
        return rows


def update(fmu):
    """From event mode to step mode."""
    while fmu.updateDiscreteStates()[0]:
        pass
    fmu.enterStepMode()


@pytest.fixture(params=["in process", "binary"])
def make_host(request, fake_fmu, tmp_path, messages):
    return lambda **more: Host(
        request.param, fake_fmu(fmi_version="3.0", **{"variant": "plain", **more}), tmp_path, messages
    )


@pytest.fixture
def host(make_host):
    return make_host()


def reference(t):
    """The simulation at t, with its events."""
    simulation = FakeSimulation(ball_model())
    simulation.advance(t)
    return simulation


def test_description(host):
    assert host.description.fmiVersion == "3.0"
    flags = host.description.coSimulation
    assert flags.hasEventMode and flags.canGetAndSetFMUstate and flags.canSerializeFMUstate
    assert flags.canHandleVariableCommunicationStepSize
    kinds = {v.name: (v.type, v.causality, v.variability, v.start) for v in host.description.modelVariables}
    assert kinds["solver.method"] == ("Enumeration", "parameter", "fixed", str(METHODS.index("auto")))
    assert kinds["push"] == ("Float64", "input", "continuous", "1.0")
    assert kinds["floor.in_contact"] == ("Boolean", "output", "discrete", None)
    outputs = {v.name for v in host.description.modelVariables if v.causality == "output"}
    assert {u.variable.name for u in host.description.outputs} == outputs


# events


@pytest.mark.parametrize(("event_mode", "early"), WAYS)
def test_a_step_over_an_impact(host, event_mode, early):
    """One step over the first impact, as each of the four kinds of instances makes it."""
    impact = reference(0.6).events[0].t
    fmu = host.started(event_mode, early)
    due, terminate, returned, last = fmu.doStep(0.0, 0.6)
    assert terminate is False
    assert (due, returned, last) == (event_mode and early, early, impact if early else 0.6)
    t, _, speed, _, count = host.read(fmu)
    assert t == last and count == (0 if due else 1)
    if due:
        assert speed < 0.0  # the side before the impact
        fmu.enterEventMode()
        assert host.read(fmu)[2] == speed
        assert fmu.updateDiscreteStates() == (False, False, False, False, False, 0.0)
        _, _, after, _, count = host.read(fmu)
        assert after == -0.7 * speed and count == 1
        fmu.enterStepMode()
    if early:
        assert fmu.doStep(last, 0.6 - last)[:3] == (False, False, False)
    assert host.read(fmu)[:3] == pytest.approx([0.6, *reference(0.6).values()[:2]], rel=1e-12)


@pytest.mark.parametrize(("event_mode", "early"), WAYS)
def test_an_impact_at_the_end_of_a_step(host, event_mode, early):
    """There is no early return; with event mode the impact is left to it, without it is solved."""
    impact = reference(0.6).events[0].t
    fmu = host.started(event_mode, early)
    assert fmu.doStep(0.0, impact) == (event_mode, False, False, impact)
    assert host.read(fmu)[4] == (0 if event_mode else 1)
    if event_mode:
        fmu.enterEventMode()
        update(fmu)
    assert host.read(fmu)[2] > 0.0 and host.read(fmu)[4] == 1


@pytest.mark.parametrize(("event_mode", "early"), WAYS)
def test_a_step_without_events(host, event_mode, early):
    fmu = host.started(event_mode, early)
    assert fmu.doStep(0.0, 0.125) == (False, False, False, 0.125)


@pytest.mark.parametrize(("event_mode", "early"), WAYS)
def test_simulate_fmu(host, event_mode, early):
    fmu = host.instance(event_mode, early)
    result = fmpy.simulate_fmu(
        host.unzipped, fmu_instance=fmu, fmi_type="CoSimulation", stop_time=1.25, output_interval=0.05,
        use_event_mode=event_mode, early_return_allowed=early, output=["ball.y", "ball.vy", "solver.events"],
    )  # fmt: skip
    impacts = [e.t for e in reference(1.25).events]
    assert len(impacts) == 2 and result["solver.events"][-1] == len(impacts)
    stops = [t for t in np.unique(result["time"]) if min(abs(np.subtract(impacts, t))) < 1e-14]
    assert stops == pytest.approx(impacts if early else [], rel=0.0, abs=1e-14)
    for t in stops:  # both sides of an impact with event mode, only that after it without
        speeds = result["ball.vy"][result["time"] == t]
        assert (len(speeds), speeds[-1] > 0.0) == ((2 if event_mode else 1), True)
        assert not event_mode or speeds[0] < 0.0
    exact = [reference(t).values()[0] for t in result["time"]]
    np.testing.assert_allclose(result["ball.y"], exact, rtol=0.0, atol=1e-12)


def test_event_mode_at_any_communication_point(host):
    """Masters enter it for their own events; inputs can be set there."""
    fmu = host.started(True, True)
    fmu.doStep(0.0, 0.125)
    fmu.enterEventMode()
    fmu.setFloat64([host.vr["push"]], [5.0])
    assert host.read(fmu)[3] == 5.0 / 2.0 - 9.81
    update(fmu)
    fmu.doStep(0.125, 0.125)


@pytest.mark.parametrize("way", [(True, True), (False, True)])
def test_a_state_stored_at_an_event(host, way):
    fmu = host.started(*way)
    last = fmu.doStep(0.0, 1.5)[3]
    data = fmu.serializeFMUState(fmu.getFMUState())
    rows = []
    for target in (fmu, host.started(*way)):
        target.setFMUState(target.deserializeFMUState(data))
        if way[0]:
            target.enterEventMode()
            update(target)
        target.doStep(last, 0.125)
        rows.append(host.read(target))
    assert rows[0] == rows[1] and rows[0][4] == 1


def test_a_state_with_an_event_needs_event_mode(host, messages):
    fmu = host.started(True, True)
    fmu.doStep(0.0, 1.5)
    data = fmu.serializeFMUState(fmu.getFMUState())
    other = host.started()
    before = host.read(other)
    with pytest.raises(FMICallException):
        other.setFMUState(other.deserializeFMUState(data))
    assert "was stored in phase 'event due', and this instance has no event mode" in messages.errors[0]
    assert host.read(other) == before
    other.doStep(0.0, 0.125)


# values, states


def test_fixed_grid_and_rollback(host):
    times = np.linspace(0.0, 2.0, 21).tolist()
    fmu = host.started()
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
    fmu.reset()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    assert host.run(fmu, times) == host.run(host.started(), times)
    fmu.terminate()
    fmu.freeInstance()


def test_all_kinds_of_values(make_host):
    host = make_host(order=4, variant="b", light=False)
    fmu, vr = host.instance(), host.vr
    fmu.setInt32([vr["solver.order"]], [5])
    fmu.setBoolean([vr["solver.light"]], [True])
    fmu.setString([vr["solver.variant"]], ["grün %d"])
    fmu.setInt64([vr["solver.method"]], [METHODS.index("auto")])
    fmu.setFloat64([vr["mass"], vr["push"]], [1.0, 2.0])
    fmu.enterInitializationMode(tolerance=1e-3, stopTime=1.0)
    assert fmu.getInt32([vr["solver.order"], vr["solver.events"]]) == [5, 0]
    assert fmu.getBoolean([vr["solver.light"], vr["floor.in_contact"]]) == [True, False]
    assert fmu.getInt64([vr["floor.state"]]) == [0]
    assert fmu.getString([vr["solver.variant"], vr["solver.variant"]]) == ["grün %d", "grün %d"]
    assert fmu.getInt64([vr["solver.method"], vr["floor.law"]]) == [METHODS.index("auto"), 0]
    assert fmu.getFloat64([vr["mass"], vr["ball.ay"], vr["solver.rtol"]]) == [1.0, 2.0 / 0.5 - 9.81, 1e-3]
    assert fmu.getFloat64([]) == [] and fmu.getString([]) == []
    fmu.setFloat64([], [])
    assert fmu.getVersion() == "3.0"


def test_derivatives(host):
    fmu = host.started()
    fmu.doStep(0.0, 0.25)
    before, outputs = host.read(fmu), [host.vr["ball.ay"], host.vr["ball.y"]]
    assert fmu.getDirectionalDerivative(outputs, [host.vr["push"]], [3.0]) == pytest.approx([1.5, 0.0], rel=1e-14)
    assert fmu.getAdjointDerivative(outputs, [host.vr["push"]], [4.0, 7.0], 1) == pytest.approx([2.0], rel=1e-14)
    assert host.read(fmu) == before


# errors


@pytest.mark.sampled(33)
@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda f, vr: f.doStep(0.3, 0.1),
         "fmi3DoStep: FmuValueError: the communication point is 0.3 s, but this slave is at 0.0 s: step from there"),
        (lambda f, vr: f.doStep(0.0, -0.1), "fmi3DoStep: FmuValueError: the communication step is -0.1 s"),
        (lambda f, vr: f.doStep(0.0, 3.0), "fmi3DoStep: FmuValueError: the step from 0.0 s by 3.0 s ends after the st"),
        (lambda f, vr: f.setFloat64([vr["push"]], [math.nan]),
         "fmi3SetFloat64: FmuValueError: 'push' (value reference {vr[push]}) was set to nan, which is not finite"),
        (lambda f, vr: f.setFloat64([4711], [1.0]), "fmi3SetFloat64: FmuValueError: value reference 4711 is unknown"),
        (lambda f, vr: f.setFloat64([vr["push"]], [1.0, 2.0]), "fmi3SetFloat64: FmuValueError: 2 values were given"),
        (lambda f, vr: f.getFloat64([vr["ball.y"]], 2), "fmi3GetFloat64: FmuValueError: room for 2 values was given"),
        (lambda f, vr: f.getString([vr["solver.variant"]], 2),
         "fmi3GetString: FmuValueError: room for 2 values was given for 1 scalar variables"),
        (lambda f, vr: f.getString([vr["solver.variant"]] * 2, 1),
         "fmi3GetString: FmuValueError: room for 1 values was given for 2 scalar variables"),
        (lambda f, vr: f.getFloat64([vr["solver.events"]]),
         "fmi3GetFloat64: FmuValueError: value reference {vr[solver.events]} is"),
        (lambda f, vr: f.getInt32([vr["floor.state"]]), "fmi3GetInt32: FmuValueError: ['floor.state'] are enumer"),
        (lambda f, vr: f.getInt64([vr["solver.events"]]), "fmi3GetInt64: FmuValueError: ['solver.events'] are Int32"),
        (lambda f, vr: f.setFloat64([vr["mass"]], [1.0]), "fmi3SetFloat64: CallOrderError: parameter 'mass' is fixed"),
        (lambda f, vr: f.enterInitializationMode(), "fmi3EnterInitializationMode: CallOrderError: cannot setup in ph"),
        (lambda f, vr: f.exitInitializationMode(), "fmi3ExitInitializationMode: CallOrderError: cannot exit"),
        (lambda f, vr: f.enterEventMode(), "fmi3EnterEventMode: CallOrderError: this instance has no event mode"),
        (lambda f, vr: f.updateDiscreteStates(), "fmi3UpdateDiscreteStates: CallOrderError: cannot update discrete"),
        (lambda f, vr: f.enterStepMode(), "fmi3EnterStepMode: CallOrderError: cannot enter step mode in phase 'step'"),
        (lambda f, vr: f.setFMUState(fmi3FMUState(99)), "fmi3SetFMUState: SnapshotError: FMU state 0x63 is unknown to"),
        (lambda f, vr: f.freeFMUState(fmi3FMUState(99)), "fmi3FreeFMUState: SnapshotError: FMU state 0x63 is unknown"),
        (lambda f, vr: f.serializeFMUState(fmi3FMUState(99)), "fmi3SerializedFMUStateSize: SnapshotError: FMU state"),
        (lambda f, vr: f.deserializeFMUState(b"some bytes"), "fmi3DeserializeFMUState: SnapshotError: these 10 bytes"),
        (lambda f, vr: f.setDebugLogging(True, ["logPoems"]), "fmi3SetDebugLogging: FmuValueError: unknown log catego"),
        (lambda f, vr: f.getFloat32([0]), "fmi3GetFloat32: UnavailableError: this FMU has no variables of this type"),
        (lambda f, vr: f.setUInt64([0], [1]), "fmi3SetUInt64: UnavailableError: this FMU has no variables of this t"),
        (lambda f, vr: f.getBinary([0]), "fmi3GetBinary: UnavailableError: this FMU has no variables of this type"),
        (lambda f, vr: f.getClock([0]), "fmi3GetClock: UnavailableError: this FMU has no clocks"),
        (lambda f, vr: f.enterConfigurationMode(), "fmi3EnterConfigurationMode: UnavailableError: this FMU has no st"),
        (lambda f, vr: f.getDirectionalDerivative([vr["ball.y"]], [vr["mass"]], [1.0]),
         "fmi3GetDirectionalDerivative: FmuValueError: 'mass' is of role parameter"),
        (lambda f, vr: f.getDirectionalDerivative([vr["ball.y"]], [vr["push"]], [1.0, 2.0]),
         "fmi3GetDirectionalDerivative: FmuValueError: a seed of 2 numbers was given for 1 inputs"),
        (lambda f, vr: f.getAdjointDerivative([vr["ball.y"]], [vr["push"]], [1.0, 2.0], 1),
         "fmi3GetAdjointDerivative: FmuValueError: a seed of 2 numbers and room for 1 sensitivities"),
        (lambda f, vr: f.getOutputDerivatives([vr["ball.ay"]], [1]),
         "fmi3GetOutputDerivatives: UnavailableError: the time derivatives of ball.ay are not known exactly"),
        (lambda f, vr: f.getOutputDerivatives([vr["ball.y"]], [2]),
         "fmi3GetOutputDerivatives: FmuValueError: a derivative of order 2 of 'ball.y' was asked"),
    ],
)  # fmt: skip
def test_errors_are_statuses_with_one_line_in_the_log_and_the_instance_lives_on(host, messages, call, message):
    fmu = host.started(stop=2.0)  # logging is off
    before = host.read(fmu)
    with pytest.raises(FMICallException) as caught:
        call(fmu, host.vr)
    assert caught.value.status == ERROR
    assert len(messages) == 1 and "\n" not in messages[0][2]
    assert messages.errors[0].startswith(message.format(vr=host.vr))
    assert host.read(fmu) == before
    fmu.doStep(0.0, 0.125)


def test_output_derivatives(host):
    fmu = host.started(stop=2.0)
    fmu.doStep(0.0, 0.25)
    v, a = fmu.getFloat64([host.vr["ball.vy"], host.vr["ball.ay"]])
    assert list(fmu.getOutputDerivatives([host.vr["ball.y"], host.vr["ball.vy"]], [1, 1])) == [v, a]


def test_a_step_while_an_event_is_due_is_refused(host, messages):
    fmu = host.started(True, True)
    last = fmu.doStep(0.0, 1.5)[3]
    for point in ("event due", "event"):
        with pytest.raises(FMICallException):
            fmu.doStep(last, 0.125)
        assert f"cannot do step in phase '{point}'" in messages.errors[-1]
        if point == "event due":
            fmu.enterEventMode()
    update(fmu)
    fmu.doStep(last, 0.125)


def test_an_error_tells_how_far_the_instance_is(host):
    fmu = host.started()
    fmu.doStep(0.0, 0.125)
    flags, last = [c_bool(True) for _ in range(3)], c_double(99.0)
    with pytest.raises(FMICallException):
        fmu.fmi3DoStep(fmu.component, 0.5, 0.1, c_bool(True), *map(byref, flags), byref(last))
    assert [flag.value for flag in flags] == [False] * 3 and last.value == 0.125


def test_everything_refused_is_answered(host, messages):
    """Every function of the standard that the FMU has not, with whatever arguments fmpy finds for it."""
    fmu = host.started()
    for name in REFUSED:
        number = c_uint64()
        kinds = getattr(fmu, "_functions", {}).get(name)
        count = len(kinds.argtypes) - 1 if kinds else 4
        zeros = [
            0 if kinds is None or t in (c_double, c_size_t) else t() for t in (kinds.argtypes[1:] if kinds else "")
        ]
        with pytest.raises(FMICallException) as caught:
            fmu._call(name, fmu.component, *zeros, *([number] * (count - len(zeros))))
        assert caught.value.status == ERROR and messages.errors[-1].startswith(f"{name}: UnavailableError: ")
    assert len(messages) == len(REFUSED) > 40
    fmu.doStep(0.0, 0.125)


def test_a_wrong_token_gives_no_instance_and_a_line(host, messages):
    with pytest.raises(Exception, match="Failed to instantiate" if host.kind == "binary" else "the guid given is"):
        host.instance(token="{wrong}")
    if host.kind == "binary":
        assert messages.errors == [
            "fmi3InstantiateCoSimulation: FmuValueError: the instantiation token given is '{wrong}', this FMU has "
            f"'{host.description.guid}': modelDescription.xml and resources come from different exports"
        ]
