"""Forces that channels show: what a contact's law forbids is not among them, nor a start that is none."""

import numpy as np
import pytest
from tlismni.core import (
    AngleStop2D,
    Box2D,
    ConsistencyError,
    Disk2D,
    DiskOnBox2D,
    DiskOnHalfPlane2D,
    DiskOnSegment2D,
    HalfPlane2D,
    KelvinVoigt,
    Marker2D,
    Model,
    MovingFrame2D,
    NewtonImpact,
    PointMass2D,
    Ramp,
    RigidBody2D,
    Segment2D,
    simulate,
)
from tlismni.core.assembly.redundancy import RedundantRow

G = 9.81
LAW = NewtonImpact(restitution=0.0)
DISK = Disk2D(marker=Marker2D(body="d"), radius=0.01)
SLIDER = RigidBody2D(name="d", mass=1.0, inertia=1e-4, position=(-0.05, 0.01), velocity=(1.0, 0.0))
EDGES = {
    "segment": DiskOnSegment2D(
        name="c", segment=Segment2D(marker=Marker2D(point=(-0.2, 0.0)), length=0.2), disk=DISK, law=LAW
    ),
    "box": DiskOnBox2D(
        name="c", shape=Box2D(marker=Marker2D(point=(-0.1, -0.1)), width=0.2, height=0.2), disk=DISK, law=LAW
    ),
}


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
def test_a_disk_that_leaves_an_edge_is_never_pulled(edge, method):
    """The curvature of the way jumps: m v^2/r = 100 N is more than the weight, so it opens at once."""
    result = simulate(Model(bodies=[SLIDER], contacts=[EDGES[edge]], gravity=(0.0, -G)), 0.1, method)
    assert result["c.normal_force"].min() == 0.0
    assert [event.kind for event in result.events] == ["close", "open"]
    assert result.events[-1].t == pytest.approx(0.05, abs=1e-6)


@pytest.mark.parametrize("edge", EDGES)
def test_a_contact_that_starts_closed_shows_its_force_from_the_first_sample_on(edge):
    result = simulate(Model(bodies=[SLIDER], contacts=[EDGES[edge]], gravity=(0.0, -G)), 0.01)
    assert result["c.normal_force"] == pytest.approx(G, rel=1e-9)
    assert result["d.ay"] == pytest.approx(0.0, abs=1e-9)
    assert np.all(np.diff(result.t) > 0.0)
    assert np.all(result["c.in_contact"] == 1.0)


def test_an_impact_at_the_start_shows_both_velocities():
    ball = PointMass2D(name="d", mass=1.0, position=(0.0, 0.01), velocity=(0.0, -1.0))
    floor = DiskOnHalfPlane2D(name="c", plane=HalfPlane2D(), disk=DISK, law=NewtonImpact(restitution=0.5))
    result = simulate(Model(bodies=[ball], contacts=[floor], gravity=(0.0, -G)), 0.01)
    assert result.t[0] == result.t[1] == 0.0
    assert result["d.vy"][:2] == pytest.approx([-1.0, 0.5])


def test_a_damper_that_lets_go_shows_no_pull_where_a_speed_jumps():
    law = KelvinVoigt(stiffness=1e6, damping=200.0)
    part = PointMass2D(name="d", mass=1.0, position=(0.0, 0.01 - G / 1e6))
    table = MovingFrame2D(name="table", y=Ramp(start=0.1, duration=1.0, before=0.0, after=-0.3))
    plane = HalfPlane2D(marker=Marker2D(body="table"))
    contact = DiskOnHalfPlane2D(name="c", plane=plane, disk=DISK, law=law)
    result = simulate(Model(bodies=[part, table], contacts=[contact], gravity=(0.0, -G)), 0.12)
    assert result["c.normal_force"].min() >= 0.0


def test_an_overlap_of_angles_is_said_in_radians():
    arm = RigidBody2D(name="arm", mass=1.0, inertia=1.0, angle=2.0)
    stop = AngleStop2D(name="stop", b=Marker2D(body="arm"), limit=0.5, law=LAW)
    with pytest.raises(ConsistencyError, match=r"overlapping by 1\.5 rad"):
        simulate(Model(bodies=[arm], contacts=[stop]), 0.1)


def test_a_redundant_norm_is_named_as_one():
    assert RedundantRow("hinge", 3, ("other",)).equation == "row 3 of 'hinge'"
    assert RedundantRow("body", 0, ("other",), of_body=True).equation == "the norm of the Euler parameters of 'body'"
