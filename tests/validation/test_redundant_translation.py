"""Joints with redundant equations in exudyn, which keeps all rows of a joint: those of ours are left free there."""

import math
from itertools import pairwise

import numpy as np
import pytest
from exudyn_agreement import agree
from tlismni.core import (
    Axes,
    Fixed3D,
    Marker2D,
    Marker3D,
    Model,
    PointMass3D,
    Prismatic2D,
    Prismatic3D,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    RotationVector,
    SpringDamper3D,
    Universal3D,
    simulate,
)
from tlismni.models import load
from tlismni.validation import run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.translation.redundant import held_axes, redundant_rows

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")


@needs_exudyn
def test_bricard_moves_in_exudyn_as_here():
    model = load("bricard").model
    assert redundant_rows(model) == {"hinge5": frozenset({4})}
    agree(model, ("rod3.x", "rod3.y", "rod3.z", "hinge0.angle", "hinge5.angle"), 1.0, 5e-3)


def four_bar(tilt=None):
    """A loop of four hinges in the xy plane, or in a plane that is tilted: three redundant equations."""
    turn = Marker3D(attitude=tilt or RotationVector(vector=(0.0, 0.0, 0.0))).axes()
    corners = [turn @ corner for corner in ((0.0, 0.0, 0.0), (0.0, 0.4, 0.0), (1.0, 0.9, 0.0), (1.1, 0.0, 0.0))]
    axis = Axes(z=tuple(turn[:, 2]), x=tuple(turn[:, 0]))
    bars = [
        RigidBody3D(name=f"bar{k}", mass=1.0, inertia=(0.05, 0.06, 0.07), position=tuple(0.5 * (a + b)))
        for k, (a, b) in enumerate(pairwise(corners))
    ]
    joints = []
    for k, corner in enumerate(corners):
        point = tuple(float(x) for x in corner)
        ground = Marker3D(point=point, attitude=axis)
        a = bars[k - 1].marker_at(point, axis) if k else ground
        b = bars[k].marker_at(point, axis) if k < 3 else ground
        joints.append(Revolute3D(name=f"pin{k}", a=a, b=b))
    gravity = tuple(float(x) for x in turn @ (3.0, -9.0, 0.0))
    return Model(bodies=bars, joints=joints, gravity=gravity)


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize("tilt", [None, RotationVector(vector=(0.5, -0.3, 0.4))])
def test_a_plane_loop_of_hinges_in_space_leaves_three_axes_free(tilt):
    model = four_bar(tilt)
    assert sum(map(len, redundant_rows(model).values())) == 3
    agree(model, ("bar0.x", "bar1.x", "pin0.angle", "pin3.angle"), 0.3, 1.5e-3)


@needs_exudyn
def test_a_carriage_on_two_guides():
    """Twice five equations, of which five say nothing new; the norm of the Euler parameters is not among those."""
    frame = Axes(z=(1.0, 0.0, 0.0))
    carriage = RigidBody3D(name="carriage", mass=2.0, inertia=(0.1, 0.1, 0.1), velocity=(1.0, 0.0, 0.0))
    load_ = PointMass3D(name="load", mass=0.5, position=(0.0, 0.0, -0.3))
    guides = [
        Prismatic3D(name=f"guide{k}", a=Marker3D(point=place, attitude=frame), b=carriage.marker_at(place, frame))
        for k, place in enumerate(((0.0, 0.3, 0.0), (0.0, -0.3, 0.0)))
    ]
    spring = SpringDamper3D(
        name="spring", a=Marker3D(body="carriage"), b=Marker3D(body="load"), stiffness=2e3, natural_length=0.25
    )
    model = Model(bodies=[carriage, load_], joints=guides, forces=[spring], gravity=(0.0, 0.0, -9.81))
    rows = redundant_rows(model)
    assert sum(map(len, rows.values())) == 5
    assert "carriage" not in rows
    agree(model, ("carriage.x", "load.x", "load.z", "guide1.position"), 0.4, 1e-3)


