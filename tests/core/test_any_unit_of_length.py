"""A body on its foot falls, slides and rests in metres as in micrometres."""

import pytest
from tlismni.core import (
    CoulombFriction,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)


@pytest.mark.parametrize("length", [1e-6, 1.0, 2e3, 1e6])
def test_a_foot_below_the_centre_of_mass_carries_the_body(length: float) -> None:
    """In millimetres a body of 2 m has lengths of 2000: its Euler parameters move the foot far, its mass does not."""
    body = RigidBody3D(name="body", mass=1.0, inertia=(0.1 * length**2,) * 3, position=(0.0, 0.0, 0.3 * length))
    foot = SphereOnHalfSpace3D(
        name="foot", plane=HalfSpace3D(),
        sphere=Sphere3D(marker=Marker3D(body="body", point=(0.0, 0.0, -0.3 * length))),
        law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=0.3),
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0, -9.81 * length), bodies=[body], contacts=[foot]), 0.01)
    assert result["foot.normal_force"] == pytest.approx(9.81 * length, rel=1e-9)
