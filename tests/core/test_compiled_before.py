"""Once a run is built, nothing is left to compile: steps, impacts, stick and slip, restored states, derivatives."""

import subprocess
import sys

import pytest

LOOK = """
import sys
from tlismni.core import Simulation
from tlismni.core.compiled.kept import KeptCode
from tlismni.models import load, names

late, look = [], KeptCode.load_overload

def load_overload(self, sig, context):
    if running:
        late.append(f"{self._name} in {name}")
    return look(self, sig, context)

KeptCode.load_overload = load_overload
for name in sys.argv[1].split(",") if sys.argv[1] else names():
    running = False
    scenario = load(name)
    run = Simulation(scenario.model, scenario.method, scenario.rtol, scenario.atol, record=True, **scenario.options)
    running = True
    run.run_to(scenario.t_end)
    run.restore(type(run.state()).from_bytes(run.state().to_bytes()))
    run.sample()
    for channel in scenario.model.inputs:
        run.input_derivatives({channel.name: 1.0})
    run.output_rates()
assert not late, sorted(set(late))
"""


def look(names: str) -> None:
    done = subprocess.run([sys.executable, "-c", LOOK, names], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]


def test_nothing_is_compiled_or_loaded_after_the_start():
    look("pendulum_stop,stick_slip,slider_crank_stop,newtons_cradle")


@pytest.mark.full
def test_nothing_is_compiled_after_the_start_in_the_whole_catalogue():
    look("")
