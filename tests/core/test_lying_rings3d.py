"""Disks, tori and cylinders that come to lie flat: what their rims reach, rest, spinning, rolling."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    ContactGroup3D,
    CoulombFriction,
    Cylinder3D,
    HalfSpace3D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    Rim3D,
    RotationVector,
    SmoothOnHalfSpace3D,
    Sphere3D,
    Torus3D,
    contacts_between,
    simulate,
)
from tlismni.core.contacts.rings3d import EDGE, FLAT_TILT, WITHIN

G, R, H = 9.81, 0.15, 0.02
ON = Marker3D(body="b")
SOFT = NewtonImpact(restitution=0.3, rest_ratio=1e-3)
SHAPES = {
    "disk": (Torus3D(marker=ON, radius=R), 0.0),
    "torus": (Torus3D(marker=ON, radius=R, rim_radius=0.02), 0.02),
    "cylinder": (Cylinder3D(marker=ON, radius=R, length=H), 0.5 * H),
}
GRIP = CoulombFriction(coefficient=0.3)


def coin(shape, friction=None, law=SOFT, plane=None, **more):
    across, along = (3.0 * R * R + H * H) / 12.0, 0.5 * R * R
    body = RigidBody3D(name="b", **{"mass": 1.0, "inertia": (across, across, along), "position": (0, 0, 0.3)} | more)
    floor = HalfSpace3D(marker=Marker3D()) if plane is None else plane
    contacts = contacts_between("g", [floor], [shape], law=law, friction=friction)
    return Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=contacts)


def least_gap(result, model):
    return min(float(result[f"{contact.name}.gap"].min()) for contact in model.contacts)


@pytest.mark.parametrize("sine", [0.0, 0.4 * EDGE, 3.0 * EDGE, 0.005, 0.03, 0.3])
@pytest.mark.parametrize("kind", [Torus3D, Rim3D])
def test_derivatives_of_what_a_ring_reaches(kind, sine):
    """Against differences, as smooth as the rim is at this tilt; flat they exist too."""
    shape = kind(marker=ON, radius=0.7, rim_radius=0.1)
    turn = 0.4
    c = 1.3 * np.array([sine * math.cos(turn), sine * math.sin(turn), math.sqrt(1.0 - sine * sine)])
    found = shape.support(tuple(c))
    assert np.isfinite(found).all() and c @ found[1:4] == pytest.approx(found[0], rel=1e-12)
    size = 0.02 * (max(sine, EDGE) if kind is Torus3D else FLAT_TILT)
    slope, bend = np.zeros(3), np.zeros((3, 3))
    for k, step in enumerate(size * np.eye(3)):
        sides = [np.array(shape.support(tuple(c + x * step))) for x in (1.0, -1.0, 0.5, -0.5)]
        difference = (8.0 * (sides[2] - sides[3]) - (sides[0] - sides[1])) / (6.0 * size)
        slope[k], bend[k] = difference[0], difference[1:4]
    assert slope == pytest.approx(np.array(found[1:4]), abs=1e-7)
    matrix = np.array([[found[4], found[5], found[6]], [found[5], found[7], found[8]], [found[6], found[8], found[9]]])
    assert np.abs(bend - matrix).max() < 2e-5 * max(1.0, np.abs(matrix).max())


@pytest.mark.parametrize("count", [3, 8])
def test_flat_the_points_reach_farther_than_the_rim_and_tilted_the_rim(count):
    rim = Rim3D(marker=ON, radius=0.7, rim_radius=0.1)
    points = np.array([point.marker.point for point in rim.points(count)])
    for tilt in np.linspace(0.0, 0.2, 41):
        for turn in np.linspace(0.0, 2.0 * math.pi, 13):
            c = np.array([math.sin(tilt) * math.cos(turn), math.sin(tilt) * math.sin(turn), math.cos(tilt)])
            reach, of_points = rim.support(tuple(c))[0], (points @ c).max() + 0.1
            if math.sin(tilt) >= FLAT_TILT:
                assert reach == pytest.approx(0.7 * math.sin(tilt) + 0.1, rel=1e-14) and reach > of_points
            elif math.sin(tilt) <= 0.1 * FLAT_TILT:
                assert reach < of_points
            # nowhere is the hull of both far from the ring
            whole = max(reach, of_points)
            ring = 0.7 * math.sin(tilt) + 0.1
            assert ring - 0.7 * FLAT_TILT * (1.0 - math.cos(math.pi / count) + WITHIN) < whole < ring + 1e-12


@pytest.mark.parametrize("name", SHAPES)
def test_flat_above_a_plane_gaps_are_heights(name):
    """A rim alone too: a disk whose axis is the normal fell through the floor (gap not a number)."""
    shape, half = SHAPES[name]
    for points in (0, 6):
        ring = shape.model_copy(update={"rim_points": points})
        law = NewtonImpact(restitution=0.5)
        model = coin(ring, law=law, position=(0.0, 0.0, 0.2 + half), angular_velocity=(0.0, 0.0, 3.0))
        result = simulate(model, 0.3)
        gaps = np.array([result[f"{contact.name}.gap"] for contact in model.contacts])
        assert np.isfinite(gaps).all()
        heights = result["b.z"] - half
        assert gaps.min(axis=0) == pytest.approx(heights, abs=1e-12) and heights.min() > -1e-12
        # it bounces once without turning over: v = e sqrt(2 g h)
        hit, speed = math.sqrt(0.4 / G), 0.5 * math.sqrt(0.4 * G)
        last = 0.3 - hit
        assert heights[-1] == pytest.approx(speed * last - 0.5 * G * last**2, abs=1e-9)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("friction", [None, GRIP], ids=["smooth", "rough"])
@pytest.mark.parametrize("name", SHAPES)
def test_dropped_tilted_it_comes_to_rest(name, friction):
    shape, half = SHAPES[name]
    model = coin(shape, friction, attitude=RotationVector(vector=(0.3, 0.1, 0.0)))
    result = simulate(model, 1.5)
    assert result["b.z"][-1] == pytest.approx(half, abs=1e-9)
    assert result["energy.kinetic"][-1] < 1e-12
    energy = result["energy.kinetic"] + result["energy.potential"]
    assert np.diff(energy).max() < 1e-6 and np.abs(result["energy.balance"]).max() < 1e-6
    assert least_gap(result, model) > -1e-11
    # alone, its rim took 500 000 steps and more
    assert result.stats["steps"] < 2000


@pytest.mark.parametrize("friction", [None, GRIP], ids=["smooth", "rough"])
@pytest.mark.parametrize("name", SHAPES)
def test_lying_flat_it_stays(name, friction):
    shape, half = SHAPES[name]
    for points in (0, 8):
        result = simulate(
            coin(shape.model_copy(update={"rim_points": points}), friction, position=(0.1, 0.2, half)), 1.0
        )
        assert result["b.z"] == pytest.approx(half, abs=1e-11)
        assert np.abs(result["b.x"] - 0.1).max() < 1e-11 and result["energy.kinetic"].max() < 1e-20
        assert {event.kind for event in result.events} <= {"close", "stick"}


@pytest.mark.parametrize("name", SHAPES)
def test_spinning_flat_it_stops(name):
    """All weight at the radius R' of the points: J w/(mu m g R'), however the points share it."""
    shape, half = SHAPES[name]
    spin = 4.0
    result = simulate(coin(shape, GRIP, position=(0.0, 0.0, half), angular_velocity=(0.0, 0.0, spin)), 0.5)
    stops = 0.5 * R * R * spin / (0.3 * G * R * (1.0 - WITHIN))
    assert stops < 0.4
    sticks = [event.t for event in result.events if event.kind == "stick"]
    assert sticks[-1] == pytest.approx(stops, rel=1e-6)
    assert result["energy.kinetic"][-1] < 1e-12
    before = result.t < stops
    rate = result["b.angular_velocity_z"][before]
    assert rate == pytest.approx(spin * (1.0 - result.t[before] / stops), abs=1e-6)


def test_above_the_tilt_it_rolls_as_its_rim_alone():
    """A disk that runs round on its rim with its centre nearly at rest."""
    r, tilt = 0.2, 0.3
    rate = 1.1 * math.sqrt(4.0 * G / (r * math.sin(tilt)))
    down = np.array([math.cos(tilt), 0.0, -math.sin(tilt)])
    start = {
        "inertia": (r * r / 4.0, r * r / 4.0, r * r / 2.0), "position": (0.0, 0.0, r * math.sin(tilt)),
        "attitude": Axes(z=(math.sin(tilt), 0.0, math.cos(tilt))), "angular_velocity_in": "space",
        "angular_velocity": tuple(-rate * math.sin(tilt) * down),
    }  # fmt: skip
    runs = [
        simulate(coin(Torus3D(marker=ON, radius=r, rim_points=count), GRIP, **start), 0.5, rtol=1e-9, t_eval=[0.5])
        for count in (0, 8)
    ]
    for axis in "xyz":
        assert runs[1][f"b.{axis}"][-1] == pytest.approx(runs[0][f"b.{axis}"][-1], abs=1e-8)


def test_a_plane_askew_and_moved_changes_nothing():
    """Gravity, plane and start turned and moved together."""
    turn = RotationVector(vector=(0.4, -0.7, 0.3))
    frame = Marker3D(point=(1.0, 2.0, -0.5), attitude=turn)
    axes, shift = frame.axes(), np.array(frame.point)
    shape, start = SHAPES["disk"][0], Marker3D(attitude=RotationVector(vector=(0.3, 0.1, 0.0))).axes()
    ends = []
    for rotation, place in ((np.eye(3), np.zeros(3)), (axes, shift)):
        z, x = (tuple((rotation @ start[:, k]).tolist()) for k in (2, 0))
        model = coin(
            shape, GRIP, plane=HalfSpace3D(marker=frame if rotation is axes else Marker3D()), attitude=Axes(z=z, x=x),
            position=tuple((place + rotation @ (0.0, 0.0, 0.3)).tolist()),
        )  # fmt: skip
        model = model.model_copy(update={"gravity": tuple((rotation @ (0.0, 0.0, -G)).tolist())})
        result = simulate(model, 0.3, rtol=1e-9)
        end = np.array([result[f"b.{axis}"][-1] for axis in "xyz"])
        ends.append(rotation.T @ (end - place))
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)


def test_groups_and_files_hold_them(tmp_path):
    body = RigidBody3D(name="b", mass=1.0, inertia=(0.01, 0.01, 0.02), position=(0.0, 0.0, 0.3))
    group = ContactGroup3D(
        name="g", smooth=[Torus3D(marker=ON, radius=R, rim_points=5)], half_spaces=[HalfSpace3D()], law=SOFT
    )
    model = Model(bodies=[body], groups=[group])
    kinds = [type(contact).__name__ for contact in model.contacts]
    assert kinds == ["SmoothOnHalfSpace3D", *["SphereOnHalfSpace3D"] * 5]
    model.save(tmp_path / "m.json")
    assert Model.load(tmp_path / "m.json") == model
    plain = Model(bodies=[body], contacts=model.contacts)
    assert Model.model_validate_json(plain.model_dump_json()) == plain
    assert isinstance(plain.contacts[0], SmoothOnHalfSpace3D) and isinstance(plain.contacts[0].shape, Rim3D)
    assert isinstance(plain.contacts[1].sphere, Sphere3D)


def test_too_few_points_are_refused():
    for kind in (Torus3D, lambda **more: Cylinder3D(length=0.1, **more)):
        with pytest.raises(ModelError, match="2 points of a rim do not hold"):
            kind(marker=ON, radius=R, rim_points=2)
