"""Random passages of two rigid bodies over all pairs of shapes: free flight, even spin; sizes, speeds, depth at random.

The first body flies and turns evenly, or is the ground; the second too, or it falls. Two shapes overlap by a chosen
depth at a chosen instant, so they touch before. When, an independent gap in numpy says, sampled densely.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.spatial.transform import Rotation
from tlismni.core import (
    Box2D,
    Box3D,
    Capsule3D,
    ContactGroup2D,
    ContactGroup3D,
    ConvexPolyhedron3D,
    Cylinder3D,
    Disk2D,
    Ellipsoid3D,
    EulerParameters,
    HalfPlane2D,
    HalfSpace3D,
    KelvinVoigt,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    Polygon2D,
    RigidBody2D,
    RigidBody3D,
    Segment2D,
    Sphere3D,
    Torus3D,
)

SAMPLES = 6000
TURNS = 12.0
"""Most radians that a body turns in a passage."""


@dataclass
class Flight:
    """Motion of a body: its place and velocity at t = 0, an even acceleration, its attitude about an axis."""

    place: np.ndarray
    velocity: np.ndarray
    attitude: Any
    """rad in the plane, a Rotation in space."""
    rate: Any
    """rad/s, a number or a vector."""
    falls: Any = 0.0
    """m/s^2."""

    def at(self, t):
        """Places (N, d) and turning matrices (N, d, d)."""
        t = np.atleast_1d(t)
        x = self.place + t[:, None] * self.velocity + 0.5 * t[:, None] ** 2 * self.falls
        if np.ndim(self.rate) == 0:
            c, s = np.cos(self.attitude + self.rate * t), np.sin(self.attitude + self.rate * t)
            return x, np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)
        return x, (Rotation.from_rotvec(t[:, None] * self.rate) * self.attitude).as_matrix()


@dataclass
class Passage:
    """A model with the first time at which its shapes touch, s, and the end of the passage."""

    model: Any
    touch: float
    end: float
    tolerance: float
    note: dict = field(default_factory=dict)


# gaps of a point y (N, d) in the frame of a shape, m


def _box(half):
    def gap(y):
        d = np.abs(y) - half
        return np.linalg.norm(np.maximum(d, 0.0), axis=-1) + np.minimum(d.max(axis=-1), 0.0)

    return gap


def _segment(half):
    """Along the last axis in space, the first in the plane."""

    def gap(y):
        axis = 0 if y.shape[-1] == 2 else 2
        nearest = np.zeros_like(y)
        nearest[..., axis] = np.clip(y[..., axis], -half, half)
        return np.linalg.norm(y - nearest, axis=-1)

    return gap


def _hull(normals, places, corners):
    """A convex polygon or polyhedron: outside the least distance of corners, edges, faces, by projection onto it."""

    def gap(y):
        inside = (y @ normals.T - places).max(axis=-1)
        found = np.where(inside <= 0.0, inside, np.inf)
        for i in range(len(corners)):
            for j in range(i):
                a, b = corners[i], corners[j]
                s = np.clip((y - a) @ (b - a) / np.dot(b - a, b - a), 0.0, 1.0)
                d = np.linalg.norm(y - a - s[..., None] * (b - a), axis=-1)
                found = np.where(inside > 0.0, np.minimum(found, d), found)
        for n, p in zip(normals, places, strict=True):
            foot = y - (y @ n - p)[..., None] * n
            on = ((foot @ normals.T - places) <= 1e-12 * np.abs(places).max()).all(axis=-1)
            found = np.where((inside > 0.0) & on, np.minimum(found, np.abs(y @ n - p)), found)
        return found

    return gap


def _cylinder(radius, half):
    def gap(y):
        d = np.stack([np.hypot(y[..., 0], y[..., 1]) - radius, np.abs(y[..., 2]) - half], -1)
        return np.linalg.norm(np.maximum(d, 0.0), axis=-1) + np.minimum(d.max(axis=-1), 0.0)

    return gap


def _circle(radius):
    return lambda y: np.hypot(np.hypot(y[..., 0], y[..., 1]) - radius, y[..., 2])


def _ellipsoid(axes):
    """The distance by its dual: the largest height over a tangent plane, by bisection on the multiplier."""
    a2 = np.asarray(axes) ** 2

    def gap(y):
        # nearest point y a^2/(a^2 + m) with sum (y a/(a^2 + m))^2 = 1, m >= 0 outside
        low = np.zeros(y.shape[:-1])
        high = np.linalg.norm(y, axis=-1) * math.sqrt(a2.max()) + 1e-300
        outside = np.sum(y**2 / a2, axis=-1) > 1.0
        for _ in range(200):
            m = 0.5 * (low + high)
            above = np.sum(a2 * y**2 / (a2 + m[..., None]) ** 2, axis=-1) > 1.0
            low, high = np.where(above, m, low), np.where(above, high, m)
        near = y * a2 / (a2 + low[..., None])
        level = np.sqrt(np.sum(y**2 / a2, axis=-1))
        return np.where(outside, np.linalg.norm(y - near, axis=-1), (level - 1.0) * math.sqrt(a2.min()))

    return gap


# shapes: (shape of the library on a marker, gap of a point, how large it is)


def _polygon(rng, size):
    count = int(rng.integers(3, 8))
    angles = (np.arange(count) + rng.uniform(-0.3, 0.3, count)) * 2.0 * math.pi / count
    corners = size * np.stack([np.cos(angles), np.sin(angles)], -1)
    sides = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([sides[:, 1], -sides[:, 0]], -1) / np.linalg.norm(sides, axis=1)[:, None]
    return corners, normals, np.sum(normals * corners, axis=1)


TETRAHEDRON = np.array([(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)]) / math.sqrt(3.0)


def _marker(body, turn, point=None):
    """On a body; without one on the ground, turned."""
    planar = np.ndim(turn) == 0 and not isinstance(turn, Rotation)
    on = {} if point is None else {"point": tuple(point)}
    if body is not None:
        return Marker2D(body=body, **on) if planar else Marker3D(body=body, **on)
    if planar:
        c, s = math.cos(turn), math.sin(turn)
        x, y = (0.0, 0.0) if point is None else point
        return Marker2D(point=(c * x - s * y, s * x + c * y), angle=turn)
    x, y, z, w = turn.as_quat()
    return Marker3D(attitude=EulerParameters(values=(w, x, y, z)))


def planar_shape(kind, rng, size, body, turn):
    """(arguments of a group, gap of a point) of a planar shape about the origin of a body, or the ground's."""
    marker, thin = _marker(body, turn), 10.0 ** rng.uniform(-2.0, 0.0)
    if kind == "disk":
        return {"disks": [Disk2D(marker=marker, radius=size)]}, lambda y: np.linalg.norm(y, axis=-1) - size
    if kind == "box":
        half = size * np.array([1.0, thin])
        return {"boxes": [Box2D(marker=marker, width=2.0 * half[0], height=2.0 * half[1])]}, _box(half)
    if kind == "polygon":
        corners, normals, places = _polygon(rng, size)
        return {"polygons": [Polygon2D(marker=marker, vertices=corners.tolist())]}, _hull(normals, places, corners)
    if kind == "segment":
        at, radius = _marker(body, turn, (-size, 0.0)), 0.5 * thin * size
        axis = _segment(size)
        return {"segments": [Segment2D(marker=at, length=2.0 * size, radius=radius)]}, lambda y: axis(y) - radius
    return {"half_planes": [HalfPlane2D(marker=marker)]}, lambda y: y[..., 1]


