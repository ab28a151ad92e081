"""By how much lines of contact pass their nodes: the place of the rounded vertex itself."""

import math

import numpy as np
import pytest
from tlismni.core import Disk2D, DiskOnLine2D, Line2D, Marker2D, Model, NewtonImpact, PointMass2D, RigidBody2D, simulate
from tlismni.core.analysis.line_nodes import missed_nodes


def on_line(nodes, rounding, height, x, *bodies):
    disk = Disk2D(marker=Marker2D(body="p"), radius=0.01)
    line = Line2D(nodes=nodes, radius=1e-3, rounding=rounding)
    contact = DiskOnLine2D(name="c", line=line, disk=disk, law=NewtonImpact(restitution=0.5))
    ball = PointMass2D(name="p", mass=1.0, position=(x, height))
    return Model(bodies=[ball, *bodies], contacts=[contact])


@pytest.mark.parametrize("rounding", [0.1, 0.5, 1.0])
def test_the_gap_over_a_vertex_is_larger_by_what_is_missed(rounding):
    """Symmetric: the point of the line below the disk is nearest to it."""
    nodes = [Marker2D(point=p) for p in ((-1.0, 0.0), (0.0, 0.1), (1.0, 0.0))]
    model = on_line(nodes, rounding, 0.5, 0.0)
    (missed,) = missed_nodes(model)
    assert (missed.contact, missed.node) == ("c", 1)
    gap = simulate(model, 1e-6)["c.gap"][0]
    assert gap == pytest.approx(0.5 - 0.1 - 0.011 + missed.distance, rel=1e-12)


@pytest.mark.parametrize("count", [30, 120])
def test_a_circle_of_nodes_is_missed_by_a_part_of_their_distance_squared(count):
    """rounding/8 s^2/R, also where the nodes are a turned body's."""
    radius, angles = 0.2, np.linspace(0.0, 2.0 * math.pi, count + 1)
    nodes = [Marker2D(body="cam", point=(radius * math.cos(a), radius * math.sin(a))) for a in angles]
    cam = RigidBody2D(name="cam", mass=1.0, inertia=1.0, position=(3.0, -1.0), angle=0.7)
    (missed,) = missed_nodes(on_line(nodes, 0.8, 5.0, 0.0, cam))
    assert missed.distance == pytest.approx(0.1 * 2.0 * radius * (1.0 - math.cos(2.0 * math.pi / count)), rel=1e-9)


def test_a_straight_line_misses_none():
    assert missed_nodes(on_line([Marker2D(point=(-1.0, 0.0)), Marker2D(point=(1.0, 0.0))], 0.5, 0.5, 0.0)) == ()
