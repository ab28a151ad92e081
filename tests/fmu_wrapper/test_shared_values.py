"""What the binary answers by itself, from values that it shares with the slave, is what the slave answers."""

import ctypes
import math
import shutil
import subprocess
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmu_helpers import Messages, ball_model
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.build import shim_sources
from tlismni.fmu_wrapper.fmi2_calls import Fmi2Calls
from tlismni.fmu_wrapper.fmi3_calls import Fmi3Calls
from tlismni.fmu_wrapper.in_process import InProcess
from tlismni.fmu_wrapper.in_process3 import InProcess3
from tlismni.fmu_wrapper.platforms import PLATFORMS, this_platform
from tlismni.fmu_wrapper.shared import LAYOUT
from tlismni.fmu_wrapper.shared_calls import SharedCalls

CC = shutil.which("cc")
MOVES = 400
STEPS = (0.02, 0.02, 0.02, 1e-4, 1e-5, 0.3)
PUSHES = (0.0, -0.0, 1.0, 1.0, 1.0, 30.0, 1e-300, math.nan, math.inf)


class Pair:
    """The binary of an FMU and the same slave without one."""

    def __init__(self, folder, version):
        path = export_fmu(ball_model(), folder / "ball.fmu", version, t_end=50.0, rtol=1e-6)
        unzipped = fmpy.extract(str(path), unzipdir=str(folder / "unzipped"))
        self.unzipped, self.version = unzipped, version
        self.description = fmpy.read_model_description(unzipped)
        self.vr = {v.name: v.valueReference for v in self.description.modelVariables}
        self.logs = Messages(), Messages()
        direct = (InProcess if version == "2.0" else InProcess3).of(unzipped, on_log=self.logs[1])
        self.both = self.start(self.binary(self.logs[0])), self.start(direct)

    def binary(self, messages):
        kind = FMU2Slave if self.version == "2.0" else FMU3Slave
        fmu = kind(
            guid=self.description.guid, unzipDirectory=self.unzipped,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )  # fmt: skip
        if self.version == "2.0":
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda e, n, s, c, m: messages(s, c.decode(), m.decode()))
            fmu.instantiate(callbacks=callbacks)
        else:
            fmu.instantiate(logMessage=lambda e, s, c, m: messages(s, c.decode(), m.decode()))
        return fmu

    def start(self, fmu):
        if self.version == "2.0":
            fmu.setupExperiment()
            fmu.get_reals, fmu.set_reals = fmu.getReal, fmu.setReal
        else:
            fmu.get_reals, fmu.set_reals = fmu.getFloat64, fmu.setFloat64
        fmu.get_mode = lambda: (fmu.getInteger if self.version == "2.0" else fmu.getInt64)([self.vr["floor.mode"]])
        fmu.get_state, fmu.set_state = (
            (fmu.getFMUstate, fmu.setFMUstate) if hasattr(fmu, "getFMUstate") else (fmu.getFMUState, fmu.setFMUState)
        )
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        return fmu

    def same(self, call):
        """What both answer to the same call; an error of both is None."""
        answers = []
        for fmu in self.both:
            try:
                answers.append(np.asarray(call(fmu)).tolist())
            except FMICallException as error:
                answers.append(f"status {error.status}")
        logs = [log[:] for log in self.logs]
        assert repr(answers[0]) == repr(answers[1])
        assert logs[0] == logs[1]
        return answers[0]


@pytest.fixture(params=["2.0", "3.0"])
def pair(request, tmp_path):
    return Pair(tmp_path, request.param)


