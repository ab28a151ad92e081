"""Slips of the pen in records and runs: refused in words that name element, field, what was needed and given."""

import json

import numpy as np
import pytest
from helpers import G, ball_over_floor, on, rod_pendulum
from tlismni.core import (
    AppliedForce2D,
    Constant,
    CoordinateContact,
    CoordinateTerm,
    Disk2D,
    DiskOnLine2D,
    Line2D,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    simulate,
)

BALL = PointMass2D(name="ball", mass=1.0)
LAW = NewtonImpact(restitution=0.5)


def model_data(**changed):
    """A model as data, with fields of its rod changed."""
    data = json.loads(rod_pendulum().to_json())
    data["bodies"][0] |= changed
    return data


@pytest.mark.parametrize(
    "make, message",
    [
        # by position
        (lambda: PointMass2D("ball", 1.0), r"PointMass2D takes its fields by name, not by position \(given: 'ball', 1"),
        (lambda: NewtonImpact(0.5), r"write NewtonImpact\(restitution=\.\.\.\)"),
        (lambda: Marker2D("a", (0.0, 1.0)), r"write Marker2D\(body=\.\.\., point=\.\.\.\)"),
        # one for a list
        (lambda: Model(name="m", bodies=BALL),
         r"Model 'm': bodies: must be a list: .* \(given: a PointMass2D 'ball'\)"),
        (lambda: Model(contacts=3.0), r"Model: contacts: must be a list.*\(given: 3\.0\)"),
        (lambda: Line2D(nodes=on("a")), r"Line2D: nodes: must be a list.*\(given: a Marker2D\)"),
        (lambda: Line2D(nodes=[on("a")]), "Line2D: nodes: needs at least 2 entries, there are 1"),
        # numbers out of range
        (lambda: PointMass2D(name="ball", mass=-1.0),
         r"PointMass2D 'ball': mass: must be greater than 0\.0 \(given: -1\.0\)"),
        (lambda: PointMass2D(name="ball", mass=float("nan")), "PointMass2D 'ball': mass: must be a finite number"),
        (lambda: PointMass2D(name="ball", mass="1"), "PointMass2D 'ball': mass: a number is needed, not the text '1'"),
        (lambda: PointMass2D(name="ball", mass=None), r"PointMass2D 'ball': mass: must be a number \(given: None\)"),
        (lambda: PointMass2D(name="ball"), "PointMass2D 'ball': mass: it is missing: give it"),
        (lambda: PointMass2D(mass=1.0), "PointMass2D: name: it is missing: give it"),
        (lambda: NewtonImpact(restitution=1.2), r"NewtonImpact: restitution: must be at most 1\.0 \(given: 1\.2\)"),
        # fields, names, kinds
        (lambda: PointMass2D(name="b", mas=1.0, mass=1.0),
         "PointMass2D 'b': mas: there is no such field; did you mean 'mass'"),
        (lambda: PointMass2D(name="2b", mass=1.0), "'2b': name: must be made of letters.*given: '2b'"),
        (lambda: Model(bodies=[Revolute2D(name="pin", a=on("a"), b=on("b"))]),
         "Model: bodies.0: type 'Revolute2D' is none of .*'PointMass2D'.*given: a Revolute2D 'pin'"),
        (lambda: Revolute2D(name="pin", a="ground", b=on("b")),
         "Revolute2D 'pin': a: must be a Marker2D .*given: 'ground'"),
        (lambda: Disk2D(marker=on("a", 0.0), radius=-1.0), "Disk2D: radius: must be at least 0"),
        # inside of others
        (lambda: Model(**model_data(mass=-2.0)),
         r"^RigidBody2D 'rod': mass: must be greater than 0\.0 \(given: -2\.0\)$"),
        (lambda: Model(**model_data(position=(0.0, "x"))), "RigidBody2D 'rod': position.1: a number is needed"),
        (lambda: Model(**model_data(masse=1.0)),
         "RigidBody2D 'rod': masse: there is no such field; did you mean 'mass'"),
        (lambda: CoordinateContact(name="c", law=LAW, terms=CoordinateTerm(body="a", coordinate="x")),
         "CoordinateContact 'c': terms: must be a list.*given: a CoordinateTerm"),
        (lambda: CoordinateContact(name="c", law={"type": "NewtonImpact", "restitution": 2.0},
                                   terms=[CoordinateTerm(body="a", coordinate="x")]),
         r"CoordinateContact 'c': law: NewtonImpact: restitution: must be at most 1\.0 \(given: 2\.0\)"),
        # what concerns several fields says its element itself, once
        (lambda: DiskOnLine2D(name="c", law=LAW, disk=Disk2D(marker=on("a")), line=Line2D(nodes=[on("b"), on("d")])),
         "^contact 'c'"),
    ],
)  # fmt: skip
def test_errors_name_element_and_field(make, message):
    with pytest.raises(ModelError, match=message) as caught:
        make()
    assert "Input should" not in str(caught.value) and "validation error" not in str(caught.value)


