"""LuGre's friction in space: lifted models, invariance, Stribeck's curve, pre-sliding, circles, ledger."""

import math

import numpy as np
import pytest
from helpers import G, events, on
from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    Axes,
    Box3D,
    Capsule3D,
    CapsuleOnCapsule3D,
    ContactGroup3D,
    CoordinateDriver,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    Ellipsoid3D,
    HalfPlane2D,
    HalfSpace3D,
    KelvinVoigt,
    LuGreFriction,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    PointMass2D,
    PointMass3D,
    Polynomial,
    Ramp,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    Simulation,
    Sine,
    SmoothOnHalfSpace3D,
    Sphere3D,
    SphereInSphere3D,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
    simulate,
)

TIGHT = {"rtol": 1e-9, "atol": 1e-12}
MASS, STIFFNESS = 2.0, 1e5
NORMAL = MASS * G
LAW = KelvinVoigt(stiffness=STIFFNESS, damping=300.0)
MU, STATIC, STRIBECK, S0, S1, S2 = 0.3, 0.5, 0.01, 1e4, 60.0, 1.0
BRISTLES = LuGreFriction(
    coefficient=MU, static_coefficient=STATIC, stribeck_speed=STRIBECK, bristle_stiffness=S0, bristle_damping=S1,
    viscous_damping=S2,
)  # fmt: skip
DOWN = (0.0, 0.0, -G)


def sphere(name, radius=0.0):
    return Sphere3D(marker=Marker3D(body=name), radius=radius)


def resting(*forces, place=(0.0, 0.0), velocity=(0.0, 0.0), joints=()):
    """A block in static equilibrium on the floor."""
    block = PointMass3D(name="block", mass=MASS, position=(*place, -NORMAL / STIFFNESS), velocity=(*velocity, 0.0))
    floor = SphereOnHalfSpace3D(name="c", plane=HalfSpace3D(), sphere=sphere("block"), law=LAW, friction=BRISTLES)
    return Model(bodies=[block], contacts=[floor], forces=forces, joints=joints, gravity=DOWN)


def pull(signal, way):
    c, s = way
    parts = {
        "force_x": signal.model_copy(update=_scaled(signal, c)),
        "force_y": signal.model_copy(update=_scaled(signal, s)),
    }
    return AppliedForce3D(name="pull", marker=Marker3D(body="block"), **parts)


def _scaled(signal, by):
    names = [name for name in ("amplitude", "before", "after") if name in type(signal).model_fields]
    return {name: by * getattr(signal, name) for name in names}


def ball(radius=0.15, **start):
    return RigidBody3D(name="ball", mass=MASS, inertia=(0.02, 0.02, 0.02), **start)


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
    assert rubs.max() < tolerance * NORMAL
    assert [e.kind for e in flat.events] == [e.kind for e in space.events]


def test_lifted_block_that_breaks_away():
    load, steps = Ramp(start=0.0, duration=10.0, before=0.0, after=50.0), {"step": 2e-3}
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
        assert np.abs(flat["block.x"] - moved).max() < 1e-10 and moved[-1] > 1.0
        bent = way[0] * space["c.bristle_x"] + way[1] * space["c.bristle_y"]
        compare(flat, space, {"block.y": "block.z", "block.vy": "block.vz"}, 1e-10, bent)