def spatial_shape(kind, rng, size, body, turn):
    """The same of a shape in space."""
    marker, thin = _marker(body, turn), 10.0 ** rng.uniform(-2.0, 0.0)
    if kind == "sphere":
        return {"spheres": [Sphere3D(marker=marker, radius=size)]}, lambda y: np.linalg.norm(y, axis=-1) - size
    if kind == "box":
        half = size * np.array([1.0, rng.uniform(0.1, 1.0), thin])
        return {"boxes": [Box3D(marker=marker, size=tuple(2.0 * half))]}, _box(half)
    if kind == "polyhedron":
        corners = size * TETRAHEDRON * np.array([1.0, 1.0, thin])
        faces = [np.delete(np.arange(4), k) for k in range(4)]
        normals, places = [], []
        for f in faces:
            n = np.cross(corners[f[1]] - corners[f[0]], corners[f[2]] - corners[f[0]])
            n *= np.sign(n @ corners[f[0]]) / np.linalg.norm(n)
            normals.append(n)
            places.append(n @ corners[f[0]])
        shape = ConvexPolyhedron3D(marker=marker, vertices=corners.tolist())
        return {"polyhedra": [shape]}, _hull(np.array(normals), np.array(places), corners)
    if kind == "capsule":
        radius, axis = thin * size, _segment(size)
        return {"capsules": [Capsule3D(marker=marker, length=2.0 * size, radius=radius)]}, lambda y: axis(y) - radius
    if kind == "cylinder":
        return {"cylinders": [Cylinder3D(marker=marker, radius=size, length=2.0 * thin * size)]}, _cylinder(
            size, thin * size
        )
    if kind == "disk":
        return {"smooth": [Torus3D(marker=marker, radius=size)]}, _cylinder(size, 0.0)
    if kind == "ring":
        rim, circle = 0.3 * thin * size, _circle(size)
        return {"smooth": [Torus3D(marker=marker, radius=size, rim_radius=rim)]}, lambda y: circle(y) - rim
    if kind == "ellipsoid":
        axes = size * np.array([1.0, rng.uniform(0.2, 1.0), max(thin, 0.05)])
        return {"smooth": [Ellipsoid3D(marker=marker, half_axes=tuple(axes))]}, _ellipsoid(axes)
    return {"half_spaces": [HalfSpace3D(marker=marker)]}, lambda y: y[..., 2]


