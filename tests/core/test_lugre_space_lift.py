"""LuGre's friction in space: planar models lifted into it, and models that are turned."""

import math

import numpy as np
import pytest
from helpers import G, events, on
from lugre_models import BRISTLES, DOWN, LAW, MASS, NORMAL, STIFFNESS, TIGHT, ball, pull, resting, sphere
from tlismni.core import (
    AngleDriver3D,
    AppliedForce2D,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    PointMass2D,
    PointMass3D,
    Polynomial,
    Ramp,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
    simulate,
)

# ---- lifted models --------------------------------------------------------------------------------------------------


def compare(flat, space, axes, tolerance, bristle):
    """Channels of the planar run against those in its plane; `bristle` says the deflection of the one in space."""
    for name, other in axes.items():
        size = max(1.0, np.abs(flat[name]).max())
        assert np.abs(flat[name] - space[other]).max() < tolerance * size, name
    assert np.abs(flat["c.bristle"] - bristle).max() < tolerance
    for name in ("c.gap", "c.normal_force", "c.dissipation", "energy.strain", "energy.kinetic"):
        assert np.abs(flat[name] - space[name]).max() < tolerance * max(1.0, np.abs(flat[name]).max()), name
    rubs = np.abs(np.abs(flat["c.friction_force"]) - space["c.friction_force"])
    assert rubs.max() < 10.0 * tolerance * NORMAL
    assert [e.kind for e in flat.events] == [e.kind for e in space.events]


def test_lifted_block_that_breaks_away():
    load, steps = Ramp(start=0.0, duration=10.0, before=0.0, after=50.0), {"step": 2e-3, "newton_tolerance": 1e-13}
    block = PointMass2D(name="block", mass=MASS, position=(0.0, -NORMAL / STIFFNESS))
    floor = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("block")), law=LAW, friction=BRISTLES
    )
    force = AppliedForce2D(name="pull", marker=on("block"), force_x=load)
    flat = simulate(Model(bodies=[block], contacts=[floor], forces=[force], gravity=(0.0, -G)), 2.5, "irk", **steps)
    for angle in (0.0, 0.9):
        way = math.cos(angle), math.sin(angle)
        space = simulate(resting(pull(load, way)), 2.5, "irk", **steps)
        moved = way[0] * space["block.x"] + way[1] * space["block.y"]
        assert np.abs(flat["block.x"] - moved).max() < 1e-10 and moved[-1] > 0.5
        bent = way[0] * space["c.bristle_x"] + way[1] * space["c.bristle_y"]
        compare(flat, space, {"block.y": "block.z", "block.vy": "block.vz"}, 1e-10, bent)


def test_lifted_ball_rolls_over_another():
    """Down a fixed ball, its bristles carried parallel to themselves as the normal turns: as in the plane, to 1e-10."""
    fixed, radius, start = 0.5, 0.15, 0.3
    reach = fixed + radius - 1e-4
    place = reach * math.sin(start), reach * math.cos(start)
    wheel = RigidBody2D(name="ball", mass=MASS, inertia=0.02, position=place)
    shapes = Disk2D(marker=Marker2D(), radius=fixed), Disk2D(marker=on("ball"), radius=radius)
    steps = {"step": 2e-4, "newton_tolerance": 1e-13}
    contact = DiskOnDisk2D(name="c", a=shapes[0], b=shapes[1], law=LAW, friction=BRISTLES)
    flat = simulate(Model(bodies=[wheel], contacts=[contact], gravity=(0.0, -G)), 0.5, "irk", **steps)
    contact = SphereOnSphere3D(
        name="c", a=sphere("ground", fixed), b=sphere("ball", radius), law=LAW, friction=BRISTLES
    )
    body = ball(position=(place[0], 0.0, place[1]))
    space = simulate(Model(bodies=[body], contacts=[contact], gravity=DOWN), 0.5, "irk", **steps)
    x, z = space["ball.x"], space["ball.z"]
    assert math.atan2(x[-1], z[-1]) - start > 0.3
    # the planar tangent is the normal, turned by -90 degrees
    bent = (z * space["c.bristle_x"] - x * space["c.bristle_z"]) / np.hypot(x, z)
    assert np.abs(flat["ball.angular_velocity"] + space["ball.angular_velocity_y"]).max() < 1e-9
    compare(flat, space, {"ball.x": "ball.x", "ball.y": "ball.z", "ball.vx": "ball.vx"}, 1e-10, bent)
    assert np.abs(space["c.bristle_y"]).max() == 0.0 and np.abs(bent).max() > 1e-5
    across = (x * space["c.bristle_x"] + z * space["c.bristle_z"]) / np.hypot(x, z)
    assert np.abs(across).max() < 1e-9 * np.abs(bent).max()


