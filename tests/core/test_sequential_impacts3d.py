"""Blows one after another in space, with friction: as in the plane, in any direction, beside contacts of other laws."""

import numpy as np
import pytest
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody2D,
    RigidBody3D,
    Sphere3D,
    SphereOnSphere3D,
    simulate,
)

R, MASS = 0.1, 1.5
IN_TURN = NewtonImpact(restitution=0.8, propagation="sequential")
SPEEDS = np.array([[1.0, 0.3], [0.0, -0.1], [-0.4, 0.2]])
SPINS = np.array([4.0, -7.0, 2.0])


def lifted(turn, law=IN_TURN, mu=0.25, speeds=SPEEDS, spins=SPINS):
    """Three balls in a row that touch, in the plane that this rotation matrix takes x and y to."""
    bodies = [
        RigidBody3D(
            name=f"b{i}", mass=MASS, inertia=(0.4 * MASS * R**2,) * 3, position=tuple(turn @ (2.0 * R * i, 0.0, 0.0)),
            velocity=tuple(turn @ (*speeds[i], 0.0)), angular_velocity=tuple(turn @ (0.0, 0.0, spins[i])),
        )
        for i in range(3)
    ]  # fmt: skip
    laws = law if isinstance(law, list) else [law, law]
    rubs = mu if isinstance(mu, list) else [mu, mu]
    contacts = [
        SphereOnSphere3D(
            name=f"c{i}", law=laws[i], friction=CoulombFriction(coefficient=rubs[i]) if rubs[i] else None,
            a=Sphere3D(marker=Marker3D(body=f"b{i}"), radius=R),
            b=Sphere3D(marker=Marker3D(body=f"b{i + 1}"), radius=R),
        )
        for i in range(2)
    ]  # fmt: skip
    return Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, contacts=contacts)


def after(model, names):
    result = simulate(model, 1e-9, first_step=1e-9)
    last = int(np.flatnonzero(result.t == 0.0)[-1])
    return np.array([[result[f"b{i}.{name}"][last] for name in names] for i in range(3)]), result


def in_plane(mu=0.25):
    bodies = [
        RigidBody2D(
            name=f"b{i}", mass=MASS, inertia=0.4 * MASS * R**2, position=(2.0 * R * i, 0.0), velocity=tuple(SPEEDS[i]),
            angular_velocity=SPINS[i],
        )
        for i in range(3)
    ]  # fmt: skip
    contacts = [
        DiskOnDisk2D(
            name=f"c{i}", law=IN_TURN, friction=CoulombFriction(coefficient=mu),
            a=Disk2D(marker=Marker2D(body=f"b{i}"), radius=R), b=Disk2D(marker=Marker2D(body=f"b{i + 1}"), radius=R),
        )
        for i in range(2)
    ]  # fmt: skip
    return Model(gravity=(0.0, 0.0), bodies=bodies, contacts=contacts)


def rotation(seed):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


@pytest.mark.parametrize("mu", [0.05, 0.25, 2.0])
@pytest.mark.parametrize("seed", [None, 0, 1])
def test_a_chain_in_a_plane_of_space_is_that_of_the_plane(mu, seed):
    """Contacts slide, or stick in their blows."""
    turn = np.eye(3) if seed is None else rotation(seed)
    flat, planar = after(in_plane(mu), ("vx", "vy", "angular_velocity"))
    found, result = after(lifted(turn, mu=mu), ("vx", "vy", "vz"))
    spins, _ = after(lifted(turn, mu=mu), [f"angular_velocity_{axis}" for axis in "xyz"])
    assert found @ turn == pytest.approx(np.column_stack([flat[:, :2], np.zeros(3)]), abs=1e-12)
    assert spins @ turn == pytest.approx(np.column_stack([np.zeros((3, 2)), flat[:, 2]]), abs=1e-11)
    ours, theirs = ({e.contact: e.energy_loss for e in x.events if e.kind == "impact"} for x in (result, planar))
    assert ours == pytest.approx(theirs, abs=1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-12


def test_momentum_is_handed_on():
    """Elastic, head on: the last one flies off, and no friction is asked for."""
    elastic = NewtonImpact(restitution=1.0, propagation="sequential")
    speeds = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    found, _ = after(lifted(rotation(3), elastic, 0.3, speeds, np.zeros(3)), ("vx", "vy", "vz"))
    assert found @ rotation(3) == pytest.approx(np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0]]), abs=1e-13)


def test_one_that_asks_for_turns_is_heard_beside_one_with_friction():
    """Laws of one instant: a frictionless contact in turn, and another one with friction."""
    elastic = NewtonImpact(restitution=1.0, propagation="sequential")
    speeds = np.array([[1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    model = lifted(np.eye(3), [elastic, NewtonImpact(restitution=1.0)], [0.0, 0.3], speeds, np.zeros(3))
    found, _ = after(model, ("vx",))
    assert found[:, 0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-13)
