"""Contacts that begin without an approach, and ledgers that error control must see."""

import numpy as np
import pytest
from helpers import floor_contact, on
from tlismni.core import (
    Constant,
    CoordinateDriver,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Hertz,
    HuntCrossley,
    Model,
    NewtonImpact,
    PointMass2D,
    RigidBody2D,
    Sine,
    simulate,
)

K, G = 1e6, 9.81


@pytest.mark.parametrize("start", [0.0, -1e-3])
def test_ball_laid_on_a_damped_floor_settles_at_the_static_depth(start):
    """Laws that divide by the approach speed must not hold it like glue: K d^(3/2) = m g."""
    ball = PointMass2D(name="ball", mass=1.0, position=(0.0, start))
    law = HuntCrossley(stiffness=K, restitution=0.5)
    result = simulate(Model(bodies=[ball], contacts=[floor_contact(law, body="ball")]), 0.5)
    assert result["ball.y"][-1] == pytest.approx(-((G / K) ** (2.0 / 3.0)), rel=1e-3)


def test_energy_in_a_contact_at_the_start_is_in_the_ledger():
    ball = PointMass2D(name="ball", mass=1.0, position=(0.0, -1e-3))
    model = Model(bodies=[ball], contacts=[floor_contact(Hertz(stiffness=K), body="ball")])
    result = simulate(model, 0.5, rtol=1e-8, atol=1e-11)
    assert result["energy.strain"][0] == pytest.approx(0.4 * K * 1e-3**2.5, rel=1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-6 * result["energy.strain"][0] / 0.4


def test_work_of_a_driver_is_under_error_control():
    """A ball on a driven plate: nothing but the driver's work is hard to integrate."""
    plate = RigidBody2D(name="plate", mass=1.0, inertia=1.0, velocity=(0.0, 0.5))
    ball = PointMass2D(name="ball", mass=1.0, position=(0.0, 1.0))
    still = Constant(value=0.0)
    motions = {"x": still, "angle": still, "y": Sine(amplitude=0.02, angular_frequency=25.0)}
    drivers = [CoordinateDriver(name=f"d{c}", body="plate", coordinate=c, motion=f) for c, f in motions.items()]
    contact = DiskOnHalfPlane2D(
        name="c",
        plane=HalfPlane2D(marker=on("plate")),
        disk=Disk2D(marker=on("ball")),
        law=NewtonImpact(restitution=0.7),
    )
    model = Model(bodies=[plate, ball], joints=drivers, contacts=[contact])
    for rtol in (1e-6, 1e-9):
        result = simulate(model, 1.5, rtol=rtol, atol=rtol * 1e-2)
        assert np.abs(result["energy.balance"]).max() < 20.0 * rtol