def _support(kind, group):
    """How far a shape reaches along unit vectors n (N, d) in its frame, m."""
    shape = next(iter(group.values()))[0]
    if kind in ("box", "polygon", "polyhedron"):
        if kind == "polygon" or kind == "polyhedron":
            corners = np.array(shape.vertices)
            return lambda n: (n @ corners.T).max(axis=-1)
        half = np.array([shape.width, shape.height]) if isinstance(shape, Box2D) else np.array(shape.size)
        return lambda n: np.abs(n) @ (0.5 * half)
    if kind == "capsule":
        return lambda n: 0.5 * shape.length * np.abs(n[..., 2]) + shape.radius
    if kind == "cylinder":
        return lambda n: shape.radius * np.hypot(n[..., 0], n[..., 1]) + 0.5 * shape.length * np.abs(n[..., 2])
    if kind in ("disk", "ring"):
        return lambda n: shape.radius * np.hypot(n[..., 0], n[..., 1]) + shape.rim_radius
    return lambda n: np.sqrt((n * np.array(shape.half_axes)) ** 2 @ np.ones(3))


def _over_plane(support, d):
    """Gap of a half-space, the first body, and a shape: height of the lowest point."""

    def gap(xa, ra, xb, rb):
        n = ra[:, :, d - 1]
        return np.sum(n * (xb - xa), axis=-1) - support(-np.einsum("nji,nj->ni", rb, n))

    return gap


def _polytopes(points_a, points_b, normals_a, normals_b, sides_a, sides_b):
    """Largest separation along the normals of both, and in space across pairs of edges (separating axes)."""

    def gap(xa, ra, xb, rb):
        axes = [np.broadcast_to(n, xa.shape) @ np.eye(xa.shape[1]) for n in normals_a]
        axes = [np.einsum("nij,j->ni", ra, n) for n in normals_a] + [np.einsum("nij,j->ni", rb, n) for n in normals_b]
        for u in sides_a:
            for w in sides_b:
                n = np.cross(np.einsum("nij,j->ni", ra, u), np.einsum("nij,j->ni", rb, w))
                size = np.linalg.norm(n, axis=-1, keepdims=True)
                axes.append(np.where(size > 1e-6, n / np.maximum(size, 1e-300), 0.0))
        found = np.full(len(xa), -np.inf)
        pa = xa[:, None] + np.einsum("nij,kj->nki", ra, points_a)
        pb = xb[:, None] + np.einsum("nij,kj->nki", rb, points_b)
        for n in axes:
            a, b = np.einsum("nki,ni->nk", pa, n), np.einsum("nki,ni->nk", pb, n)
            apart = np.maximum(b.min(axis=1) - a.max(axis=1), a.min(axis=1) - b.max(axis=1))
            found = np.maximum(found, np.where(np.any(n != 0.0, axis=-1), apart, -np.inf))
        return found

    return gap


