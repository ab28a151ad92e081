"""A cable in space that touches spheres and planes: beside the plane's, at rest, stiff limits, friction, files."""

import numpy as np
import pytest
from cables import straight
from helpers import events, on
from tlismni.core import (
    Axes,
    Cable2D,
    Cable3D,
    CableClamp3D,
    CableLine3D,
    CableOnHalfSpace3D,
    ContactGroup3D,
    CoulombFriction,
    Disk2D,
    DiskOnCable2D,
    HalfSpace3D,
    KelvinVoigt,
    Marker3D,
    MaterialPoint2D,
    MaterialPoint3D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    PointMass3D,
    Revolute2D,
    RigidBody3D,
    RotationVector,
    Sphere3D,
    SphereOnCable3D,
    Spherical3D,
    TanhFriction,
    TurningFriction,
    simulate,
)
from tlismni.fmu_wrapper import export_fmu

G = 9.81
SOFT = KelvinVoigt(stiffness=2e4, damping=20.0)
DOWN = (0.0, 0.0, -G)


def bridge(law, elements=4):
    """A cable between two pins, and a mass that slides along on top of it, in the plane and in space."""
    ends = (("left", 0.0), ("right", 2.0))
    mass, place, speed = 0.3, (0.2, 0.1), (3.0, 0.0)
    flat = Model(
        bodies=[
            PointMass2D(name="ball", mass=mass, position=place, velocity=speed),
            Cable2D(**straight(elements, axial_damping=1.0)),
            *(MaterialPoint2D(name=name, body="cable", point=(s, 0.0)) for name, s in ends),
        ],
        joints=[Revolute2D(name=f"pin_{name}", a=on("ground", s), b=on(name)) for name, s in ends],
        contacts=[
            DiskOnCable2D(name="c", cable="cable", thickness=0.02, law=law, disk=Disk2D(marker=on("ball"), radius=0.08))
        ],
    )
    space = Model(
        gravity=flat.gravity,
        bodies=[
            PointMass3D(name="ball", mass=mass, position=(*place, 0.0), velocity=(*speed, 0.0)),
            Cable3D(**straight(elements, axial_damping=1.0)),
            *(MaterialPoint3D(name=name, body="cable", s=s) for name, s in ends),
        ],
        joints=[
            Spherical3D(name=f"pin_{name}", a=Marker3D(point=(s, 0.0, 0.0)), b=Marker3D(body=name)) for name, s in ends
        ],
        contacts=[
            SphereOnCable3D(
                name="c", cable="cable", thickness=0.02, law=law,
                sphere=Sphere3D(marker=Marker3D(body="ball"), radius=0.08),
            )
        ],
    )  # fmt: skip
    return flat, space


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.0), SOFT], ids=["constraint", "force"])
def test_a_mass_slides_over_a_cable_as_in_the_plane(law):
    """Over a border between elements."""
    flat, space = (simulate(model, 0.12, rtol=1e-8, atol=1e-10) for model in bridge(law))
    for channel in ("ball.x", "ball.y", "cable.y2", "cable.slope_y2", "cable.x1"):
        assert space[channel][-1] == pytest.approx(flat[channel][-1], abs=1e-7)
    assert np.abs(space["ball.z"]).max() < 1e-12
    assert space["ball.x"][-1] > 0.5  # the first element ends there
    assert [e.kind for e in space.events] == [e.kind for e in flat.events]
    assert abs(space["energy.balance"][-1]) < 1e-5


def fallen(law, friction, points=5, elements=2):
    """A slanting cable over a floor."""
    cable = Cable3D(
        name="cable", elements=elements, length=1.0, mass_per_length=0.3, axial_stiffness=400.0, bending_stiffness=0.05,
        axial_damping=2.0, position=(0.0, 0.0, 0.1), attitude=RotationVector(vector=(0.0, -0.05, 0.3)),
        velocity=(0.1, 0.2, 0.0),
    )  # fmt: skip
    group = ContactGroup3D(
        name="floor", cables=[CableLine3D(cable="cable", thickness=0.02, points=points)], half_spaces=[HalfSpace3D()],
        law=law, friction=friction,
    )  # fmt: skip
    return Model(name="fallen", gravity=DOWN, bodies=[cable], groups=[group])


