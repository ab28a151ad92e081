"""Round shapes in space: smooth shapes on half-spaces, spheres in hollow spheres, capsules; closed forms, balances."""

import math
from typing import ClassVar

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    Capsule3D,
    CapsuleOnCapsule3D,
    ContactGroup3D,
    CoulombFriction,
    Cylinder3D,
    Ellipsoid3D,
    HalfSpace3D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    RollingDisk3D,
    SmoothOnHalfSpace3D,
    SmoothShape3D,
    Sphere3D,
    SphereInSphere3D,
    Torus3D,
    contacts_between,
    simulate,
    support_formula,
)

G = 9.81
ON = Marker3D(body="b")
HARD, ROUGH = NewtonImpact(restitution=0.0), CoulombFriction(coefficient=5.0)


def body(mass=1.0, inertia=(0.01, 0.01, 0.01), **start):
    return RigidBody3D(name="b", mass=mass, inertia=inertia, **start)


def on_floor(shape, friction=None, law=HARD):
    return SmoothOnHalfSpace3D(name="floor", plane=HalfSpace3D(), shape=shape, law=law, friction=friction)


def run(stone, contacts, t_end, gravity=G, rtol=1e-10, **options):
    model = Model(gravity=(0.0, 0.0, -gravity), bodies=[stone], contacts=contacts)
    return simulate(model, t_end, rtol=rtol, atol=0.01 * rtol, **options)


def place(result, name="b"):
    return np.array([result[f"{name}.{axis}"] for axis in "xyz"])


# ---- support functions ----------------------------------------------------------------------------------------------


@support_formula
def ellipsoid(x, y, z, a, b, c):
    return math.sqrt((a * x) ** 2 + (b * y) ** 2 + (c * z) ** 2)


@support_formula
def ring(x, y, z, radius, rim):
    return radius * math.sqrt(x * x + y * y) + rim * math.sqrt(x * x + y * y + z * z)


class OwnEllipsoid(SmoothShape3D):
    a: float
    b: float
    c: float
    formula: ClassVar = ellipsoid


class OwnRing(SmoothShape3D):
    radius: float
    rim: float
    formula: ClassVar = ring


@pytest.mark.parametrize("seed", range(5))
def test_shapes_of_the_library_are_those_of_their_formulas(seed):
    """Derivatives by hand and by jets; the point that is reached lies on the surface."""
    direction = np.random.default_rng(seed).normal(size=3)
    pairs = (
        (Ellipsoid3D(marker=ON, half_axes=(0.3, 0.4, 0.6)), OwnEllipsoid(marker=ON, a=0.3, b=0.4, c=0.6)),
        (Torus3D(marker=ON, radius=0.5, rim_radius=0.1), OwnRing(marker=ON, radius=0.5, rim=0.1)),
    )
    for shape, own in pairs:
        found = shape.support(tuple(direction))
        assert found == pytest.approx(own.support(tuple(direction)), rel=1e-13, abs=1e-14)
        assert direction @ found[1:4] == pytest.approx(found[0], rel=1e-14)
    x = np.array(pairs[0][0].support(tuple(direction))[1:4]) / (0.3, 0.4, 0.6)
    assert x @ x == pytest.approx(1.0, rel=1e-14)


def test_what_is_no_support_function_is_refused():
    class Wrong(SmoothShape3D):
        formula: ClassVar = support_formula(lambda x, y, z: 1.0 + x * x)

    class Hollow(SmoothShape3D):
        formula: ClassVar = support_formula(lambda x, y, z: 3.0 * math.fabs(x) - math.sqrt(x * x + y * y + z * z))

    with pytest.raises(ModelError, match="a support function grows as its argument does"):
        Wrong(marker=ON)
    with pytest.raises(ModelError, match="bends inwards"):
        Hollow(marker=ON)
    with pytest.raises(ModelError, match="takes 2 arguments"):
        support_formula(lambda x, y: x + y)


# ---- smooth shapes on a half-space ----------------------------------------------------------------------------------


