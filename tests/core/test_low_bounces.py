"""Bounces that become ever lower end at the instant of the closed form, however far a step goes beyond them."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    PointMass2D,
    PointMass3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)

G = 9.81


def ball(space, height, speed, e):
    law = NewtonImpact(restitution=e)
    if space:
        sphere = Sphere3D(marker=Marker3D(body="ball"), radius=0.1 * height)
        body = PointMass3D(name="ball", mass=1.0, position=(0.0, 0.0, 1.1 * height), velocity=(0.0, 0.0, speed))
        floor = SphereOnHalfSpace3D(name="floor", plane=HalfSpace3D(), sphere=sphere, law=law)
        return Model(bodies=[body], contacts=[floor], gravity=(0.0, 0.0, -G))
    disk = Disk2D(marker=Marker2D(body="ball"), radius=0.0)
    body = PointMass2D(name="ball", mass=1.0, position=(0.0, height), velocity=(0.0, speed))
    return Model(
        bodies=[body], contacts=[DiskOnHalfPlane2D(name="floor", plane=HalfPlane2D(), disk=disk, law=law)],
        gravity=(0.0, -G),
    )  # fmt: skip


@pytest.mark.parametrize("method", ["ebdf", "irk", "adams", "bdf"])
@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_the_bounces_end_in_time(space, method):
    """First touch at t_1 with v_1; then 2 v_1 e/(g (1 - e)) until rest."""
    rng = np.random.default_rng(len(method) + space)
    for _ in range(12):
        height, e = 10.0 ** rng.uniform(-6.0, 1.0), rng.uniform(0.1, 0.9)
        speed = rng.uniform(-1.0, 1.0) * 10.0 ** rng.uniform(-2.0, 1.0) * math.sqrt(2.0 * G * height)
        touch = math.sqrt(speed**2 + 2.0 * G * height)
        rest = (speed + touch) / G + 2.0 * touch * e / (G * (1.0 - e))
        result = simulate(ball(space, height, speed, e), 2.0 * rest, method, rtol=1e-6)
        (last,) = [event for event in result.events if event.kind == "rest"]
        assert last.t == pytest.approx(rest, rel=1e-5)
        impacts = [event.approach_speed for event in result.events if event.kind == "impact"]
        assert np.array(impacts[1:6]) == pytest.approx(e * np.array(impacts[:-1][:5]), rel=1e-6)
        assert np.all(np.diff(impacts) < 0.0)
