"""Spheres on ellipsoids, own smooth shapes, cylinders, disks, rings: distances, motion as on known shapes, blows."""

import math
from typing import ClassVar

import numpy as np
import pytest
from test_tangents import Point
from tlismni.core import (
    Axes,
    Capsule3D,
    ContactGroup3D,
    CoulombFriction,
    Cylinder3D,
    Ellipsoid3D,
    HalfSpace3D,
    KelvinVoigt,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    Rim3D,
    RotationVector,
    SmoothShape3D,
    Sphere3D,
    SphereOnCylinder3D,
    SphereOnRing3D,
    SphereOnSmooth3D,
    TanhFriction,
    Torus3D,
    contacts_between,
    simulate,
    support_formula,
)

G, R = 9.81, 0.1
BALL = Sphere3D(marker=Marker3D(body="ball"), radius=R)
HARD, GRIP = NewtonImpact(restitution=0.5), CoulombFriction(coefficient=0.3)
SKEW = Marker3D(point=(0.3, -0.2, 0.5), attitude=RotationVector(vector=(0.4, -0.7, 0.2)))
HALF_AXES = np.array((0.3, 0.5, 0.02))


@support_formula
def shifted(x, y, z, radius, up):
    """A ball whose middle is far from the marker."""
    return radius * math.sqrt(x * x + y * y + z * z) + up * z


class Shifted(SmoothShape3D):
    radius: float
    up: float
    formula: ClassVar = shifted


def ball(**more):
    return RigidBody3D(name="ball", **{"mass": 1.0, "inertia": (4e-3,) * 3, "position": (0.0, 0.0, 1.0)} | more)


def on_ellipsoid(c):
    """Distance from the ellipsoid, by the root of sum (a c/(a^2 + t))^2 = 1 (Eberly 2013), bisected."""
    low, high = 0.0, float(np.linalg.norm(HALF_AXES * c)) + 1.0
    for _ in range(200):
        t = 0.5 * (low + high)
        low, high = (t, high) if ((HALF_AXES * c / (HALF_AXES**2 + t)) ** 2).sum() > 1.0 else (low, t)
    return float(np.linalg.norm(c - HALF_AXES**2 * c / (HALF_AXES**2 + high)))


def on_cylinder(c, radius, half):
    out = max(math.hypot(c[0], c[1]) - radius, 0.0), max(abs(c[2]) - half, 0.0)
    return math.hypot(*out)


