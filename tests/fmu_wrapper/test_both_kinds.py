"""FMUs with and without Python have the same functions of FMI (`fmu_wrapper/fmi`) over two kinds of instances: what is
allowed when, what is answered and what is logged are the same."""

import ctypes
import math
import random

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmu_helpers import Messages, ball_model
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.fmi3_calls import REFUSED

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="FMUs without Python are made of the library of machine code")
CALLS = 600
ERROR = 3
STEPS = (0.05, 0.05, 0.3, 1e-3, 0.0, -0.1, math.nan, math.inf, 1e-30)
PUSHES = (0.0, 1.0, 25.0, -3.0, 1.0, 0.5, math.nan, math.inf)
TIMES = (0.0, 0.0, 0.0, 0.5, -1.0, math.nan)


class Instance:
    """An instance of an FMU, its log, and what it has stored."""

    def __init__(self, unzipped, version, **how):
        description = fmpy.read_model_description(unzipped)
        self.three, self.log, self.states = version == "3.0", Messages(), []
        self.vr = {v.name: v.valueReference for v in description.modelVariables}
        identifier = description.coSimulation.modelIdentifier
        kind = FMU3Slave if self.three else FMU2Slave
        self.fmu = kind(guid=description.guid, unzipDirectory=unzipped, modelIdentifier=identifier)
        if self.three:
            self.fmu.instantiate(logMessage=lambda e, s, c, m: self.log(s, c.decode(), m.decode()), **how)
        else:
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda e, n, s, c, m: self.log(s, c.decode(), m.decode()))
            self.fmu.instantiate(callbacks=callbacks, **how)
        self.get, self.set = (
            (self.fmu.getFloat64, self.fmu.setFloat64) if self.three else (self.fmu.getReal, self.fmu.setReal)
        )

    def begin(self, start=0.0, stop=None):
        if self.three:
            self.fmu.enterInitializationMode(startTime=start, stopTime=stop)
        else:
            self.fmu.setupExperiment(startTime=start, stopTime=stop)
            self.fmu.enterInitializationMode()

    def named(self, *names):
        return [self.vr.get(name, 4711) for name in names]

    def store(self):
        self.states.append(self.fmu.getFMUState() if self.three else self.fmu.getFMUstate())

    def restore(self, k):
        if self.states:
            state = self.states[k % len(self.states)]
            (self.fmu.setFMUState if self.three else self.fmu.setFMUstate)(state)

    def carry(self, k):
        if self.states:
            state = self.states[k % len(self.states)]
            if self.three:
                self.states.append(self.fmu.deserializeFMUState(self.fmu.serializeFMUState(state)))
            else:
                self.states.append(self.fmu.deSerializeFMUstate(self.fmu.serializeFMUstate(state)))

    def free(self, k):
        if self.states:
            state = self.states.pop(k % len(self.states))
            (self.fmu.freeFMUState if self.three else self.fmu.freeFMUstate)(state)

    def wholes(self, name):
        if self.three:
            return list(self.fmu.getInt32(self.named(name)))
        return list(self.fmu.getInteger(self.named(name)))

    def outputs_rates(self, order):
        if self.three:
            return list(self.fmu.getOutputDerivatives(self.named("ball.y"), [order]))
        return list(self.fmu.getRealOutputDerivatives(self.named("ball.y"), [order]))


class Both:
    """An instance of each kind."""

    def __init__(self, folder, version, solver=None, **how):
        self._version, self._how, self._folders = version, how, []
        for native in (False, True):
            settings = {"t_end": 3.0, **(solver or {})}
            path = export_fmu(ball_model(), folder / f"{native}.fmu", version, native=native, **settings)
            self._folders.append(fmpy.extract(str(path), unzipdir=str(folder / str(native))))
        self.instances = self.new_instances()

    def new_instances(self):
        return [Instance(unzipped, self._version, **self._how) for unzipped in self._folders]

    def same(self, what, call):
        """The answer to a call, which both give: None is an error, of which each has logged one line."""
        answers = []
        for instance in self.instances:
            instance.log.clear()
            try:
                answers.append(repr(call(instance)))
            except FMICallException as error:
                answers.append(f"status {error.status}")
                assert error.status == ERROR and len(instance.log) == 1, (what, instance.log)
                assert instance.log[0][2].startswith("fmi"), (what, instance.log)
            else:
                assert not instance.log.errors, (what, instance.log)
        assert answers[0] == answers[1], (what, answers, [i.log for i in self.instances])
        return None if answers[0].startswith("status") else answers[0]


def nothing(answer):
    """Where what a call answers with belongs to one instance."""


