"""Reduced bodies of the plane in exudyn: its floating frame goes the same way, free, on joints and in contact."""

from typing import Any

import numpy as np
import pytest
from exudyn_limits import SETTINGS, compare
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Constant,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    MaterialPoint2D,
    Model,
    ReducedBody2D,
    ReducedPoint,
    Revolute2D,
    RigidBody2D,
    simulate,
)
from tlismni.core.elements import Clamp2D, CoordinateDriver, Prismatic2D, TorsionSpring2D
from tlismni.core.laws import Hertz, Tsuji
from tlismni.validation import NotTranslatable, run_exudyn
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.translation.reduced2d import cloud_in_plane

WEIGHT = (0.6, -9.0)
needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")


def integrals(masses: np.ndarray, places: np.ndarray, shapes: np.ndarray) -> dict[str, np.ndarray]:
    """Fields of a ReducedBody2D of point masses (N,) at `places` (N, 2) that modes (n, N, 2) move."""
    cross = np.einsum("a,ka,la->kl", masses, shapes[..., 0], shapes[..., 1])
    moved = np.einsum("a,aj,kai->kji", masses, places, shapes)
    return {
        "mass": masses.sum(),
        "inertia": masses @ (places**2).sum(axis=1),
        "first_moment": masses @ places,
        "modal_mass": np.einsum("a,kai,lai->kl", masses, shapes, shapes),
        "modal_first_moment": np.einsum("a,kai->ik", masses, shapes),
        "modal_inertia": moved[:, 0, 0] + moved[:, 1, 1],
        "modal_coupling": moved[:, 0, 1] - moved[:, 1, 0],
        "gyroscopic": cross - cross.T,
    }


def body(seed: int, modes: int = 2, stiff: float = 50.0, **changes: Any) -> ReducedBody2D:
    """Of random points, the first three of which others can be attached to; one of these does not turn by the modes."""
    rng = np.random.default_rng(seed)
    masses, places = rng.uniform(0.1, 0.5, 7), rng.normal(size=(7, 2))
    shapes = 0.5 * rng.normal(size=(modes, 7, 2))
    root = rng.normal(size=(modes, modes))
    stiffness = stiff * (root @ root.T + 3.0 * np.eye(modes))
    turns = 0.3 * rng.normal(size=(3, modes))
    points = [
        ReducedPoint(point=tuple(places[k]), shape=shapes[:, k].T.tolist(), rotation=turns[k].tolist() if k else None)
        for k in range(3)
    ]
    fields = {name: value.tolist() for name, value in integrals(masses, places, shapes).items()}
    given = {"stiffness": (0.5 * (stiffness + stiffness.T)).tolist(), "points": points, "angle": 0.4}
    return ReducedBody2D(name="r", **{**fields, **given, **changes})


def point_frames(record: ReducedBody2D) -> list[MaterialPoint2D]:
    return [MaterialPoint2D(name=f"p{k}", body="r", point=given.point) for k, given in enumerate(record.points)]


@pytest.mark.parametrize("seed, modes", [(0, 1), (1, 2), (2, 3), (3, 5)])
def test_the_cloud_has_the_integrals_of_the_body(seed: int, modes: int) -> None:
    record = body(seed, modes)
    each, places, shapes = cloud_in_plane(record)
    assert not places[:, 2].any() and not shapes[..., 2].any()
    for name, value in integrals(np.full(len(places), each), places[:, :2], shapes[..., :2]).items():
        wanted = np.array(getattr(record, name))
        assert np.abs(value - wanted).max() < 1e-13 * max(1.0, np.abs(wanted).max()), name


def test_inertia_of_modes_that_no_turn_of_the_plane_sees_goes_across_it() -> None:
    plain = body(2, 3)
    more = np.array([[0.2, 0.1, 0.0], [0.1, 0.3, 0.0], [0.0, 0.0, 0.0]])
    record = plain.model_copy(
        update={
            "modal_mass": (np.array(plain.modal_mass) + more).tolist(),
            "centrifugal_mass": plain.modal_mass,
        }
    )
    each, places, shapes = cloud_in_plane(record)
    masses = np.full(len(places), each)
    found = integrals(masses, places[:, :2], shapes[..., :2])
    assert np.abs(found["modal_mass"] - plain.modal_mass).max() < 1e-13
    assert np.abs(np.einsum("a,ka,la->kl", masses, shapes[..., 2], shapes[..., 2]) - more).max() < 1e-13


