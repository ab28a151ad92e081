"""Forces between two markers along an angle, a way or a distance: an ObjectGenericODE2 that shares the bodies' nodes.

It has no mass, only the generalised force -F(x, x', t) grad x as its user function. exudyn's own spring-dampers take
user functions too, but know distances (and angles within a turn) only, and no way along an axis that turns.
"""

import math
from collections.abc import Callable
from operator import add, mul

from scipy.interpolate import CubicSpline

from ...core.elements import (
    PIDController2D,
    RelativeLoad2D,
    RevoluteFriction2D,
    Servo2D,
    SlideFriction2D,
    SlideSpring2D,
    TableSpring2D,
    TorsionSpring2D,
)
from ...core.elements.base import PairElement2D
from .measures import MEASURES, scalar
from .registry import Build, no_equal, translates
from .signals import time_function
from .user_gaps import Nodes, Numbers

Effort = Callable[[float, float, float], float]
"""(x, x', t) -> force or torque against the growth of x."""

no_equal("a Servo2D, which has no integral of the error", PIDController2D)


def add_effort(record: PairElement2D, build: Build, measure: str, effort: Effort) -> None:
    """The force of `record`. exudyn forms the tangent by differences of it."""
    nodes = Nodes(build, (record.a.body, record.b.body))
    value = scalar(build, record.a, record.b, MEASURES[measure], nodes)

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


@translates(TableSpring2D)
def table_spring(record: TableSpring2D, build: Build) -> None:
    """scipy's cubic spline through the table, and a damper."""
    pull, c = CubicSpline(record.lengths_table, record.forces), record.damping
    add_effort(record, build, "distance", lambda x, rate, t: float(pull(x)) + c * rate)


@translates(RevoluteFriction2D)
def revolute_friction(record: RevoluteFriction2D, build: Build) -> None:
    """T tanh(phi'/w)."""
    size, width = record.torque, record.transition_rate
    add_effort(record, build, "angle", lambda x, rate, t: size * math.tanh(rate / width))


@translates(SlideFriction2D)
def slide_friction(record: SlideFriction2D, build: Build) -> None:
    """F tanh(s'/v)."""
    size, width = record.force, record.transition_speed
    add_effort(record, build, "slide", lambda x, rate, t: size * math.tanh(rate / width))


@translates(RelativeLoad2D)
def relative_load(record: RelativeLoad2D, build: Build) -> None:
    """The load makes the measure grow."""
    load = time_function(record.load, build.model)
    add_effort(record, build, record.measure, lambda x, rate, t: -load.value(t))


@translates(Servo2D)
def servo(record: Servo2D, build: Build) -> None:
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
