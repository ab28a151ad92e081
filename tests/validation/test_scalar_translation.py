"""Forces, joints and contacts of one number between two markers: exudyn with equations of its own, and the solver."""

import math
from typing import Any

import numpy as np
import pytest
from momentum import momentum_drift
from tlismni.core import AxisAngles, Joint3D, Model, simulate
from tlismni.core.contacts import CONTACTS, AngleStop2D, DiskInRing2D, DiskOnBox2D, DiskOnPolygon2D, Rope2D
from tlismni.core.contacts.contact2d import Disk2D
from tlismni.core.contacts.disk_on_box2d import Box2D
from tlismni.core.contacts.polygon2d import Polygon2D
from tlismni.core.contacts.ring2d import Ring2D
from tlismni.core.elements import (
    BODIES,
    FORCES,
    JOINTS,
    AppliedForce3D,
    AppliedTorque3D,
    Belt2D,
    Cable2D,
    CoordinateRelation,
    Gear2D,
    KnifeEdge2D,
    MaterialPoint2D,
    PIDController2D,
    PointMass2D,
    Rack2D,
    RelativeLoad2D,
    RelativeMotor2D,
    Revolute2D,
    RevoluteFriction2D,
    RigidBody2D,
    RigidBody3D,
    Servo2D,
    SlideFriction2D,
    SlideSpring2D,
    SpringDamper2D,
    TableSpring2D,
    TorsionSpring2D,
)
from tlismni.core.elements.coordinate_relation import RelationTerm
from tlismni.core.laws import Gonthier, Hertz, NewtonImpact
from tlismni.core.laws.friction import TanhFriction
from tlismni.core.model.markers import Marker2D, Marker3D
from tlismni.core.model.signals import Polynomial, Sine
from tlismni.validation import crosscheck, run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.translation.registry import _ROUTES, _TRANSLATORS

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
MARKS = {"a": Marker2D(body="w", point=(0.1, -0.05), angle=0.3), "b": Marker2D(body="d", point=(0.02, 0.03), angle=0.1)}
TABLE = {"lengths_table": (0.2, 0.4, 0.5, 0.7, 1.0), "forces": (-30.0, -4.0, 3.0, 20.0, 90.0)}
WAVE = Sine(amplitude=2.0, angular_frequency=9.0, offset=0.5)


def pair(**parts: Any) -> Model:
    """Two free bodies that turn and fly, without weight."""
    return Model(
        gravity=(0.0, 0.0),
        bodies=(
            RigidBody2D(name="w", mass=3.0, inertia=0.4, angular_velocity=0.7, velocity=(0.1, 0.2), angle=0.2),
            RigidBody2D(
                name="d", mass=2.0, inertia=0.05, position=(0.5, 0.3), velocity=(-0.4, -0.1), angle=-0.4,
                angular_velocity=3.0,
            ),
        ),
        **parts,
    )  # fmt: skip


def differences(model: Model, t_end: float, step: float) -> tuple[dict[str, float], Any, Any]:
    """Largest differences of the coordinates between the two programs, and both results."""
    theirs = run_exudyn(model, t_end, step)
    ours = simulate(model, t_end, rtol=1e-10, atol=1e-12, t_eval=theirs.t)
    names = [f"{body.name}.{k}" for body in model.bodies for k in body.coordinate_names]
    return {name: float(np.abs(theirs[name] - ours[name]).max()) for name in names}, ours, theirs


BETWEEN = [
    TorsionSpring2D(name="f", **MARKS, stiffness=4.0, damping=0.1, natural_angle=0.2),
    SlideSpring2D(name="f", **MARKS, stiffness=60.0, damping=1.0, natural_position=0.1),
    TableSpring2D(name="f", **MARKS, **TABLE, damping=1.0),
    RevoluteFriction2D(name="f", **MARKS, torque=0.4, transition_rate=0.5),
    SlideFriction2D(name="f", **MARKS, force=3.0, transition_speed=0.2),
    *(RelativeLoad2D(name="f", **MARKS, load=WAVE, measure=m) for m in ("angle", "slide", "distance")),
    *(Servo2D(name="f", **MARKS, target=WAVE, measure=m, gain=8.0, rate_gain=0.3, largest=3.0)
      for m in ("angle", "slide", "distance")),
    Servo2D(name="f", **MARKS, target=WAVE, of_rate=True, rate_gain=0.2),
]  # fmt: skip


