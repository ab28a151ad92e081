"""Runs in exudyn leave no memory behind."""

import gc
from pathlib import Path

import pytest
from tlismni.models import load
from tlismni.validation.exudyn_run import run_exudyn

STATUS = Path("/proc/self/statm")


@pytest.mark.skipif(not STATUS.exists(), reason="the memory of a process is read from Linux's /proc")
def test_what_sensors_stored_is_let_go():
    """Each run stores about 8 MB; three leave less than two of them do."""
    pytest.importorskip("exudyn")
    model = load("pendulum_stop", law="hunt_crossley").model

    def run():
        found = run_exudyn(model, 0.5, 1e-5)
        assert len(found.t) == 50_001 and found.t[-1] == 0.5
        stored = sum(channel.nbytes for channel in found.channels.values())
        del found
        gc.collect()
        return stored, 4096 * int(STATUS.read_text().split()[1])

    for _ in range(2):
        stored, before = run()
    for _ in range(3):
        _, after = run()
    assert stored > 4e6
    assert after - before < 16e6
