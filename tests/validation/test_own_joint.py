"""A joint in space made of primitives, from outside of the package: all that is said of it stands in its class."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import pytest
from tlismni.core import (
    AppliedForce3D,
    AppliedTorque3D,
    Constant,
    Distance2D,
    Marker2D,
    Marker3D,
    Model,
    PointMass2D,
    RigidBody3D,
    RotationVector,
    ScalarForce2D,
    ScalarJoint2D,
    scalar_constraint,
    scalar_force,
    simulate,
)
from tlismni.core.contacts.element import ContactElement
from tlismni.core.elements.base import Element
from tlismni.core.elements.dot1_3d import Dot1
from tlismni.core.elements.dot2_3d import Dot2
from tlismni.core.elements.joint3d import Joint3D, TurningJoint3D
from tlismni.core.elements.primitive3d import Primitive
from tlismni.core.model.open_union import subclasses
from tlismni.fmu_wrapper.slave import Slave
from tlismni.validation import NotTranslatable, run_exudyn
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.viewer import animate, forces
from tlismni.viewer.build import scene_of_start
from tlismni.viewer.drawing import interactions
from tlismni.viewer.drawing.mechanism import draw
from tlismni.viewer.fixtures import SYMBOLS, stretched, symbol
from tlismni.viewer.space import fixtures as in_space
from tlismni.viewer.space import forces as space_forces

MASS, INERTIA, SPIN = 2.0, (0.3, 0.25, 0.4), 4.0
FORCE, TORQUE, LEVER = 3.0, 0.7, 0.5

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")


class Upright3D(TurningJoint3D):
    """The z axes of both markers stay parallel, and b in the yz plane of marker a (3 rows)."""

    symbol = "block"
    aligned = (("z", "z"),)

    def primitives(self) -> Sequence[Primitive]:
        return (Dot1("z", "x"), Dot1("z", "y"), Dot2("x"))


class Askew3D(Joint3D):
    """Two axes stay at an angle of 60 degrees: of this exudyn has nothing."""

    symbol: ClassVar[str] = "rod"

    def primitives(self) -> Sequence[Primitive]:
        return (Dot1("x", "y", 0.5),)


def upright(**more) -> Model:
    top = RigidBody3D(name="top", mass=MASS, inertia=INERTIA, angular_velocity=(0.0, 0.0, SPIN))
    held = Upright3D(name="held", a=Marker3D(), b=Marker3D(body="top"))
    return Model(bodies=[top], joints=[held], gravity=(0.0, 0.0, 0.0), **more)


@pytest.fixture(scope="module")
def pushed():
    """A force along x, which is held, one along y, which is not, and a torque about x, which is held."""
    forces = [
        AppliedForce3D(name="push", marker=Marker3D(body="top"), force_x=Constant(value=FORCE),
                       force_y=Constant(value=FORCE)),
        AppliedTorque3D(name="tilt", marker=Marker3D(body="top"), torque_x=Constant(value=TORQUE)),
    ]  # fmt: skip
    return simulate(upright(forces=forces), 2.0, method="irk", rtol=1e-10, atol=1e-12)


def test_it_moves_and_carries_loads(pushed) -> None:
    t = pushed.t
    assert pushed["top.y"] == pytest.approx(0.5 * FORCE / MASS * t**2, abs=1e-8)
    assert pushed["held.angle"] == pytest.approx(SPIN * t, abs=1e-8)
    assert np.abs(pushed["top.x"]).max() < 1e-12
    assert pushed["held.force_x"] == pytest.approx(-FORCE, rel=1e-8)
    assert pushed["held.torque_x"] == pytest.approx(-TORQUE, rel=1e-8)


def test_it_is_seen(pushed) -> None:
    """A block on the body, and what holds it on the ground."""
    solids = animate(pushed).scene.solids
    assert len(solids) > len(animate(simulate(upright().model_copy(update={"joints": ()}), 0.1)).scene.solids)


def test_an_fmu_runs_it(pushed) -> None:
    slave = Slave(pushed.system, rtol=1e-10, atol=1e-12)
    slave.enter_initialization()
    slave.exit_initialization()
    slave.do_step(0.0, 1.0)
    slave.do_step(1.0, 1.0)
    assert slave["held.angle"] == pytest.approx(2.0 * SPIN, abs=1e-7)


@needs_exudyn
def test_exudyn_has_one_of_the_same_primitives() -> None:
    """A force off the centre turns the body about z, and pushes it across what is held."""
    at = Marker3D(body="top", point=(0.0, LEVER, 0.2))
    force = AppliedForce3D(name="push", marker=at, force_x=Constant(value=FORCE), force_y=Constant(value=FORCE))
    model = upright(forces=[force])
    theirs = run_exudyn(model, 0.5, 5e-4)
    ours = simulate(model, 0.5, rtol=1e-10, atol=1e-12, t_eval=theirs.t)
    assert np.ptp(ours["held.angle"] - SPIN * ours.t) > 0.1
    for name in ("top.x", "top.y", "top.z", "held.angle"):
        assert np.abs(theirs[name] - ours[name]).max() < 1e-5, name


@needs_exudyn
def test_what_exudyn_cannot_hold_is_said() -> None:
    start = RotationVector(vector=(0.0, 0.0, -np.pi / 6.0))
    body = RigidBody3D(name="top", mass=MASS, inertia=INERTIA, attitude=start)
    joint = Askew3D(name="askew", a=Marker3D(), b=Marker3D(body="top"))
    model = Model(bodies=[body], joints=[joint], gravity=(0.0, 0.0, 0.0))
    with pytest.raises(NotTranslatable, match="'askew' is an Askew3D and holds a Dot1"):
        run_exudyn(model, 0.1, 1e-3)


# forces, and joints in the plane, from a formula


class Stretcher2D(ScalarForce2D):
    """A spring between two points, whose class says that it looks like one."""

    symbol = "spring"
    formula = scalar_force(
        lambda a, b: (b.x - a.x) ** 2 + (b.y - a.y) ** 2,
        lambda x, rate, stiffness, damping: stiffness * x + damping * rate,
    )
    a: Marker2D = Marker2D()
    b: Marker2D
    stiffness: float
    damping: float = 0.0


def test_a_force_from_a_formula_is_seen() -> None:
    bead = PointMass2D(name="bead", mass=0.1, position=(0.5, 0.25))
    spring = Stretcher2D(name="pull", b=Marker2D(body="bead"), stiffness=3.0)
    model = Model(bodies=[bead], forces=[spring])
    (link,) = scene_of_start(model).links
    assert (link.name, link.kind) == ("pull", "spring")
    zigzags = [len(draw(m).shapes) for m in (model, Model(bodies=[bead]))]
    assert zigzags[0] > zigzags[1]
    (damped,) = scene_of_start(Model(bodies=[bead], forces=[spring.model_copy(update={"damping": 1.0})])).links
    assert damped.kind == "spring-damper"


def test_a_symbol_may_be_drawn_by_its_author() -> None:
    """A name that nobody knows is not seen; `symbol` says what draws it."""

    class Flag2D(Stretcher2D):
        symbol = "flag of this test"

    bead = PointMass2D(name="bead", mass=0.1, position=(0.5, 0.25))
    model = Model(bodies=[bead], forces=[Flag2D(name="flag", b=Marker2D(body="bead"), stiffness=3.0)])
    assert not scene_of_start(model).links

    @symbol("flag of this test")
    def _flag(element, stage):
        stretched(stage, element.name, "rope", element.a, element.b)

    try:
        (link,) = scene_of_start(model).links
        assert (link.name, link.kind) == ("flag", "rope")
    finally:
        del SYMBOLS["flag of this test"]


def test_arrows_are_said_by_the_class() -> None:
    """Of the same formula one has a tension, which an arrow shows, and one is said to have none."""

    class Tied2D(Distance2D):
        pass

    class Hidden2D(Distance2D):
        arrow = "none"

    for kind, shown in ((Tied2D, ["rod"]), (Hidden2D, [])):
        bead = PointMass2D(name="bead", mass=0.1, position=(0.5, 0.0))
        joint = kind(name="rod", a=Marker2D(), b=Marker2D(body="bead"), length=0.5)
        result = simulate(Model(bodies=[bead], joints=[joint]), 0.1)
        arrows = [arrow for arrow in animate(result).scene.arrows if arrow.kind == "joint"]
        assert [arrow.name for arrow in arrows] == shown


def test_all_symbols_of_the_library_are_known() -> None:
    """Each class that says a symbol is drawn, in a scene or in drawings."""
    known = {"none", *SYMBOLS, *interactions.SYMBOLS, *interactions.IN_SPACE, *in_space.SYMBOLS}
    kinds = [kind for kind in subclasses(Element) if kind.__module__.startswith("tlismni.")]
    assert len(kinds) > 100
    assert {kind.symbol for kind in kinds} <= known
    assert {kind.arrow for kind in kinds} == {"none", "components", "tension", "signals"}
    touches = {kind.touch for kind in kinds if issubclass(kind, ContactElement)}
    assert touches == {"none", *forces.TOUCHES, *space_forces.TOUCHES}


# a joint in the plane from a formula


class AlongParabola(ScalarJoint2D):
    """Marker b slides on a parabola about marker a."""

    formula = scalar_constraint(lambda a, b, curvature: b.y - a.y - 0.5 * curvature * (b.x - a.x) ** 2)
    a: Marker2D = Marker2D()
    b: Marker2D
    curvature: float


def test_a_joint_from_a_formula_is_seen() -> None:
    bead = PointMass2D(name="bead", mass=0.1, position=(0.5, 0.25))
    model = Model(bodies=[bead], joints=[AlongParabola(name="wire", b=Marker2D(body="bead"), curvature=2.0)])
    (link,) = scene_of_start(model).links
    assert (link.name, link.kind) == ("wire", "rod")