def _parts(kind, group):
    """(corners, normals of faces, directions of edges) of a polytope."""
    shape = next(iter(group.values()))[0]
    if isinstance(shape, Box2D):
        half, signs = 0.5 * np.array([shape.width, shape.height]), np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
        return signs * half, np.eye(2), []
    if isinstance(shape, Polygon2D):
        corners = np.array(shape.vertices)
        sides = np.roll(corners, -1, axis=0) - corners
        return corners, np.stack([sides[:, 1], -sides[:, 0]], -1) / np.linalg.norm(sides, axis=1)[:, None], []
    if isinstance(shape, Box3D):
        signs = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        return signs * 0.5 * np.array(shape.size), np.eye(3), np.eye(3)
    corners, normals = np.array(shape.vertices), []
    sides = [corners[i] - corners[j] for i in range(4) for j in range(i)]
    for k in range(4):
        f = np.delete(np.arange(4), k)
        n = np.cross(corners[f[1]] - corners[f[0]], corners[f[2]] - corners[f[0]])
        normals.append(n / np.linalg.norm(n))
    return corners, np.array(normals), np.array([s / np.linalg.norm(s) for s in sides])


def _segments(half_a, half_b, radii):
    """Distance of two segments along z axes, less both radii."""

    def gap(xa, ra, xb, rb):
        d, a, b = xb - xa, ra[:, :, 2], rb[:, :, 2]
        c, along_a, along_b = np.sum(a * b, -1), np.sum(a * d, -1), np.sum(b * d, -1)
        best = np.full(len(xa), np.inf)
        square = 1.0 - c * c
        s = np.where(square > 1e-12, (along_a - c * along_b) / np.maximum(square, 1e-300), 0.0)
        trials = [np.clip(s, -half_a, half_a), np.full(len(s), half_a), np.full(len(s), -half_a)]
        trials += [np.clip(along_a + c * t, -half_a, half_a) for t in (half_b, -half_b)]
        for s in trials:
            t = np.clip(c * s - along_b, -half_b, half_b)
            best = np.minimum(best, np.linalg.norm(d + t[:, None] * b - s[:, None] * a, axis=-1))
        return best - radii

    return gap


PLANAR_PAIRS = [
    *((a, "disk") for a in ("disk", "box", "polygon", "segment", "half_plane")),
    ("half_plane", "box"), ("half_plane", "polygon"), ("box", "box"), ("polygon", "box"), ("polygon", "polygon"),
]  # fmt: skip
SPATIAL_PAIRS = [
    *((a, "sphere") for a in (
        "sphere", "box", "polyhedron", "capsule", "cylinder", "disk", "ring", "ellipsoid", "half_space",
    )),
    *(("half_space", b) for b in ("box", "polyhedron", "capsule", "cylinder", "disk", "ring", "ellipsoid")),
    ("capsule", "capsule"), ("box", "box"), ("polyhedron", "box"),
]  # fmt: skip
PAIRS = [(2, *pair) for pair in PLANAR_PAIRS] + [(3, *pair) for pair in SPATIAL_PAIRS]
ROUNDED = {"cylinder", "disk", "ring"}
"""Whose flat sides come onto half-spaces by a rounding."""


