"""Ropes, end stops and hollow shapes are reached within a step and left again: no touch is passed by.

A point of a spinning body goes farthest from a fixed one, or along an axis, once in a while: a limit a little below is
reached just before. Angles turn back just beyond a limit, whole turns from where they began.
"""

import math

import numpy as np
import pytest
from helpers import events
from tlismni.core import (
    AngleStop2D,
    AngleStop3D,
    AppliedTorque2D,
    AppliedTorque3D,
    Constant,
    Disk2D,
    DiskInRing2D,
    DistanceStop3D,
    KelvinVoigt,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    Ring2D,
    Rope2D,
    Rope3D,
    SlideStop3D,
    Sphere3D,
    SphereInSphere3D,
    simulate,
)

METHODS = ("ebdf", "irk", "bdf", "adams")
SAMPLE = 12


def course(rng, d):
    """(body, marker of a point of it, places of that point at times (N,)) of an evenly spinning body."""
    rate, drift = rng.uniform(3.0, 30.0), rng.normal(size=d)
    arm, place = rng.uniform(0.2, 1.0), rng.normal(size=d)
    place[-1] += 3.0
    if d == 2:
        body = RigidBody2D(
            name="b", mass=1.0, inertia=1e3, position=tuple(place), velocity=tuple(drift), angular_velocity=rate
        )
        return body, Marker2D(body="b", point=(arm, 0.0)), _places(place, drift, arm, rate)
    body = RigidBody3D(
        name="b", mass=1.0, inertia=(1e3,) * 3, position=tuple(place), velocity=tuple(drift),
        angular_velocity=(rate, 0.0, 0.0),
    )  # fmt: skip
    return body, Marker3D(body="b", point=(0.0, arm, 0.0)), _places(place, drift, arm, rate)


def _places(place, drift, arm, rate):
    def at(t):
        t = np.atleast_1d(t)
        x = place + t[:, None] * drift
        x[:, -2] += arm * np.cos(rate * t)
        x[:, -1] += arm * np.sin(rate * t)
        return x

    return at


def stops(kind, law, rng):
    """(model, gap at times (N,), end in s, depth in m) of a limit that the point passes by `depth`; None if it is
    farthest at an end of the course."""
    d = 2 if kind.endswith("2D") else 3
    body, marker, places = course(rng, d)
    end, along = rng.uniform(0.3, 2.0), kind == "SlideStop3D"
    t = np.linspace(0.0, end, 20_001)

    def measure(t):
        return places(t)[:, 2] if along else np.linalg.norm(places(t), axis=1)

    side = rng.choice(["upper", "lower"]) if kind in ("SlideStop3D", "DistanceStop3D") else "upper"
    sign, x = (1.0 if side == "upper" else -1.0), measure(t)
    best = int(np.argmax(sign * x))
    if not 0.1 * len(t) < best < 0.9 * len(t):
        return None
    depth = 10.0 ** rng.uniform(-4.0, -1.0)
    limit = float(x[best] - sign * depth)
    if sign * (limit - x[0]) < 1e-2 or limit < 0.1:
        return None
    ground = Marker2D() if d == 2 else Marker3D()
    contact = {
        "Rope2D": lambda: Rope2D(name="c", a=ground, b=marker, length=limit, law=law),
        "Rope3D": lambda: Rope3D(name="c", a=ground, b=marker, length=limit, law=law),
        "DistanceStop3D": lambda: DistanceStop3D(name="c", a=ground, b=marker, limit=limit, side=side, law=law),
        "SlideStop3D": lambda: SlideStop3D(name="c", a=ground, b=marker, limit=limit, side=side, law=law),
        "DiskInRing2D": lambda: DiskInRing2D(
            name="c", shape=Ring2D(marker=ground, radius=1.1 * limit), disk=Disk2D(marker=marker, radius=0.1 * limit),
            law=law,
        ),
        "SphereInSphere3D": lambda: SphereInSphere3D(
            name="c", hollow=Sphere3D(marker=ground, radius=1.1 * limit),
            sphere=Sphere3D(marker=marker, radius=0.1 * limit), law=law,
        ),
    }[kind]()  # fmt: skip
    still = (0.0,) * d
    return Model(gravity=still, bodies=[body], contacts=[contact]), lambda t: sign * (limit - measure(t)), end, depth


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "kind", ["Rope2D", "DiskInRing2D", "Rope3D", "DistanceStop3D", "SlideStop3D", "SphereInSphere3D"]
)
def test_what_goes_a_little_beyond_its_limit_and_back_is_seen(kind):
    wrong, made = [], 0
    for seed in range(8 * SAMPLE):
        rng = np.random.default_rng(seed)
        law = NewtonImpact(restitution=0.5) if seed % 3 else KelvinVoigt(stiffness=10.0, damping=0.0)
        item = stops(kind, law, rng)
        if item is None:
            continue
        made += 1
        model, gap, end, depth = item
        t = np.linspace(0.0, end, 20_001)
        deep = t[np.flatnonzero(gap(t) < -0.5 * depth)[0]]
        result = simulate(model, end * rng.uniform(1.0, 2.0), METHODS[seed % 4], rtol=1e-8)
        hits = events(result, "impact", "close", "graze", "rest")
        if not hits or hits[0].t > deep or abs(gap(hits[0].t)[0]) > 0.05 * depth + 1e-6:
            wrong.append((seed, law.type, METHODS[seed % 4], deep, hits[:1]))
        if made == SAMPLE:
            break
    assert made >= 4 and wrong == []