def test_what_a_joint_holds_without_an_equation():
    tilted = Marker3D(attitude=RotationVector(vector=(0.3, 0.2, 0.1)))
    on = Marker3D(body="it")
    straight = {"name": "j", "a": Marker3D(), "b": on}
    model = Model(bodies=[RigidBody3D(name="it", mass=1.0, inertia=(1.0, 1.0, 1.0))])
    for row, axes in enumerate(([0, 1, 1, 1, 1, 0], [1, 0, 1, 1, 1, 0], [1, 1, 0, 1, 1, 0])):
        assert held_axes(Revolute3D(**straight), frozenset({row}), model)[0] == axes
    for row, other in ((3, 1), (4, 0)):
        # z of marker a stays across the other axis of marker b: exudyn's y and z
        axes, order = held_axes(Revolute3D(**straight), frozenset({row}), model)
        assert axes == [1, 1, 1, 1, 0, 0]
        assert np.linalg.det(order) == pytest.approx(1.0)
        assert order[:, 1] == pytest.approx(np.eye(3)[2])
        assert order[:, 2] == pytest.approx(np.eye(3)[other])
    for row, freed in ((3, 4), (4, 3), (5, 5)):
        assert held_axes(Fixed3D(**straight), frozenset({row}), model)[0] == [int(k != freed) for k in range(6)]
    assert held_axes(Universal3D(**straight), frozenset({3}), model)[0] == [1, 1, 1, 0, 0, 0]
    assert held_axes(Prismatic3D(**straight), frozenset({3}), model)[0] == [0, 1, 0, 1, 1, 1]
    with pytest.raises(NotTranslatable, match=r"'j' has a redundant equation.*attitude"):
        held_axes(Revolute3D(name="j", a=tilted, b=on), frozenset({1}), model)


def three_cranks():
    """Of one length and direction, under a beam in the plane."""
    lean, places = 1.2, (-0.5, 0.1, 0.5)
    ux, uy = 0.2 * math.cos(lean), 0.2 * math.sin(lean)
    cranks = [
        RigidBody2D(name=f"crank{k}", mass=1.0, inertia=0.1, position=(x + ux, uy), angle=lean)
        for k, x in enumerate(places)
    ]
    beam = RigidBody2D(name="beam", mass=3.0, inertia=1.0, position=(2.0 * ux, 2.0 * uy))
    joints = []
    for k, x in enumerate(places):
        low, high = Marker2D(body=f"crank{k}", point=(-0.2, 0.0)), Marker2D(body=f"crank{k}", point=(0.2, 0.0))
        joints.append(Revolute2D(name=f"foot{k}", a=Marker2D(point=(x, 0.0)), b=low))
        joints.append(Revolute2D(name=f"head{k}", a=high, b=Marker2D(body="beam", point=(x, 0.0))))
    return Model(bodies=[*cranks, beam], joints=joints, gravity=(0.0, -9.81))


@needs_exudyn
def test_three_cranks_in_the_plane():
    """The joints share loads, of which exudyn has one less: what bars feel together is compared, not each joint."""
    model = three_cranks()
    assert sum(map(len, redundant_rows(model).values())) == 1
    agree(model, ("beam.x", "beam.y", "crank0.angle", "crank2.angle"), 0.2, 1e-3)
    ours, theirs = simulate(model, 0.2, "irk", 1e-9, 1e-11), run_exudyn(model, 0.2, 2e-4)
    assert not any(".force" in channel for channel in theirs.channels)
    for channel in ("beam.ax", "beam.ay", "crank1.angular_acceleration"):
        assert theirs[channel][-1] == pytest.approx(ours[channel][-1], rel=1e-5), channel


@needs_exudyn
def test_a_joint_that_exudyn_cannot_hold_in_part_is_refused():
    """A carriage on two guides in the plane."""
    body = RigidBody2D(name="carriage", mass=1.0, inertia=0.1)
    guides = [
        Prismatic2D(
            name=f"guide{k}", a=Marker2D(point=(0.0, 0.1 * k)), b=Marker2D(body="carriage", point=(0.0, 0.1 * k))
        )
        for k in range(2)
    ]
    with pytest.raises(NotTranslatable, match=r"guide.*is redundant.*Prismatic2D keeps all.*Revolute3D"):
        run_exudyn(Model(bodies=[body], joints=guides), 0.1, 1e-2)
