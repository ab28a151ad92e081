"""Degrees of freedom, redundant rows and what is stuck."""

import pytest
from helpers import GROUND, ball_over_floor, on, rod_pendulum
from tlismni.core import Marker2D, Model, NewtonImpact, Revolute2D, RigidBody2D
from tlismni.core.analysis import mobility
from tlismni.models import load


@pytest.mark.parametrize(
    "name, stuck",
    [
        ("pendulum_stop", ()),
        ("four_bar", ("coupler1.angle", "coupler2.angle")),
        ("slider_crank_stop", ("slider.y", "slider.angle")),
    ],
)
def test_mechanisms_of_one_degree_of_freedom(name, stuck):
    """Coordinates that only stand still for the moment, at the end of their way, are not stuck."""
    found = mobility(load(name).model)
    assert found.freedom == 1
    assert found.stuck == stuck


def test_a_chain():
    for links in (2, 7):
        assert mobility(load("chain", links=links).model).freedom == links


def bars(angles, doubled=False):
    """Parallel cranks of length 1 at x = 0, 1, 2, carrying one coupler."""
    bodies = [RigidBody2D(name="coupler", mass=1.0, inertia=1.0, position=(1.0, 1.0))]
    joints = []
    for i in range(3):
        bodies.append(RigidBody2D(name=f"crank{i}", mass=1.0, inertia=1.0, position=(i, 0.5), angle=angles))
        joints.append(Revolute2D(name=f"low{i}", a=Marker2D(point=(i, 0.0)), b=on(f"crank{i}", 0.0, -0.5)))
        joints.append(Revolute2D(name=f"high{i}", a=on(f"crank{i}", 0.0, 0.5), b=on("coupler", i - 1.0)))
    return Model(bodies=bodies, joints=joints)


def test_a_third_parallel_crank_repeats_the_others():
    """Gruebler counts 3*4 - 2*6 = 0; it moves all the same."""
    found = mobility(bars(0.0))
    assert (found.counted, found.freedom, found.rank) == (0, 1, 11)
    (row,) = found.redundant
    assert row.constraint.startswith(("low", "high"))


def test_a_triangle_is_stuck():
    model = rod_pendulum(0.0)
    prop = RigidBody2D(name="prop", mass=1.0, inertia=1.0, position=(1.0, -0.5))
    joints = [
        *model.joints,
        Revolute2D(name="foot", a=Marker2D(point=(1.0, -1.0)), b=on("prop", 0.0, -0.5)),
        Revolute2D(name="top", a=on("rod", 0.5), b=on("prop", 0.0, 0.5)),
    ]
    found = mobility(Model(bodies=[*model.bodies, prop], joints=joints))
    assert found.freedom == 0 and found.independent == ()
    assert set(found.stuck) == {f"{body}.{c}" for body in ("rod", "prop") for c in ("x", "y", "angle")}


def test_a_closed_contact_takes_one_degree_of_freedom():
    assert mobility(ball_over_floor(NewtonImpact(restitution=0.5))).freedom == 2
    found = mobility(ball_over_floor(NewtonImpact(restitution=0.5), height=0.0))
    assert found.freedom == 1 and found.closed == ("floor",) and found.stuck == ("ball.y",)


def test_rows_are_counted_by_joint():
    pin = Revolute2D(name="pin", a=GROUND, b=on("rod", -0.5))
    assert mobility(Model(bodies=rod_pendulum(0.0).bodies, joints=[pin])).joints == {"pin": 2}
