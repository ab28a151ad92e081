"""Bodies and their weight."""

from ...core.elements import PointMass2D, RigidBody2D
from .registry import BodyItems, Build, Column, translates

RIGID_NAMES = (("x", "y", "angle"), ("vx", "vy", "angular_velocity"), ("ax", "ay", "angular_acceleration"))


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
    build.bodies[record.name] = BodyItems(node, item, rigid)
    if any(build.model.gravity):
        marker = build.add("MarkerBodyMass", bodyNumber=item)
        build.add("LoadMassProportional", markerNumber=marker, loadVector=[*build.model.gravity, 0.0])
    if build.sensors:
        for level, output in enumerate(("Coordinates", "Coordinates_t", "Coordinates_tt")):
            sensor = build.sensor(node, output, of_node=True)
            for k in range(len(q0)):
                # exudyn's coordinates are displacements from the reference
                offset = q0[k] if level == 0 else 0.0
                name = f"{record.name}.{RIGID_NAMES[level][k]}"
                build.columns.append(Column(name, sensor, k, 1.0, offset))
