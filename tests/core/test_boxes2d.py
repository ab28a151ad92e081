"""Shapes with corners in the plane that slide into each other along a floor, side against side."""

import numpy as np
import pytest
from tlismni.core import (
    Box2D,
    ContactGroup2D,
    CoulombFriction,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    Polygon2D,
    RigidBody2D,
    Simulation,
)

WIDTH, HEIGHT, G = 0.2, 0.15, 9.81


def shape(kind, body, height):
    if kind == "boxes":
        return Box2D(marker=Marker2D(body=body), width=WIDTH, height=height)
    x, y = 0.5 * WIDTH, 0.5 * height
    return Polygon2D(marker=Marker2D(body=body), vertices=((-x, -y), (x, -y), (x, y), (-x, y)))


def towards(kind, height, speeds, friction):
    """Two of them on a floor, 0.2 m apart, that slide towards each other at these speeds and stop each other."""
    bodies = [
        RigidBody2D(name=name, mass=1.0, inertia=0.01, position=(x, 0.5 * h), velocity=(speed, 0.0))
        for name, x, h, speed in (("a", -0.2, HEIGHT, speeds[0]), ("b", 0.2, height, -speeds[1]))
    ]
    shapes = shape(kind, "a", HEIGHT), shape(kind, "b", height)
    group = ContactGroup2D(
        name="g", half_planes=[HalfPlane2D()], law=NewtonImpact(restitution=0.0),
        friction=CoulombFriction(coefficient=friction) if friction else None, **{kind: shapes},
    )  # fmt: skip
    return Model(gravity=(0.0, -G), bodies=bodies, groups=[group])


@pytest.mark.sampled(12)
@pytest.mark.parametrize("kind", ["boxes", "polygons"])
@pytest.mark.parametrize("height", [0.15, 0.1, 0.2])
@pytest.mark.parametrize("friction", [0.0, 0.1])
@pytest.mark.parametrize("seed", range(3))
def test_they_stop_each_other(kind, height, friction, seed):
    """Corners come along the other's sides to corners of the same height: none may slip through. Momentum stays, but
    for the floor's friction; their sides stay together."""
    speeds = np.random.default_rng(seed).uniform(0.3, 2.0, 2)
    sim = Simulation(towards(kind, height, speeds, friction), "ebdf", max_steps=3000)
    index = {c.name: k for k, c in enumerate(sim.channels)}
    for t in np.linspace(0.0, 0.6, 31)[1:]:
        sim.advance(float(t))
        values = sim.values()
        apart = values[index["b.x"]] - values[index["a.x"]] - WIDTH
        tilt = max(abs(values[index["a.angle"]]), abs(values[index["b.angle"]]))
        assert apart > -1e-9 - HEIGHT * tilt
    if friction == 0.0 and height == HEIGHT:
        # struck side against side, nothing tilts
        mean = 0.5 * (speeds[0] - speeds[1])
        assert [values[index[f"{name}.vx"]] for name in "ab"] == pytest.approx([mean, mean], abs=1e-9)
        assert abs(apart) < 1e-9


@pytest.mark.parametrize("radius", [0.0, 0.01])
def test_corners_reach_both_sides(radius):
    """Each as far from the sides at it as its radius says."""
    corners = ((0.0, 0.0), (2.0, 0.0), (2.5, 1.0), (1.0, 2.0))
    polygon = Polygon2D(marker=Marker2D(body="a", point=(1.0, -2.0)), vertices=corners)
    for k, disk in enumerate(polygon.corners(radius)):
        assert disk.radius == radius
        for start, end in ((corners[k - 1], corners[k]), (corners[k], corners[(k + 1) % 4])):
            along = np.subtract(end, start) / np.hypot(*np.subtract(end, start))
            x, y = np.subtract(disk.marker.point, (1.0, -2.0)) - start
            assert along[0] * y - along[1] * x == pytest.approx(radius, abs=1e-14)
