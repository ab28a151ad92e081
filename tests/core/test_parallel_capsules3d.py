"""Capsules side by side: two ends carry; crossed and end to end the five contacts have the distance as least gap."""

import numpy as np
import pytest
from test_tangents import Point
from tlismni.core import (
    Axes,
    Capsule3D,
    CapsuleOnCapsule3D,
    ContactGroup3D,
    CoulombFriction,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    contacts_between,
    simulate,
)
from tlismni.core.contacts.parallel_axes3d import BACK
from tlismni.core.contacts.round3d import SHORTER

L, R, G = 0.6, 0.1, 9.81
SOFT = NewtonImpact(restitution=0.2, rest_ratio=1e-3)
LOG = Capsule3D(marker=Marker3D(body="log"), length=L, radius=R)


def log(**more):
    across = 2.0 * (L * L / 12.0 + R * R / 4.0)
    return RigidBody3D(name="log", **{"mass": 2.0, "inertia": (across, across, R * R)} | more)


def lying(x, y, z, length=L):
    """On the ground, along y."""
    return Capsule3D(marker=Marker3D(point=(x, y, z), attitude=Axes(z=(0.0, 1.0, 0.0))), length=length, radius=R)


def distance(first, second):
    """Of two segments, by a fine search: of points of the first from the second, and again around the best."""
    (a, b), (c, d) = first, second
    low, high = 0.0, 1.0
    for _ in range(12):
        s = np.linspace(low, high, 41)
        points = a + s[:, None] * (b - a)
        t = np.clip((points - c) @ (d - c) / ((d - c) @ (d - c)), 0.0, 1.0)
        away = np.linalg.norm(points - c - t[:, None] * (d - c), axis=1)
        best, width = s[int(away.argmin())], (high - low) / 20.0
        low, high = max(best - width, 0.0), min(best + width, 1.0)
    return float(away.min())


@pytest.mark.sampled(2)
@pytest.mark.parametrize("slope", [2.0, 0.5, 0.01, 0.0])
def test_the_least_gap_is_the_distance(slope):
    """Exact for angles above the tilt, sine 0.033 here; below it to what the axes draw back."""
    rest = lying(0.0, 0.0, 0.0)
    contacts = contacts_between("g", [rest], [LOG], law=SOFT)
    assert len(contacts) == 5 and contacts[0].parallel_tilt == pytest.approx(0.1 * 2.0 * R / L)
    rng = np.random.default_rng(1)
    for place in rng.uniform((-0.4, -0.5, 0.1), (0.4, 0.5, 0.6), (40, 3)):
        way = np.array((slope * rng.uniform(0.8, 1.2), 1.0, slope * rng.uniform(-1.0, 1.0)))
        body = log(position=tuple(place), attitude=Axes(z=tuple(way)))
        point = Point(Model(bodies=[body], contacts=contacts))
        rows = [contact.row for contact in point.workspace.assembly.contacts]
        none = np.zeros(point.n)
        gap = point.at(0.0, point.workspace.assembly.q0, none, none, np.zeros(point.m))[1][rows].min()
        half = 0.5 * L * way / np.linalg.norm(way)
        ends = (np.array((0.0, -0.5 * L, 0.0)), np.array((0.0, 0.5 * L, 0.0)))
        true = distance(ends, (place - half, place + half)) - 2.0 * R
        allowed = 2.0 * R * BACK if 0.0 < slope < 0.1 else SHORTER * L if slope else 0.0
        assert -1e-9 <= gap - true <= allowed + 1e-9


@pytest.mark.parametrize("shift", [0.2, pytest.param(0.0, marks=pytest.mark.full)])
def test_a_log_in_a_groove_of_two_comes_to_rest(shift):
    """Two capsules side by side on the ground: it lies level on both, by two places each, wherever its middle is."""
    apart = 0.13
    ground = [lying(x, 0.0, 0.0) for x in (-apart, apart)]
    start = {"position": (0.01, shift, 0.3), "attitude": Axes(z=(0.02, 1.0, 0.03))}
    contacts = contacts_between("g", ground, [LOG], law=SOFT, friction=CoulombFriction(coefficient=0.3))
    model = Model(gravity=(0.0, 0.0, -G), bodies=[log(**start)], contacts=contacts)
    result = simulate(model, 1.0)
    assert result["log.z"][-1] == pytest.approx(np.sqrt(4.0 * R * R - apart**2), abs=1e-4)
    assert result["energy.kinetic"][-1] < 1e-12
    energy = result["energy.kinetic"] + result["energy.potential"]
    assert np.diff(energy).max() < 1e-6
    assert min(result[f"{contact.name}.gap"].min() for contact in contacts) > -1e-9
    assert sum(result[f"{contact.name}.in_contact"][-1] > 0.5 for contact in contacts) >= 3
    assert result.stats["steps"] < 20000


def test_a_log_across_two_rests_on_both():
    """Crossed it is the contact of the axes that carries."""
    ground = [lying(x, 0.0, 0.0) for x in (-0.2, 0.2)]
    across = log(position=(0.03, 0.02, 0.25), attitude=Axes(z=(1.0, 0.05, 0.02)))
    contacts = contacts_between("g", ground, [LOG], law=SOFT, friction=CoulombFriction(coefficient=0.5))
    result = simulate(Model(gravity=(0.0, 0.0, -G), bodies=[across], contacts=contacts), 1.5)
    carry = [contact for contact in contacts if result[f"{contact.name}.in_contact"][-1] > 0.5]
    assert len(carry) == 2 and all(contact.parallel_tilt > 0.0 for contact in carry)
    assert sum(result[f"{contact.name}.normal_force"][-1] for contact in carry) == pytest.approx(2.0 * G, rel=1e-3)
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_groups_and_files_hold_them(tmp_path):
    group = ContactGroup3D(name="g", capsules=[LOG, lying(0.0, 0.0, 0.0)], law=SOFT)
    model = Model(bodies=[log(position=(0.0, 0.0, 1.0))], groups=[group])
    assert [type(contact) for contact in model.contacts] == [CapsuleOnCapsule3D] * 5
    model.save(tmp_path / "m.json")
    assert Model.load(tmp_path / "m.json") == model
    plain = Model(bodies=model.bodies, contacts=model.contacts)
    assert Model.model_validate_json(plain.model_dump_json()) == plain