def calls_of(
    three, k=0, h=0.05, slip=0.0, t=0.0, stop=None, u=1.0, order=1, output="ball.y", known="push", whole="solver.events"
):
    """Calls by name, each for any instance."""

    def step(i):
        now = i.get(i.named("time"))[0]
        return i.fmu.doStep(now + slip, h) if three else nothing(i.fmu.doStep(now + slip, h))

    calls = {
        "begin": lambda i: i.begin(t, stop),
        "enter": lambda i: nothing(i.fmu.enterInitializationMode()),
        "exit": lambda i: nothing(i.fmu.exitInitializationMode()),
        "step": step,
        "step from the start": lambda i: nothing(i.fmu.doStep(0.0, h)),
        "get": lambda i: list(i.get(i.named(output, "time"))),
        "get none": lambda i: list(i.get([])),
        "get wholes": lambda i: i.wholes(whole),
        "push": lambda i: nothing(i.set(i.named("push"), [u])),
        "set parameter": lambda i: nothing(i.set(i.named("restitution"), [0.5 if k < 6 else -2.0])),
        "set output": lambda i: nothing(i.set(i.named("push", output), [1.0, 1.0])),
        "derivative": lambda i: list(i.fmu.getDirectionalDerivative(i.named(output), i.named(known), [u])),
        "rates": lambda i: i.outputs_rates(order),
        "store": lambda i: i.store(),
        "restore": lambda i: i.restore(k),
        "carry": lambda i: i.carry(k),
        "free": lambda i: i.free(k),
        "terminate": lambda i: nothing(i.fmu.terminate()),
        "reset": lambda i: nothing(i.fmu.reset()),
    }
    if three:
        return calls | {
            "event mode": lambda i: nothing(i.fmu.enterEventMode()),
            "update": lambda i: [bool(x) for x in i.fmu.updateDiscreteStates()[:5]],
            "step mode": lambda i: nothing(i.fmu.enterStepMode()),
            "refused": lambda i: nothing(i.fmu.getFloat32(i.named("push"))),
            "room": lambda i: list(i.fmu.getFloat64(i.named("ball.y"), 2)),
            "get enumeration": lambda i: list(i.fmu.getInt64(i.named(whole))),
            "set whole": lambda i: nothing(i.fmu.setInt32(i.named(whole), [1])),
        }
    return calls | {
        "input rates": lambda i: nothing(i.fmu.setRealInputDerivatives(i.named("push"), [order], [u])),
        "cancel": lambda i: nothing(i.fmu.cancelStep()),
        "set whole": lambda i: nothing(i.fmu.setInteger(i.named(whole), [1])),
    }


def random_call(rng, three):
    """What a call is, and the call."""
    outputs = (
        "ball.y",
        "ball.y",
        "ball.vy",
        "ball.vy",
        "ball.ay",
        "ball.ay",
        "push",
        "mass",
        "time",
        "floor.mode",
        "none",
    )
    calls = calls_of(
        three,
        k=rng.randrange(9),
        h=rng.choice(STEPS),
        slip=rng.choice((0.0,) * 9 + (0.7,)),
        t=rng.choice(TIMES),
        stop=rng.choice((None, 3.0, 0.2, math.nan)),
        u=rng.choice(PUSHES),
        order=rng.choice((1, 1, 1, 0, 2, 3)),
        output=rng.choice(outputs),
        known=rng.choice(("push",) * 6 + ("mass", "ball.y")),
        whole=rng.choice(("solver.events", "floor.mode", "ball.y")),
    )
    rare = {"terminate": 0.1, "reset": 0.2, "begin": 0.5, "step": 4.0}
    name = rng.choices(list(calls), [rare.get(name, 1.0) for name in calls])[0]
    return name, calls[name]


WAYS = {
    "instantiated": (),
    "initialization": ("begin",),
    "step": ("begin", "exit", "update", "step mode"),
    "event due": ("begin", "exit", "update", "step mode", "to the floor"),
    "event": ("begin", "exit"),
    "failed": ("begin", "exit", "update", "step mode", "too long"),
    "terminated": ("begin", "exit", "terminate"),
}
"""How to come to each phase."""


@pytest.mark.parametrize(("version", "events"), [("2.0", False), ("3.0", False), ("3.0", True)])
def test_each_call_in_each_phase(version, events, tmp_path):
    """It is allowed by both kinds or by none, and does the same."""
    how = {"eventModeUsed": True, "earlyReturnAllowed": True} if events else {}
    both, three, allowed = Both(tmp_path, version, {"step": 1e-3, "max_steps": 1000}, **how), version == "3.0", {}
    for phase, way in WAYS.items():
        if phase.startswith("event") and not events:
            continue
        for name, call in calls_of(three).items():
            for instance in both.instances:
                instance.fmu.reset()
                instance.states.clear()
            do = calls_of(three) | {"to the floor": calls_of(three, h=0.9)["step"]}
            for part in way:
                if part == "too long":  # away from the floor, in more steps of the solver than are allowed
                    both.same("push", lambda i: nothing(i.set(i.named("push"), [25.0])))
                    assert both.same(part, calls_of(three, h=2.5)["step"]) is None
                elif events or part not in ("update", "step mode"):
                    assert both.same(part, do[part]) is not None
                if part == "exit":
                    both.same("store", lambda i: i.store())
            allowed[phase, name] = both.same(f"{name} in phase {phase}", call) is not None
    assert not allowed["instantiated", "step from the start"] and allowed["step", "step from the start"]
    assert not allowed["failed", "step from the start"] and allowed["failed", "restore"]
    assert not allowed["failed", "store"] and not allowed["terminated", "push"] and allowed["terminated", "get"]
    assert allowed["initialization", "set parameter"] and not allowed["step", "set parameter"]


