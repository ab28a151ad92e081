"""Contacts that are far from touching are not evaluated: nothing that can be seen may depend on it."""

import numpy as np
import pytest
from test_heap import RADIUS, heap
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    DiskOnSegment2D,
    HalfPlane2D,
    KelvinVoigt,
    Marker2D,
    Model,
    NewtonImpact,
    RigidBody2D,
    Segment2D,
    Simulation,
    TanhFriction,
)
from tlismni.core.location.probe import SLEEPS


def billiard(law, friction):
    """Disks that fly between a turning paddle with a plane, a flying segment and the ground."""
    rng = np.random.default_rng(5)
    disks = [
        RigidBody2D(
            name=f"disk{k}", mass=1.0, inertia=0.5 * RADIUS**2, position=(0.3 * k - 0.6, 0.5 + 0.2 * (k % 2)),
            velocity=tuple(rng.uniform(-2.0, 2.0, 2)), angular_velocity=3.0,
        )
        for k in range(4)
    ]  # fmt: skip
    paddle = RigidBody2D(name="paddle", mass=3.0, inertia=0.3, position=(0.0, -0.8), angular_velocity=0.7)
    rod = RigidBody2D(name="rod", mass=1.0, inertia=0.05, position=(0.0, 1.4), velocity=(0.0, -0.5), angular_velocity=1)
    rims = [Disk2D(marker=Marker2D(body=disk.name, point=(0.01, 0.0)), radius=RADIUS) for disk in disks]
    shape = Segment2D(marker=Marker2D(body="rod", point=(-0.4, 0.0)), length=0.8, radius=0.02)
    how = {"law": law, "friction": friction}
    floor, plane = HalfPlane2D(marker=Marker2D(point=(0.0, -1.5))), HalfPlane2D(marker=Marker2D(body="paddle"))
    contacts = [DiskOnDisk2D(name=f"pair{i}{j}", a=rims[i], b=rims[j], **how) for i in range(4) for j in range(i)]
    for k, rim in enumerate(rims):
        contacts.append(DiskOnHalfPlane2D(name=f"floor{k}", plane=floor, disk=rim, **how))
        contacts.append(DiskOnHalfPlane2D(name=f"paddle{k}", plane=plane, disk=rim, **how))
        contacts.append(DiskOnSegment2D(name=f"rod{k}", segment=shape, disk=rim, **how))
    return Model(gravity=(0.0, -9.81), bodies=[*disks, paddle, rod], contacts=contacts)


NEWTON = billiard(NewtonImpact(restitution=0.8), CoulombFriction(coefficient=0.2))
FORCES = billiard(KelvinVoigt(stiffness=1e5, damping=10.0), TanhFriction(coefficient=0.2, transition_speed=1e-2))


@pytest.mark.parametrize(
    "model, method, end",
    [
        (heap(5, 0.3, 0.4, 2), "ebdf", 0.35),
        (heap(5, 0.3, 0.4, 2), "hht", 0.2),
        (NEWTON, "ebdf", 0.7),
        (NEWTON, "irk", 0.7),
        (FORCES, "ebdf", 0.5),
    ],
    ids=["heap-ebdf", "heap-hht", "billiard-ebdf", "billiard-irk", "forces"],
)
def test_sleeping_contacts_change_no_bit(model, method, end):
    with_sleep, without = Simulation(model, method, record=3), Simulation(model, method, record=3)
    without._loop.arrays["near"][:, SLEEPS] = 0
    for t in np.linspace(0.0, end, 8)[1:]:
        for sim in (with_sleep, without):
            sim.advance(float(t))
            sim.sample()
        assert with_sleep.state().deciding_bytes() == without.state().deciding_bytes()
        for name in ("phi", "phid", "phidd"):
            np.testing.assert_array_equal(with_sleep.workspace.arrays[name], without.workspace.arrays[name])
        assert not with_sleep.workspace.arrays["asleep"].any()
    assert np.any(with_sleep._loop.arrays["margin"] > 0.0), "no contact has slept"
    assert not without._loop.arrays["margin"].any()
    assert with_sleep.events == without.events
    assert with_sleep.events
    np.testing.assert_array_equal(np.concatenate(with_sleep.samples), np.concatenate(without.samples))


def test_a_restored_run_goes_on_in_the_same_way():
    sim = Simulation(heap(5, 0.3, 0.4, 3), "ebdf")
    sim.advance(0.2)
    state = sim.state()
    sim.advance(0.3)
    end = sim.state()
    sim.restore(state)
    sim.advance(0.3)
    assert sim.state() == end
