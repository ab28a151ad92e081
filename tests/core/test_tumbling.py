"""Boxes and disks that fall on each other, a rough floor and a wall: what must hold however they tumble."""

import math

import numpy as np
import pytest
from helpers import on
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PoissonImpact,
    RigidBody2D,
    simulate,
)

SIDE = 0.1
"""Half the side of a box, radius of a disk, m."""
CORNERS = [(-SIDE, -SIDE), (SIDE, -SIDE), (SIDE, SIDE), (-SIDE, SIDE)]


def scene(seed):
    """One to three random bodies, one above another; boxes touch floor and wall with their corners, each other with a
    disk about their centre. Some lie, some fall, some turn."""
    rng = np.random.default_rng(seed)
    mu, e = rng.uniform(0.0, 0.8), rng.choice([0.0, 0.0, 0.3, 0.6])
    ends = {
        "law": (NewtonImpact if rng.random() < 0.5 else PoissonImpact)(restitution=e),
        "friction": CoulombFriction(coefficient=mu, static_coefficient=mu * rng.choice([1.0, 1.0, 1.4])),
    }
    sides = {"floor": Marker2D(), "wall": Marker2D(point=(0.6, 0.0), angle=0.5 * math.pi)}
    bodies, contacts, height = [], [], 0.0
    for i in range(int(rng.integers(1, 4))):
        box = rng.random() < 0.5
        tilt = rng.choice([0.0, rng.uniform(-0.3, 0.3)]) if box else 0.0
        height += 2.0 * SIDE + rng.choice([0.0, 0.05]) + (0.1 if tilt else 0.0)
        mass = rng.uniform(0.3, 3.0)
        bodies.append(
            RigidBody2D(
                name=f"b{i}", mass=mass, inertia=mass * SIDE**2 * (2.0 / 3.0 if box else 0.5), angle=tilt,
                position=(rng.uniform(-0.05, 0.05), height - SIDE - (0.04 if tilt else 0.0)),
                velocity=(0.5 * rng.normal(), rng.choice([0.0, 0.5 * rng.normal()])),
                angular_velocity=rng.choice([0.0, 10.0 * rng.normal()]),
            )
        )  # fmt: skip
        for k, point in enumerate(CORNERS if box else [(0.0, 0.0)]):
            disk = Disk2D(marker=on(f"b{i}", *point), radius=0.0 if box else SIDE)
            contacts += [
                DiskOnHalfPlane2D(name=f"{name}{i}{k}", plane=HalfPlane2D(marker=marker), disk=disk, **ends)
                for name, marker in sides.items()
            ]
        contacts += [
            DiskOnDisk2D(
                name=f"pair{i}{j}", a=Disk2D(marker=on(f"b{i}"), radius=SIDE),
                b=Disk2D(marker=on(f"b{j}"), radius=SIDE), **ends,
            )
            for j in range(i)
        ]  # fmt: skip
    return Model(bodies=bodies, contacts=contacts)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", range(24))
def test_tumbling_bodies_keep_every_law(seed):
    """No penetration, no pulling, friction within its limit and against the sliding, ledger closed, nothing created."""
    model = scene(seed)
    method = ("ebdf", "irk")[seed % 2]
    result = simulate(model, 0.8, method, rtol=1e-7, atol=1e-9)
    for contact in model.contacts:
        name, law = contact.name, contact.friction
        normal, friction = result[f"{name}.normal_force"], result[f"{name}.friction_force"]
        assert result[f"{name}.gap"].min() > -1e-10
        assert normal.min() > -1e-9
        assert np.all(np.abs(friction) <= law.sticking_coefficient * normal + 1e-7)
        # contacts that open more slowly than can be told from rest are held, which may slide them by as little
        assert np.max(friction * result[f"{name}.sliding_velocity"]) < 1e-5
        assert np.all(np.diff(result[f"{name}.impulse"]) > -1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-5
    if not isinstance(model.contacts[0].law, NewtonImpact):
        assert np.all(np.diff(result["energy.impact_loss"]) > -1e-12)
    for level in ("position", "velocity", "acceleration"):
        assert result[f"residual.{level}"].max() < 1e-7


def test_the_order_of_contacts_does_not_matter_while_forces_are_unique():
    """Two bodies side by side that share nothing: each moves as it would alone."""
    a, b = scene(2), scene(5)
    alone = simulate(a, 0.3, "irk", rtol=1e-9)
    apart = [body.model_copy(update={"name": f"x{body.name}", "position": (body.position[0] - 9.0, body.position[1])})
             for body in b.bodies]  # fmt: skip
    floors = [
        c.model_copy(update={"name": f"x{c.name}", "disk": c.disk.model_copy(
            update={"marker": c.disk.marker.model_copy(update={"body": f"x{c.disk.marker.body}"})})})
        for c in b.contacts if c.name.startswith("floor")
    ]  # fmt: skip
    both = a.model_copy(update={"bodies": (*apart, *a.bodies), "contacts": (*floors, *a.contacts)})
    together = simulate(both, 0.3, "irk", rtol=1e-9)
    for body in a.bodies:
        for channel in ("x", "y", "angle"):
            name = f"{body.name}.{channel}"
            assert together[name][-1] == pytest.approx(alone[name][-1], abs=1e-6)