@pytest.mark.parametrize("seed", [1])
@pytest.mark.parametrize(("version", "events"), [("2.0", False), ("3.0", False), ("3.0", True)])
def test_calls_in_any_order_get_the_same_answers(version, events, seed, tmp_path):
    """Legal and illegal ones: the same status, the same bits, and one line in the log for an error."""
    how = {"eventModeUsed": True, "earlyReturnAllowed": True} if events else {}
    both, rng, done = Both(tmp_path, version, **how), random.Random(seed), {}
    for _ in range(CALLS):
        name, call = random_call(rng, version == "3.0")
        fine, all_ = done.get(name, (0, 0))
        found = both.same(name, call)
        done[name] = fine + (found is not None), all_ + 1
    ends = sum(fine for fine, _ in done.values())
    assert 0.2 < ends / CALLS < 0.9
    assert all(done[name][0] for name in ("exit", "step", "get", "push", "derivative", "rates", "restore", "carry"))


def test_room_that_is_refused_changes_nothing(tmp_path):
    """The solver is not told the inputs of that moment, which are others before it goes on."""
    both = Both(tmp_path, "3.0")
    plain = both.new_instances()
    for instance in (*both.instances, *plain):
        instance.begin()
        instance.fmu.exitInitializationMode()
        instance.fmu.doStep(0.0, 0.001)
    found = []
    for instance in both.instances:
        instance.set(instance.named("push"), [-3.0])
        for call in (
            lambda i: i.fmu.getFloat64(i.named("ball.y"), 2),
            lambda i: i.fmu.getDirectionalDerivative(i.named("ball.ay", "ball.vy"), i.named("push"), [1.0, 1.0]),
            lambda i: i.fmu.fmi3GetOutputDerivatives(
                i.fmu.component, (ctypes.c_uint32 * 1)(*i.named("ball.y")), 1, (ctypes.c_int32 * 1)(1),
                (ctypes.c_double * 2)(), 2,
            ),
        ):  # fmt: skip
            with pytest.raises(FMICallException):
                call(instance)
        instance.set(instance.named("push"), [1.0])
    for instance in (*both.instances, *plain):
        instance.fmu.doStep(0.001, 0.05)
        found.append(list(instance.get(instance.named("ball.y", "ball.vy"))))
    assert found == [found[0]] * 4


def test_functions_that_the_fmu_has_not(tmp_path):
    both = Both(tmp_path, "3.0")
    for name in sorted(REFUSED):
        said = []
        for instance in both.instances:
            instance.log.clear()
            function = getattr(ctypes.CDLL(instance.fmu.dll._name), name)
            zeros = [ctypes.c_void_p(None)] * 8
            assert function(ctypes.c_void_p(instance.fmu.component), *zeros) == ERROR
            said.append(instance.log[:])
            assert function(None, *zeros) == ERROR and len(instance.log) == 1  # nobody is there to be told
        assert said[0] == said[1] and said[0][0][2].startswith(f"{name}: UnavailableError: ")


def test_figures_of_status_and_log_categories(tmp_path):
    both = Both(tmp_path, "2.0", loggingOn=True)
    for instance in both.instances:
        instance.begin()
        instance.fmu.exitInitializationMode()
        instance.fmu.doStep(0.0, 0.25)
        instance.log.clear()
        dll, c = ctypes.CDLL(instance.fmu.dll._name), ctypes.c_void_p(instance.fmu.component)
        real, whole = ctypes.c_double(), ctypes.c_int(7)
        assert dll.fmi2GetRealStatus(c, 2, ctypes.byref(real)) == 0 and real.value == 0.25
        assert dll.fmi2GetBooleanStatus(c, 3, ctypes.byref(whole)) == 0 and whole.value == 0
        text = ctypes.c_char_p(b"x")
        for name, value in (("Status", whole), ("RealStatus", real), ("IntegerStatus", whole), ("BooleanStatus", whole),
                            ("StringStatus", text)):  # fmt: skip
            assert getattr(dll, f"fmi2Get{name}")(c, 0, ctypes.byref(value)) == 2
            assert getattr(dll, f"fmi2Get{name}")(c, 0, None) == ERROR
        categories = (ctypes.c_char_p * 1)(b"poems")
        assert dll.fmi2SetDebugLogging(c, 1, 1, categories) == ERROR
        assert dll.fmi2SetDebugLogging(c, 0, 0, None) == 0
        assert dll.fmi2GetStatus(c, 0, ctypes.byref(whole)) == 2  # and nothing is said
        categories = (ctypes.c_char_p * 1)(b"logStatusDiscard")
        assert dll.fmi2SetDebugLogging(c, 1, 1, categories) == 0
        assert dll.fmi2GetStatus(c, 0, ctypes.byref(whole)) == 2
    found = [[message for _, _, message in instance.log] for instance in both.instances]
    assert found[0] == found[1] and len(found[0]) == 12
    assert sum("DiscardError: status kind 0 is not available" in line for line in found[0]) == 6
    assert "unknown log categories ['poems']" in found[0][-2]