@pytest.mark.parametrize("friction", [None, CoulombFriction(coefficient=0.3)])
def test_a_disk_spins_on_its_rim_with_its_centre_at_rest(friction):
    """Thin disk: W^2 sin(a) = 4 g/r, its angular velocity W sin(a) along the diameter that touches; no friction."""
    r, tilt = 0.2, 0.7
    rate = math.sqrt(4.0 * G / (r * math.sin(tilt)))
    down = np.array([math.cos(tilt), 0.0, -math.sin(tilt)])
    disk = body(
        inertia=(r * r / 4.0, r * r / 4.0, r * r / 2.0), position=(0.0, 0.0, r * math.sin(tilt)),
        attitude=Axes(z=(math.sin(tilt), 0.0, math.cos(tilt))),
        angular_velocity=tuple(-rate * math.sin(tilt) * down),
        angular_velocity_in="space",
    )  # fmt: skip
    result = run(disk, [on_floor(Torus3D(marker=ON, radius=r), friction)], 0.5, t_eval=np.linspace(0.0, 0.5, 11))
    assert np.abs(place(result) - [[0.0], [0.0], [r * math.sin(tilt)]]).max() < 1e-7
    spin = np.array([result[f"b.angular_velocity_{axis}"] for axis in "xyz"])
    turn = rate * result.t
    wanted = (
        -rate
        * math.sin(tilt)
        * np.array([math.cos(tilt) * np.cos(turn), math.cos(tilt) * np.sin(turn), -math.sin(tilt) + 0.0 * turn])
    )
    assert np.abs(spin - wanted).max() < 1e-5
    assert np.abs(result["floor.normal_force"][1:] - G).max() < 1e-5


def test_a_torus_that_sticks_rolls_as_the_joint_that_rolls():
    """The contact's rows and those of `RollingDisk3D`, which were written apart, make the same motion."""
    r, rim, tilt = 0.2, 0.05, 0.3
    height = r * math.cos(tilt) + rim
    axis = np.array([0.0, math.cos(tilt), math.sin(tilt)])
    # it starts rolling: no velocity of the point that touches
    spin = 6.0 * axis + np.array([0.0, 0.0, 0.8])
    arm = np.array([0.0, r * math.sin(tilt), -r * math.cos(tilt) - rim])
    stone = body(
        inertia=(0.02, 0.02, 0.035), position=(0.0, 0.0, height), attitude=Axes(z=tuple(axis)),
        angular_velocity=tuple(spin),
        angular_velocity_in="space", velocity=tuple(-np.cross(spin, arm)),
    )  # fmt: skip
    assert np.array(stone.velocity)[2] == pytest.approx(0.0, abs=1e-12)
    times = np.linspace(0.0, 1.0, 11)
    rolls = RollingDisk3D(name="rolls", a=Marker3D(), b=ON, radius=r + rim, rim_radius=rim)
    by_joint = simulate(
        Model(gravity=(0.0, 0.0, -G), bodies=[stone], joints=[rolls]), 1.0, rtol=1e-11, atol=1e-13, t_eval=times
    )
    touches = on_floor(Torus3D(marker=ON, radius=r, rim_radius=rim), ROUGH)
    by_contact = run(stone, [touches], 1.0, rtol=1e-11, t_eval=times)
    for name in ("x", "y", "z", "angular_velocity_x", "angular_velocity_y", "angular_velocity_z"):
        assert np.abs(by_joint[f"b.{name}"] - by_contact[f"b.{name}"]).max() < 1e-7
    force = np.hypot(by_joint["rolls.force_x"], by_joint["rolls.force_y"])[1:]
    assert by_contact["floor.friction_force"][1:] == pytest.approx(force, abs=1e-5)
    assert by_contact["floor.normal_force"][1:] == pytest.approx(by_joint["rolls.force_z"][1:], abs=1e-5)


@pytest.mark.parametrize("rolls", [True, False])
def test_an_ellipsoid_rocks_about_its_flat_side(rolls):
    """w^2 = m g (a^2 - c^2)/c / (J + m c^2) where it rolls, without m c^2 where it slides freely."""
    a, b, c, moment, mass = 0.3, 0.25, 0.2, 0.02, 1.5
    tilt = 1e-3
    height = math.hypot(a * math.sin(tilt), c * math.cos(tilt))
    stone = body(
        mass, (0.015, moment, 0.03), position=(0.0, 0.0, height),
        attitude=Axes(x=(math.cos(tilt), 0.0, -math.sin(tilt)), z=(math.sin(tilt), 0.0, math.cos(tilt))),
    )  # fmt: skip
    rate = math.sqrt(mass * G * (a * a - c * c) / c / (moment + (mass * c * c if rolls else 0.0)))
    t_end = 2.25 * 2.0 * math.pi / rate
    floor = on_floor(Ellipsoid3D(marker=ON, half_axes=(a, b, c)), ROUGH if rolls else None)
    result = run(stone, [floor], t_end)
    # after a quarter of a swing it is upright, and turns fastest
    assert abs(result["b.angular_velocity_y"][-1]) == pytest.approx(rate * tilt, rel=1e-5)
    # to rounding: of the height, which is 1e-6 of the whole
    assert result["b.z"][-1] == pytest.approx(c, abs=1e-4 * (height - c))
    total = result["energy.kinetic"] + result["energy.potential"]
    assert np.abs(total - total[0]).max() < 1e-9


