"""Rollback at a hundred random instants, before, between and after impacts: the run goes on bit for bit, here and in a
new process."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_fmi3_real import Fmu3
from tlismni.models import load

INSTANTS = 100
AHEAD = (0.013, 0.04, 0.11)
CASES = {
    "pendulum_stop": {},
    "slider_crank_stop": {"driven": True},
    "pendulum_stop with a force": {"law": "hunt_crossley"},
}


def fmu_of(case, folder):
    return Fmu3(load(case.split()[0], **CASES[case]), folder, method="irk" if "force" in case else "ebdf", rtol=1e-6)


def going_on(fmu, instance, t):
    """What the next steps give, the input changing, as text without rounding."""
    rows = []
    names = [v for v in sorted(fmu.vr) if v.endswith((".angle", "_force", ".balance", ".impulse"))]
    for k, h in enumerate(AHEAD):
        instance.setFloat64([fmu.vr["torque"]], [0.1 * (k % 2)])
        t = instance.doStep(t, h)[3]
        rows.append([x.hex() for x in instance.getFloat64([fmu.vr[n] for n in names])])
    return rows


def continue_all(unzipped, folder):
    """The same in a new process, from the bytes in `folder`."""
    fmu = object.__new__(Fmu3).open(unzipped)
    instance = fmu.instance()
    rows = []
    for k in range(INSTANTS):
        instance.setFMUState(instance.deserializeFMUState((Path(folder) / f"{k}").read_bytes()))
        rows.append(going_on(fmu, instance, instance.getFloat64([fmu.vr["time"]])[0]))
    print(json.dumps(rows))


@pytest.mark.sampled(1)
@pytest.mark.parametrize("case", CASES)
def test_rollback_at_random_instants(case, tmp_path):
    fmu = fmu_of(case, tmp_path)
    instance, random = fmu.instance(), np.random.default_rng(11)
    instants = np.sort(random.uniform(0.0, min(2.5, load(case.split()[0]).t_end), INSTANTS))
    t, rows, events = 0.0, [], []
    for k, instant in enumerate(instants):
        t = instance.doStep(t, float(instant) - t)[3]
        if k % 3 == 0:
            instance.setFloat64([fmu.vr["torque"]], [float(random.uniform(-0.2, 0.2))])
        state = instance.getFMUState()
        (tmp_path / f"{k}").write_bytes(instance.serializeFMUState(state))
        rows.append(going_on(fmu, instance, t))
        events += instance.getInt32([fmu.vr["solver.events"]])
        instance.setFMUState(state)
        assert going_on(fmu, instance, t) == rows[-1]
        instance.setFMUState(state)
        instance.freeFMUState(state)
    instance.freeInstance()
    assert events[0] < events[-1]  # some lie before an impact, some behind one
    script = "import sys; sys.path.insert(0, sys.argv[1]); from test_rollback import *; continue_all(*sys.argv[2:])"
    command = [sys.executable, "-c", script, str(Path(__file__).parent), fmu.unzipped, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr[-2000:]
    assert json.loads(done.stdout) == rows
