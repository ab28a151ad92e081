"""Contacts in space without friction, and with regularised friction: impacts, rest, momentum, energy."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    Box3D,
    EulerParameters,
    HalfSpace3D,
    Hertz,
    KelvinVoigt,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass3D,
    PoissonImpact,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
    TanhFriction,
    contacts_between,
    simulate,
)

G = 9.81


def sphere(name, radius=0.1, mass=1.0, **start):
    moment = 0.4 * mass * radius**2
    body = RigidBody3D(name=name, mass=mass, inertia=(moment,) * 3, **start)
    return body, Sphere3D(marker=Marker3D(body=name), radius=radius)


def angular_momentum(result, bodies, at):
    """About the origin, (3,)."""
    total = np.zeros(3)
    for body in bodies:
        x, v, w = (
            np.array([result[f"{body.name}.{name}"][at] for name in names])
            for names in (
                "xyz", ("vx", "vy", "vz"), ("angular_velocity_x", "angular_velocity_y", "angular_velocity_z"),
            )
        )  # fmt: skip
        total += body.mass * np.cross(x, v) + body.inertia[0] * w
    return total


def test_ball_on_an_inclined_plane_bounces_along_it():
    """Across the plane it bounces as on a floor under g cos(slope); along it it falls freely; the spin stays."""
    slope = 0.3
    normal = np.array([math.sin(slope), 0.0, math.cos(slope)])
    body, ball = sphere("ball", position=tuple(0.6 * normal), angular_velocity=(1.0, 2.0, 3.0))
    plane = HalfSpace3D(marker=Marker3D(attitude=Axes(z=tuple(normal))))
    floor = SphereOnHalfSpace3D(name="floor", plane=plane, sphere=ball, law=NewtonImpact(restitution=0.5))
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=[floor]), 2.0, rtol=1e-10, atol=1e-12)
    fall = math.sqrt(2.0 * 0.5 / (G * math.cos(slope)))
    times = [event.t for event in result.events if event.kind == "impact"]
    for n in range(6):
        expected = fall * (1.0 + 2.0 * sum(0.5**k for k in range(1, n + 1)))
        assert times[n] == pytest.approx(expected, abs=1e-9)
    rest = next(event.t for event in result.events if event.kind == "rest")
    assert rest == pytest.approx(3.0 * fall, rel=1e-5)
    assert result["floor.normal_force"][-1] == pytest.approx(G * math.cos(slope), rel=1e-9)
    along = np.array([math.cos(slope), 0.0, -math.sin(slope)])
    place = np.array([result[f"ball.{axis}"][-1] for axis in "xyz"])
    assert place @ along == pytest.approx(0.5 * G * math.sin(slope) * 4.0, rel=1e-9)
    assert place @ normal == pytest.approx(0.1, abs=1e-10)
    spin = [result[f"ball.angular_velocity_{axis}"][-1] for axis in "xyz"]
    assert spin == pytest.approx([1.0, 2.0, 3.0], abs=1e-9)
    assert np.abs(result["energy.balance"] - result["energy.balance"][0]).max() < 1e-8


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.7), PoissonImpact(restitution=0.7)])
def test_oblique_blow_of_two_spheres(law):
    """Only the velocity along the line of centres changes, as in Newton's law."""
    first, a = sphere("a", 0.2, 2.0, position=(-1.0, 0.15, 0.1), velocity=(3.0, 0.0, 0.0), angular_velocity=(1, 2, 3))
    second, b = sphere("b", 0.3, 1.0, position=(0.5, 0.0, 0.0), velocity=(-1.0, 0.2, 0.0))
    blow = SphereOnSphere3D(name="blow", a=a, b=b, law=law)
    result = simulate(
        Model(gravity=(0.0, 0.0, 0.0), bodies=[first, second], contacts=[blow]), 0.6, rtol=1e-12, atol=1e-13
    )
    (event,) = result.events
    relative, place = np.array([-4.0, 0.2, 0.0]), np.array([1.5, -0.15, -0.1])
    along = place @ relative / (relative @ relative)
    t = -along - math.sqrt(along**2 - (place @ place - 0.25) / (relative @ relative))
    assert event.t == pytest.approx(t, abs=1e-10)
    n = (place + t * relative) / 0.5
    impulse = -1.7 * (relative @ n) / (1.0 / 2.0 + 1.0 / 1.0)
    assert event.impulse == pytest.approx(impulse, rel=1e-10)
    for body, mass, sign in ((first, 2.0, -1.0), (second, 1.0, 1.0)):
        v = [result[f"{body.name}.v{axis}"][-1] for axis in "xyz"]
        assert v == pytest.approx(np.array(body.velocity) + sign * impulse / mass * n, abs=1e-9)
    spin = [result[f"a.angular_velocity_{axis}"][-1] for axis in "xyz"]
    assert spin == pytest.approx([1, 2, 3], abs=1e-10)


