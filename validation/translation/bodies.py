"""Bodies and their weight, and linear systems."""

from collections.abc import Sequence
from typing import Any

from ...core.elements import BodyElement, LinearSystem, MovingFrame2D, PointMass2D, RigidBody2D
from ...core.model.base import in_space
from .registry import BodyItems, Build, Column, translates
from .signals import TimeFunction, time_function


@translates(RigidBody2D, PointMass2D)
def body(record: RigidBody2D | PointMass2D, build: Build) -> None:
    """NodeRigidBody2D with ObjectRigidBody2D, or NodePoint2D with ObjectMassPoint2D; reference = start."""
    q0, v0 = record.initial_state()
    rigid = isinstance(record, RigidBody2D)
    zero = [0.0] * len(q0)
    node = build.add(
        "NodeRigidBody2D" if rigid else "NodePoint2D",
        referenceCoordinates=list(q0),
        initialCoordinates=zero,
        initialVelocities=list(v0),
    )
    if isinstance(record, RigidBody2D):
        item = build.add("ObjectRigidBody2D", nodeNumber=node, mass=record.mass, inertia=record.inertia)
    else:
        item = build.add("ObjectMassPoint2D", nodeNumber=node, mass=record.mass)
    build.bodies[record.name] = BodyItems(node, item, rigid, reference=tuple(q0))
    if any(build.model.gravity):
        marker = build.add("MarkerBodyMass", bodyNumber=item)
        build.add("LoadMassProportional", markerNumber=marker, loadVector=[*in_space(build.model.gravity)])
    node_columns(record, build, (node,), q0)


@translates(MovingFrame2D)
def moving_frame(record: MovingFrame2D, build: Build) -> None:
    """NodeRigidBody2D of unit mass without weight, all three coordinates held to the motion by constraints."""
    q0, v0 = build.start(record.name)
    node = build.add(
        "NodeRigidBody2D", referenceCoordinates=list(q0), initialCoordinates=[0.0] * 3, initialVelocities=list(v0)
    )
    item = build.add("ObjectRigidBody2D", nodeNumber=node, mass=1.0, inertia=1.0)
    build.bodies[record.name] = BodyItems(node, item, True, reference=q0)
    for name, signal, start in zip(record.coordinate_names, record.motions(), q0, strict=True):
        driven, _ = build.coordinate(record.name, name, record.name)
        add_motion(build, driven, time_function(signal, build.model), start)
    node_columns(record, build, (node,), q0)


def add_motion(build: Build, driven: Any, motion: TimeFunction, reference: float) -> Any:
    """ObjectConnectorCoordinate between the ground and a coordinate, with the motion as offset; returns its index."""
    functions: dict[str, Any] = {}
    if motion.constant is None:
        functions = {
            "offsetUserFunction": lambda mbs, t, item, offset: motion.value(t) - reference,
            "offsetUserFunction_t": lambda mbs, t, item, offset: motion.rate(t),
        }
    return build.add(
        "ObjectConnectorCoordinate", markerNumbers=[build.ground_coordinate(), driven],
        offset=motion.value(0.0) - reference, **functions,
    )  # fmt: skip


@translates(LinearSystem)
def linear_system(record: LinearSystem, build: Build) -> None:
    """NodeGenericODE2 with ObjectGenericODE2; reference = zero, so that the stiffness acts on the coordinates."""
    n = len(record.coordinates)
    zero = [0.0] * n
    q0, v0 = record.initial_state()
    node = build.add(
        "NodeGenericODE2", numberOfODE2Coordinates=n, referenceCoordinates=zero, initialCoordinates=list(q0),
        initialCoordinates_t=list(v0),
    )  # fmt: skip
    matrices = {
        f"{name}Matrix": [list(row) for row in value]
        for name in ("mass", "stiffness", "damping")
        if (value := getattr(record, name)) is not None
    }
    item = build.add("ObjectGenericODE2", nodeNumbers=[node], forceVector=list(record.force or zero), **matrices)
    build.bodies[record.name] = BodyItems(node, item, False, reference=tuple(zero))
    node_columns(record, build, (node,), zero)


def node_columns(record: BodyElement, build: Build, nodes: Sequence[int], reference: Sequence[float]) -> None:
    """Channels of the coordinates, the same number from each node; exudyn's are displacements from the reference."""
    if not build.sensors:
        return
    records = record.coordinate_records()
    each = len(records) // len(nodes)
    outputs = ("Coordinates", "Coordinates_t", "Coordinates_tt")
    sensors = [[build.sensor(node, output, of_node=True) for output in outputs] for node in nodes]
    for k, coordinate in enumerate(records):
        for level, name in enumerate((coordinate.name, coordinate.rate, coordinate.acceleration)):
            offset = reference[k] if level == 0 else 0.0
            build.columns.append(Column(f"{record.name}.{name}", sensors[k // each][level], k % each, 1.0, offset))