def _pair(rng, d, a, b, size, still, turn):
    """(arguments of a group, gap of both bodies' places and attitudes, its tolerance, size of the second shape)."""
    make = planar_shape if d == 2 else spatial_shape
    first, point_gap = make(a, rng, size, None if still else "a", turn)
    if b in ("disk", "sphere") and not (a.startswith("half") and b == "disk" and d == 3):
        radius, arm = size * 10.0 ** rng.uniform(-2.0, 0.5), size * rng.uniform(-1.0, 1.0, d) * rng.choice([0.0, 1.0])
        marker = Marker2D(body="b", point=tuple(arm)) if d == 2 else Marker3D(body="b", point=tuple(arm))
        second = (
            {"disks": [Disk2D(marker=marker, radius=radius)]} if d == 2
            else {"spheres": [Sphere3D(marker=marker, radius=radius)]}
        )  # fmt: skip
        if a == "ring":
            hole = size - next(iter(first.values()))[0].rim_radius
            radius = min(radius, 0.8 * hole)
            second = {"spheres": [Sphere3D(marker=marker, radius=radius)]}

        def gap(xa, ra, xb, rb):
            y = np.einsum("nji,nj->ni", ra, xb + rb @ arm - xa)
            return point_gap(y) - radius

        return _merged(first, second), gap, 1e-9 * size, radius
    second, _ = make(b, rng, size * 10.0 ** rng.uniform(-1.0, 0.3), "b", turn)
    shape = next(iter(second.values()))[0]
    if a.startswith("half"):
        rough = 2e-3 if b in ROUNDED else 1e-9
        return _merged(first, second), _over_plane(_support(b, second), d), rough * size, size
    if a == "capsule":
        one = next(iter(first.values()))[0]
        radii = one.radius + shape.radius
        return _merged(first, second), _segments(0.5 * one.length, 0.5 * shape.length, radii), 3e-3 * radii, radii
    parts, others = _parts(a, first), _parts(b, second)
    gap = _polytopes(parts[0], others[0], parts[1], others[1], parts[2], others[2])
    return _merged(first, second), gap, 2e-3 * size, size


def _merged(first, second):
    return {name: [*first.get(name, ()), *second.get(name, ())] for name in {**first, **second}}


def _attitude(rng):
    return Rotation.random(random_state=int(rng.integers(2**31)))


def _direction(rng, d):
    x = rng.normal(size=d)
    return x / np.linalg.norm(x)


