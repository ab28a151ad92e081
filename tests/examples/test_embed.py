"""The example in C: compiled, run, and held against the same in Python."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tlismni.core import Simulation
from tlismni.core.compiled.library import LIBRARY
from tlismni.models import load

FOLDER = Path(__file__).parents[2] / "examples" / "embed"
CC = shutil.which("cc")


@pytest.mark.skipif(CC is None or LIBRARY is None, reason="needs a C compiler and the library of machine code")
def test_the_controller_in_c_does_what_it_does_in_python(tmp_path):
    def run(*command):
        done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    run(sys.executable, FOLDER / "make_image.py", tmp_path / "control.image")
    flags = run(sys.executable, "-m", "tlismni.core.native").split()
    run(CC, "-Wall", "-Wextra", "-Werror", "-o", tmp_path / "control", FOLDER / "control.c", *flags)
    text = run(tmp_path / "control", tmp_path / "control.image")
    scenario = load("slider_crank_stop")
    sim = Simulation(scenario.model, scenario.method, scenario.rtol, scenario.atol, **scenario.options)
    speed = next(k for k, c in enumerate(sim.channels) if c.name == "crank.angular_velocity")

    def control(first, last, gain):
        for k in range(first, last):
            sim.set_inputs({"torque": gain * (6.0 - sim.values()[speed])})
            sim.advance((k + 1) * 1e-3)
        return f"{sim.values()[speed]:.6f}"

    wanted = [control(0, 150, 2.0)]
    kept = sim.state()
    wanted.append(control(150, 300, 2.0))
    sim.restore(kept)
    wanted.append(control(150, 300, 20.0))
    assert re.findall(r"gain [\d.]+: (\S+) rad/s", text) == wanted
    assert wanted[1] != wanted[2] and "impact at" in text
