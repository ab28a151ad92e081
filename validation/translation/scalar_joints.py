"""Joints of one equation between two markers: an ObjectConnectorCoordinateVector with the equation as user function.

It is a constraint of exudyn's own solver, met at position or (index 2) at velocity level.
"""

import math
from operator import mul
from typing import Any

import numpy as np

from ...core.elements import Belt2D, CoordinateRelation, Gear2D, KnifeEdge2D, Rack2D, RelativeMotor2D
from ...core.elements.base import Element, PairElement2D
from ..errors import NotTranslatable
from .measures import MEASURES, Measure, Scalar, arcs, place_of, rolling, scalar
from .registry import Build, Column, translates
from .signals import TimeFunction, time_function
from .user_gaps import Nodes, Numbers


def add_equation(record: Element, build: Build, nodes: Nodes, equation: Scalar, motion: TimeFunction | None = None,
                 *, rate_only: bool = False, row: int = 0) -> None:  # fmt: skip
    """equation(q) = motion(t), or with `rate_only` gradient . q' = 0. The channel of its multiplier is read: of a joint
    with several equations that of its `row`.

    Raises
    ------
    NotTranslatable : if it has no moving body, or reaches more than two nodes, as at a point of a flexible body.
    """
    if not 1 <= len(nodes.nodes) <= 2:
        raise NotTranslatable(
            f"'{record.name}' acts on {len(nodes.nodes)} of exudyn's nodes, whose constraint takes one or two: put it "
            "between rigid bodies; a light RigidBody2D on a Clamp2D stands for a point of a flexible one"
        )
    first = build.ground_node if len(nodes.nodes) == 1 else nodes.nodes[0]
    markers = [build.add("MarkerNodeCoordinates", nodeNumber=n) for n in (first, nodes.nodes[-1])]

    def constraint(mbs: Any, t: float, item: int, q: Numbers, v: Numbers, of_rates: bool) -> list[float]:
        x, gradient = equation(q)
        if of_rates or rate_only:
            return [sum(map(mul, gradient, v)) - (motion.rate(t) if motion else 0.0)]
        return [x - (motion.value(t) if motion else 0.0)]

    def jacobian(mbs: Any, t: float, item: int, q: Numbers, v: Numbers, of_rates: bool) -> np.ndarray:
        return np.array([equation(q)[1]])

    item = build.add(
        "ObjectConnectorCoordinateVector", markerNumbers=markers, scalingMarker0=np.zeros((1, 1)),
        scalingMarker1=np.zeros((1, 1)), velocityLevel=rate_only, constraintUserFunction=constraint,
        jacobianUserFunction=jacobian,
    )  # fmt: skip
    if build.sensors:
        for channel in record.multiplier_channels()[row : row + 1]:  # of drivers in space there is none
            build.columns.append(Column(channel.name, build.sensor(item, "Force"), 0))


def _pair(record: PairElement2D, build: Build, measure: Measure, motion: TimeFunction | None = None,
          period: float = 0.0) -> None:  # fmt: skip
    """Without a motion the measure stays what it is at the start, but for whole periods."""
    nodes = Nodes(build, (record.a.body, record.b.body))
    value = scalar(build, record.a, record.b, measure, nodes)
    start = 0.0 if motion else value(nodes.reference)[0]

    def equation(x: Numbers) -> tuple[float, list[float]]:
        found, gradient = value(x)
        lag = found - start
        return (math.remainder(lag, period) if period else lag), gradient

    add_equation(record, build, nodes, equation, motion)


@translates(RelativeMotor2D)
def relative_motor(record: RelativeMotor2D, build: Build) -> None:
    """Angle, way or distance follow the motion."""
    _pair(record, build, MEASURES[record.measure], time_function(record.motion, build.model))


@translates(Gear2D)
def gear(record: Gear2D, build: Build) -> None:
    """The arcs of both pitch circles past the line of the centres, whatever holds these."""
    both = record.radius_a + record.radius_b
    _pair(record, build, arcs(record.radius_a, record.radius_b), period=2.0 * math.pi * both)


@translates(Belt2D)
def belt(record: Belt2D, build: Build) -> None:
    """As a gear, with the other pulley turning the same way unless the belt is crossed."""
    radius_b = record.radius_b if record.crossed else -record.radius_b
    _pair(record, build, arcs(record.radius_a, radius_b), period=2.0 * math.pi * (record.radius_a + radius_b))


@translates(Rack2D)
def rack(record: Rack2D, build: Build) -> None:
    """Way along the rack and arc on the wheel."""
    _pair(record, build, rolling(record.radius))


@translates(KnifeEdge2D)
def knife_edge(record: KnifeEdge2D, build: Build) -> None:
    """No velocity across the edge: a constraint of rates alone."""
    nodes = Nodes(build, (record.marker.body,))
    place = place_of(build, record.marker, nodes)

    def across(x: Numbers) -> tuple[float, list[float]]:
        edge, gradient = place(x), [0.0] * len(nodes.reference)
        edge.push(gradient, math.sin(edge.angle), -math.cos(edge.angle))
        return 0.0, gradient

    add_equation(record, build, nodes, across, rate_only=True)


@translates(CoordinateRelation)
def coordinate_relation(record: CoordinateRelation, build: Build) -> None:
    """A weighted sum of coordinates of one or two nodes."""
    nodes = Nodes(build, [term.body for term in record.terms])
    row = [0.0] * len(nodes.reference)
    for term in record.terms:
        row[nodes.place(build, term.body, term.coordinate)] += term.factor
    add_equation(record, build, nodes, lambda x: (sum(map(mul, row, x)) - record.offset, row))