def test_in_an_intermediate_update(tmp_path):
    """The instance is at work: it is not freed, and other calls than values and derivatives are refused."""
    found = []
    for native in (False, True):
        path = export_fmu(ball_model(), tmp_path / f"{native}.fmu", "3.0", native=native, t_end=3.0)
        unzipped = fmpy.extract(str(path), unzipdir=str(tmp_path / str(native)))
        tried, at = [], []

        def update(environment, time, *arguments, tried=tried, at=at):
            fmu = at[0].fmu
            component = ctypes.c_void_p(fmu.component)
            for name in ("Terminate", "Reset", "ExitInitializationMode", "EnterEventMode", "EnterStepMode"):
                tried.append(getattr(ctypes.CDLL(fmu.dll._name), f"fmi3{name}")(component))
            ctypes.CDLL(fmu.dll._name).fmi3FreeInstance(component)
            with pytest.raises(FMICallException):
                at[0].set(at[0].named("push"), [3.0])
            with pytest.raises(FMICallException):
                at[0].store()
            tried.append((time, list(at[0].get(at[0].named("ball.y", "time")))))

        instance = Instance(unzipped, "3.0", earlyReturnAllowed=True, intermediateUpdate=update)
        at.append(instance)
        instance.begin()
        instance.fmu.exitInitializationMode()
        assert instance.fmu.doStep(0.0, 0.3)[3] == pytest.approx(0.3)
        assert len(tried) >= 6 and {x for x in tried if isinstance(x, int)} == {ERROR}
        assert sum("is not freed" in line for line in instance.log.errors) == len(tried) / 6
        found.append((tried, list(instance.get(instance.named("ball.y", "ball.vy"))), len(instance.log.errors)))
        instance.fmu.freeInstance()
    assert found[0] == found[1]


def test_null_and_absurd_numbers_of_intermediate_variables_make_no_instance(tmp_path):
    for given in Both(tmp_path, "3.0").instances:
        description = fmpy.read_model_description(given.fmu.unzipDirectory)
        function = ctypes.CDLL(given.fmu.dll._name).fmi3InstantiateCoSimulation
        function.restype = ctypes.c_void_p
        lines = []
        pattern = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
        logger, update = pattern(lambda e, s, c, m, lines=lines: lines.append(m.decode())), ctypes.CFUNCTYPE(None)(list)
        token, resources = description.instantiationToken.encode(), f"{given.fmu.unzipDirectory}/resources/".encode()
        flags = [ctypes.c_bool(False)] * 4
        some = (ctypes.c_uint32 * 1)(1)
        for references, count in ((None, 1), (some, 2**62), (some, 2**64 - 1)):
            wanted = references, ctypes.c_size_t(count), None
            assert not function(b"it", token, resources, *flags, *wanted, logger, update)
            assert "fmi3InstantiateCoSimulation: FmuValueError: NULL was given for an array" in lines[-1]
        assert len(lines) == 3
        # nobody looks at them without a callback
        made = function(b"it", token, resources, *flags, None, ctypes.c_size_t(1), None, logger, None)
        assert made and len(lines) == 3
        ctypes.CDLL(given.fmu.dll._name).fmi3FreeInstance(ctypes.c_void_p(made))


def test_a_freed_instance_and_none(tmp_path):
    """Error, in silence; nothing is freed twice."""
    for instance in Both(tmp_path, "3.0").instances:
        dll = ctypes.CDLL(instance.fmu.dll._name)
        for name in ("Reset", "EnterEventMode", "EnterStepMode", "GetFMUState", "ExitInitializationMode"):
            assert getattr(dll, f"fmi3{name}")(None, None) == ERROR
        assert dll.fmi3FreeFMUState(None, None) == ERROR
        dll.fmi3FreeInstance(None)
        assert instance.log == []
        instance.fmu.freeInstance()
