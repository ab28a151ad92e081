"""Runs in exudyn leave no memory behind."""

import gc
import weakref
from pathlib import Path

import pytest
from tlismni.models import load
from tlismni.validation import build_exudyn_model
from tlismni.validation.exudyn_run import ExudynSettings, run_exudyn, solve

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


@pytest.mark.parametrize(("name", "law"), [("pendulum_stop", "hunt_crossley"), ("bouncing_ball", "kelvin_voigt")])
def test_a_system_is_freed_with_its_build(name, law):
    """Without a search for circles of references; the second has a function that exudyn calls before each step."""
    pytest.importorskip("exudyn")
    build = build_exudyn_model(load(name, law=law).model)
    assert bool(build.before_step) == (law == "kelvin_voigt")
    solve(build, 0.01, 1e-4, ExudynSettings())
    mbs, built = build.mbs, weakref.ref(build)
    assert mbs.systemData.NumberOfObjects() > 0
    gc.collect()
    gc.disable()
    try:
        del build
        assert built() is None
        assert mbs.systemData.NumberOfObjects() == 0
    finally:
        gc.enable()


def test_a_system_is_freed_where_its_run_fails():
    pytest.importorskip("exudyn")
    build = build_exudyn_model(load("pendulum_stop", law="hunt_crossley").model)
    build.release()
    assert build.mbs.systemData.NumberOfObjects() == 0
    build.release()
