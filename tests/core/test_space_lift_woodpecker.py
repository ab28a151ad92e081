"""A woodpecker of rigid bodies, in the plane and lifted into space: impacts with friction of a sleeve that jams."""

import numpy as np
import pytest
from test_space_lift_friction import in_space, rigid, same_events, touching
from tlismni.core import (
    Axes,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    Prismatic2D,
    Prismatic3D,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    TorsionSpring2D,
    TorsionSpring3D,
    simulate,
)
from tlismni.models import woodpecker as toy

G, T_END = 9.81, 0.6
SLEEVE, BIRD = -0.1, -0.2788


def flat_woodpecker():
    """A carriage on the pole that the sleeve turns on, and the bird on a torsion spring; all angles are large ones."""
    arm = toy.SPRING_ARM * np.array([np.cos(SLEEVE), np.sin(SLEEVE)])
    bird = arm + toy.BIRD_ARM * np.array([np.cos(BIRD), np.sin(BIRD)])
    y, turn, peck = toy.START_RATES
    assert turn == 0.0
    hinge = Marker2D(body="sleeve", point=(toy.SPRING_ARM, 0.0)), Marker2D(body="bird", point=(-toy.BIRD_ARM, 0.0))
    rub, pole = (
        CoulombFriction(coefficient=0.3),
        HalfPlane2D(marker=Marker2D(point=(toy.POLE_RADIUS, 0.0), angle=-np.pi / 2)),
    )

    def edge(name, body, point, restitution):
        disk, law = Disk2D(marker=Marker2D(body=body, point=point)), NewtonImpact(restitution=restitution)
        return DiskOnHalfPlane2D(name=name, plane=pole, disk=disk, law=law, friction=rub)

    return Model(
        gravity=(0.0, -G),
        bodies=[
            RigidBody2D(name="carriage", mass=1e-4, inertia=1e-9, velocity=(0.0, y)),
            RigidBody2D(
                name="sleeve", mass=toy.SLEEVE_MASS, inertia=toy.SLEEVE_INERTIA, angle=SLEEVE, velocity=(0.0, y)
            ),
            RigidBody2D(
                name="bird", mass=toy.BIRD_MASS, inertia=toy.BIRD_INERTIA, position=tuple(bird), angle=BIRD,
                velocity=(-peck * (bird - arm)[1], y + peck * (bird - arm)[0]), angular_velocity=peck,
            ),
        ],
        joints=[
            Prismatic2D(name="pole", a=Marker2D(angle=np.pi / 2), b=Marker2D(body="carriage", angle=np.pi / 2)),
            Revolute2D(name="turn", a=Marker2D(body="carriage"), b=Marker2D(body="sleeve")),
            Revolute2D(name="hinge", a=hinge[0], b=hinge[1]),
        ],
        forces=[TorsionSpring2D(name="spring", a=hinge[0], b=hinge[1], stiffness=toy.SPRING)],
        contacts=[
            edge("beak", "bird", (-toy.BEAK_ARM, toy.BEAK_HEIGHT), 0.5),
            edge("lower", "sleeve", (toy.SLEEVE_RADIUS, -toy.SLEEVE_HALF_HEIGHT), 0.0),
            edge("upper", "sleeve", (toy.SLEEVE_RADIUS, toy.SLEEVE_HALF_HEIGHT), 0.0),
        ],
    )  # fmt: skip


def lifted(model):
    """The same in space, about z."""
    _, turn, hinge = model.joints
    along = Axes(z=(0.0, 1.0, 0.0))
    (spring,) = model.forces
    ends = {"a": in_space(hinge.a), "b": in_space(hinge.b)}
    return Model(
        gravity=(0.0, -G, 0.0), bodies=[rigid(body) for body in model.bodies],
        joints=[
            Prismatic3D(name="pole", a=Marker3D(attitude=along), b=Marker3D(body="carriage", attitude=along)),
            Revolute3D(name="turn", a=in_space(turn.a), b=in_space(turn.b)),
            Revolute3D(name="hinge", **ends),
        ],
        forces=[TorsionSpring3D(name="spring", **ends, stiffness=spring.stiffness)],
        contacts=[touching(contact) for contact in model.contacts],
    )  # fmt: skip


def test_lifted_woodpecker():
    """Four pecks: places to 1e-10 m, rates to 1e-10 of the largest, instants and impulses of all events to 1e-10."""
    model = flat_woodpecker()
    times = np.linspace(0.0, T_END, 101)
    flat, spatial = (simulate(m, T_END, rtol=1e-13, atol=1e-15, t_eval=times) for m in (model, lifted(model)))
    kinds = same_events(flat, spatial, 1e-10)
    assert ("impact", "beak") in kinds and ("impact", "lower") in kinds
    assert {kind for kind, _ in kinds} >= {"impact", "stick", "slip"}
    assert kinds.count(("impact", "beak")) >= 4
    for body in ("sleeve", "bird"):
        for axis in "xy":
            assert np.abs(flat[f"{body}.{axis}"] - spatial[f"{body}.{axis}"]).max() < 1e-10
            assert np.abs(flat[f"{body}.v{axis}"] - spatial[f"{body}.v{axis}"]).max() < 1e-10
        rates = flat[f"{body}.angular_velocity"], spatial[f"{body}.angular_velocity_z"]
        assert np.abs(rates[0] - rates[1]).max() < 1e-10 * np.abs(rates[0]).max()
    assert spatial["bird.y"][-1] < spatial["bird.y"][0] - 0.005
    assert np.abs(spatial["bird.z"]).max() == pytest.approx(0.0, abs=1e-12)