def test_an_ellipsoid_bounces_with_spin():
    """Dropped level without friction: its centre bounces as a ball's, while it turns about the vertical."""
    law = NewtonImpact(restitution=0.5)
    stone = body(inertia=(0.01, 0.02, 0.03), position=(0.0, 0.0, 0.7), angular_velocity=(0.0, 0.0, 4.0))
    result = run(stone, [on_floor(Ellipsoid3D(marker=ON, half_axes=(0.4, 0.3, 0.2)), law=law)], 1.0)
    times = [event.t for event in result.events if event.kind == "impact"]
    fall = math.sqrt(2.0 * 0.5 / G)
    assert times[:3] == pytest.approx([fall, 2.0 * fall, 2.5 * fall], abs=1e-9)


def test_a_blow_on_an_ellipsoid_is_that_of_its_lever():
    """Tilted, without friction: P = m v/(1 + m d^2/J) with the lever d of the point that touches, e = 0."""
    a, c, tilt, moment = 0.3, 0.1, 0.4, 0.02
    half = math.hypot(a * math.sin(tilt), c * math.cos(tilt))
    lever = (a * a - c * c) * math.sin(tilt) * math.cos(tilt) / half
    stone = body(
        2.0, (0.02, moment, 0.03), position=(0.0, 0.0, half + 0.1), velocity=(0.0, 0.0, -1.0),
        attitude=Axes(x=(math.cos(tilt), 0.0, -math.sin(tilt)), z=(math.sin(tilt), 0.0, math.cos(tilt))),
    )  # fmt: skip
    result = run(stone, [on_floor(Ellipsoid3D(marker=ON, half_axes=(a, 0.2, c)))], 0.101, gravity=0.0)
    (event,) = [event for event in result.events if event.kind == "impact"]
    assert event.t == pytest.approx(0.1, abs=1e-10)
    assert event.impulse == pytest.approx(2.0 / (1.0 + 2.0 * lever**2 / moment), rel=1e-9)


def test_a_cylinder_rolls_down_a_slope_on_both_rims():
    """2/3 g sin(slope)."""
    slope, r = 0.2, 0.1
    normal, down = np.array([math.sin(slope), 0.0, math.cos(slope)]), np.array([math.cos(slope), 0, -math.sin(slope)])
    roller = body(1.0, (0.02, 0.02, 0.5 * r * r), position=tuple(r * normal), attitude=Axes(z=(0.0, 1.0, 0.0)))
    plane = HalfSpace3D(marker=Marker3D(attitude=Axes(z=tuple(normal))))
    contacts = contacts_between(
        "floor", [plane], [Cylinder3D(marker=ON, radius=r, length=0.4)], law=HARD, friction=ROUGH
    )
    assert [type(contact) for contact in contacts[:2]] == [SmoothOnHalfSpace3D] * 2 and len(contacts) == 18
    result = run(roller, contacts, 1.0)
    assert place(result)[:, -1] == pytest.approx(r * normal + G * math.sin(slope) / 3.0 * down, abs=1e-8)


def test_a_cylinder_with_rim_points_comes_to_stand():
    """Dropped a little tilted onto its lower end."""
    can = body(1.0, (0.01, 0.01, 0.005), position=(0.0, 0.0, 0.2), attitude=Axes(z=(0.05, 0.02, 1.0)))
    contacts = contacts_between(
        "floor", [HalfSpace3D()], [Cylinder3D(marker=ON, radius=0.15, length=0.2, rim_points=6)], law=HARD,
        friction=CoulombFriction(coefficient=0.4),
    )  # fmt: skip
    assert len(contacts) == 2 + 12
    result = run(can, contacts, 1.5, rtol=1e-8)
    assert result["b.z"][-1] == pytest.approx(0.1, abs=1e-9)
    assert result["energy.kinetic"][-1] < 1e-12
    with pytest.raises(ModelError, match="2 points of a rim do not hold"):
        Cylinder3D(marker=ON, radius=0.15, length=0.2, rim_points=2)