def test_several_slips_are_told_at_once():
    with pytest.raises(ModelError) as caught:
        RigidBody2D(name="rod", mass=-1.0, inertia=0.0, colour="red")
    assert str(caught.value).count("RigidBody2D 'rod': ") == 3


def test_model_without_bodies_is_refused():
    for model in (Model(), Model(name="m")):
        with pytest.raises(ModelError, match=f"model '{model.name}' has no bodies.*give it at least one in `bodies`"):
            simulate(model, 1.0)


@pytest.mark.parametrize("angle, start", [(0.5, 0.0), (0.5, 0.9), (-2.0, 0.3)])
def test_follower_force_acts_along_the_axes_of_its_marker(angle, start):
    """It turns with the body: constant moment and, in the body's frame, constant force."""
    point, (fx, fy), mass, inertia = np.array([0.3, -0.2]), (3.0, 1.0), 2.0, 0.5
    body = RigidBody2D(name="b", mass=mass, inertia=inertia, angle=start)
    push = AppliedForce2D(name="push", marker=on("b", *point, angle=angle), force_x=Constant(value=fx),
                          force_y=Constant(value=fy), follower=True)  # fmt: skip
    result = simulate(Model(bodies=[body], forces=[push], gravity=(0.0, 0.0)), 0.8, rtol=1e-10, atol=1e-12)
    c, s = np.cos(angle), np.sin(angle)
    own = np.array([c * fx - s * fy, s * fx + c * fy])
    moment = point[0] * own[1] - point[1] * own[0]
    theta = start + 0.5 * moment / inertia * result.t**2
    assert result["b.angle"] == pytest.approx(theta, abs=1e-9)
    assert mass * result["b.ax"] == pytest.approx(np.cos(theta) * own[0] - np.sin(theta) * own[1], abs=1e-7)
    assert mass * result["b.ay"] == pytest.approx(np.sin(theta) * own[0] + np.cos(theta) * own[1], abs=1e-7)


def test_a_force_that_does_not_follow_keeps_the_inertial_axes():
    ball = RigidBody2D(name="b", mass=2.0, inertia=0.5, angle=0.4, angular_velocity=3.0)
    push = AppliedForce2D(name="push", marker=on("b", angle=0.7), force_x=Constant(value=4.0))
    result = simulate(Model(bodies=[ball], forces=[push], gravity=(0.0, 0.0)), 0.5)
    assert result["b.vx"] == pytest.approx(2.0 * result.t, abs=1e-9) and np.abs(result["b.y"]).max() < 1e-9


def test_wall_time_is_that_of_the_run_alone(monkeypatch):
    """By a clock that building the simulation puts on by 1000 s, and compiling on the way by 100 s."""
    from numba.core import event
    from tlismni.core.compiled import stopwatch
    from tlismni.core.simulation.engine import Engine

    now = [0.0]
    monkeypatch.setattr(stopwatch.time, "perf_counter", lambda: now[0])
    monkeypatch.setattr(event, "timer", lambda: now[0])
    built, compiled = Engine.__init__, []

    def slow(self, *args, **kwargs):
        built(self, *args, **kwargs)
        now[0] += 1000.0

    def progress(t):
        with event.trigger_event(stopwatch.KIND):
            now[0] += 100.0
        compiled.append(t)
        now[0] += 2.0

    monkeypatch.setattr(Engine, "__init__", slow)
    result = simulate(ball_over_floor(LAW), 0.1, t_eval=[0.0, 0.05, 0.1], progress=progress)
    assert len(compiled) >= 3
    assert result.stats["wall_time"] == pytest.approx(2.0 * len(compiled))
    assert result["ball.y"][-1] == pytest.approx(1.0 - 0.5 * G * 0.01)
