"""A native host makes its first instances in many threads at once, of one FMU and of several."""

import os
import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest
from fmu_helpers import ball_model
from test_fmu_real import Fmu
from tlismni.fmu_wrapper.export import fmi2_platform, shim_path
from tlismni.fmu_wrapper.python_library import shared_library

HERE = Path(__file__).parent
CC = shutil.which("cc")
STEP, STEPS = 0.1, 20

pytestmark = [
    pytest.mark.skipif(CC is None, reason="needs a C compiler"),
    pytest.mark.skipif(shared_library() is None, reason="needs a Python with a shared library"),
]


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    program = tmp_path_factory.mktemp("host") / "host_threads"
    headers = Path(fmpy.__file__).parent / "c-code"  # the standard's own
    source = HERE / "host_threads.c"
    command = [CC, "-Wall", "-Werror", f"-I{headers}", "-o", str(program), str(source), "-ldl", "-lpthread"]
    subprocess.run(command, check=True)
    return program


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """Three FMUs, each with a binary of its own, whose values differ."""
    return [
        Fmu(ball_model(f"ball{k}", height=1.0 + k), tmp_path_factory.mktemp(f"ball{k}"), t_end=2.0) for k in range(3)
    ]


def run_host(host, fmus, threads, steps):
    """(FMU, last value) of each thread."""
    arguments = []
    for fmu in fmus:
        library = Path(fmu.unzipped, "binaries", fmi2_platform(), fmu.identifier + shim_path().suffix)
        resources = Path(fmu.unzipped, "resources").as_uri()
        arguments += [library, resources, fmu.description.guid, fmu.vr["ball.y"]]
    command = list(map(str, [host, threads, steps, STEP, *arguments]))
    # nothing of this Python in the environment
    kept = {k: v for k, v in os.environ.items() if k in ("HOME", "NUMBA_CACHE_DIR")}
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200, env=kept)
    assert done.returncode == 0, f"ended with {done.returncode}: {done.stdout}{done.stderr}"
    return [(int(line.split()[0]), float.fromhex(line.split()[1])) for line in done.stdout.splitlines()]


def alone(fmu):
    instance = fmu.instance()
    for k in range(STEPS):
        instance.doStep(k * STEP, STEP)
    return instance.getReal([fmu.vr["ball.y"]])[0]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("count", [1, 3])
def test_all_instances_are_made_and_step(host, fmus, count):
    """One Python is started, its paths are extended once, and each instance gives what it gives alone."""
    expected = [alone(fmu) for fmu in fmus[:count]]
    assert len(set(expected)) == count
    found = run_host(host, fmus[:count], 16, STEPS)
    assert len(found) == 16 and all(value == expected[k] for k, value in found)


@pytest.mark.full
@pytest.mark.parametrize("count", [1, 3])
def test_again_and_again(host, fmus, count):
    """The race was lost in 6 of 100 runs with one FMU, in all with several."""
    for _ in range(100):
        run_host(host, fmus[:count], 16, 0)
