"""Kernels that are made from formulas, for the library of machine code: one record of each kind that there is."""

from collections.abc import Callable, Iterator
from typing import Any

from ..contacts.angle_stop2d import AngleStop2D
from ..contacts.contact2d import Disk2D
from ..contacts.disk_on_box2d import Box2D, DiskOnBox2D
from ..contacts.polygon2d import DiskOnPolygon2D, Polygon2D
from ..contacts.ring2d import DiskInRing2D, Ring2D
from ..contacts.rope2d import Rope2D
from ..contacts.scalar_contact2d import ScalarContact2D
from ..elements import pid_controller2d, relative_load2d, relative_motor2d, scalar_force2d, scalar_joint2d, servo2d
from ..elements.base import Element, Form
from ..elements.belt2d import Belt2D
from ..elements.distance2d import Distance2D
from ..elements.formula2d import form_name
from ..elements.gear2d import Gear2D
from ..elements.joint_friction2d import RevoluteFriction2D, SlideFriction2D
from ..elements.measures2d import MEASURES
from ..elements.pid_controller2d import PIDController2D
from ..elements.rack2d import Rack2D
from ..elements.relative_load2d import RelativeLoad2D
from ..elements.relative_motor2d import RelativeMotor2D
from ..elements.scalar_force2d import ScalarForce2D
from ..elements.scalar_joint2d import ScalarJoint2D
from ..elements.servo2d import Servo2D
from ..elements.slide_spring2d import SlideSpring2D
from ..elements.torsion_spring2d import TorsionSpring2D
from ..laws import KelvinVoigt, NewtonImpact
from ..laws.friction import CoulombFriction, LuGreFriction
from ..model.markers import Marker2D
from ..model.signals import Constant

A, B = Marker2D(), Marker2D(body="b")
NOTHING = Constant(value=0.0)


def _elements() -> Iterator[Element]:
    ends: dict[str, Any] = {"a": A, "b": B}
    yield Distance2D(name="distance", **ends, length=1.0)
    yield Gear2D(name="gear", **ends, radius_a=1.0, radius_b=1.0)
    yield Rack2D(name="rack", **ends, radius=1.0)
    yield Belt2D(name="belt", **ends, radius_a=1.0, radius_b=1.0)
    yield TorsionSpring2D(name="torsion", **ends)
    yield SlideSpring2D(name="slide", **ends)
    yield RevoluteFriction2D(name="turning", **ends, torque=1.0, transition_rate=1.0)
    yield SlideFriction2D(name="sliding", **ends, force=1.0, transition_speed=1.0)
    for measure in ("angle", "slide", "distance"):
        yield RelativeLoad2D(name=measure, **ends, load=NOTHING, measure=measure)
        yield RelativeMotor2D(name=measure, **ends, motion=NOTHING, measure=measure)
        yield Servo2D(name=measure, **ends, target=NOTHING, gain=1.0, measure=measure)
        for sensed in ("angle", "slide", "distance"):
            yield PIDController2D(name=measure, **ends, target=NOTHING, gain=1.0, measure=measure, sensed=sensed)
    hard, soft = NewtonImpact(restitution=0.0), KelvinVoigt(stiffness=1.0, damping=0.0)
    yield Rope2D(name="rope", **ends, length=1.0, law=hard)
    yield AngleStop2D(name="stop", **ends, limit=1.0, law=hard)
    box: dict[str, Any] = {"shape": Box2D(marker=A, width=1.0, height=1.0), "disk": Disk2D(marker=B)}
    yield DiskOnBox2D(name="box", **box, law=hard)
    yield DiskOnBox2D(name="rubbed", **box, law=hard, friction=CoulombFriction(coefficient=0.5))
    bristles = LuGreFriction(coefficient=0.5, stribeck_speed=1.0, bristle_stiffness=1.0)
    yield DiskOnBox2D(name="bristled", **box, law=soft, friction=bristles)
    corners = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    polygon: dict[str, Any] = {"shape": Polygon2D(marker=A, vertices=corners), "disk": Disk2D(marker=B)}
    yield DiskOnPolygon2D(name="polygon", **polygon, law=hard)
    yield DiskOnPolygon2D(name="rubbed", **polygon, law=hard, friction=CoulombFriction(coefficient=0.5))
    yield DiskOnPolygon2D(name="bristled", **polygon, law=soft, friction=bristles)
    ring: dict[str, Any] = {"shape": Ring2D(marker=A, radius=2.0), "disk": Disk2D(marker=B, radius=1.0)}
    yield DiskInRing2D(name="ring", **ring, law=hard)
    yield DiskInRing2D(name="rubbed", **ring, law=hard, friction=CoulombFriction(coefficient=0.5))
    yield DiskInRing2D(name="bristled", **ring, law=soft, friction=bristles)


def _key(element: Any) -> tuple[str, tuple[Callable[..., Any], ...]]:
    """Kind and formulas of an element."""
    if isinstance(element, ScalarJoint2D):
        return scalar_joint2d.KIND, (element.formula.formula,)
    if isinstance(element, ScalarForce2D):
        return scalar_force2d.KIND, element.formula.formulas
    if isinstance(element, RelativeLoad2D):
        return relative_load2d.KIND, (MEASURES[element.measure],)
    if isinstance(element, RelativeMotor2D):
        return relative_motor2d.KIND, (MEASURES[element.measure],)
    if isinstance(element, PIDController2D):
        return pid_controller2d.KIND, element.formulas()
    if isinstance(element, Servo2D):
        return servo2d.KIND, (MEASURES[element.measure],)
    if isinstance(element, ScalarContact2D) and element.kind is not None:
        return element.kind, element.formula.formulas
    raise TypeError(f"nothing says how the kernel of a {type(element).__name__} is called in the library")


def forms() -> dict[str, Form]:
    """Kernels that are made from formulas, with their patterns, by their names in the library."""
    found = {}
    for element in _elements():
        kind, formulas = _key(element)
        arguments = element.arguments()  # type: ignore[attr-defined]
        found[form_name(kind, formulas, arguments)] = element.form()
    return found