@pytest.mark.parametrize("force", BETWEEN, ids=lambda f: f"{f.type}-{getattr(f, 'measure', '')}")
def test_a_force_moves_both_bodies_as_the_solver_does(force: Any) -> None:
    model = pair(forces=(force,))
    found, ours, _ = differences(model, 0.3, 1e-3)
    assert max(found.values()) < 2e-5, found
    free = 0.5 + -0.4 * ours.t
    assert max(np.abs(ours["d.x"] - free).max(), np.abs(ours["d.angle"] + 0.4 - 3.0 * ours.t).max()) > 1e-3
    # what is left is exudyn's formula, of second order in the step
    assert momentum_drift(model, 0.2, 1e-3) < 2e-6


def on_pins(**joints: Any) -> Model:
    """Two wheels on pins of a carrier that turns about the origin, and a torque spring that drives the first."""
    wheel = {"mass": 1.0, "inertia": 0.02}
    return Model(
        bodies=(
            RigidBody2D(name="c", mass=2.0, inertia=0.3),
            RigidBody2D(name="w", **wheel, position=(0.1, 0.0), angle=0.3),
            RigidBody2D(name="d", **wheel, position=(0.5, 0.0), angle=-0.2),
        ),
        joints=(
            Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="c")),
            Revolute2D(name="p1", a=Marker2D(body="c", point=(0.1, 0.0)), b=Marker2D(body="w")),
            Revolute2D(name="p2", a=Marker2D(body="c", point=(0.5, 0.0)), b=Marker2D(body="d")),
            *joints["joints"],
        ),
        forces=(TorsionSpring2D(name="s", a=Marker2D(), b=Marker2D(body="w"), stiffness=3.0),),
    )


ENDS = {"a": Marker2D(body="w"), "b": Marker2D(body="d")}
EQUATIONS = [
    Gear2D(name="j", **ENDS, radius_a=0.1, radius_b=0.3),
    Gear2D(name="j", **ENDS, radius_a=-0.1, radius_b=0.5),
    Belt2D(name="j", **ENDS, radius_a=0.1, radius_b=0.2),
    Belt2D(name="j", **ENDS, radius_a=0.1, radius_b=0.2, crossed=True),
    Belt2D(name="j", **ENDS, radius_a=0.1, radius_b=0.1),
    CoordinateRelation(
        name="j", offset=0.8,
        terms=(
            RelationTerm(body="w", coordinate="angle", factor=2.0),
            RelationTerm(body="d", coordinate="angle", factor=-1.0),
        ),
    ),
    RelativeMotor2D(name="j", **ENDS, motion=Polynomial(coefficients=(-0.5, 0.0, 2.0))),
]  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize("joint", EQUATIONS, ids=lambda j: j.type)
def test_an_equation_on_a_carrier_that_turns(joint: Any) -> None:
    found, ours, theirs = differences(on_pins(joints=(joint,)), 0.5, 5e-4)
    assert max(found.values()) < 1e-5, found
    (channel,) = joint.multiplier_channels()
    late = theirs.t > 0.1  # the multiplier of an index-3 formula rings at the start
    size = np.abs(ours[channel.name][late]).max()
    assert size > 1e-3
    assert np.abs(theirs[channel.name] - ours[channel.name])[late].max() < 1e-3 * size


@pytest.mark.parametrize("measure", ["slide", "distance"])
def test_a_drive_along_a_way_or_a_distance(measure: str) -> None:
    a, b = Marker2D(body="w", angle=0.4), Marker2D(body="d", point=(0.02, 0.0))
    still = pair()
    bodies = tuple(x.model_copy(update={"velocity": (0.0, 0.0), "angular_velocity": 0.0}) for x in still.bodies)
    dx, dy = 0.5 + 0.02 * math.cos(-0.4), 0.3 + 0.02 * math.sin(-0.4)
    start = math.hypot(dx, dy) if measure == "distance" else dx * math.cos(0.6) + dy * math.sin(0.6)
    motor = RelativeMotor2D(name="j", a=a, b=b, measure=measure, motion=Polynomial(coefficients=(start, 0.0, 0.4)))
    model = still.model_copy(update={"bodies": bodies, "joints": (motor,)})
    found, ours, theirs = differences(model, 0.5, 2.5e-4)
    assert max(found.values()) < 1e-5, found
    force = ours["j.force"]
    assert np.abs(theirs["j.force"] - force)[theirs.t > 0.1].max() < 1e-3 * np.abs(force).max()


