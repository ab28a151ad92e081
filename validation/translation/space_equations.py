"""Rods, homokinetic joints, drivers, gears, racks and screws in space: equations of one number each, as
`scalar_joints.py` has them in the plane.

The multipliers of the joints and drivers are no loads of the model's, and are not read.
"""

import math

from ...core.elements import (
    AngleDriver3D,
    ConstantVelocity3D,
    Distance3D,
    Gear3D,
    PositionDriver3D,
    RackAndPinion3D,
    RevoluteSpherical3D,
    Screw3D,
)
from ...core.elements.base import JointElement
from .measures import Scalar
from .measures3d import angle, angle_from, distance, slide, twist, weighted
from .registry import Build, translates
from .scalar_joints import add_equation
from .signals import time_function
from .space import derive_coordinates, placed
from .space_contacts import check_bodies
from .user_gaps import Nodes, Numbers

TURN = 2.0 * math.pi


def _nodes(record: JointElement, build: Build) -> Nodes:
    check_bodies(record, build)
    return Nodes(build, [marker.body for marker in record.markers()])


def _kept(record: JointElement, build: Build, nodes: Nodes, value: Scalar) -> None:
    """The measure stays what it is at the start."""
    start, _ = value(nodes.reference)

    def equation(x: Numbers) -> tuple[float, list[float]]:
        found, row = value(x)
        return found - start, row

    add_equation(record, build, nodes, equation)


@translates(Distance3D)
def rod(record: Distance3D, build: Build) -> None:
    """ObjectConnectorDistance; a user function for a length over time."""
    if isinstance(record.length, float | int):
        markers = [placed(marker, build, record.name) for marker in (record.a, record.b)]
        build.add("ObjectConnectorDistance", markerNumbers=markers, distance=record.length)
        return
    nodes, motion = _nodes(record, build), time_function(record.length, build.model)
    add_equation(record, build, nodes, distance(build, record.a, record.b, nodes), motion)


@translates(RevoluteSpherical3D)
def rod_on_a_hinge(record: RevoluteSpherical3D, build: Build) -> None:
    """A rod, and its end in the xy plane of a."""
    markers = [placed(marker, build, record.name) for marker in (record.a, record.b)]
    build.add("ObjectConnectorDistance", markerNumbers=markers, distance=record.length)
    nodes = _nodes(record, build)
    add_equation(record, build, nodes, slide(build, record.a, record.b, nodes))


@translates(ConstantVelocity3D)
def homokinetic(record: ConstantVelocity3D, build: Build) -> None:
    """ObjectJointSpherical, and no twist."""
    markers = [placed(marker, build, record.name) for marker in (record.a, record.b)]
    build.add("ObjectJointSpherical", markerNumbers=markers)
    nodes = _nodes(record, build)
    add_equation(record, build, nodes, twist(build, record.a, record.b, nodes))


@translates(AngleDriver3D)
def angle_driver(record: AngleDriver3D, build: Build) -> None:
    """The angle follows the motion, with the turns that it says."""
    nodes, motion = _nodes(record, build), time_function(record.angle, build.model)
    add_equation(record, build, nodes, angle_from(build, record.a, record.b, nodes, motion.value(0.0)), motion)


@translates(PositionDriver3D)
def position_driver(record: PositionDriver3D, build: Build) -> None:
    """The place along the axis follows the motion."""
    nodes, motion = _nodes(record, build), time_function(record.position, build.model)
    add_equation(record, build, nodes, slide(build, record.a, record.b, nodes), motion)


@translates(Gear3D)
def gear(record: Gear3D, build: Build) -> None:
    """Arcs of both pitch circles, each wheel seen from its frame."""
    nodes = _nodes(record, build)
    pairs = ((record.radius_a, record.frame_a, record.wheel_a), (record.radius_b, record.frame_b, record.wheel_b))
    _kept(record, build, nodes, weighted([(radius, angle(build, a, b, nodes)) for radius, a, b in pairs]))


@translates(RackAndPinion3D)
def rack(record: RackAndPinion3D, build: Build) -> None:
    """Way of the rack in its guide less the arc on the wheel."""
    nodes = _nodes(record, build)
    arc = angle(build, record.frame, record.wheel, nodes)
    _kept(
        record, build, nodes, weighted([(1.0, slide(build, record.guide, record.rack, nodes)), (-record.radius, arc)])
    )


@translates(Screw3D)
def screw(record: Screw3D, build: Build) -> None:
    """Way along the axis less `lead` a turn."""
    nodes = _nodes(record, build)
    a, b = record.a, record.b
    arc = angle(build, a, b, nodes)
    _kept(record, build, nodes, weighted([(1.0, slide(build, a, b, nodes)), (-record.lead / TURN, arc)]))
    derive_coordinates(record, build)
