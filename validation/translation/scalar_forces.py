"""Forces between two markers along an angle, a way or a distance: an ObjectGenericODE2 that shares the bodies' nodes.
In the plane and in space.

It has no mass, only the generalised force -F(x, x', t) grad x as its user function. exudyn's own spring-dampers take
user functions too, but know distances (and angles within a turn) only, and no way along an axis that turns.
"""

import math
from collections.abc import Callable
from operator import add, mul

from scipy.interpolate import CubicSpline

from ...core.assembly.numbering import ModelNumbering
from ...core.elements import (
    PIDController2D,
    PIDController3D,
    RelativeLoad2D,
    RelativeLoad3D,
    RevoluteFriction2D,
    RevoluteFriction3D,
    Servo2D,
    Servo3D,
    SlideFriction2D,
    SlideFriction3D,
    SlideSpring2D,
    TableSpring2D,
    TableSpring3D,
    TorsionSpring2D,
)
from ...core.elements.base import PairElement2D
from ...core.elements.joint_friction import JointFrictionForce
from ...core.elements.measured_force3d import CountingForce3D, MeasuredForce3D
from ..errors import NotTranslatable
from .measures import MEASURES, Scalar, scalar
from .measures3d import MEASURES3D, angle_from
from .registry import Build, no_equal, translates
from .signals import time_function
from .space_contacts import check_bodies
from .user_gaps import Nodes, Numbers

Effort = Callable[[float, float, float], float]
"""(x, x', t) -> force or torque against the growth of x."""

no_equal("a Servo2D, which has no integral of the error", PIDController2D)
no_equal("a Servo3D, which has no integral of the error", PIDController3D)


def measured(record: PairElement2D | MeasuredForce3D, build: Build, measure: str, nodes: Nodes) -> Scalar:
    """The measure between the markers of `record`. Raises NotTranslatable on points of flexible bodies in space."""
    if not isinstance(record, MeasuredForce3D):
        return scalar(build, record.a, record.b, MEASURES[measure], nodes)
    check_bodies(record, build)
    if measure == "angle" and isinstance(record, CountingForce3D):
        start = ModelNumbering(build.model).start_angle(record.a, record.b, record.name)
        return angle_from(build, record.a, record.b, nodes, start)
    return MEASURES3D[measure](build, record.a, record.b, nodes)


def add_effort(record: PairElement2D | MeasuredForce3D, build: Build, measure: str, effort: Effort) -> None:
    """The force of `record`. exudyn forms the tangent by differences of it."""
    nodes = Nodes(build, (record.a.body, record.b.body))
    value = measured(record, build, measure, nodes)

    def force(mbs: object, t: float, item: int, q: Numbers, v: Numbers) -> list[float]:
        x, gradient = value(list(map(add, nodes.reference, q)))
        load = -effort(x, sum(map(mul, gradient, v)), t)
        return [load * g for g in gradient]

    if nodes.nodes:  # between two markers on the ground nothing moves
        build.add("ObjectGenericODE2", nodeNumbers=list(nodes.nodes), forceUserFunction=force)


@translates(TorsionSpring2D)
def torsion_spring(record: TorsionSpring2D, build: Build) -> None:
    """Torque k (phi - phi0) + c phi'."""
    k, c, free = record.stiffness, record.damping, record.natural_angle
    add_effort(record, build, "angle", lambda x, rate, t: k * (x - free) + c * rate)


@translates(SlideSpring2D)
def slide_spring(record: SlideSpring2D, build: Build) -> None:
    """Force k (s - s0) + c s'."""
    k, c, free = record.stiffness, record.damping, record.natural_position
    add_effort(record, build, "slide", lambda x, rate, t: k * (x - free) + c * rate)


@translates(TableSpring2D, TableSpring3D)
def table_spring(record: TableSpring2D | TableSpring3D, build: Build) -> None:
    """scipy's cubic spline through the table, and a damper."""
    pull, c = CubicSpline(record.lengths_table, record.forces), record.damping
    measure = record.measure if isinstance(record, TableSpring3D) else "distance"
    add_effort(record, build, measure, lambda x, rate, t: float(pull(x)) + c * rate)


def transition_of(record: JointFrictionForce) -> float:
    """Of a regularised friction. Raises NotTranslatable for a set-valued one."""
    if record.transition is None:
        raise NotTranslatable(
            f"friction '{record.name}' is set-valued, and exudyn's friction of joints is not: to compare, give it a "
            "small transition_rate (transition_speed of a slide), and the size that the joint's force gives it"
        )
    return record.transition


@translates(RevoluteFriction2D, RevoluteFriction3D)
def revolute_friction(record: RevoluteFriction2D | RevoluteFriction3D, build: Build) -> None:
    """T tanh(phi'/w)."""
    size, width = record.torque, transition_of(record)
    add_effort(record, build, "angle", lambda x, rate, t: size * math.tanh(rate / width))


@translates(SlideFriction2D, SlideFriction3D)
def slide_friction(record: SlideFriction2D | SlideFriction3D, build: Build) -> None:
    """F tanh(s'/v)."""
    size, width = record.force, transition_of(record)
    add_effort(record, build, "slide", lambda x, rate, t: size * math.tanh(rate / width))


@translates(RelativeLoad2D, RelativeLoad3D)
def relative_load(record: RelativeLoad2D | RelativeLoad3D, build: Build) -> None:
    """The load makes the measure grow."""
    load = time_function(record.load, build.model)
    add_effort(record, build, record.measure, lambda x, rate, t: -load.value(t))


@translates(Servo2D, Servo3D)
def servo(record: Servo2D | Servo3D, build: Build) -> None:
    """Gains on what is missing, with the smooth limit that the record states."""
    target = time_function(record.target, build.model)
    gain, rate_gain, limit = record.gain, record.rate_gain, record.largest

    def effort(x: float, rate: float, t: float) -> float:
        if record.of_rate:
            asked = rate_gain * (rate - target.value(t))
        else:
            asked = gain * (x - target.value(t)) + rate_gain * (rate - target.rate(t))
        return asked if limit is None or asked == 0.0 else asked / (1.0 + abs(asked / limit) ** 8) ** 0.125

    add_effort(record, build, record.measure, effort)