def check_rest(result, points, height, tolerance, trembling):
    """It lies, and the floor carries its weight; the ledger holds. Nothing damps the bending of what does not touch:
    of the 0.3 J that it fell with, what `trembling` says in J goes on."""
    for k in range(3):
        assert result[f"cable.z{k}"][-1] == pytest.approx(height, abs=tolerance)
    late = result.t >= 0.5 * result.t[-1]
    forces = sum(result[f"floor_cable_ground_{k + 1}.normal_force"] for k in range(points))
    blows = sum(e.impulse for e in result.events if e.t > result.t[late][0])
    pushed = np.trapezoid(forces[late], result.t[late]) + blows
    assert pushed / np.ptp(result.t[late]) == pytest.approx(0.3 * G, rel=0.02)
    assert result["energy.kinetic"][-1] < trembling
    assert np.abs(result["energy.balance"]).max() < 1e-4


def test_a_cable_falls_on_a_floor_and_comes_to_rest_by_forces(tmp_path):
    law = KelvinVoigt(stiffness=3e3, damping=6.0)
    model = fallen(law, TanhFriction(coefficient=0.4, transition_speed=0.01))
    result = simulate(model, 2.0, rtol=1e-6)
    check_rest(result, 5, 0.02, 0.3 * G / 3e3, 1e-4)
    assert Model.model_validate_json(model.model_dump_json()) == model
    file = tmp_path / "cable.html"
    result.animate(file)
    assert "floor" in file.read_text() or file.stat().st_size > 1e4


def test_a_cable_falls_on_a_floor_and_comes_to_rest_by_constraints():
    result = simulate(fallen(NewtonImpact(restitution=0.0), CoulombFriction(coefficient=0.4)), 1.0, rtol=1e-6)
    check_rest(result, 5, 0.02, 1e-3, 2e-3)
    assert events(result, "impact") and events(result, "stick")


def test_an_fmu_of_a_cable_on_a_floor(tmp_path):
    fmpy = pytest.importorskip("fmpy")
    model = fallen(NewtonImpact(restitution=0.0), CoulombFriction(coefficient=0.4), points=3)
    path = export_fmu(model, tmp_path / "cable.fmu", "2.0", t_end=0.2, communication_step=0.05)
    found = fmpy.simulate_fmu(str(path), stop_time=0.2, output_interval=0.05, output=["cable.z0", "cable.z2"])
    result = simulate(model, 0.2)
    assert found["cable.z2"][-1] == pytest.approx(result["cable.z2"][-1], abs=1e-6)


def cantilever(law, friction=None, stiffness=0.7, **ball):
    """A cable clamped at its start, and a ball on top of it."""
    cable = Cable3D(
        name="cable", elements=3, length=1.0, mass_per_length=0.3, axial_stiffness=4e3, bending_stiffness=stiffness,
        axial_damping=20.0,
    )  # fmt: skip
    body = RigidBody3D(name="ball", **({"mass": 0.05, "inertia": (2e-5,) * 3, "position": (0.6, 0.0, 0.06)} | ball))
    contact = SphereOnCable3D(
        name="c", cable="cable", thickness=0.01, sphere=Sphere3D(marker=Marker3D(body="ball"), radius=0.05), law=law,
        friction=friction,
    )  # fmt: skip
    joints = [CableClamp3D(name="root", cable="cable", s=0.0)]
    return Model(gravity=DOWN, bodies=[cable, body], joints=joints, contacts=[contact])


def test_a_constraint_is_the_limit_of_stiff_forces():
    """While it lasts, before the cable throws the ball up; place and force."""
    hard = simulate(cantilever(NewtonImpact(restitution=0.0)), 0.009, rtol=1e-9)
    assert hard["c.normal_force"][-1] > 0.02
    errors = []
    for stiffness in (1e5, 1e6, 1e7):
        law = KelvinVoigt(stiffness=stiffness, damping=0.5 * np.sqrt(stiffness))
        soft = simulate(cantilever(law), 0.009, rtol=1e-9)
        errors.append([abs(soft[name][-1] - hard[name][-1]) for name in ("ball.z", "c.normal_force")])
    errors = np.array(errors)
    assert (errors[1:] < 0.2 * errors[:-1]).all()
    assert errors[-1, 0] < 1e-8 and errors[-1, 1] < 1e-3 * hard["c.normal_force"][-1]