CASES = {
    "ellipsoid": (Ellipsoid3D(marker=SKEW, half_axes=tuple(HALF_AXES)), on_ellipsoid),
    "own": (Shifted(marker=SKEW, radius=0.2, up=0.9), lambda c: max(np.linalg.norm(c - (0, 0, 0.9)) - 0.2, 0.0)),
    "cylinder": (Cylinder3D(marker=SKEW, radius=0.3, length=0.4), lambda c: on_cylinder(c, 0.3, 0.2)),
    "disk": (Torus3D(marker=SKEW, radius=0.3), lambda c: on_cylinder(c, 0.3, 0.0)),
    "torus": (
        Torus3D(marker=SKEW, radius=0.4, rim_radius=0.05),
        lambda c: max(math.hypot(math.hypot(c[0], c[1]) - 0.4, c[2]) - 0.05, 0.0),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_the_gap_is_the_distance(name):
    """In a frame that is moved; close to the surface and far away. With the centre in the shape it is negative."""
    shape, distance = CASES[name]
    (contact,) = contacts_between("g", [BALL], [shape], law=HARD)
    point = Point(Model(bodies=[ball()], contacts=[contact]))
    row, q, none = point.workspace.assembly.contacts[0].row, point.workspace.assembly.q0.copy(), np.zeros(point.n)
    rng = np.random.default_rng(0)
    outside = 0
    for place in rng.normal(size=(400, 3)) * rng.choice([0.1, 0.3, 1.0, 20.0], (400, 1)):
        q[:3] = np.array(SKEW.point) + SKEW.axes() @ place
        gap, far = point.at(0.0, q, none, none, np.zeros(point.m))[1][row], distance(place)
        if far > 0.0 and (name != "ellipsoid" or ((place / HALF_AXES) ** 2).sum() > 1.0):
            outside += 1
            assert gap == pytest.approx(far - R, abs=1e-11 * max(1.0, far))
        else:
            assert gap < -R + 0.05 + 1e-12
    assert outside > 200


def as_on(shape, known, gravity=(0.0, 0.0, -G), friction=GRIP, law=HARD, t=0.5, **start):
    """Ends of the same run on a shape and on one that is known."""
    ends = []
    for each in (shape, known):
        contacts = contacts_between("g", [each], [BALL], law=law, friction=friction)
        result = simulate(Model(gravity=gravity, bodies=[ball(**start)], contacts=contacts), t, rtol=1e-9)
        if law is HARD:
            assert np.abs(result["energy.balance"]).max() < 1e-7
        ends.append([result[f"ball.{name}"][-1] for name in ("x", "y", "z", "vx", "vz", "angular_velocity_y")])
        kinds = [event.kind for event in result.events]
    assert kinds or law is not HARD
    assert ends[0] == pytest.approx(ends[1], abs=2e-7)


LAWS = {
    "constraint": {"law": HARD, "friction": GRIP},
    "force": {
        "law": KelvinVoigt(stiffness=2e4, damping=20.0),
        "friction": TanhFriction(coefficient=0.3, transition_speed=0.01),
    },
}


def smooth(law):
    """Without friction of forces: how fast round shapes slide that overlap is said in other words for spheres."""
    return LAWS[law] | ({"friction": None} if law == "force" else {})


@pytest.mark.parametrize("law", LAWS)
def test_on_an_ellipsoid_with_equal_axes_as_on_a_sphere(law):
    start = {"position": (0.03, 0.01, 0.45), "velocity": (0.1, 0.0, 0.0), "angular_velocity": (0.0, 2.0, 1.0)}
    round_one = Ellipsoid3D(marker=Marker3D(), half_axes=(0.3, 0.3, 0.3))
    as_on(round_one, Sphere3D(marker=Marker3D(), radius=0.3), **smooth(law), **start)


@pytest.mark.parametrize("law", LAWS)
def test_on_the_side_of_a_cylinder_as_on_a_capsule(law):
    lying = Marker3D(attitude=Axes(z=(0.0, 1.0, 0.0)))
    start = {"position": (0.03, 0.0, 0.45), "velocity": (0.1, 0.2, 0.0), "angular_velocity": (0.0, 2.0, 1.0)}
    shapes = (kind(marker=lying, radius=0.3, length=2.0) for kind in (Cylinder3D, Capsule3D))
    as_on(*shapes, **smooth(law), **start)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", ["cylinder", "disk"])
def test_on_an_end_as_on_a_half_space(kind, law):
    start = {"position": (-0.3, 0.0, 0.15), "velocity": (0.8, 0.2, 0.0), "angular_velocity": (0.0, 2.0, 1.0)}
    shape = (
        Torus3D(marker=Marker3D(), radius=1.0) if kind == "disk"
        else Cylinder3D(marker=Marker3D(point=(0.0, 0.0, -0.2)), radius=1.0, length=0.4)
    )  # fmt: skip
    as_on(shape, HalfSpace3D(), **LAWS[law], **start)


def test_a_ball_rolls_off_a_cylinder_over_its_rim():
    """On the rim it turns about it: the distance stays and so does the energy."""
    stand = Cylinder3D(marker=Marker3D(point=(0.0, 0.0, -0.1)), radius=0.5, length=0.2)
    start = {"position": (0.49, 0.0, R), "velocity": (0.3, 0.0, 0.0), "angular_velocity": (0.0, 3.0, 0.0)}
    law, rough = NewtonImpact(restitution=0.0), CoulombFriction(coefficient=2.0)
    contacts = contacts_between("g", [stand], [BALL], law=law, friction=rough)
    result = simulate(Model(gravity=(0, 0, -G), bodies=[ball(**start)], contacts=contacts), 0.15, rtol=1e-8)
    x, z = result["ball.x"], result["ball.z"]
    on_rim = (x > 0.501) & (result["g_ground_ball.in_contact"] > 0.5)
    assert on_rim.sum() > 5
    assert np.hypot(x - 0.5, z)[on_rim] == pytest.approx(R, abs=1e-8)
    speed = np.hypot(result["ball.vx"], result["ball.vz"])[on_rim]
    assert speed**2 == pytest.approx(0.3**2 + 10.0 / 7.0 * G * (R - z[on_rim]), rel=1e-4)


def test_a_ball_falls_through_a_ring_or_bounces_off_it():
    ring = Torus3D(marker=Marker3D(), radius=0.4, rim_radius=0.05)
    contacts = contacts_between("g", [ring], [BALL], law=HARD)

    def run(x):
        model = Model(gravity=(0.0, 0.0, -G), bodies=[ball(position=(x, 0.0, 0.3))], contacts=contacts)
        return simulate(model, 0.5)

    through, off = run(0.05), run(0.4)
    assert not through.events and through["ball.z"][-1] == pytest.approx(0.3 - 0.5 * G * 0.25, abs=1e-9)
    hit = math.sqrt(2.0 * 0.15 / G)
    assert off.events[0].t == pytest.approx(hit, abs=1e-9)
    assert off.events[0].separation_speed == pytest.approx(0.5 * G * hit, rel=1e-9)
    with pytest.raises(ModelError, match=r"sits in the hole of a torus, of radius 0\.09 m"):
        contacts_between("g", [Torus3D(marker=Marker3D(), radius=0.1, rim_radius=0.01)], [BALL], law=HARD)


@pytest.mark.parametrize("name", ["ellipsoid", "cylinder", "torus"])
def test_a_free_shape_is_hit_without_loss(name):
    """Momentum, angular momentum and energy stay; friction-free, the blow is along the normal."""
    on = Marker3D(body="stone")
    shape = {
        "ellipsoid": Ellipsoid3D(marker=on, half_axes=(0.3, 0.5, 0.2)),
        "cylinder": Cylinder3D(marker=on, radius=0.3, length=0.3),
        "torus": Torus3D(marker=on, radius=0.4, rim_radius=0.1),
    }[name]
    inertia = np.array((0.1, 0.12, 0.15))
    stone = RigidBody3D(
        name="stone", mass=2.0, inertia=tuple(inertia), attitude=RotationVector(vector=(0.3, 0.2, -0.4)),
        angular_velocity=(0.5, -0.3, 0.2),
    )  # fmt: skip
    mover = ball(position=(0.8, 0.1, 0.5), velocity=(-1.0, -0.3, -0.6))
    contacts = contacts_between("g", [shape], [BALL], law=NewtonImpact(restitution=1.0))
    result = simulate(Model(gravity=(0, 0, 0), bodies=[stone, mover], contacts=contacts), 1.0, rtol=1e-9)
    hits = [event for event in result.events if event.kind == "impact"]
    assert hits and hits[0].impulse > 0.1
    kinetic = result["energy.kinetic"]
    assert np.abs(kinetic - kinetic[0]).max() < 1e-7
    whole = np.zeros((3, len(result.t)))
    for body, mass in (("stone", 2.0), ("ball", 1.0)):
        place, speed = (np.array([result[f"{body}.{kind}{axis}"] for axis in "xyz"]) for kind in ("", "v"))
        whole += mass * np.cross(place, speed, axis=0)
    # J w in space: A J A^T w, A from the Euler parameters
    e0, e = result["stone.e0"], np.array([result[f"stone.e{k}"] for k in (1, 2, 3)])
    w = np.array([result[f"stone.body_angular_velocity_{axis}"] for axis in "xyz"])
    local = inertia[:, None] * w
    whole += local + 2.0 * np.cross(e, e0 * local + np.cross(e, local, axis=0), axis=0)
    whole += 4e-3 * np.array([result[f"ball.angular_velocity_{axis}"] for axis in "xyz"])
    assert np.abs(whole - whole[:, :1]).max() < 1e-7


def test_groups_and_files_hold_them(tmp_path):
    group = ContactGroup3D(
        name="g", spheres=[BALL], cylinders=[Cylinder3D(marker=Marker3D(), radius=0.3, length=0.4)], law=HARD,
        smooth=[shape for name, (shape, _) in CASES.items() if name in ("ellipsoid", "disk", "torus")],
    )  # fmt: skip
    model = Model(bodies=[ball()], groups=[group])
    kinds = sorted(type(contact).__name__ for contact in model.contacts)
    assert kinds == ["SphereOnCylinder3D"] * 2 + ["SphereOnRing3D", "SphereOnSmooth3D"]
    model.save(tmp_path / "m.json")
    assert Model.load(tmp_path / "m.json") == model
    plain = Model(bodies=[ball()], contacts=model.contacts)
    assert Model.model_validate_json(plain.model_dump_json()) == plain


def test_what_does_not_fit_is_refused():
    torus, disk = CASES["torus"][0], CASES["disk"][0]
    more = {"name": "c", "law": HARD}
    with pytest.raises(ModelError, match="no normal: give the sphere a radius"):
        SphereOnCylinder3D(shape=disk, sphere=Sphere3D(marker=Marker3D(body="ball")), **more)
    with pytest.raises(ModelError, match="take a SphereOnRing3D, or a Cylinder3D"):
        SphereOnCylinder3D(shape=torus, sphere=BALL, **more)
    with pytest.raises(ModelError, match="which is a disk: take a SphereOnCylinder3D"):
        SphereOnRing3D(ring=disk, sphere=BALL, **more)
    for shape, other in ((torus, "SphereOnRing3D"), (disk, "SphereOnCylinder3D")):
        with pytest.raises(ModelError, match=f"take {other} with a Torus3D"):
            SphereOnSmooth3D(shape=shape, sphere=BALL, **more)
    with pytest.raises(ModelError, match="Rim3D"):
        SphereOnSmooth3D(shape=Rim3D(marker=SKEW, radius=0.3), sphere=BALL, **more)