def passage(d, a, b, rng, glance=1e-6, spinning=True):
    """A Passage of shapes a and b in d dimensions, at least as deep as `glance` times the smaller size; None where the
    random start is none."""
    size, speed = 10.0 ** rng.uniform(-6.0, 1.0), 10.0 ** rng.uniform(-2.0, 3.0)
    turns = [rng.uniform(-math.pi, math.pi) if d == 2 else _attitude(rng) for _ in range(2)]
    still = rng.random() < 0.4
    shapes, gap, rough, other = _pair(rng, d, a, b, size, still, turns[0])
    depth = min(size, other) * 10.0 ** rng.uniform(math.log10(glance), -0.7)
    if rough > 0.2 * depth:
        depth = min(20.0 * rough, 0.2 * min(size, other))
    before = size * 10.0 ** rng.uniform(0.0, 3.5) / speed
    if d == 2:
        rates = [rng.uniform(-TURNS, TURNS) / before * spinning * rng.choice([0, 1]) for _ in range(2)]
    else:
        rates = [rng.uniform(0, TURNS) / before * spinning * rng.choice([0, 1]) * _direction(rng, 3) for _ in range(2)]
    if still:
        rates[0] = 0.0 * rates[0]
    va = np.zeros(d) if still else 0.3 * speed * _direction(rng, d)
    flight_a = Flight(np.zeros(d) - before * va, va, turns[0], rates[0])
    _, ra = flight_a.at(before)
    flight_b = Flight(np.zeros(d), np.zeros(d), turns[1], rates[1])
    _, rb = flight_b.at(before)
    core = np.zeros(d)
    if a == "ring":
        angle = rng.uniform(0.0, 2.0 * math.pi)
        core = ra[0] @ (size * np.array([math.cos(angle), math.sin(angle), 0.0]))
    ray = _direction(rng, d)
    if a.startswith("half"):
        core, ray = ra[0] @ np.append(rng.normal(size=d - 1) * size, 0.0), ra[0][:, d - 1]

    def depth_at(s):
        return float(gap(np.zeros((1, d)), ra, (core + s * ray)[None], rb)[0]) + depth

    if depth_at(-1e-3 * size) > 0.0 or depth_at(20.0 * (size + other)) < 0.0:
        return None
    s = brentq(depth_at, -1e-3 * size, 20.0 * (size + other), xtol=1e-14 * size, rtol=1e-14)
    place, slope = core + s * ray, np.empty(d)
    for k in range(d):
        step = 1e-4 * depth * np.eye(d)[k]
        low, high = (float(gap(np.zeros((1, d)), ra, (place + x)[None], rb)[0]) for x in (-step, step))
        slope[k] = high - low
    vb = _direction(rng, d)
    if rng.random() < 0.5 and np.any(slope != 0.0):
        n = slope / np.linalg.norm(slope)
        vb = vb - (vb @ n) * n
        if np.linalg.norm(vb) < 1e-3:
            return None
        vb /= np.linalg.norm(vb)
    if a.startswith("half") and vb @ ray > -1e-3:
        vb = vb - (vb @ ray + abs(rng.normal())) * ray
        vb /= np.linalg.norm(vb)
    if still and rng.random() < 0.7:
        # from rest, or thrown
        flight_b.falls = speed * rng.choice([1.0, 2.0]) * vb / before
    velocity = speed * vb + va
    flight_b.velocity = velocity - before * flight_b.falls
    flight_b.place = place - before * velocity + 0.5 * before**2 * flight_b.falls
    end = before * (1.0 + 10.0 ** rng.uniform(-3.0, 0.7))

    def course(t):
        return gap(*flight_a.at(t), *flight_b.at(t))

    count = SAMPLES // 5 if d == 3 and b == "box" and a != "half_space" else SAMPLES
    ahead = before * (1.0 - np.geomspace(1e-9, 1.0, count // 3))
    t = np.unique(np.concatenate([np.linspace(0.0, before, count), ahead]))
    g = course(t)
    if not g[0] > max(10.0 * rough, 1e-3 * min(size, other)):
        return None
    dips = np.flatnonzero((g[1:-1] <= g[:-2]) & (g[1:-1] <= g[2:])) + 1
    extra = []
    for k in dips:
        low = minimize_scalar(lambda x: float(course(x)[0]), bounds=(t[k - 1], t[k + 1]), method="bounded",
                              options={"xatol": 1e-10 * before})  # fmt: skip
        extra.append(low.x)
    t = np.unique(np.append(t, extra))
    g = course(t)
    # the first time at which it is certainly deep, and the first touch
    deep = np.flatnonzero(g < -0.5 * depth)
    if not len(deep):
        return None
    # so large that touches leave even spin what it is
    inertia = 1e3 * size**2
    flights = [("b", flight_b)] if still else [("a", flight_a), ("b", flight_b)]
    bodies = [_body(d, name, flight, inertia) for name, flight in flights]
    return Passage((bodies, shapes), float(t[deep[0]]), end, 0.1 * depth + rough, {
        "pair": (d, a, b), "size": size, "speed": speed, "depth": depth, "before": before, "course": course,
        "falls": tuple(float(x) for x in flight_b.falls * np.ones(d)),
    })  # fmt: skip


def _body(d, name, flight, inertia):
    if d == 2:
        return RigidBody2D(
            name=name, mass=1.0, inertia=inertia, position=tuple(flight.place), velocity=tuple(flight.velocity),
            angle=flight.attitude, angular_velocity=flight.rate,
        )  # fmt: skip
    x, y, z, w = flight.attitude.as_quat()
    return RigidBody3D(
        name=name, mass=1.0, inertia=(inertia,) * 3, position=tuple(flight.place), velocity=tuple(flight.velocity),
        attitude=EulerParameters(values=(w, x, y, z)), angular_velocity=tuple(flight.attitude.inv().apply(flight.rate)),
    )  # fmt: skip


def model_of(item, force):
    """The model of a passage, with an impact law or a force law."""
    (bodies, shapes), note = item.model, item.note
    law = NewtonImpact(restitution=0.5)
    if force:
        law = KelvinVoigt(stiffness=(note["speed"] / note["size"]) ** 2, damping=0.0)
    kind = ContactGroup2D if note["pair"][0] == 2 else ContactGroup3D
    return Model(gravity=note["falls"], bodies=bodies, groups=[kind(name="g", law=law, **shapes)])