def test_any_moves_get_the_same_answers_and_log_lines(pair):
    """Held, changed and refused inputs, fine and coarse steps, impacts, rollbacks, calls in all orders."""
    rng, vr, t, kept = np.random.default_rng(5), pair.vr, 0.0, []
    push, lists = [vr["push"]], [
        [vr["ball.y"], vr["ball.vy"]], [vr["push"]], [vr["ball.ay"], vr["push"], vr["time"]], [vr["time"]],
        [vr["energy.balance"]] * 2, [vr["restitution"]], [4711], [vr["ball.y"], 4711],
    ]  # fmt: skip
    done = {"step": 0, "refused": 0, "back": 0}
    for _ in range(MOVES):
        move = rng.choice(
            ["set", "step", "get", "mode", "wrong", "store", "back"], p=[0.22, 0.34, 0.3, 0.04, 0.04, 0.03, 0.03]
        )
        if move == "set":
            u = PUSHES[rng.integers(len(PUSHES))]
            refused = pair.same(lambda fmu, u=u: fmu.set_reals(push, [u])) == "status 3"
            assert refused == (not math.isfinite(u))
            done["refused"] += refused
        elif move == "step":
            h = STEPS[rng.integers(len(STEPS))]
            pair.same(lambda fmu, t=t, h=h: (fmu.doStep(t, h), None)[1])
            t, done["step"] = t + h, done["step"] + 1
        elif move == "get":
            chosen = lists[rng.integers(len(lists))]
            pair.same(lambda fmu, chosen=chosen: fmu.get_reals(chosen))
        elif move == "mode":
            pair.same(lambda fmu: fmu.get_mode())
        elif move == "wrong":
            pair.same(lambda fmu, t=t: (fmu.doStep(t + 1.0, 0.1), None)[1])
            pair.same(lambda fmu: fmu.set_reals([vr["restitution"]], [0.5]))
            pair.same(lambda fmu: fmu.set_reals([vr["ball.y"]], [0.5]))
        elif move == "store":
            kept.append((t, [fmu.get_state() for fmu in pair.both]))
        elif kept:
            t, states = kept[rng.integers(len(kept))]
            for fmu, state in zip(pair.both, states, strict=True):
                fmu.set_state(state)
            done["back"] += 1
    assert pair.same(lambda fmu: fmu.get_reals([vr["time"]])) == [t]
    assert min(done["step"] / 100, done["refused"] / 10, done["back"]) >= 1


def test_states_hold_inputs_that_no_step_has_taken_yet(pair):
    push, y = [pair.vr["push"]], [pair.vr["ball.y"]]
    fmu = pair.both[0]
    for k in range(3):
        fmu.set_reals(push, [float(k)])
        fmu.doStep(0.01 * k, 0.01)
        fmu.get_reals(y)
    fmu.set_reals(push, [20.0])
    state = fmu.get_state()
    fmu.doStep(0.03, 0.01)
    expected = fmu.get_reals(y)
    fmu.set_reals(push, [0.0])
    fmu.set_state(state)
    assert fmu.get_reals(push) == [20.0]
    fmu.doStep(0.03, 0.01)
    assert fmu.get_reals(y) == expected


def test_instances_share_nothing(pair):
    one = pair.both[0]
    two = pair.start(pair.binary(pair.logs[0]))
    push, y = [pair.vr["push"]], [pair.vr["ball.y"], pair.vr["push"]]
    for k in range(4):
        for fmu, u in ((one, 1.0), (two, 50.0)):
            fmu.set_reals(push, [u])
            fmu.doStep(0.01 * k, 0.01)
            fmu.get_reals(y)
    assert one.get_reals(y)[1] == 1.0 and two.get_reals(y)[1] == 50.0
    assert one.get_reals(y)[0] < two.get_reals(y)[0]
    two.freeInstance()
    one.doStep(0.04, 0.01)


