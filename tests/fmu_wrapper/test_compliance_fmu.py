"""The relative compliance of a contact as a parameter of an FMU, with and without Python."""

import numpy as np
import pytest
from native_pair import Pair
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    Parameter,
    RigidBody2D,
)
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import Slave
from tlismni.fmu_wrapper.errors import FmuError

MASS, G, HEIGHT, MU, SPEED = 3.0, 9.81, 0.3, (0.1, 0.3, 0.2), 2.0
PLACES = (-0.3, 0.1, 0.4)


def sliding_block():
    """On three feet, whose friction follows their loads."""
    body = RigidBody2D(name="b", mass=MASS, inertia=0.1, position=(0.0, HEIGHT), velocity=(SPEED, 0.0))
    feet = [
        DiskOnHalfPlane2D(
            name=f"f{i}", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body="b", point=(x, -HEIGHT))),
            law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=mu),
        )
        for i, (x, mu) in enumerate(zip(PLACES, MU, strict=True))
    ]  # fmt: skip
    give = Parameter(name="give", minimum=0.01, maximum=100.0, targets=["f1.compliance"])
    return Model(name="feet", gravity=(0.0, -G), bodies=[body], contacts=feet, parameters=[give])


def loads(give):
    """Normal forces and the acceleration with this compliance of the middle foot."""
    gaps = np.array([np.ones(3), PLACES])
    null = np.linalg.svd(gaps)[2][-1]
    matrix = np.array([gaps[0], gaps[1] - np.array(MU) * HEIGHT, null * (1.0, give, 1.0)])
    found = np.linalg.solve(matrix, [MASS * G, 0.0, 0.0])
    return found, -float(found @ MU) / MASS


@pytest.mark.parametrize("give", [1.0, 4.0, 0.5])
def test_it_is_set_before_the_run(give):
    slave = Slave(sliding_block(), rtol=1e-8)
    slave.setup(0.0)
    slave.set_by_name({"give": give})
    slave.enter_initialization()
    slave.exit_initialization()
    for k in range(3):
        slave.do_step(0.1 * k, 0.1)
    normal, acceleration = loads(give)
    assert min(normal) > 0.0
    np.testing.assert_allclose([slave[f"f{i}.normal_force"] for i in range(3)], normal, rtol=1e-7)
    assert slave["b.vx"] == pytest.approx(SPEED + 0.3 * acceleration, rel=1e-8)
    with pytest.raises(FmuError, match="give"):
        slave.set_by_name({"give": 2.0})


@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_it_has_the_same_bits_without_python(version, tmp_path):
    sides = Pair(sliding_block(), tmp_path, version, t_end=1.0).instances()
    for side in sides:
        side.set(give=4.0)
        side.begin()
    for _ in range(20):
        assert sides[0].step(0.05) == sides[1].step(0.05)
        assert sides[0].read() == sides[1].read()