@pytest.mark.sampled(1)
@pytest.mark.parametrize("release", ["gap", "force"])
def test_lifted_ball_bounces_as_in_the_plane(release):
    law = LAW.model_copy(update={"release_rule": release})
    disk = RigidBody2D(
        name="ball", mass=MASS, inertia=0.02, position=(0.0, 0.3), velocity=(1.0, 0.0), angular_velocity=2.0
    )
    floor = DiskOnHalfPlane2D(
        name="c", plane=HalfPlane2D(), disk=Disk2D(marker=on("ball"), radius=0.15), law=law, friction=BRISTLES
    )
    times = {"t_eval": np.linspace(0.0, 1.0, 101), "rtol": 1e-11, "atol": 1e-13}
    flat = simulate(Model(bodies=[disk], contacts=[floor], gravity=(0.0, -G)), 1.0, "irk", **times)
    body = ball(position=(0.0, 0.0, 0.3), velocity=(0.8, 0.6, 0.0), angular_velocity=(1.2, -1.6, 0.0))
    contact = SphereOnHalfSpace3D(
        name="c", plane=HalfSpace3D(), sphere=sphere("ball", 0.15), law=law, friction=BRISTLES
    )
    space = simulate(Model(bodies=[body], contacts=[contact], gravity=DOWN), 1.0, "irk", **times)
    assert [e.kind for e in flat.events] == [e.kind for e in space.events] and len(flat.events) >= 4
    for one, other in zip(flat.events, space.events, strict=True):
        assert one.t == pytest.approx(other.t, abs=1e-9)
    assert np.abs(0.8 * space["ball.x"] + 0.6 * space["ball.y"] - flat["ball.x"]).max() < 1e-8
    spin = 0.6 * space["ball.angular_velocity_x"] - 0.8 * space["ball.angular_velocity_y"]
    assert np.abs(spin - flat["ball.angular_velocity"]).max() < 1e-7
    assert flat["c.dissipation"] == pytest.approx(space["c.dissipation"], abs=1e-7)


# ---- invariance -----------------------------------------------------------------------------------------------------


def turned(angle, vector):
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = vector
    return c * x - s * y, s * x + c * y, z


def thrown(angle, spin=(3.0, -8.0, 5.0), marker=0.0, lower=False):
    """A ball thrown onto the floor or onto a fixed ball below it, all turned about the vertical by an angle; the axes
    of the first marker by another."""
    body = ball(
        position=turned(angle, (0.1, -0.05, 0.3)), velocity=turned(angle, (1.0, 0.4, 0.0)),
        angular_velocity=turned(angle, spin),
    )  # fmt: skip
    at = Marker3D(point=(0.0, 0.0, -0.6 if lower else 0.0), attitude=RotationVector(vector=(0.0, 0.0, marker)))
    parts = {"name": "c", "law": LAW, "friction": BRISTLES}
    if lower:
        contact = SphereOnSphere3D(a=Sphere3D(marker=at, radius=0.6), b=sphere("ball", 0.15), **parts)
    else:
        contact = SphereOnHalfSpace3D(plane=HalfSpace3D(marker=at), sphere=sphere("ball", 0.15), **parts)
    return simulate(
        Model(bodies=[body], contacts=[contact], gravity=DOWN), 0.6, **TIGHT, t_eval=np.linspace(0, 0.6, 61)
    )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("lower", [False, True], ids=["floor", "ball"])
def test_turning_all_about_the_vertical_changes_nothing(lower):
    one = thrown(0.0, lower=lower)
    for angle, marker in ((0.7, 0.0), (2.1, 1.3)):
        other = thrown(angle, marker=marker, lower=lower)
        for names in (("x", "y", "z"), tuple(f"angular_velocity_{axis}" for axis in "xyz")):
            here, there = ([run[f"ball.{name}"] for name in names] for run in (one, other))
            assert np.abs(np.array(turned(angle, here)) - there).max() < 1e-7
        bent = [run["c.bristle_x"] ** 2 + run["c.bristle_y"] ** 2 for run in (one, other)]
        if lower:
            bent = [x + run["c.bristle_z"] ** 2 for x, run in zip(bent, (one, other), strict=True)]
        assert np.abs(np.sqrt(bent[0]) - np.sqrt(bent[1])).max() < 1e-8
        for name in ("c.friction_force", "c.dissipation"):
            assert one[name] == pytest.approx(other[name], abs=1e-5)
        assert [e.kind for e in one.events] == [e.kind for e in other.events]
        assert len(events(one, "open")) >= 1


def test_bristles_turn_with_the_floor_that_carries_them():
    """A turntable with a block on it, both at rest relative to each other: bristles turn with the table and hold."""
    rate, load = 2.0, 0.02 * NORMAL
    # on the table at radius r the block needs the force m w^2 r
    place = load / (MASS * rate**2)
    block = PointMass3D(
        name="block", mass=MASS, position=(place, 0.0, -NORMAL / STIFFNESS), velocity=(0.0, rate * place, 0.0)
    )
    table = RigidBody3D(name="table", mass=1.0, inertia=(1.0, 1.0, 1.0), angular_velocity=(0.0, 0.0, rate))
    joints = [
        Revolute3D(name="pin", a=Marker3D(), b=Marker3D(body="table")),
        AngleDriver3D(name="turn", a=Marker3D(), b=Marker3D(body="table"), angle=Polynomial(coefficients=(0.0, rate))),
    ]
    floor = SphereOnHalfSpace3D(
        name="c", plane=HalfSpace3D(marker=Marker3D(body="table")), sphere=sphere("block"), law=LAW, friction=BRISTLES
    )
    model = Model(bodies=[table, block], joints=joints, contacts=[floor], gravity=DOWN)
    result = simulate(model, 6.0, **TIGHT)
    late = result.t > 1.0
    force = result["c.friction_force"][late]
    assert force == pytest.approx(MASS * rate**2 * np.hypot(result["block.x"], result["block.y"])[late], rel=1e-3)
    # in the table's axes the bristles stand still but for creep, though the table makes two turns
    way = np.arctan2(result["c.bristle_y"][late], result["c.bristle_x"][late])
    assert np.ptp(np.unwrap(way)) < 0.15
    assert np.abs(result["energy.balance"]).max() < 1e-6