FLIGHT = {
    "position": (0.2, -0.1), "velocity": (0.3, 0.1), "angular_velocity": 1.7, "amplitudes": (0.01, -0.02, 0.015),
    "amplitude_rates": (0.1, 0.0, -0.1), "damping": [[0.2, 0.5, 0.0], [-0.4, 0.3, 0.0], [0.0, 0.0, 0.1]],
}  # fmt: skip


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize("rotary", [False, True])
def test_a_body_that_flies_and_vibrates_follows_the_solver(rotary: bool) -> None:
    flying = body(3, 3, **FLIGHT)
    if rotary:
        mass = np.array(flying.modal_mass)
        flying = body(3, 3, **FLIGHT, centrifugal_mass=mass.tolist(), modal_mass=(mass + 0.3 * np.eye(3)).tolist())
    channels = ("r.x", "r.y", "r.angle", "r.mode1", "r.mode2", "r.mode3", "r.angular_velocity", "r.d_mode2",
                "p0.x", "p1.y", "p1.vx", "p2.x", "p2.vy")  # fmt: skip
    compare(Model(gravity=WEIGHT, bodies=[flying, *point_frames(flying)]), 0.5, channels, 2e-7)


@needs_exudyn
def test_points_turn_by_the_modes_as_far_as_small_angles_go() -> None:
    """Theirs by the modes' rotation phi, ours by arctan phi: what is between them is phi^3/3."""
    flying = body(3, 3, **FLIGHT)
    model = Model(gravity=WEIGHT, bodies=[flying, *point_frames(flying)])
    ours = simulate(model, 0.5, "irk", 1e-9, 1e-11, t_eval=np.linspace(0.0, 0.5, 21))
    coarse, fine = (run_exudyn(model, 0.5, h, SETTINGS) for h in (1e-3, 5e-4))
    for k in (1, 2):
        values = [np.interp(ours.t[1:], r.t, r[f"p{k}.angle"]) for r in (coarse, fine)]
        limit = values[1] + (values[1] - values[0]) / 3.0
        apart = ours[f"p{k}.angle"][1:] - limit
        phi = sum(
            r * ours[f"r.mode{i + 1}"][1:] for i, r in enumerate(np.array(flying.points[k].rotation, dtype=float))
        )
        assert np.abs(phi).max() > 5e-3 and np.abs(apart - (np.arctan(phi) - phi)).max() < 1e-7


def held() -> tuple[ReducedBody2D, list[np.ndarray]]:
    record = body(3, 2, 400.0)
    c, s = np.cos(record.angle), np.sin(record.angle)
    turn = np.array([[c, -s], [s, c]])
    return record, [turn @ np.array(given.point) for given in record.points]


@needs_exudyn
def test_a_body_on_joints_at_its_points_follows_the_solver() -> None:
    """It hangs from one point, carries a weight welded to the frame of another, which turns, and a load at an arm of
    the third and a torque."""
    record, places = held()
    weight = RigidBody2D(name="weight", mass=0.4, inertia=0.03, position=tuple(places[1]), angle=0.2)
    model = Model(
        gravity=WEIGHT,
        bodies=[record, *point_frames(record), weight],
        joints=[
            Revolute2D(name="pin", a=Marker2D(point=tuple(places[0])), b=Marker2D(body="p0")),
            Clamp2D(name="weld", a=Marker2D(body="p1"), b=Marker2D(body="weight")),
        ],
        forces=[
            AppliedForce2D(name="pull", marker=Marker2D(body="p2", point=(0.0, 0.3)), force_x=Constant(value=3.0)),
            AppliedTorque2D(name="twist", body="p2", torque=Constant(value=0.7)),
        ],
    )
    channels = ("weight.x", "weight.y", "weight.angle", "r.angle", "r.mode1", "r.mode2", "p2.x")
    compare(model, 0.4, channels, 1e-6)


