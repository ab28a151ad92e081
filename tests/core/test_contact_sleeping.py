"""Contacts that are far from touching are not evaluated: nothing that can be seen may depend on it."""

import math

import numpy as np
import pytest
from test_heap import RADIUS, heap
from tlismni.core import (
    ContactGroup2D,
    ContactGroup3D,
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    DiskOnSegment2D,
    HalfPlane2D,
    KelvinVoigt,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody2D,
    RigidBody3D,
    Segment2D,
    Simulation,
    Sphere3D,
    TanhFriction,
    compile_model,
)
from tlismni.core.event_detection.contact_evaluation import SLEEPS
from tlismni.core.simulation.blueprint import what_differs


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
    without._loop.set_size("n_balls", 0)
    for t in np.linspace(0.0, end, 8)[1:]:
        for sim in (with_sleep, without):
            sim.advance(float(t))
            sim.sample()
        assert with_sleep.state().deciding_bytes() == without.state().deciding_bytes()
        for name in ("phi", "phid", "phidd"):
            np.testing.assert_array_equal(with_sleep.workspace.arrays[name], without.workspace.arrays[name])
        assert not with_sleep.workspace.arrays["sleeping"].any()
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


def swarm(count, spatial, restitution=0.9):
    """Balls of different size, some of them about points off their bodies' centres, that fly through each other's
    way; they touch nothing else."""
    rng = np.random.default_rng(11)
    across = math.ceil(count ** (1.0 / (3 if spatial else 2)))
    bodies, shapes = [], []
    for k in range(count):
        cell = np.array([k % across, k // across % across, k // across**2]) - 0.5 * (across - 1)
        where, speed = 0.7 * cell + rng.uniform(-0.05, 0.05, 3), rng.uniform(-1.0, 1.0, 3)
        off = rng.uniform(-0.05, 0.05, 3) if k % 3 == 0 else np.zeros(3)
        radius = float(rng.uniform(0.1, 0.2))
        if spatial:
            bodies.append(
                RigidBody3D(
                    name=f"b{k}", mass=1.0, inertia=(0.01,) * 3, position=tuple(where), velocity=tuple(speed - where),
                    angular_velocity=tuple(rng.uniform(-3.0, 3.0, 3)),
                )
            )  # fmt: skip
            shapes.append(Sphere3D(marker=Marker3D(body=f"b{k}", point=tuple(off)), radius=radius))
        else:
            bodies.append(
                RigidBody2D(
                    name=f"b{k}", mass=1.0, inertia=0.01, position=tuple(where[:2]),
                    velocity=tuple((speed - where)[:2]), angular_velocity=float(speed[2]),
                )
            )  # fmt: skip
            shapes.append(Disk2D(marker=Marker2D(body=f"b{k}", point=tuple(off[:2])), radius=radius))
    law = NewtonImpact(restitution=restitution)
    groups = [
        ContactGroup3D(name="swarm", spheres=shapes, law=law)
        if spatial
        else ContactGroup2D(name="swarm", disks=shapes, law=law)
    ]
    return Model(gravity=(0.0, 0.0, 0.0) if spatial else (0.0, 0.0), bodies=bodies, groups=groups)


@pytest.mark.parametrize("spatial", [False, True], ids=["plane", "space"])
def test_the_broad_phase_changes_no_bit(spatial):
    model = swarm(16, spatial)
    swept, without = (Simulation(model, "ebdf", max_step=2e-3) for _ in range(2))
    without._loop.arrays["near"][:, SLEEPS] = 0
    without._loop.set_size("n_balls", 0)
    assert len(swept._loop.arrays["balls"]) == 16
    fewest = len(model.contacts)
    for t in np.linspace(0.0, 1.2, 25)[1:]:
        for sim in (swept, without):
            sim.advance(float(t))
        assert swept.state().deciding_bytes() == without.state().deciding_bytes()
        # nothing of it is left between two calls, but what the last sweep has found
        assert swept.workspace.arrays["looked"][0] == len(model.contacts)
        marks = swept._loop.arrays["broad"]
        fewest = min(fewest, int(np.sum(swept._loop.arrays["pair_found"] == marks[1])))
    assert swept.events == without.events
    assert swept.events
    assert fewest < len(model.contacts) // 3


def test_skins_become_thin_again_behind_long_steps():
    """Disks that fly into a box in long steps, and then strike: in one call, so that nothing but sweeps ends skins."""
    sim = Simulation(heap(12, 0.3, 0.4, 0), "ebdf")
    sim.advance(0.3)
    loop = sim._loop.arrays
    found = loop["pair_found"][loop["pair_found"] >= 0]
    assert len(found) == 66
    assert np.sum(found == loop["broad"][1]) < 33
    assert np.all(loop["ball_moves"][:, 3] < 2.0 * RADIUS)


def test_balls_fit_the_shapes_however_their_numbers_change():
    """A compiled model gives its tables to runs with other numbers; the balls are those of their own radii."""
    small, large = grown(1.0), Simulation(grown(4.0), "ebdf")
    assert not what_differs(small.assemble(), large.assembly)
    of_its_tables = compile_model(small, "ebdf").run_of(grown(4.0))
    for sim in (of_its_tables, large):
        sim.advance(0.6)
    assert large.events
    assert of_its_tables.state().deciding_bytes() == large.state().deciding_bytes()
    np.testing.assert_array_equal(of_its_tables._loop.arrays["balls"], large._loop.arrays["balls"])


def grown(factor):
    """The swarm with its spheres so many times as large, in a model of the same tables."""
    model = swarm(12, True)
    (group,) = model.groups
    spheres = tuple(s.model_copy(update={"radius": 0.25 * factor * s.radius}) for s in group.spheres)
    return Model(gravity=model.gravity, bodies=model.bodies, groups=[group.model_copy(update={"spheres": spheres})])
