"""LuGre's friction in space in FMUs: the bits of a run in this process, with Python and without."""

import numpy as np
import pytest
from native_pair import Pair, step_alike, steps_of_the_same_bits
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
    bent = 0.0
    for slave in steps_of_the_same_bits(model(), tmp_path, STEPS, STEP):
        bent = max(bent, abs(slave["floor.bristle_x"]))
        assert all(np.isfinite(slave[name]) for name in ("floor.bristle_y", "post.bristle_z"))
    assert bent > 1e-5


@pytest.mark.sampled(1)
@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_without_python_the_same_bits(version, tmp_path):
    sides = Pair(model(), tmp_path, version, t_end=STEPS * STEP).instances()
    for side in sides:
        side.begin()
    step_alike(sides, STEPS, STEP)