def test_a_wheel_on_a_rack_and_a_skate() -> None:
    wheel = RigidBody2D(name="w", mass=1.0, inertia=0.02, angular_velocity=-2.0, velocity=(0.4, 0.0))
    rack = Rack2D(name="j", a=Marker2D(body="w"), b=Marker2D(point=(0.0, -0.2)), radius=0.2)
    spring = SlideSpring2D(name="s", a=Marker2D(), b=Marker2D(body="w"), stiffness=30.0)
    model = Model(gravity=(0.0, 0.0), bodies=(wheel,), joints=(rack,), forces=(spring,))
    found, _, theirs = differences(model, 1.0, 1e-3)
    assert max(found.values()) < 1e-4, found
    # closed form: x oscillates with the inertia m + J/r^2
    rate = math.sqrt(30.0 / (1.0 + 0.02 / 0.04))
    assert np.abs(theirs["w.x"] - 0.4 / rate * np.sin(rate * theirs.t)).max() < 1e-4
    skate = RigidBody2D(name="w", mass=1.0, inertia=0.1, velocity=(1.0, 0.0), angular_velocity=2.0)
    edge = KnifeEdge2D(name="j", marker=Marker2D(body="w"))
    found, _, theirs = differences(Model(gravity=(0.0, 0.0), bodies=(skate,), joints=(edge,)), 1.0, 1e-3)
    # closed form: a circle of radius v/w
    assert np.abs(theirs["w.x"] - 0.5 * np.sin(2.0 * theirs.t)).max() < 1e-5
    assert max(found.values()) < 1e-5, found


def test_what_flexible_points_and_three_bodies_would_need_is_refused() -> None:
    cable = Cable2D(name="k", elements=2, length=1.0, mass_per_length=0.3, axial_stiffness=3e3, bending_stiffness=0.1)
    tip, ball = (
        MaterialPoint2D(name="tip", body="k", point=(1.0, 0.0)),
        PointMass2D(name="p", mass=1.0, position=(2.0, 0.0)),
    )
    motor = RelativeMotor2D(
        name="j", a=Marker2D(body="tip"), b=Marker2D(body="p"), measure="distance",
        motion=Polynomial(coefficients=(1.0, 0.0, 0.1)),
    )  # fmt: skip
    with pytest.raises(NotTranslatable, match="'j' acts on 3 of exudyn's nodes"):
        run_exudyn(Model(bodies=(cable, tip, ball), joints=(motor,)), 0.01, 1e-3)
    pid = PIDController2D(name="f", **MARKS, target=WAVE, gain=1.0)
    with pytest.raises(NotTranslatable, match="a Servo2D, which has no integral"):
        run_exudyn(pair(forces=(pid,)), 0.01, 1e-3)
    for rub in (RevoluteFriction2D(name="f", **MARKS, torque=0.4), SlideFriction2D(name="f", **MARKS, force=0.4)):
        with pytest.raises(NotTranslatable, match="friction 'f' is set-valued"):
            run_exudyn(pair(forces=(rub,)), 0.01, 1e-3)


SOFT = Gonthier(stiffness=1e5, restitution=0.6)
KITE = ((0.2, 0.0), (0.0, 0.15), (-0.12, 0.02), (0.0, -0.2))


def shapes(kind: str) -> dict[str, Any]:
    where = {"marker": Marker2D(body="w", point=(0.02, 0.0), angle=0.3)}
    disk = Disk2D(marker=Marker2D(body="d", point=(0.01, 0.02)), radius=0.08)
    return {
        "ring": {"shape": Ring2D(**where, radius=0.7), "disk": disk},
        "box": {"shape": Box2D(**where, width=0.6, height=0.4), "disk": disk},
        "polygon": {"shape": Polygon2D(**where, vertices=tuple((2.0 * x, 2.0 * y) for x, y in KITE)), "disk": disk},
    }[kind]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("rubs", [False, True])