def test_more_lists_than_are_kept(pair):
    """Each is answered, and what is not asked is not touched."""
    outputs = [v for v in pair.description.modelVariables if v.causality == "output"]
    reals = [v.valueReference for v in outputs if v.type in ("Real", "Float64")][:4]
    rng = np.random.default_rng(1)
    fmu = pair.both[0]
    for k in range(3):
        fmu.doStep(0.01 * k, 0.01)
        all_values = dict(zip(reals, fmu.get_reals(reals), strict=True))
        for _ in range(150):
            chosen = rng.choice(reals, size=rng.integers(1, 9)).tolist()
            assert fmu.get_reals(chosen) == [all_values[r] for r in chosen]


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_many_single_lists_leave_room_for_those_of_each_step(tmp_path, monkeypatch, version):
    """A host that sets a hundred parameters one by one still sets inputs and reads outputs without Python."""
    pair = Pair(tmp_path, version)
    calls = Fmi2Calls if version == "2.0" else Fmi3Calls
    get, put = ("fmi2GetReal", "fmi2SetReal") if version == "2.0" else ("fmi3GetFloat64", "fmi3SetFloat64")
    counts = {name: count_calls(monkeypatch, calls, name) for name in (get, put)}
    fmu = pair.start(pair.binary(pair.logs[0]))
    parameter, push, y = pair.vr["restitution"], [pair.vr["push"]], [pair.vr["ball.y"]]
    for k in range(100):
        fmu.get_reals([parameter] * (k + 1))
    asked = len(counts[get])
    assert asked >= 100
    for k in range(20):
        fmu.set_reals(push, [float(k)])
        fmu.doStep(0.01 * k, 0.01)
        fmu.get_reals(y)
    assert len(counts[get]) - asked == 1
    assert 1 <= len(counts[put]) <= 2


def count_calls(monkeypatch, kind, name):
    """A list that gets longer with each call of a method."""
    method, calls = getattr(kind, name), []
    monkeypatch.setattr(kind, name, lambda self, *arguments: (calls.append(name), method(self, *arguments))[1])
    return calls


@pytest.mark.sampled(1)
@pytest.mark.skipif(CC is None, reason="needs a C compiler")
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_a_binary_of_another_layout_shares_nothing_and_answers_the_same(tmp_path, monkeypatch, version):
    pair = Pair(tmp_path, version)
    # in a folder of its own: the binary of the first one stays in the process
    pair.unzipped = shutil.copytree(pair.unzipped, tmp_path / "other")
    here = PLATFORMS[this_platform()]
    binary = Path(
        pair.unzipped, "binaries", here.folder(version), f"{pair.description.coSimulation.modelIdentifier}{here.suffix}"
    )
    flags = ["-std=c11", "-O2", "-shared", "-fPIC", f"-DSHARED_LAYOUT={LAYOUT + 1}", "-ldl", "-lpthread"]
    sources = list(map(str, shim_sources()))
    subprocess.run([CC, *sources, "-o", str(binary), *flags], check=True)
    step = count_calls(monkeypatch, SharedCalls, "step")
    pair.both = pair.start(pair.binary(pair.logs[0])), pair.both[1]
    for k in range(100):
        pair.same(lambda fmu, k=k: fmu.set_reals([pair.vr["push"]], [float(k // 7)]))
        pair.same(lambda fmu, k=k: (fmu.doStep(0.01 * k, 0.01), None)[1])
        pair.same(lambda fmu: fmu.get_reals([pair.vr["ball.y"], pair.vr["push"]]))
    assert not step


def test_room_that_does_not_fit_is_refused_for_known_lists_too(tmp_path):
    pair = Pair(tmp_path, "3.0")
    fmu, vr = pair.both[0], (ctypes.c_uint32 * 1)(pair.vr["ball.y"])
    fmu.doStep(0.0, 0.01)
    room = (ctypes.c_double * 2)(7.0, 8.0)
    for _ in range(2):
        assert fmu.dll.fmi3GetFloat64(fmu.component, vr, 1, room, 1) == 0
    room[0] = 7.0
    assert fmu.dll.fmi3GetFloat64(fmu.component, vr, 1, room, 2) == 3
    assert fmu.dll.fmi3GetFloat64(fmu.component, vr, 1, room, 0) == 3
    assert list(room) == [7.0, 8.0]
    assert "room for 2 values was given for 1 scalar variables" in pair.logs[0].errors[-2]