@pytest.mark.sampled(1)
@pytest.mark.parametrize("space", [False, True])
def test_angle_turns_back_just_beyond_its_limit(space):
    """omega_0 t - alpha t^2/2 goes up to omega_0^2/(2 alpha), several turns."""
    for seed in range(SAMPLE):
        rng = np.random.default_rng(seed)
        rate, most, beyond = rng.uniform(5.0, 50.0), rng.uniform(1.0, 30.0), 10.0 ** rng.uniform(-4.0, -1.0)
        alpha, limit = rate**2 / (2.0 * most), most * (1.0 - beyond)
        touch = (rate - math.sqrt(rate**2 - 2.0 * alpha * limit)) / alpha
        law = NewtonImpact(restitution=0.5) if seed % 3 else KelvinVoigt(stiffness=1.0, damping=0.0)
        if space:
            ends = {"a": Marker3D(), "b": Marker3D(body="b")}
            model = Model(
                gravity=(0.0, 0.0, 0.0), contacts=[AngleStop3D(name="c", **ends, limit=limit, law=law)],
                bodies=[RigidBody3D(name="b", mass=1.0, inertia=(1.0, 1.0, 1.0), angular_velocity=(0.0, 0.0, rate))],
                joints=[Revolute3D(name="pin", **ends)],
                forces=[AppliedTorque3D(name="brake", marker=Marker3D(body="b"), torque_z=Constant(value=-alpha))],
            )  # fmt: skip
        else:
            ends = {"a": Marker2D(), "b": Marker2D(body="b")}
            model = Model(
                gravity=(0.0, 0.0), contacts=[AngleStop2D(name="c", **ends, limit=limit, law=law)],
                bodies=[RigidBody2D(name="b", mass=1.0, inertia=1.0, angular_velocity=rate)],
                joints=[Revolute2D(name="pin", **ends)],
                forces=[AppliedTorque2D(name="brake", body="b", torque=Constant(value=-alpha))],
            )  # fmt: skip
        result = simulate(model, 2.0 * touch * rng.uniform(1.0, 2.0), METHODS[seed % 4], rtol=1e-9)
        hits = events(result, "impact", "close", "graze", "rest")
        assert hits, (seed, limit, touch)
        slow = math.sqrt(2.0 * alpha * most * beyond)
        assert abs(hits[0].t - touch) < 1e-6 * most / slow + 1e-9 * touch, (seed, hits[0].t, touch)
