"""What is made when it is first used: validators of records, drawings. One process each, since others have used all."""

import json
import subprocess
import sys

BUILT = """
import json, sys
from tlismni.models import load
from tlismni.core.model.base import Record
from tlismni.core.model.open_union import subclasses
load("bouncing_ball")
built = [record.__name__ for record in subclasses(Record) if record.__pydantic_complete__]
print(json.dumps([built, [name for name in sys.modules if name.startswith("tlismni.viewer")]]))
"""
THREADS = """
import json, sys, threading
sys.setswitchinterval(1e-6)
from tlismni.core import Marker2D, Model, Revolute2D, RigidBody2D, TorsionSpring2D
failed, together = [], threading.Barrier(8)

def make(k):
    together.wait()
    try:
        bodies = [RigidBody2D(name="rod", mass=1.0, inertia=1.0)]
        at = Marker2D(body="rod")
        spring = {"type": "TorsionSpring2D", "name": "spring", "a": {}, "b": at, "stiffness": 2.0}
        model = Model(bodies=bodies, joints=[Revolute2D(name="hinge", a=Marker2D(), b=at)], forces=[spring])
        assert isinstance(model.forces[0], TorsionSpring2D) and model.bodies[0] is bodies[0]
    except Exception as error:
        failed.append(f"{type(error).__name__}: {error}")

threads = [threading.Thread(target=make, args=(k,)) for k in range(8)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
print(json.dumps(failed))
"""


def _said(code: str) -> list:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=1200)
    return json.loads(done.stdout.splitlines()[-1])


def test_only_records_in_use_are_built_and_nothing_is_drawn() -> None:
    built, drawing = _said(BUILT)
    assert "Model" in built and "PointMass2D" in built
    assert len(built) < 20 and "RigidBody3D" not in built
    assert set(drawing) == {"tlismni.viewer", "tlismni.viewer.sketches"}


def test_threads_may_use_records_first_together() -> None:
    assert _said(THREADS) == []
