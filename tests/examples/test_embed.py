"""The examples in C and Rust: compiled, run, and held against the same in Python."""

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
CC, RUSTC = shutil.which("cc"), shutil.which("rustc")
if RUSTC and subprocess.run([RUSTC, "--version"], capture_output=True).returncode:
    RUSTC = None  # rustup's, and no compiler chosen for this user
needs_library = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code")


def run(*command):
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def controlled(program, folder):
    """What the program prints of its image."""
    run(sys.executable, FOLDER / "make_image.py", folder / "control.image")
    return run(program, folder / "control.image")


def check(text):
    """Hold what a program has printed against the same in Python."""
    scenario = load("slider_crank_stop")
    sim = Simulation(scenario.model, scenario.method, scenario.rtol, scenario.atol, **scenario.options)
    speed = next(k for k, c in enumerate(sim.channels) if c.name == "crank.angular_velocity")

    def control(first, last, gain):
        impacts = 0
        for k in range(first, last):
            before = len(sim.events)
            sim.set_inputs({"torque": gain * (6.0 - sim.values()[speed])})
            sim.advance((k + 1) * 1e-3)
            # the programs look at eight events of a step
            impacts += sum(event.kind == "impact" for event in sim.events[before : before + 8])
        return f"{sim.values()[speed]:.6f}", impacts

    wanted = [control(0, 150, 2.0)]
    kept = sim.state()
    wanted.append(control(150, 300, 2.0))
    sim.restore(kept)
    wanted.append(control(150, 300, 20.0))
    assert re.findall(r"gain [\d.]+: (\S+) rad/s", text) == [speed for speed, _ in wanted]
    impacts = tuple(map(int, re.findall(r"(\d+) impacts, and (\d+)", text)[0]))
    assert impacts == (wanted[1][1], wanted[2][1]) and impacts[0] != impacts[1] > 0


@needs_library
@pytest.mark.skipif(CC is None, reason="needs a C compiler")
def test_the_controller_in_c_does_what_it_does_in_python(tmp_path):
    flags = run(sys.executable, "-m", "tlismni.core.native").split()
    run(CC, "-Wall", "-Wextra", "-Werror", "-o", tmp_path / "control", FOLDER / "control.c", *flags)
    check(controlled(tmp_path / "control", tmp_path))


@needs_library
@pytest.mark.skipif(RUSTC is None or CC is None, reason="needs rustc, and a linker")
def test_the_controller_in_rust_does_the_same(tmp_path):
    flags = run(sys.executable, "-m", "tlismni.core.native").strip()
    run(RUSTC, "-O", "-D", "warnings", FOLDER / "control.rs", "-o", tmp_path / "control", "-C", f"link-args={flags}")
    check(controlled(tmp_path / "control", tmp_path))