# ---- spheres in spheres, capsules -----------------------------------------------------------------------------------


def test_a_ball_rolls_in_a_bowl():
    """5 g/(7 (R - r)) for small swings."""
    bowl, r, angle = 0.5, 0.1, 1e-3
    arm = bowl - r
    ball = body(inertia=(0.4 * r * r,) * 3, position=(arm * math.sin(angle), 0.0, -arm * math.cos(angle)))
    inside = SphereInSphere3D(
        name="bowl", hollow=Sphere3D(marker=Marker3D(), radius=bowl), sphere=Sphere3D(marker=ON, radius=r), law=HARD,
        friction=ROUGH,
    )  # fmt: skip
    rate = math.sqrt(5.0 * G / (7.0 * arm))
    result = run(ball, [inside], 2.25 * 2.0 * math.pi / rate)
    assert abs(result["b.vx"][-1]) == pytest.approx(arm * rate * angle, rel=1e-5)
    assert abs(result["b.x"][-1]) < 1e-5 * arm * angle + 1e-9
    with pytest.raises(ModelError, match="does not fit"):
        SphereInSphere3D(
            name="c", hollow=Sphere3D(marker=Marker3D(), radius=0.1), sphere=Sphere3D(marker=ON, radius=0.1), law=HARD
        )


def test_a_ball_in_a_hollow_sphere_goes_along_equal_chords():
    """Without gravity and friction, e = 1: chords of 2 (R - r) cos(angle), from a start in the middle too."""
    bowl, r = 1.0, 0.2
    law = NewtonImpact(restitution=1.0)
    inside = SphereInSphere3D(
        name="bowl", hollow=Sphere3D(marker=Marker3D(), radius=bowl), sphere=Sphere3D(marker=ON, radius=r), law=law
    )
    for start, miss in (((0.0, 0.3, 0.0), 0.3), ((0.0, 0.0, 0.0), 0.0)):
        ball = body(inertia=(0.4 * r * r,) * 3, position=start, velocity=(2.0, 0.0, 0.0))
        result = run(ball, [inside], 3.0, gravity=0.0)
        times = np.array([event.t for event in result.events if event.kind == "impact"])
        half = math.sqrt((bowl - r) ** 2 - miss**2) / 2.0
        assert times == pytest.approx(half * (1.0 + 2.0 * np.arange(len(times))), abs=1e-8)
        assert len(times) >= 3
        assert np.abs(result["energy.kinetic"] - 2.0).max() < 1e-9


def two_capsules(friction, second):
    rod = {"mass": 1.0, "inertia": (0.05, 0.05, 0.002)}
    first = RigidBody3D(name="a", **rod, position=(0.03, 0.1, 0.0), attitude=Axes(z=(1.0, 0.1, 0.0)))
    other = RigidBody3D(
        name="b", mass=2.0, inertia=(0.08, 0.07, 0.01), position=(0.1, 0.0, 0.6), velocity=(0.1, -0.2, -1.0),
        angular_velocity=(0.6, 0.3, -0.4), attitude=Axes(z=(0.2, 1.0, 0.1)),
    )  # fmt: skip
    touch = CapsuleOnCapsule3D(
        name="touch", a=Capsule3D(marker=Marker3D(body="a"), length=1.0, radius=0.05), b=second,
        law=NewtonImpact(restitution=0.4), friction=friction,
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, 0.0), bodies=[first, other], contacts=[touch])