def test_a_ball_slides_and_rolls_along_a_stiff_cable():
    """It rolls with 5/7 of its speed, as on a plane."""
    grip = CoulombFriction(coefficient=0.3)
    ball = {
        "inertia": (0.4 * 0.01 * 0.05**2,) * 3,
        "mass": 0.01,
        "velocity": (0.5, 0.0, 0.0),
        "position": (0.1, 0.0, 0.06),
    }
    model = cantilever(NewtonImpact(restitution=0.0), grip, stiffness=2e3, **ball)
    result = simulate(model, 0.12, rtol=1e-6)
    assert events(result, "stick")
    assert result["ball.vx"][-1] == pytest.approx(0.5 * 5.0 / 7.0, rel=1e-3)
    assert result["c.sliding_velocity"][-1] < 1e-9
    assert abs(result["energy.balance"][-1]) < 1e-6


def test_what_cannot_touch_is_refused():
    law, ball = NewtonImpact(restitution=0.5), Sphere3D(marker=Marker3D(body="b"), radius=0.1)
    cable, body = Cable3D(**straight(2)), RigidBody3D(name="b", mass=1.0, inertia=(1.0, 1.0, 1.0))
    with pytest.raises(ModelError, match="name a Cable3D"):
        Model(bodies=[body], contacts=[SphereOnCable3D(name="c", cable="b", sphere=ball, law=law)])
    with pytest.raises(ModelError, match="both 0"):
        SphereOnCable3D(name="c", cable="cable", sphere=Sphere3D(marker=Marker3D(body="b")), law=law)
    with pytest.raises(ModelError, match="no torsion"):
        CableOnHalfSpace3D(
            name="c", cable="cable", plane=HalfSpace3D(), place=0.5, law=law, friction=CoulombFriction(coefficient=0.2),
            turning=TurningFriction(rolling=0.1, spinning=0.1),
        )  # fmt: skip
    with pytest.raises(ModelError, match="at most 1"):
        CableOnHalfSpace3D(name="c", cable="cable", plane=HalfSpace3D(), place=1.5, law=law)
    own = MaterialPoint3D(name="p", body="cable", s=1.0)
    with pytest.raises(ModelError, match="itself"):
        touching = Sphere3D(marker=Marker3D(body="p"), radius=0.1)
        Model(bodies=[cable, own], contacts=[SphereOnCable3D(name="c", cable="cable", sphere=touching, law=law)])


def test_a_plane_on_a_moving_body_touches_a_cable():
    """A plate that falls on a clamped cable: action and reaction leave the momentum to weight and clamp alone."""
    cable = Cable3D(
        name="cable", elements=2, length=1.0, mass_per_length=0.3, axial_stiffness=4e2, bending_stiffness=0.7,
        axial_damping=2.0,
    )  # fmt: skip
    plate = RigidBody3D(
        name="plate", mass=0.2, inertia=(1e-3, 1e-3, 2e-3), position=(0.5, 0.0, 0.05), velocity=(0.0, 0.0, -0.5)
    )
    plane = HalfSpace3D(marker=Marker3D(body="plate", point=(0.0, 0.0, -0.02), attitude=Axes(z=(0.0, 0.0, -1.0))))
    contacts = [
        CableOnHalfSpace3D(name=f"c{k}", cable="cable", thickness=0.01, plane=plane, place=place, law=SOFT)
        for k, place in enumerate((0.25, 0.5, 0.75))
    ]
    result = simulate(Model(gravity=(0.0, 0.0, 0.0), bodies=[cable, plate], contacts=contacts), 0.1, rtol=1e-8)
    # the cable's momentum: integral of its velocity, by its shape functions
    length, total = 0.5, 0.2 * result["plate.vz"]
    for e in range(2):
        ends = [result[f"cable.{what}z{k}"] for k in (e, e + 1) for what in ("v", "d_slope_")]
        total = total + 0.3 * length * (0.5 * (ends[0] + ends[2]) + length / 12.0 * (ends[1] - ends[3]))
    assert result["c1.normal_force"].max() > 0.0
    assert np.abs(total - 0.2 * -0.5).max() < 1e-9