@needs_exudyn
def test_joints_and_forces_on_its_frame_follow_the_solver() -> None:
    """Its frame slides along a rail at a marker beside its origin, one mode is driven, a spring holds it to a point."""
    record, places = held()
    hub = RigidBody2D(name="hub", mass=0.8, inertia=0.2, position=tuple(places[1]), angular_velocity=0.5)
    c, s = np.cos(record.angle), np.sin(record.angle)
    rail = (0.2 * c + 0.1 * s, 0.2 * s - 0.1 * c)
    model = Model(
        gravity=WEIGHT,
        bodies=[record, *point_frames(record), hub],
        joints=[
            Prismatic2D(name="rail", a=Marker2D(point=rail, angle=0.3), b=Marker2D(body="r", point=(0.2, -0.1))),
            Revolute2D(name="pin", a=Marker2D(body="hub"), b=Marker2D(body="p1")),
            CoordinateDriver(name="still", body="r", coordinate="mode2", motion=Constant(value=0.0)),
        ],
        forces=[
            TorsionSpring2D(name="spring", a=Marker2D(body="p1"), b=Marker2D(body="hub"), stiffness=9.0, damping=0.1),
            AppliedForce2D(name="pull", marker=Marker2D(body="r", point=(0.0, 0.5)), force_y=Constant(value=6.0)),
        ],
    )
    compare(model, 0.3, ("r.x", "r.y", "hub.angle", "r.mode1", "p1.y"), 1e-6)


HERTZ, TSUJI = Hertz(stiffness=2e4), Tsuji(stiffness=2e4, damping=0.1)


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize(
    ("law", "place"),
    [
        (HERTZ, "point"),
        (TSUJI, "frame"),
        pytest.param(HERTZ, "frame", marks=pytest.mark.full),
        pytest.param(TSUJI, "point", marks=pytest.mark.full),
    ],
)
def test_a_place_that_strikes_a_floor_follows_the_solver(law: Any, place: str) -> None:
    """With exudyn's own contact on a marker of the body, and with a user function of its coordinates."""
    record, places = held()
    low = float(places[1][1])
    marker = Marker2D(body="p1") if place == "point" else Marker2D(body="r", point=record.points[1].point)
    floor = HalfPlane2D(marker=Marker2D(point=(0.0, low - 0.06)))
    disk = Disk2D(marker=marker, radius=0.05)
    model = Model(
        gravity=(0.0, -9.0),
        bodies=[record.model_copy(update={"velocity": (0.1, -0.5)}), *point_frames(record)],
        contacts=[DiskOnHalfPlane2D(name="floor", plane=floor, disk=disk, law=law)],
    )
    ours = simulate(model, 0.1, "irk", 1e-9, 1e-11, t_eval=np.linspace(0.0, 0.1, 41))
    theirs = run_exudyn(model, 0.1, 1e-5, SETTINGS)
    for channel in ("r.angular_velocity", "r.mode1", "r.d_mode2", "p1.vy", "floor.gap", "floor.impulse"):
        values = np.interp(ours.t, theirs.t, theirs[channel])
        assert np.abs(values - ours[channel]).max() < 1e-6 * np.ptp(ours[channel]), channel
    assert ours["floor.impulse"][-1] > 0.1


def test_what_exudyns_frame_does_not_have_is_said() -> None:
    with pytest.raises(NotTranslatable, match="integrals of second order"):
        cloud_in_plane(body(1, 1, geometric_inertia=[[-0.1]]))
    mass = np.array(body(1).modal_mass)
    with pytest.raises(NotTranslatable, match="no points of mass have its integrals"):
        cloud_in_plane(body(1, centrifugal_mass=(0.1 * mass).tolist()))
    with pytest.raises(NotTranslatable, match="more than modal_mass"):
        cloud_in_plane(body(1, centrifugal_mass=(1.1 * mass).tolist()))
