"""Coulomb friction of contacts in space: closed forms of the sphere, cones, sticking and sliding of bodies."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    Box3D,
    CoulombFriction,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    PointMass3D,
    PoissonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
    contacts_between,
    simulate,
)
from tlismni.models import load

G, R, UP = 9.81, 0.1, np.array([0.0, 0.0, 1.0])


def thrown(v, w, height=0.0, mu=0.3, law=None, plane=None, mass=1.0, **more):
    moment = 0.4 * mass * R**2
    body = RigidBody3D(
        name="ball", mass=mass, inertia=(moment,) * 3, position=(0.0, 0.0, height + R), velocity=tuple(v),
        angular_velocity=tuple(w),
    )  # fmt: skip
    floor = SphereOnHalfSpace3D(
        name="floor", plane=plane or HalfSpace3D(), sphere=Sphere3D(marker=Marker3D(body="ball"), radius=R),
        law=law or NewtonImpact(restitution=0.5), friction=CoulombFriction(coefficient=mu, **more),
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=[floor])


def at_end(result, body="ball"):
    v = np.array([result[f"{body}.v{axis}"][-1] for axis in "xyz"])
    return v, np.array([result[f"{body}.angular_velocity_{axis}"][-1] for axis in "xyz"])


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf", "adams"])
def test_sphere_slides_until_it_rolls(method):
    """It rolls after |slip|/(3.5 mu g) with (5 v + 2 R w x n)/7, and goes on so."""
    v, w = np.array([2.0, -0.5, 0.0]), np.array([3.0, 8.0, 5.0])
    slip = v - R * np.cross(w, UP)
    result = simulate(thrown(v, w), 1.0, method, rtol=1e-10, atol=1e-12)
    (event,) = [event for event in result.events if event.kind == "stick"]
    assert event.t == pytest.approx(np.linalg.norm(slip) / (3.5 * 0.3 * G), abs=1e-8)
    found, spin = at_end(result)
    rolls = (5.0 * v + 2.0 * R * np.cross(w, UP)) / 7.0
    assert found == pytest.approx(rolls, abs=1e-8)
    assert found - R * np.cross(spin, UP) == pytest.approx(np.zeros(3), abs=1e-10)
    assert spin[2] == pytest.approx(5.0, abs=1e-5)
    assert result["floor.friction_force"][1] == pytest.approx(0.3 * G, rel=1e-9)
    assert abs(result["floor.friction_force"][-1]) < 1e-8
    balance = result["energy.balance"]
    assert np.abs(balance - balance[0]).max() < 1e-7
    lost = 0.5 * (slip @ slip) / 3.5
    assert result["floor.dissipation"][-1] == pytest.approx(lost, rel=1e-7)


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.6), PoissonImpact(restitution=0.6)])
@pytest.mark.parametrize("mu, spin", [(0.1, 60.0), (0.4, 5.0), (0.0, 20.0)])
def test_blow_of_a_sphere_with_spin(law, mu, spin):
    """P_N = m (1 + e) |v_n|, P_T = min(mu P_N, 2/7 m |slip|) against the slip, every blow to 1e-10."""
    v, w = np.array([1.0, 0.7, 0.0]), np.array([0.3 * spin, spin, -0.5 * spin])
    result = simulate(thrown(v, w, height=0.4, mu=mu, law=law, mass=2.0), 1.1, rtol=1e-12, atol=1e-13)
    blows = [event for event in result.events if event.kind == "impact"]
    assert len(blows) >= 3
    down = math.sqrt(2.0 * G * 0.4)
    for blow in blows:
        slip = v - R * np.cross(w, UP)
        normal = 2.0 * 1.6 * down
        along = min(mu * normal, 2.0 / 7.0 * 2.0 * np.linalg.norm(slip))
        assert blow.impulse == pytest.approx(normal, rel=1e-10)
        assert blow.friction_impulse == pytest.approx(along, abs=1e-10)
        push = -along * slip / max(np.linalg.norm(slip), 1e-300)
        v, w = v + push / 2.0, w + np.cross(-R * UP, push) / (0.4 * 2.0 * R**2)
        down *= 0.6
    found, turning = at_end(result)
    assert found[:2] == pytest.approx(v[:2], abs=1e-10)
    assert turning == pytest.approx(w, abs=1e-8)


def test_ball_rolls_down_a_slope_or_slides():
    """5/7 g sin(slope) while mu > 2/7 tan(slope), else g (sin - mu cos), with the direction of sliding turning."""
    slope = 0.5
    normal = np.array([math.sin(slope), 0.0, math.cos(slope)])
    down = np.array([math.cos(slope), 0.0, -math.sin(slope)])
    for mu, pull in ((0.3, 5.0 / 7.0 * G * math.sin(slope)), (0.1, G * (math.sin(slope) - 0.1 * math.cos(slope)))):
        moment = 0.4 * R**2
        body = RigidBody3D(name="ball", mass=1.0, inertia=(moment,) * 3, position=tuple(R * normal))
        plane = HalfSpace3D(marker=Marker3D(attitude=Axes(z=tuple(normal))))
        floor = SphereOnHalfSpace3D(
            name="floor", plane=plane, sphere=Sphere3D(marker=Marker3D(body="ball"), radius=R),
            law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=mu),
        )  # fmt: skip
        result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=[floor]), 1.0, rtol=1e-10, atol=1e-12)
        v, _ = at_end(result)
        assert v == pytest.approx(pull * down, abs=1e-8)


def test_point_thrown_across_a_slope_turns_into_its_fall_line():
    """A point mass: |v| (1 + cos a) grows as the closed form of the sleigh says; where mu = tan(slope),
    v + v_down is constant."""
    slope = 0.4
    normal = np.array([math.sin(slope), 0.0, math.cos(slope)])
    down = np.array([math.cos(slope), 0.0, -math.sin(slope)])
    mass = PointMass3D(name="m", mass=1.0, position=(0.0, 0.0, 0.0), velocity=(0.0, 1.5, 0.0))
    plane = HalfSpace3D(marker=Marker3D(attitude=Axes(z=tuple(normal))))
    floor = SphereOnHalfSpace3D(
        name="floor", plane=plane, sphere=Sphere3D(marker=Marker3D(body="m")), law=NewtonImpact(restitution=0.0),
        friction=CoulombFriction(coefficient=math.tan(slope)),
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[mass], contacts=[floor]), 3.0, rtol=1e-10, atol=1e-12)
    v = np.array([result[f"m.v{axis}"] for axis in "xyz"])
    assert np.abs(np.linalg.norm(v, axis=0) + down @ v - 1.5).max() < 1e-7
    # at the end half the speed, straight down
    assert (down @ v)[-1] == pytest.approx(0.75, abs=2e-3)
    assert not [event for event in result.events if event.kind == "stick"]


def test_point_thrown_up_a_slope_stops_or_comes_back():
    slope, mu = 0.4, 0.3
    normal = np.array([math.sin(slope), 0.0, math.cos(slope)])
    up = -np.array([math.cos(slope), 0.0, -math.sin(slope)])
    plane = HalfSpace3D(marker=Marker3D(attitude=Axes(z=tuple(normal))))
    for friction, back in ((CoulombFriction(coefficient=mu), True), (CoulombFriction(coefficient=0.6), False)):
        mass = PointMass3D(name="m", mass=1.0, velocity=tuple(2.0 * up))
        floor = SphereOnHalfSpace3D(
            name="floor", plane=plane, sphere=Sphere3D(marker=Marker3D(body="m")), law=NewtonImpact(restitution=0.0),
            friction=friction,
        )  # fmt: skip
        result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[mass], contacts=[floor]), 1.0, rtol=1e-10, atol=1e-12)
        brake = G * (math.sin(slope) + friction.coefficient * math.cos(slope))
        stop = 2.0 / brake
        kinds = [(event.kind, event.t) for event in result.events if event.kind in ("stick", "slip")]
        assert kinds[0][1] == pytest.approx(stop, abs=1e-8)
        v = np.array([result[f"m.v{axis}"][-1] for axis in "xyz"])
        pull = G * (math.sin(slope) - mu * math.cos(slope)) if back else 0.0
        assert v == pytest.approx(-pull * (1.0 - stop) * up, abs=1e-7)


def test_oblique_blow_of_two_spheres_with_friction_keeps_all_momentum():
    moment = 0.4 * R**2
    first = RigidBody3D(
        name="a", mass=1.0, inertia=(moment,) * 3, position=(-1.0, 0.05, 0.02), velocity=(3.0, 0.0, 0.0),
        angular_velocity=(10.0, 20.0, -30.0),
    )  # fmt: skip
    second = RigidBody3D(name="b", mass=2.0, inertia=(2.0 * moment,) * 3, angular_velocity=(5.0, 0.0, 8.0))
    blow = SphereOnSphere3D(
        name="blow", a=Sphere3D(marker=Marker3D(body="a"), radius=R), b=Sphere3D(marker=Marker3D(body="b"), radius=R),
        law=NewtonImpact(restitution=0.5), friction=CoulombFriction(coefficient=0.1),
    )  # fmt: skip
    bodies = [first, second]
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, contacts=[blow]), 0.6, rtol=1e-12, atol=1e-13)
    (event,) = result.events
    assert event.friction_impulse == pytest.approx(0.1 * event.impulse, rel=1e-9)
    for at in (0, -1):
        momentum, turning = np.zeros(3), np.zeros(3)
        for body in bodies:
            x, v = (np.array([result[f"{body.name}.{d}{axis}"][at] for axis in "xyz"]) for d in ("", "v"))
            w = np.array([result[f"{body.name}.angular_velocity_{axis}"][at] for axis in "xyz"])
            momentum += body.mass * v
            turning += body.mass * np.cross(x, v) + body.inertia[0] * w
        if at == 0:
            before = momentum, turning
    assert momentum == pytest.approx(before[0], abs=1e-10)
    assert turning == pytest.approx(before[1], abs=1e-9)
    lost = result["energy.kinetic"][0] - result["energy.kinetic"][-1]
    assert event.energy_loss == pytest.approx(lost, rel=1e-8)


def test_box_slides_on_its_face_and_stops():
    """Four corners, one of them more than a body needs: v^2/(2 mu g) is its way."""
    mu, v = 0.3, 1.2
    body = RigidBody3D(
        name="box", mass=2.0, inertia=(0.02, 0.03, 0.04), position=(0.0, 0.0, 0.1), velocity=(v, 0.0, 0.0)
    )
    box = Box3D(marker=Marker3D(body="box"), size=(0.4, 0.3, 0.2))
    floor = contacts_between(
        "floor", [HalfSpace3D()], [box], law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=mu)
    )
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=floor), 1.0, rtol=1e-9, atol=1e-11)
    assert result["box.x"][-1] == pytest.approx(v * v / (2.0 * mu * G), rel=1e-6)
    assert abs(result["box.vx"][-1]) < 1e-9
    assert sum(result[f"{contact.name}.normal_force"][-1] for contact in floor) == pytest.approx(2.0 * G, rel=1e-9)


@pytest.mark.parametrize("spin", [(0.5, -0.4, 0.0), (2.0, 1.0, 3.0)])
def test_box_dropped_on_a_corner_comes_to_rest(spin):
    body = RigidBody3D(
        name="box", mass=2.0, inertia=(0.02, 0.03, 0.04), position=(0.0, 0.0, 0.5),
        attitude=Axes(z=(0.3, 0.2, 1.0)), angular_velocity=spin, velocity=(0.3, 0.1, 0.0),
    )  # fmt: skip
    box = Box3D(marker=Marker3D(body="box"), size=(0.4, 0.3, 0.2))
    law = PoissonImpact(restitution=0.2, rest_ratio=1e-3)
    floor = contacts_between("floor", [HalfSpace3D()], [box], law=law, friction=CoulombFriction(coefficient=0.4))
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=floor), 2.0)
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.all(np.diff(total) < 1e-7 * total[0])
    assert result["energy.kinetic"][-1] < 1e-10
    assert min(result[f"{contact.name}.gap"].min() for contact in floor) > -1e-9


@pytest.mark.sampled(8)
@pytest.mark.parametrize("friction", [0.3, 0.8])
@pytest.mark.parametrize("seed", range(12))
def test_boxes_dropped_in_any_attitude_come_to_rest(seed, friction):
    """On edges and faces, which turn, slide and stop; several corners stop at one instant, one of them too many."""
    random = np.random.default_rng(seed)
    scenario = load(
        "dropped_box", friction=friction, tilt_x=random.uniform(-1, 1), tilt_y=random.uniform(-1, 1),
        tilt_z=random.uniform(-3, 3), velocity_x=random.uniform(-1, 1), restitution=random.uniform(0, 0.5),
    )  # fmt: skip
    tolerance = 10.0 ** random.uniform(-9, -5)
    result = simulate(scenario.model, 3.0, rtol=tolerance, atol=0.01 * tolerance)
    names = [contact.name for contact in scenario.model.contacts]
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.all(np.diff(total) < 30.0 * tolerance * total[0])
    assert result["energy.kinetic"][-1] < 1e-12
    assert min(result[f"{name}.gap"].min() for name in names) > -1e-9
    weight = scenario.model.bodies[0].mass * G
    assert sum(result[f"{name}.normal_force"][-1] for name in names) == pytest.approx(weight, rel=1e-8)
    for name in names:
        assert np.all(result[f"{name}.friction_force"] <= friction * result[f"{name}.normal_force"] * (1 + 1e-6) + 1e-9)
