"""Random calls, legal and illegal, with NaN and huge values: never a crash or a Fatal, and the instance works after."""

import math

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from tlismni.fmu_wrapper.in_process3 import InProcess3

NUMBERS = (0.0, 0.125, 0.5, 1.0, -1.0, 1e-300, 1e300, math.nan, math.inf, -math.inf)
CALLS = 1500
ERROR = 3


def calls(fmu, vr, states, rng):
    """One random call. Its name is in the dictionary, so that a failure tells what it was."""
    number = NUMBERS[rng.integers(len(NUMBERS))]
    reference = [*vr.values(), 4711][rng.integers(len(vr) + 1)]
    now = fmu.getFloat64([vr["time"]])[0] if rng.random() < 0.5 else 0.0
    state = states[rng.integers(len(states))] if states else None
    table = {
        "enter": lambda: fmu.enterInitializationMode(startTime=0.0 if rng.random() < 0.8 else number),
        "exit": fmu.exitInitializationMode,
        "event mode": fmu.enterEventMode,
        "update": fmu.updateDiscreteStates,
        "step mode": fmu.enterStepMode,
        "step": lambda: fmu.doStep(now, 0.125 if rng.random() < 0.7 else number),
        "set": lambda: fmu.setFloat64([reference], [number]),
        "push": lambda: fmu.setFloat64([vr["push"]], [number]),
        "get": lambda: fmu.getFloat64([reference]),
        "get integer": lambda: fmu.getInt32([reference]),
        "get enumeration": lambda: fmu.getInt64([reference]),
        "get boolean": lambda: fmu.getBoolean([reference]),
        "get string": lambda: fmu.getString([reference]),
        "derivative": lambda: fmu.getDirectionalDerivative([reference], [vr["push"]], [number]),
        "store": lambda: states.append(fmu.getFMUState()),
        "restore": lambda: state and fmu.setFMUState(state),
        "bytes": lambda: state and states.append(fmu.deserializeFMUState(fmu.serializeFMUState(state))),
        "no state": lambda: fmu.deserializeFMUState(rng.bytes(60)),
        "free": lambda: state and fmu.freeFMUState(states.pop(states.index(state))),
        "refused": lambda: fmu.getFloat32([reference]),
        "terminate": fmu.terminate,
        "reset": fmu.reset,
    }
    weights = np.array([0.02 if name in ("terminate", "reset") else 1.0 for name in table])
    name = list(table)[rng.choice(len(table), p=weights / weights.sum())]
    return name, table[name]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("kind", ["in process", "binary"])
def test_random_calls(fake_fmu, tmp_path, messages, kind, seed):
    unzipped = fmpy.extract(str(fake_fmu(fmi_version="3.0")), unzipdir=str(tmp_path / "unzipped"))
    description = fmpy.read_model_description(unzipped)
    vr = {v.name: v.valueReference for v in description.modelVariables}
    if kind == "in process":
        fmu = InProcess3.of(unzipped, on_log=messages, event_mode=True, early_return=True)
    else:
        fmu = FMU3Slave(
            guid=description.guid, unzipDirectory=unzipped, modelIdentifier=description.coSimulation.modelIdentifier
        )
        fmu.instantiate(
            eventModeUsed=True, earlyReturnAllowed=True,
            logMessage=lambda e, s, c, m: messages(s, c.decode(), m.decode()),
        )  # fmt: skip
    rng, states, done, refused = np.random.default_rng(seed), [], set(), 0
    for _ in range(CALLS):
        logged = len(messages)
        try:
            name, call = calls(fmu, vr, states, rng)
            answer = call()
        except FMICallException as error:
            assert error.status == ERROR
            assert len(messages) == logged + 1 and len(messages[-1][2]) > 30
            refused += 1
        else:
            done.add(name)
            assert len(messages) == logged
            if name in ("get", "derivative"):
                assert np.isfinite(answer).all()
    assert refused > 300 and {"step", "set", "get", "update", "restore", "bytes", "derivative"} <= done
    fmu.reset()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    while fmu.updateDiscreteStates()[0]:
        pass
    fmu.enterStepMode()
    fmu.doStep(0.0, 0.125)
    assert fmu.getFloat64([vr["time"], vr["ball.y"]]) == [0.125, pytest.approx(1.0 + 0.5 * (0.5 - 9.81) * 0.125**2)]
    fmu.freeInstance()