@pytest.mark.parametrize("kind", ["ring", "box", "polygon"])
def test_a_disk_in_a_ring_on_a_box_on_a_polygon(kind: str, rubs: bool) -> None:
    types: dict[str, Any] = {"ring": DiskInRing2D, "box": DiskOnBox2D, "polygon": DiskOnPolygon2D}
    friction = TanhFriction(coefficient=0.3, transition_speed=0.05) if rubs else None
    contact = types[kind](name="c", **shapes(kind), law=SOFT, friction=friction)
    model = pair(contacts=(contact,))
    away = {"velocity": (1.2, 0.5)} if kind == "ring" else {"velocity": (-1.2, -0.3)}
    model = model.model_copy(update={"bodies": (model.bodies[0], model.bodies[1].model_copy(update=away))})
    found, ours, _ = differences(model, 0.3, 1e-4)
    assert any(event.kind == "close" for event in ours.events)
    assert max(found.values()) < 5e-5, found


@pytest.mark.parametrize("law", [Hertz(stiffness=1e5), Gonthier(stiffness=1e5, restitution=0.6)])
def test_a_rope_and_a_stop(law: Any) -> None:
    rope = Rope2D(name="c", a=MARKS["a"], b=MARKS["b"], length=0.6, law=law)
    stop = AngleStop2D(name="s", a=MARKS["a"], b=MARKS["b"], limit=-0.5, law=law)
    model = pair(contacts=(rope, stop))
    faster = model.bodies[1].model_copy(update={"velocity": (1.0, 0.4)})
    model = model.model_copy(update={"bodies": (model.bodies[0], faster)})
    found, ours, _ = differences(model, 0.3, 1e-4)
    assert {event.contact for event in ours.events if event.kind == "close"} == {"c", "s"}
    assert max(found.values()) < 5e-5, found


@pytest.mark.full
def test_a_rigid_stop_is_the_limit_of_stiff_ones() -> None:
    """The whole cross-check of a model of one's own with an end stop as a constraint."""
    arm = RigidBody2D(name="arm", mass=1.0, inertia=1.0 / 12.0, position=(0.5, 0.0))
    hook = SpringDamper2D(
        name="s", a=Marker2D(point=(0.0, 1.0)), b=Marker2D(body="arm"), stiffness=5.0, natural_length=1.0
    )
    stop = AngleStop2D(name="stop", b=Marker2D(body="arm"), limit=-1.0, side="lower", law=NewtonImpact(restitution=0.6))
    model = Model(
        bodies=(arm,),
        joints=(Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="arm", point=(-0.5, 0.0))),),
        forces=(hook,),
        contacts=(stop,),
    )
    found = crosscheck(model, t_end=1.0)
    assert found.ok
    units = {row.quantity.partition(": ")[2]: row.unit for row in found.rows if row.quantity.startswith("stop: ")}
    assert units["approach speed"] == units["separation speed"] == "rad/s" and units["impulse"] == "N.m.s"


@pytest.mark.parametrize("follower", [False, True])
def test_forces_and_torques_in_space(follower: bool) -> None:
    body = RigidBody3D(name="b", mass=2.0, inertia=(0.3, 0.2, 0.25), angular_velocity=(1.0, -0.5, 2.0))
    marker = Marker3D(body="b", point=(0.1, 0.2, -0.1), attitude=AxisAngles(sequence="zxz", angles=(0.4, 0.7, -0.3)))
    loads = (
        AppliedForce3D(name="f", marker=marker, force_x=WAVE, force_z=WAVE, follower=follower),
        AppliedTorque3D(name="m", marker=marker, torque_y=WAVE, torque_z=WAVE, follower=follower),
    )
    found, _, _ = differences(Model(gravity=(0.0, 0.0, -9.81), bodies=(body,), forces=loads), 0.5, 5e-4)
    assert max(found.values()) < 1e-5, found


def test_every_element_and_contact_is_translated_or_refused_with_a_route() -> None:
    """Of each kind that the package has, a translation or a nearest route is written down: none is met by surprise."""
    for record in (record for known in (BODIES, JOINTS, FORCES, CONTACTS) for record in known.values()):
        assert record in _TRANSLATORS or record in _ROUTES or issubclass(record, Joint3D), record.__name__
