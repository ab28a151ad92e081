"""A table that stands reports nothing: its contacts repeat each other, and none opens, closes, slips or sticks."""

import numpy as np
import pytest
from tlismni.core import (
    CoordinateDriver,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    PositionDriver3D,
    Prismatic3D,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Sine,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)

HIGH, GRAVITY, REACH, TURN = 0.4, 9.81, 0.05, 2.0 * np.pi
"""Metres, m/s^2; amplitude (m) and angular frequency (1/s) of a support: its acceleration is a fifth of gravity."""
STEADY = {"rtol": 1e-6, "atol": 1e-9}
KINDS = {
    "plain": {},
    "uneven": {"uneven": True},
    "off centre": {"off": 0.19},
    "tilted": {"tilt": 0.2},
    "no friction": {"mu": 0.0},
    "millimetres": {"unit": 1e3, "tilt": 0.1},
    "kilometres": {"unit": 1e-3, "tilt": 0.1},
    "dropped": {"drop": 1e-3},
    "dropped, tilted": {"drop": 1e-3, "tilt": 0.2, "uneven": True},
    "dropped, bounces": {"drop": 1e-3, "bounce": 0.3, "off": 0.07},
    "support along": {"support": (1.0, 0.0)},
    "support up": {"support": (0.0, 1.0)},
    "support askew": {"support": (0.6, 0.8)},
}
"""`unit`: of length, so many of them are a metre; `off`: of the centre of mass, m; `support`: which way it moves."""


def places(feet, planar, uneven):
    """Of the feet (feet, 1 or 2) about the centre of their polygon."""
    random = np.random.default_rng(feet)
    if planar:
        x = np.sort(random.uniform(-0.5, 0.5, feet)) if uneven else np.linspace(-0.5, 0.5, feet)
        return (x - x.mean())[:, None]
    angle = 0.3 + TURN * (np.arange(feet) + (random.uniform(-0.3, 0.3, feet) if uneven else 0.0)) / feet
    radius = random.uniform(0.35, 0.5, feet) if uneven else np.full(feet, 0.5)
    points = np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))
    return points - points.mean(axis=0)


def laws(mu, bounce):
    return {
        "law": NewtonImpact(restitution=bounce),
        "friction": CoulombFriction(coefficient=mu) if mu else None,
    }


def in_plane(feet, *, uneven=False, off=0.0, tilt=0.0, mu=0.6, unit=1.0, drop=0.0, bounce=0.0, support=None):
    motion = Sine(amplitude=REACH * unit, angular_frequency=TURN)
    speed = (0.0, 0.0) if support is None else tuple(unit * REACH * TURN * np.array(support))
    high = unit * (HIGH + drop)
    table = RigidBody2D(
        name="table", mass=2.0, inertia=0.3 * unit**2, angle=tilt, velocity=speed,
        position=(-np.sin(tilt) * high, np.cos(tilt) * high),
    )  # fmt: skip
    bodies, joints, floor = [table], [], HalfPlane2D(marker=Marker2D(angle=tilt))
    if support is not None:
        bodies.append(RigidBody2D(name="plate", mass=10.0, inertia=1.0, velocity=speed))
        floor = HalfPlane2D(marker=Marker2D(body="plate"))
        joints = [
            CoordinateDriver(
                name=f"led_{name}", body="plate", coordinate=name,
                motion=motion.model_copy(update={"amplitude": share * REACH * unit}),
            )
            for name, share in (*zip("xy", support, strict=True), ("angle", 0.0))
        ]  # fmt: skip
    contacts = [
        DiskOnHalfPlane2D(
            name=f"foot{k}", plane=floor, **laws(mu, bounce),
            disk=Disk2D(marker=Marker2D(body="table", point=(unit * (x - off), -unit * HIGH))),
        )
        for k, (x,) in enumerate(places(feet, True, uneven).tolist())
    ]  # fmt: skip
    return Model(name="table", gravity=(0.0, -unit * GRAVITY), bodies=bodies, joints=joints, contacts=contacts)


def in_space(feet, *, uneven=False, off=0.0, tilt=0.0, mu=0.6, unit=1.0, drop=0.0, bounce=0.0, support=None):
    lean = RotationVector(vector=(0.0, tilt, 0.0))
    speed = (0.0, 0.0, 0.0) if support is None else tuple(unit * REACH * TURN * np.array((support[0], 0.0, support[1])))
    high = unit * (HIGH + drop)
    table = RigidBody3D(
        name="table", mass=2.0, inertia=(0.3 * unit**2, 0.35 * unit**2, 0.5 * unit**2), attitude=lean, velocity=speed,
        position=(np.sin(tilt) * high, 0.0, np.cos(tilt) * high),
    )  # fmt: skip
    bodies, joints, floor = [table], [], HalfSpace3D(marker=Marker3D(attitude=lean))
    if support is not None:
        bodies.append(RigidBody3D(name="plate", mass=10.0, inertia=(1.0, 1.0, 1.0), velocity=speed))
        floor = HalfSpace3D(marker=Marker3D(body="plate"))
        along = RotationVector(vector=(0.0, float(np.arctan2(*support)), 0.0))
        ends = {"a": Marker3D(attitude=along), "b": Marker3D(body="plate", attitude=along)}
        motion = Sine(amplitude=REACH * unit, angular_frequency=TURN)
        joints = [Prismatic3D(name="guide", **ends), PositionDriver3D(name="led", **ends, position=motion)]
    contacts = [
        SphereOnHalfSpace3D(
            name=f"foot{k}", plane=floor, **laws(mu, bounce),
            sphere=Sphere3D(
                marker=Marker3D(body="table", point=tuple(unit * np.array((x - off, y + 0.5 * off, -HIGH)))), radius=0.0
            ),
        )
        for k, (x, y) in enumerate(places(feet, False, uneven).tolist())
    ]  # fmt: skip
    return Model(name="table", gravity=(0.0, 0.0, -unit * GRAVITY), bodies=bodies, joints=joints, contacts=contacts)


@pytest.mark.parametrize("feet", [4, 7, *(pytest.param(n, marks=pytest.mark.full) for n in (3, 5, 6, 8))])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("make", [in_plane, in_space])
def test_nothing_happens_once_it_stands(make, kind, feet):
    how = KINDS[kind]
    # until when the last bounce of 1 mm has died away
    stands = 0.3 if "drop" in how else 0.0
    result = simulate(make(feet, **how), 2.0, **STEADY)
    assert [(e.t, e.kind, e.contact) for e in result.events if e.t > stands] == []
    assert {e.contact for e in result.events if e.kind in ("close", "rest")} <= {f"foot{k}" for k in range(feet)}
    later = result.t > stands
    assert np.count_nonzero(later) > 1
    total = sum(result[f"foot{k}.normal_force"][later] for k in range(feet))
    unit, support = how.get("unit", 1.0), how.get("support", (0.0, 0.0))
    up = -support[1] * REACH * TURN**2 * np.sin(TURN * result.t[later])
    np.testing.assert_allclose(total, 2.0 * unit * (GRAVITY * np.cos(how.get("tilt", 0.0)) + up), rtol=1e-6)
    if "support" not in how:
        assert np.max(np.abs(result.v[later])) < 1e-12 * unit
