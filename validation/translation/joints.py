"""Joints and drivers. Signs of the force channels are those of the model's records."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ...core.elements import Clamp2D, CoordinateDriver, Distance2D, Prismatic2D, Revolute2D
from ...core.elements.base import Element
from ...core.model.markers import GROUND
from ..errors import NotTranslatable
from .bodies import add_motion
from .measures import place_of
from .registry import Build, Column, Derived, frees, translates
from .scalar_joints import add_equation
from .signals import time_function
from .user_gaps import Nodes, Numbers

frees(Revolute2D)


def _force_columns(record: Element, build: Build, item: Any, output: str, factors: tuple[float, ...]) -> None:
    """The joint's multiplier channels from components 0, 1 ... of exudyn's force output."""
    if build.sensors:
        sensor = build.sensor(item, output)
        for k, (channel, factor) in enumerate(zip(record.multiplier_channels(), factors, strict=True)):
            build.columns.append(Column(channel.name, sensor, k, factor))


@translates(Revolute2D)
def revolute(record: Revolute2D, build: Build) -> None:
    """ObjectJointRevolute2D. Its Force output is the opposite of the force on body b.

    Without redundant equations those left along x or y, one by one.
    """
    if record.name in build.redundant:
        _pin_in_part(record, build, build.redundant[record.name])
        return
    markers = [build.point(record.a), build.point(record.b)]
    item = build.add("ObjectJointRevolute2D", markerNumbers=markers)
    _force_columns(record, build, item, "Force", (-1.0, -1.0))


def _pin_in_part(record: Revolute2D, build: Build, left_out: frozenset[int]) -> None:
    nodes = Nodes(build, (record.a.body, record.b.body))
    first, second = place_of(build, record.a, nodes), place_of(build, record.b, nodes)

    def apart(x: Numbers, along: tuple[float, float]) -> tuple[float, list[float]]:
        a, b, gradient = first(x), second(x), [0.0] * len(nodes.reference)
        a.push(gradient, *along)
        b.push(gradient, -along[0], -along[1])
        return along[0] * (a.x - b.x) + along[1] * (a.y - b.y), gradient

    for row, along in enumerate(((1.0, 0.0), (0.0, 1.0))):
        if row not in left_out:
            add_equation(record, build, nodes, partial(apart, along=along), row=row)
    build.notes.append(f"{record.name}: exudyn's holds {2 - len(left_out)} ways, without the redundant equations")


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


@translates(Clamp2D)
def clamp(record: Clamp2D, build: Build) -> None:
    """ObjectJointGeneric that locks x, y and the rotation about z, with b's frame turned by the angle that is kept."""
    relative = record.relative_angle
    if relative is None:
        relative = build.start_angle(record.b.body) - build.start_angle(record.a.body)
    c, s = math.cos(relative), math.sin(relative)
    item = build.add(
        "ObjectJointGeneric",
        markerNumbers=[build.frame(record.a, record.name), build.frame(record.b, record.name)],
        constrainedAxes=[1, 1, 0, 0, 0, 1],
        rotationMarker1=[[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]],
    )
    if not build.sensors:
        return
    force, torque = build.sensor(item, "ForceLocal"), build.sensor(item, "TorqueLocal")
    names = [channel.name for channel in record.multiplier_channels()]
    # in the axes of a's body, and the force is the one on a
    own = [f"{record.name}.exudyn_force_{axis}" for axis in "xy"]
    build.columns += [Column(own[0], force, 0, -1.0), Column(own[1], force, 1, -1.0), Column(names[2], torque, 2)]
    turned = f"{record.a.body}.angle"

    def along(c_x: Callable[[Any], Any], c_y: Callable[[Any], Any]) -> Callable[[dict[str, Any]], Any]:
        return lambda found: c_x(found.get(turned, 0.0)) * found[own[0]] + c_y(found.get(turned, 0.0)) * found[own[1]]

    build.derived += [
        Derived(names[0], along(np.cos, lambda angle: -np.sin(angle))),
        Derived(names[1], along(np.sin, np.cos)),
    ]


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
    driven, reference = build.coordinate(record.body, record.coordinate, record.name)
    motion = time_function(record.motion, build.model)
    item = add_motion(build, driven, motion, reference)
    _force_columns(record, build, item, "Force", (1.0,))
