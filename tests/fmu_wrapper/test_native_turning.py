"""Friction against rolling and spinning in an FMU without Python: the bits of that with it, of both contacts."""

import numpy as np
import pytest
from native_pair import Pair, step_alike
from tlismni.core import (
    CoulombFriction,
    HalfSpace3D,
    HuntCrossley,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    TanhFriction,
    TurningFriction,
)
from tlismni.core.compiled.library import LIBRARY

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
HARD = {"law": NewtonImpact(restitution=0.4), "friction": CoulombFriction(coefficient=0.5)}
SOFT = {
    "law": HuntCrossley(stiffness=1e6, restitution=0.5),
    "friction": TanhFriction(coefficient=0.5, transition_speed=1e-3),
}


def ball(turning, contact):
    """A ball that falls on the floor with speed and spin, bounces, slides and rolls out."""
    body = RigidBody3D(
        name="ball", mass=0.7, inertia=(7e-4,) * 3, position=(0.0, 0.0, 0.06), velocity=(0.3, 0.1, 0.0),
        angular_velocity=(0.0, 4.0, 9.0),
    )  # fmt: skip
    touch = SphereOnHalfSpace3D(
        name="touch", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=0.05),
        turning=turning, **contact,
    )  # fmt: skip
    return Model(name="ball_that_rolls_out", gravity=(0.0, 0.0, -9.81), bodies=[body], contacts=[touch])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("contact", [HARD, SOFT], ids=["constraint", "force"])
def test_a_ball_that_rolls_out(contact, tmp_path):
    turning = TurningFriction(rolling=0.004, spinning=0.002, transition_speed=1e-2)
    sides = Pair(ball(turning, contact), tmp_path, "3.0", t_end=0.4).instances()
    for side in sides:
        side.begin()
    step_alike(sides, 20, 0.02)
    # it has been slowed down: without that friction the spin about the vertical would be nearly what it was
    reference = [sides[0].by_name["ball.angular_velocity_z"].valueReference]
    assert abs(sides[0].fmu.getFloat64(reference)[0]) < 7.0
    assert np.isfinite(sides[0].fmu.getFloat64(sides[0].reals)).all()
