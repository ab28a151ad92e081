"""LuGre's friction in space in FMUs: the bits of a run in this process, with Python and without."""

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from native_pair import Pair, Side
from tlismni.core import (
    HalfSpace3D,
    KelvinVoigt,
    LuGreFriction,
    Marker3D,
    Model,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
)
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import Slave, export_fmu

PARTS = {
    "law": KelvinVoigt(stiffness=1e5, damping=100.0),
    "friction": LuGreFriction(
        coefficient=0.3, static_coefficient=0.5, stribeck_speed=0.01, bristle_stiffness=1e4, bristle_damping=30.0
    ),
}
STEPS, STEP = 20, 0.02


def model():
    """A ball that falls on the floor and on a fixed ball with speed and spin."""
    body = RigidBody3D(
        name="ball", mass=1.0, inertia=(4e-3,) * 3, position=(-0.3, 0.02, 0.15), velocity=(1.0, 0.1, 0.0),
        angular_velocity=(0.0, 4.0, 9.0),
    )  # fmt: skip
    ball = Sphere3D(marker=Marker3D(body="ball"), radius=0.1)
    fixed = Sphere3D(marker=Marker3D(point=(0.1, 0.0, 0.0)), radius=0.1)
    floor = SphereOnHalfSpace3D(name="floor", plane=HalfSpace3D(), sphere=ball, **PARTS)
    post = SphereOnSphere3D(name="post", a=fixed, b=ball, **PARTS)
    return Model(name="ball_on_bristles", gravity=(0.0, 0.0, -9.81), bodies=[body], contacts=[floor, post])


def test_the_bits_of_a_run_in_this_process(tmp_path):
    settings = {"t_end": STEPS * STEP, "communication_step": STEP}
    path = export_fmu(model(), tmp_path / "bristles.fmu", "3.0", **settings)
    assert validate_fmu(str(path)) == []
    unzipped = fmpy.extract(str(path), unzipdir=str(tmp_path / "bristles"))
    side = Side("3.0", unzipped, fmpy.read_model_description(unzipped))
    slave = Slave(model(), **settings)
    slave.setup()
    slave.enter_initialization()
    slave.exit_initialization()
    side.begin()
    names = [v.name for v in side.by_name.values() if v.valueReference in side.reals]
    assert {"floor.bristle_x", "floor.bristle_y", "post.bristle_z"} < set(names)
    references, bent, time = [side.by_name[name].valueReference for name in names], 0.0, 0.0
    for _ in range(STEPS):
        slave.do_step(time, STEP)
        time += STEP
        side.step(STEP)
        found = side.fmu.getFloat64(references)
        assert np.array([slave[name] for name in names]).tobytes() == np.array(found).tobytes()
        bent = max(bent, abs(slave["floor.bristle_x"]))
    assert bent > 1e-5


@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.ahead)")
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_without_python_the_same_bits(version, tmp_path):
    sides = Pair(model(), tmp_path, version, t_end=STEPS * STEP).instances()
    for side in sides:
        side.begin()
    for _ in range(STEPS):
        assert sides[0].step(STEP) == sides[1].step(STEP)
        assert sides[0].read() == sides[1].read()