def test_rubbing_spheres_keep_momentum_and_angular_momentum():
    first, a = sphere("a", 0.2, 2.0, position=(-0.6, 0.1, 0.05), velocity=(3.0, 0.0, 0.0), angular_velocity=(9, -8, 7))
    second, b = sphere("b", 0.3, 1.0, position=(0.0, 0.0, 0.0), velocity=(-1.0, 0.2, 0.0), angular_velocity=(-3, 2, 5))
    rub = SphereOnSphere3D(
        name="rub", a=a, b=b, law=Hertz(stiffness=1e6), friction=TanhFriction(coefficient=0.4, transition_speed=0.01)
    )
    bodies = [first, second]
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, contacts=[rub]), 0.2, rtol=1e-11, atol=1e-13)
    assert [event.kind for event in result.events] == ["close", "open"]
    before, after = (angular_momentum(result, bodies, at) for at in (0, -1))
    assert after == pytest.approx(before, abs=1e-8)
    for axis in "xyz":
        moved = 2.0 * result[f"a.v{axis}"] + result[f"b.v{axis}"]
        assert np.abs(moved - moved[0]).max() < 1e-9
    assert result["rub.dissipation"][-1] > 0.1
    balance = result["energy.balance"]
    assert np.abs(balance - balance[0]).max() < 1e-7 * result["energy.kinetic"][0]


def test_sphere_on_a_springy_floor_slides_until_it_rolls():
    """It keeps the direction of its slip, and rolls with (5 v + 2 R w x n)/7 (Coulomb's limit of a steep law)."""
    v, w = np.array([2.0, -0.5, 0.0]), np.array([3.0, 8.0, 5.0])
    body, ball = sphere("ball", position=(0.0, 0.0, 0.1), velocity=tuple(v), angular_velocity=tuple(w))
    floor = SphereOnHalfSpace3D(
        name="floor", plane=HalfSpace3D(), sphere=ball, law=KelvinVoigt(stiffness=1e6, damping=2e3),
        friction=TanhFriction(coefficient=0.3, transition_speed=1e-3),
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=[floor]), 1.0, rtol=1e-9, atol=1e-11)
    n = np.array([0.0, 0.0, 1.0])
    rolls = (5.0 * v + 2.0 * 0.1 * np.cross(w, n)) / 7.0
    found = np.array([result[f"ball.v{axis}"][-1] for axis in "xyz"])
    assert found == pytest.approx(rolls, abs=2e-3)
    assert result["floor.sliding_velocity"][-1] < 1e-5
    # no drilling friction: the spin about the normal stays
    assert result["ball.angular_velocity_z"][-1] == pytest.approx(5.0, abs=1e-6)
    assert np.all(np.diff(result["floor.dissipation"]) > -1e-12)


def test_box_dropped_on_a_smooth_floor_comes_to_rest_on_a_face():
    """Energy never grows; at the end it lies flat, and the floor carries its weight."""
    body = RigidBody3D(
        name="box", mass=2.0, inertia=(0.02, 0.03, 0.04), position=(0.0, 0.0, 0.5),
        attitude=EulerParameters(values=(1.0, 0.2, 0.1, 0.0)), angular_velocity=(0.5, -0.4, 0.0),
    )  # fmt: skip
    box = Box3D(marker=Marker3D(body="box"), size=(0.4, 0.3, 0.2))
    floor = contacts_between("floor", [HalfSpace3D()], [box], law=NewtonImpact(restitution=0.2, rest_ratio=1e-3))
    assert len(floor) == 8
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=floor), 2.5)
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.all(np.diff(total) < 1e-7 * total[0])
    gaps = np.array([result[f"{contact.name}.gap"] for contact in floor])
    assert gaps.min() > -1e-9
    assert result["box.z"][-1] == pytest.approx(0.1, abs=1e-6) or result["box.z"][-1] == pytest.approx(0.15, abs=1e-6)
    assert abs(result["box.vz"][-1]) < 1e-8
    assert sum(result[f"{contact.name}.normal_force"][-1] for contact in floor) == pytest.approx(2.0 * G, rel=1e-6)


def test_point_mass_in_space_strikes_a_moving_plane():
    """A plate that turns about a hinge throws a ball: relative to the plate's point the ball leaves with e times the
    speed with which it came."""
    plate = RigidBody3D(
        name="plate", mass=3.0, inertia=(0.5, 0.5, 0.5), position=(0.0, 0.0, 0.0), angular_velocity=(0.4, 0.0, 0.0)
    )
    ball = PointMass3D(name="ball", mass=1.0, position=(0.1, 0.3, 0.4), velocity=(0.0, 0.0, -2.0))
    hit = SphereOnHalfSpace3D(
        name="hit", plane=HalfSpace3D(marker=Marker3D(body="plate")),
        sphere=Sphere3D(marker=Marker3D(body="ball"), radius=0.05), law=NewtonImpact(restitution=0.6),
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=[plate, ball], contacts=[hit]), 0.5, rtol=1e-11, atol=1e-12)
    (event,) = result.events
    assert event.separation_speed == pytest.approx(0.6 * event.approach_speed, rel=1e-9)
    spin = [result[f"plate.angular_velocity_{axis}"][-1] for axis in "xyz"]
    before = 3.0 * 0.0 + 0.5 * np.array([0.4, 0.0, 0.0]) + np.cross((0.1, 0.3, 0.4), (0.0, 0.0, -2.0))
    x, v, plate_x, plate_v = (
        np.array([result[f"{name}.{prefix}{axis}"][-1] for axis in "xyz"])
        for name, prefix in (("ball", ""), ("ball", "v"), ("plate", ""), ("plate", "v"))
    )
    after = 0.5 * np.array(spin) + np.cross(x, v) + 3.0 * np.cross(plate_x, plate_v)
    assert after == pytest.approx(before, abs=1e-8)


def test_refused():
    with pytest.raises(ModelError, match="two points"):
        SphereOnSphere3D(
            name="c", a=Sphere3D(marker=Marker3D()), b=Sphere3D(marker=Marker3D(body="b")),
            law=NewtonImpact(restitution=0.5),
        )  # fmt: skip
