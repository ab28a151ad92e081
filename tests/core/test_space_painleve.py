"""Painleve's paradox in space: a rod that slides on the floor with its tip, in any vertical plane."""

import logging
import math

import numpy as np
import pytest
from helpers import G
from test_contact_limits import critical
from tlismni.core import (
    CoulombFriction,
    EulerParameters,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    SimulationError,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)


def sliding_rod(angle, speed, rate, mu, turned):
    """A slender rod of length 2 and mass 1, its lower end on the floor at the origin, at `angle` from the floor in the
    plane that is turned about the vertical by `turned`; the end slides with `speed` along that plane."""
    c, s, ct, st = math.cos(angle), math.sin(angle), math.cos(turned), math.sin(turned)
    flat = speed - rate * s
    # about the vertical by `turned`, then about the plane's horizontal normal by -angle: x of the body is the rod
    about_z = (math.cos(0.5 * turned), 0.0, 0.0, math.sin(0.5 * turned))
    about_y = (math.cos(0.5 * angle), 0.0, -math.sin(0.5 * angle), 0.0)
    attitude = (
        about_z[0] * about_y[0], -about_z[3] * about_y[2], about_z[0] * about_y[2], about_z[3] * about_y[0],
    )  # fmt: skip
    rod = RigidBody3D(
        name="rod", mass=1.0, inertia=(1e-3, 1.0 / 3.0, 1.0 / 3.0), position=(c * ct, c * st, s),
        attitude=EulerParameters(values=attitude), velocity=(flat * ct, flat * st, rate * c),
        angular_velocity=(rate * st, -rate * ct, 0.0), angular_velocity_in="space",
    )  # fmt: skip
    tip = SphereOnHalfSpace3D(
        name="tip", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="rod", point=(-1.0, 0.0, 0.0))),
        law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=mu),
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G), bodies=[rod], contacts=[tip])


@pytest.mark.parametrize(("angle", "turned"), [(0.7, 0.0), (1.1, 0.8), (1.4, -2.3)])
def test_beyond_the_critical_coefficient_the_start_is_refused_by_name(angle, turned):
    with pytest.raises(SimulationError, match=r"'tip', t = 0 s: Painleve's paradox.*mu = .*smaller.*regularised"):
        simulate(sliding_rod(angle, -5.0, 0.0, critical(angle) + 1e-3, turned), 0.1)
    # below it, and sliding away from its foot, it moves
    simulate(sliding_rod(angle, -5.0, 0.0, critical(angle) - 1e-2, turned), 1e-3)
    result = simulate(sliding_rod(angle, 5.0, 0.0, critical(angle) + 1.0, turned), 1e-2)
    assert result.events[0].kind == "close"


@pytest.mark.parametrize("turned", [0.0, 2.0])
def test_a_rod_that_turns_into_the_critical_angle_is_stopped_by_name(turned):
    """As in the plane: it is raised by its rate, N grows without bound where mu = 1.6 is critical."""
    with pytest.raises(SimulationError, match=r"'tip'.*Painleve's paradox.*mu = 1\.6") as caught:
        simulate(sliding_rod(0.6, -10.0, 1.0, 1.6, turned), 2.0, "ebdf", rtol=1e-8)
    assert caught.value.loop == "contact"
    partial = caught.value.partial
    reached = math.asin(partial["rod.z"][-1])
    assert critical(reached) == pytest.approx(1.6, rel=1e-2)
    assert partial["tip.normal_force"].max() > 10.0 * partial["tip.normal_force"][1]
    assert np.abs(partial["tip.friction_force"][-1]) == pytest.approx(1.6 * partial["tip.normal_force"][-1], rel=1e-9)


def test_among_many_contacts_impulses_take_over(caplog):
    """The same rod beside eight balls at rest: what has no accelerations is stopped by an impulse, and the log says
    so."""
    rod = sliding_rod(0.6, -10.0, 1.0, 1.6, 0.0)
    with pytest.raises(SimulationError) as caught:
        simulate(rod, 2.0, "ebdf", rtol=1e-8)
    balls = [
        RigidBody3D(name=f"ball{k}", mass=1.0, inertia=(4e-3,) * 3, position=(k, 5.0, 0.1)) for k in range(8)
    ]  # fmt: skip
    on_floor = [
        SphereOnHalfSpace3D(
            name=f"floor{k}", plane=HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body=f"ball{k}"), radius=0.1),
            law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=0.3),
        )
        for k in range(8)
    ]  # fmt: skip
    beside = rod.model_copy(update={"bodies": [*rod.bodies, *balls], "contacts": [*rod.contacts, *on_floor]})
    with caplog.at_level(logging.WARNING):
        result = simulate(beside, caught.value.t + 0.05, "ebdf", rtol=1e-8)
    assert "steps of impulses take over" in caplog.text
    assert result.stats["impulse_steps"] > 0
    assert result["tip.gap"].min() > -1e-5
    energy = result["energy.kinetic"] + result["energy.potential"]
    assert energy[-1] < energy[0]
    assert result["energy.balance"][-1] == pytest.approx(0.0, abs=1e-6 * energy[0])
    assert result["ball3.z"] == pytest.approx(0.1, abs=1e-9)