@pytest.mark.parametrize("friction", [None, CoulombFriction(coefficient=0.3)])
@pytest.mark.parametrize("second", [Capsule3D(marker=ON, length=0.8, radius=0.07), Sphere3D(marker=ON, radius=0.2)])
def test_a_blow_of_capsules_keeps_momentum(friction, second):
    result = simulate(two_capsules(friction, second), 0.6, rtol=1e-11, atol=1e-13)
    (event,) = [event for event in result.events if event.kind == "impact"]
    assert event.separation_speed == pytest.approx(0.4 * event.approach_speed, rel=1e-8)
    found = []
    for at in (0, -1):
        momentum, turning = np.zeros(3), np.zeros(3)
        for name, mass, inertia in (("a", 1.0, (0.05, 0.05, 0.002)), ("b", 2.0, (0.08, 0.07, 0.01))):
            x, v = (np.array([result[f"{name}.{d}{axis}"][at] for axis in "xyz"]) for d in ("", "v"))
            own = np.array([result[f"{name}.body_angular_velocity_{axis}"][at] for axis in "xyz"])
            e = np.array([result[f"{name}.e{k}"][at] for k in range(4)])
            cross = np.array([[0, -e[3], e[2]], [e[3], 0, -e[1]], [-e[2], e[1], 0]])
            turn = np.eye(3) + 2.0 * e[0] * cross + 2.0 * cross @ cross
            momentum += mass * v
            turning += mass * np.cross(x, v) + turn @ (np.array(inertia) * own)
        found.append((momentum, turning))
    assert found[1][0] == pytest.approx(found[0][0], abs=1e-10)
    assert found[1][1] == pytest.approx(found[0][1], abs=1e-9)
    lost = result["energy.kinetic"][0] - result["energy.kinetic"][-1]
    assert event.energy_loss == pytest.approx(lost, rel=1e-8)
    if friction is not None:
        assert 0.0 < event.friction_impulse <= 0.3 * event.impulse * (1.0 + 1e-9)


def test_a_ball_bounces_on_a_capsule_and_rolls_off_its_side():
    """Dropped on the ridge it bounces as on a floor; with a push it leaves where a ball leaves a cylinder."""
    ball = body(inertia=(0.4 * 0.01,) * 3, position=(0.2, 0.0, 0.5))
    ridge = Capsule3D(marker=Marker3D(attitude=Axes(z=(1.0, 0.0, 0.0))), length=2.0, radius=0.2)
    touch = CapsuleOnCapsule3D(
        name="touch", a=ridge, b=Sphere3D(marker=ON, radius=0.1), law=NewtonImpact(restitution=0.5)
    )
    result = run(ball, [touch], 0.5)
    times = [event.t for event in result.events if event.kind == "impact"]
    fall = math.sqrt(2.0 * 0.2 / G)
    assert times[:2] == pytest.approx([fall, 2.0 * fall], abs=1e-9)
    # smooth: it leaves at cos = 2/3 (1 + v^2/(2 g R))
    speed, arm = 0.3, 0.3
    pushed = body(inertia=(0.4 * 0.01,) * 3, position=(0.2, 0.0, arm), velocity=(0.0, speed, 0.0))
    result = run(pushed, [touch.model_copy(update={"law": HARD})], 1.0, t_eval=np.linspace(0.0, 1.0, 201))
    (event,) = [event for event in result.events if event.kind == "open"]
    at = np.searchsorted(result.t, event.t)
    assert result["b.z"][at] / arm == pytest.approx(2.0 / 3.0 * (1.0 + speed**2 / (2.0 * G * arm)), abs=0.02)


def test_groups_take_round_shapes(tmp_path):
    bodies = [
        RigidBody3D(name=name, mass=1.0, inertia=(0.01, 0.01, 0.01), position=(x, 0.0, 0.5))
        for name, x in (("egg", 0.0), ("wheel", 2.0), ("pill", 4.0), ("ball", 6.0))
    ]
    on = {body.name: Marker3D(body=body.name) for body in bodies}
    group = ContactGroup3D(
        name="g", spheres=[Sphere3D(marker=on["ball"], radius=0.1)],
        capsules=[Capsule3D(marker=on["pill"], length=0.2, radius=0.1)],
        cylinders=[Cylinder3D(marker=on["wheel"], radius=0.2, length=0.1, rim_points=0)],
        smooth=[Ellipsoid3D(marker=on["egg"], half_axes=(0.1, 0.2, 0.3))], half_spaces=[HalfSpace3D()], law=HARD,
        except_bodies=[("egg", "wheel"), ("egg", "pill"), ("egg", "ball"), ("wheel", "pill"), ("wheel", "ball")],
    )  # fmt: skip
    model = Model(bodies=bodies, groups=[group], gravity=(0.0, 0.0, -G))
    names = sorted(type(contact).__name__ for contact in model.contacts)
    assert names == ["CapsuleOnCapsule3D", *["SmoothOnHalfSpace3D"] * 3, *["SphereOnHalfSpace3D"] * 3]
    model.save(tmp_path / "round.json")
    assert Model.load(tmp_path / "round.json") == model
    result = simulate(model, 0.3)
    assert result["egg.z"][-1] == pytest.approx(0.3, abs=1e-9)
