"""Boxes on boxes in FMUs: the bits of a run in this process, with Python and without."""

import pytest
from native_pair import Pair, step_alike, steps_of_the_same_bits
from tlismni.core import (
    Box3D,
    ContactGroup3D,
    CoulombFriction,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    RotationVector,
)
from tlismni.core.compiled.library import LIBRARY

STEPS, STEP = 20, 0.03


def model():
    """A box that falls on another by a corner, and on its edges."""
    box = RigidBody3D(
        name="box", mass=1.0, inertia=(0.011, 0.017, 0.021), position=(0.35, 0.1, 0.4), velocity=(0.5, 0.0, 0.0),
        attitude=RotationVector(vector=(0.5, 0.6, 0.1)),
    )  # fmt: skip
    table = Box3D(marker=Marker3D(), size=(1.0, 1.0, 0.2))
    group = ContactGroup3D(
        name="on", boxes=[table, Box3D(marker=Marker3D(body="box"), size=(0.4, 0.3, 0.2))],
        law=NewtonImpact(restitution=0.3, rest_ratio=1e-3), friction=CoulombFriction(coefficient=0.4),
    )  # fmt: skip
    return Model(name="box_on_box", gravity=(0.0, 0.0, -9.81), bodies=[box], groups=[group])


def test_the_bits_of_a_run_in_this_process(tmp_path):
    lowest = min(slave["box.z"] for slave in steps_of_the_same_bits(model(), tmp_path, STEPS, STEP))
    assert 0.15 < lowest < 0.35  # it has fallen on the other, and not through it


@pytest.mark.sampled(1)
@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_without_python_the_same_bits(version, tmp_path):
    sides = Pair(model(), tmp_path, version, t_end=STEPS * STEP).instances()
    for side in sides:
        side.begin()
    step_alike(sides, STEPS, STEP)
