"""Joints and drivers. Signs of the force channels are those of the model's records."""

import math
from typing import Any

from ...core.elements import CoordinateDriver, Distance2D, LinearSystem, Prismatic2D, Revolute2D
from ...core.elements.base import Element
from ...core.model.markers import GROUND
from ..errors import NotTranslatable
from .registry import Build, Column, translates
from .signals import time_function


def _force_columns(record: Element, build: Build, item: Any, output: str, factors: tuple[float, ...]) -> None:
    """The joint's multiplier channels from components 0, 1 ... of exudyn's force output."""
    if build.sensors:
        sensor = build.sensor(item, output)
        for k, (channel, factor) in enumerate(zip(record.multiplier_channels(), factors, strict=True)):
            build.columns.append(Column(channel.name, sensor, k, factor))


@translates(Revolute2D)
def revolute(record: Revolute2D, build: Build) -> None:
    """ObjectJointRevolute2D. Its Force output is the opposite of the force on body b."""
    markers = [build.point(record.a), build.point(record.b)]
    item = build.add("ObjectJointRevolute2D", markerNumbers=markers)
    _force_columns(record, build, item, "Force", (-1.0, -1.0))


@translates(Prismatic2D)
def prismatic(record: Prismatic2D, build: Build) -> None:
    """ObjectJointPrismatic2D: axis in a's frame, normal in b's frame at the kept relative angle."""
    relative = record.relative_angle
    if relative is None:
        relative = build.start_angle(record.b.body) - build.start_angle(record.a.body)
    axis = record.a.angle
    normal = axis + 0.5 * math.pi - relative
    build.add(
        "ObjectJointPrismatic2D",
        markerNumbers=[build.frame(record.a, record.name), build.frame(record.b, record.name)],
        axisMarker0=[math.cos(axis), math.sin(axis), 0.0],
        normalMarker1=[math.cos(normal), math.sin(normal), 0.0],
    )
    build.notes.append(f"{record.name}: its forces are not read back from exudyn, which splits them otherwise")


@translates(Distance2D)
def distance(record: Distance2D, build: Build) -> None:
    """ObjectConnectorDistance."""
    item = build.add(
        "ObjectConnectorDistance",
        markerNumbers=[build.point(record.a), build.point(record.b)],
        distance=record.length,
    )
    _force_columns(record, build, item, "Force", (1.0,))


@translates(CoordinateDriver)
def driver(record: CoordinateDriver, build: Build) -> None:
    """ObjectConnectorCoordinate between the ground and the coordinate, with the motion as offset."""
    if record.body == GROUND:
        raise NotTranslatable(f"'{record.name}' drives the ground, which cannot move: name a body")
    body = next(b for b in build.model.bodies if b.name == record.body)
    if record.coordinate not in body.coordinate_names:
        raise NotTranslatable(f"'{record.name}' drives '{record.coordinate}', which '{body.name}' does not have")
    k = body.coordinate_names.index(record.coordinate)
    motion = time_function(record.motion, build.model)
    # exudyn constrains displacements from the reference: subtract where the body starts
    reference = 0.0 if isinstance(body, LinearSystem) else body.initial_state()[0][k]
    markers = [
        build.add("MarkerNodeCoordinate", nodeNumber=build.ground_node, coordinate=0),
        build.add("MarkerNodeCoordinate", nodeNumber=build.bodies[record.body].node, coordinate=k),
    ]
    functions: dict[str, Any] = {}
    if motion.constant is None:
        functions = {
            "offsetUserFunction": lambda mbs, t, item, offset: motion.value(t) - reference,
            "offsetUserFunction_t": lambda mbs, t, item, offset: motion.rate(t),
        }
    item = build.add(
        "ObjectConnectorCoordinate", markerNumbers=markers, offset=motion.value(0.0) - reference, **functions
    )
    _force_columns(record, build, item, "Force", (1.0,))