def test_lifted_ball_rolls_over_another():
    """Down a fixed ball, its bristles carried parallel to themselves as the normal turns: as in the plane, to 1e-10."""
    fixed, radius, start = 0.5, 0.15, 0.3
    reach = fixed + radius - 1e-4
    place = reach * math.sin(start), reach * math.cos(start)
    wheel = RigidBody2D(name="ball", mass=MASS, inertia=0.02, position=place)
    shapes = Disk2D(marker=Marker2D(), radius=fixed), Disk2D(marker=on("ball"), radius=radius)
    steps = {"step": 2e-4}
    contact = DiskOnDisk2D(name="c", a=shapes[0], b=shapes[1], law=LAW, friction=BRISTLES)
    flat = simulate(Model(bodies=[wheel], contacts=[contact], gravity=(0.0, -G)), 0.35, "irk", **steps)
    contact = SphereOnSphere3D(
        name="c", a=sphere("ground", fixed), b=sphere("ball", radius), law=LAW, friction=BRISTLES
    )
    body = ball(position=(place[0], 0.0, place[1]))
    space = simulate(Model(bodies=[body], contacts=[contact], gravity=DOWN), 0.35, "irk", **steps)
    x, z = space["ball.x"], space["ball.z"]
    assert math.atan2(x[-1], z[-1]) - start > 0.3
    # the planar tangent is the normal, turned by -90 degrees
    bent = (z * space["c.bristle_x"] - x * space["c.bristle_z"]) / np.hypot(x, z)
    turns = {"ball.angular_velocity": "ball.angular_velocity_y"}
    assert np.abs(flat["ball.angular_velocity"] + space["ball.angular_velocity_y"]).max() < 1e-10 * 20.0, turns
    compare(flat, space, {"ball.x": "ball.x", "ball.y": "ball.z", "ball.vx": "ball.vx"}, 1e-10, bent)
    assert np.abs(space["c.bristle_y"]).max() == 0.0 and np.abs(bent).max() > 1e-5
    across = (x * space["c.bristle_x"] + z * space["c.bristle_z"]) / np.hypot(x, z)
    assert np.abs(across).max() < 1e-9 * np.abs(bent).max()


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
    from tlismni.core import AngleDriver3D, Revolute3D

    joints = [
        Revolute3D(name="pin", a=Marker3D(), b=Marker3D(body="table")),
        AngleDriver3D(name="turn", a=Marker3D(), b=Marker3D(body="table"), motion=Polynomial(coefficients=(0.0, rate))),
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


# ---- the law --------------------------------------------------------------------------------------------------------


def driven(x, y):
    motions = {"x": x, "y": y}
    return [CoordinateDriver(name=f"drive_{c}", body="block", coordinate=c, motion=m) for c, m in motions.items()]


@pytest.mark.parametrize("speed", [0.002, 0.01, 0.05, 0.5])
@pytest.mark.parametrize("angle", [0.6, 2.5, -1.9])
def test_steady_sliding_lies_on_the_stribeck_curve_against_the_slip(speed, angle):
    way = np.array([math.cos(angle), math.sin(angle)])
    x, y = (Polynomial(coefficients=(0.0, speed * c)) for c in way)
    model = resting(velocity=tuple(speed * way), joints=driven(x, y))
    result = simulate(model, 12.0 * STATIC * NORMAL / S0 / speed, **TIGHT)
    g = NORMAL * (MU + (STATIC - MU) * math.exp(-((speed / STRIBECK) ** 2)))
    assert result["c.friction_force"][-1] == pytest.approx(g + S2 * speed, rel=1e-4)
    bent = np.array([result["c.bristle_x"], result["c.bristle_y"]])
    assert bent[:, -1] == pytest.approx(g / S0 * way, rel=1e-4)
    assert np.hypot(*bent).max() <= STATIC * NORMAL / S0 * (1.0 + 1e-6)
    pulls = np.array([result[f"drive_{c}.reaction"][-1] for c in "xy"])
    assert pulls == pytest.approx((g + S2 * speed) * way, rel=1e-4)
    assert np.abs(result["energy.balance"]).max() < 1e-7


@pytest.mark.parametrize("angle", [0.0, 0.8, 2.0])
def test_small_oscillations_feel_the_bristles_stiffness_in_every_direction(angle):
    amplitude, way = 0.01 * STATIC * NORMAL, (math.cos(angle), math.sin(angle))
    load = Sine(amplitude=amplitude, angular_frequency=2.0 * math.pi)
    result = simulate(resting(pull(load, way)), 3.0, **TIGHT)
    late = result.t > 1.0
    along = (way[0] * result["block.x"] + way[1] * result["block.y"])[late]
    across = (way[0] * result["block.y"] - way[1] * result["block.x"])[late]
    assert np.abs(along - along.mean()).max() == pytest.approx(amplitude / S0, rel=2e-2)
    assert np.abs(across).max() < 1e-12


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_on_a_circle_the_force_turns_with_the_slip(sense):
    """At constant |u| and turning direction z = u/(h + i w), F = -(s0 z + s1 i w z + s2 u) in the complex plane."""
    rate, radius = 4.0 * sense, 0.02
    speed = abs(rate) * radius
    x = Sine(amplitude=radius, angular_frequency=rate, phase=0.5 * math.pi)
    y = Sine(amplitude=radius, angular_frequency=rate)
    result = simulate(resting(place=(radius, 0.0), velocity=(0.0, rate * radius), joints=driven(x, y)), 6.0, **TIGHT)
    h = S0 * speed / (NORMAL * (MU + (STATIC - MU) * math.exp(-((speed / STRIBECK) ** 2))))
    u = 1j * rate * radius * np.exp(1j * rate * result.t)
    z = u / (h + 1j * rate)
    force = -(S0 * z + S1 * 1j * rate * z + S2 * u)
    late = result.t > 3.0
    assert np.abs(result["c.bristle_x"] + 1j * result["c.bristle_y"] - z)[late].max() < 1e-6 * np.abs(z).max()
    assert result["c.friction_force"][late] == pytest.approx(np.abs(force)[late], rel=1e-6)
    inertia = -MASS * rate**2 * radius * np.exp(1j * rate * result.t)
    held = result["drive_x.reaction"] + 1j * result["drive_y.reaction"]
    assert np.abs(held - (inertia - force))[late].max() < 1e-4 * np.abs(force).max()
    assert np.abs(result["energy.balance"]).max() < 1e-7


# ---- contacts that open, other shapes -------------------------------------------------------------------------------


def test_bristles_stand_straight_while_the_contact_is_open():
    """A ball that bounces and rubs: deflection zero in the air, and the ledger knows what is let go."""
    result = simulate(_bouncing(), 1.0, **TIGHT)
    assert len(events(result, "open")) >= 2
    touch = np.array([event.t for event in result.events])
    away = (result["c.in_contact"] == 0.0) & (np.abs(result.t[:, None] - touch).min(axis=1) > 1e-9)
    bent = np.hypot(result["c.bristle_x"], result["c.bristle_y"])
    assert away.any() and np.all(bent[away] == 0.0) and bent.max() > 1e-5
    assert np.abs(result["energy.balance"]).max() < 1e-6


def _bouncing(release="gap"):
    body = ball(position=(0.0, 0.0, 0.3), velocity=(0.8, 0.6, 0.0), angular_velocity=(2.0, 0.0, 4.0))
    law = LAW.model_copy(update={"release_rule": release})
    floor = SphereOnHalfSpace3D(name="c", plane=HalfSpace3D(), sphere=sphere("ball", 0.15), law=law, friction=BRISTLES)
    return Model(bodies=[body], contacts=[floor], gravity=DOWN)


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


def test_box_stands_on_a_slope():
    """Held by the bristles of its corners; the forces along the slope are its weight's part."""
    slope = 0.2
    plane = Marker3D(
        attitude=Axes(x=(math.cos(slope), 0.0, -math.sin(slope)), z=(math.sin(slope), 0.0, math.cos(slope)))
    )
    high = 0.1 - 0.25 * NORMAL * math.cos(slope) / STIFFNESS
    box = RigidBody3D(
        name="box", mass=MASS, inertia=(0.02, 0.02, 0.02),
        position=(high * math.sin(slope), 0.0, high * math.cos(slope)),
        attitude=RotationVector(vector=(0.0, slope, 0.0)),
    )  # fmt: skip
    group = ContactGroup3D(
        name="g", boxes=(Box3D(marker=Marker3D(body="box"), size=(0.3, 0.3, 0.2)),),
        half_spaces=(HalfSpace3D(marker=plane),), law=LAW, friction=BRISTLES,
    )  # fmt: skip
    result = simulate(Model(bodies=[box], groups=[group], gravity=DOWN), 0.5, rtol=1e-7, atol=1e-10)
    names = [name for name in result.channels if name.endswith(".friction_force")]
    held = sum(result[name][-1] for name in names)
    assert len(names) == 8 and held == pytest.approx(NORMAL * math.sin(slope), rel=2e-2)
    assert abs(result["box.x"][-1] - result["box.x"][0]) < 5e-3
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_egg_rolls_on_the_floor_and_a_marble_in_a_bowl():
    egg = RigidBody3D(
        name="egg", mass=1.0, inertia=(2e-3, 4e-3, 5e-3), position=(0.0, 0.0, 0.099), angular_velocity=(4.0, 6.0, 1.0)
    )
    shape = Ellipsoid3D(marker=Marker3D(body="egg"), half_axes=(0.15, 0.12, 0.1))
    floor = SmoothOnHalfSpace3D(name="floor", plane=HalfSpace3D(), shape=shape, law=LAW, friction=BRISTLES)
    marble = ball(position=(0.2, 0.0, -math.sqrt(0.35**2 - 0.04)), velocity=(0.0, 0.6, 0.0))
    bowl = SphereInSphere3D(
        name="bowl", hollow=sphere("ground", 0.5), sphere=sphere("ball", 0.15), law=LAW, friction=BRISTLES
    )
    model = Model(bodies=[egg, marble], contacts=[floor, bowl], gravity=DOWN)
    result = simulate(model, 1.0, rtol=1e-8, atol=1e-11)
    assert np.abs(result["energy.balance"]).max() < 1e-6
    # the marble goes round in the bowl by more than a quarter of a turn; its bristles stay in the tangent plane
    places = np.array([result[f"ball.{axis}"] for axis in "xyz"])
    bent = np.array([result[f"bowl.bristle_{axis}"] for axis in "xyz"])
    normal = places / np.linalg.norm(places, axis=0)
    assert np.ptp(np.unwrap(np.arctan2(places[1], places[0]))) > 2.0
    assert np.abs((normal * bent).sum(axis=0)).max() < 1e-6 * np.linalg.norm(bent, axis=0).max()


# ---- the record -----------------------------------------------------------------------------------------------------


def test_names_and_sizes():
    assembly = resting().assemble()
    assert assembly.coordinate_names[-2:] == ["c.bristle_x", "c.bristle_y"]
    assert assembly.n_internal == 2 and np.isinf(assembly.leap[-2:]).all()
    assert {"c.bristle_x", "c.bristle_y"} < set(simulate(resting(), 0.01).channels)
    two = SphereOnSphere3D(name="c", a=sphere("ground", 0.2), b=sphere("ball", 0.1), law=LAW, friction=BRISTLES)
    assert tuple(two.internal_coordinates()) == ("bristle_x", "bristle_y", "bristle_z")


def test_json_round_trip():
    assert Model.from_json(resting().to_json()) == resting()


def test_state_goes_on_bit_for_bit():
    run = Simulation(_bouncing())
    run.advance(0.25)
    state = run.state()
    assert np.hypot(*run.state_v()[-2:]) > 0.0 if hasattr(run, "state_v") else True
    run.advance(1.0)
    again = Simulation(_bouncing())
    again.restore(state)
    again.advance(1.0)
    assert np.array_equal(run.values(), again.values())


def test_shapes_whose_bristles_are_not_carried_are_refused():
    rod = Capsule3D(marker=Marker3D(body="rod"), length=0.3, radius=0.05)
    with pytest.raises(ModelError, match=r"contact 'c' is a CapsuleOnCapsule3D, .* BrownMcPhee"):
        CapsuleOnCapsule3D(name="c", a=rod, b=sphere("ball", 0.1), law=LAW, friction=BRISTLES)
