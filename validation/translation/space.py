"""Bodies and joints in space: rigid bodies on Euler parameters, joints as exudyn's spherical or generic joint."""

from collections.abc import Callable, Sequence

import numpy as np

from ...core.assembly.numbering import ModelNumbering
from ...core.contacts.ball_on_round3d import SphereOnCylinder3D, SphereOnRing3D, SphereOnSmooth3D
from ...core.contacts.edges3d import EdgesOnEdges3D
from ...core.contacts.on_cable3d import CableOnHalfSpace3D, SphereOnCable3D
from ...core.contacts.on_mesh3d import SphereOnMesh3D
from ...core.contacts.round3d import CapsuleOnCapsule3D, SmoothOnHalfSpace3D, SphereInSphere3D
from ...core.elements import (
    Joint3D,
    PointMass3D,
    RigidBody3D,
    RollingDisk3D,
    RollingSphere3D,
    Screw3D,
    Spherical3D,
)
from ...core.elements.joint_coordinates3d import JointAngle, JointPosition
from ...core.model.angular_velocity import AngularVelocity
from ...core.model.base import in_space
from ...core.model.derived import Columns
from ...core.model.derived import Derived as Group
from ...core.model.frame3d import Frame3D
from ...core.model.markers import GROUND, Marker3D
from ..errors import NotTranslatable
from .bodies import node_columns
from .redundant import held_axes
from .registry import BodyItems, Build, Derived, frees, no_equal, translates

Work = Callable[[np.ndarray], np.ndarray]

no_equal("a sphere on a ground plane with large friction", RollingSphere3D)

frees(Joint3D, Spherical3D)
YZ = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Columns: our z, x, y axes as x, y, z. exudyn's universal joint holds y of a across z of b, ours x across y."""


no_equal(
    "closed forms (docs/space.md), or spheres on half-spaces at the places that touch: of rolling round shapes exudyn "
    "has no contact",
    SmoothOnHalfSpace3D,
    SphereInSphere3D,
    CapsuleOnCapsule3D,
    EdgesOnEdges3D,
    SphereOnMesh3D,
    SphereOnSmooth3D,
    SphereOnCylinder3D,
    SphereOnRing3D,
)
no_equal("none: of cables in space exudyn has no contact with friction", SphereOnCable3D, CableOnHalfSpace3D)


@translates(RigidBody3D, PointMass3D)
def spatial_body(record: RigidBody3D | PointMass3D, build: Build) -> None:
    """NodeRigidBodyEP with ObjectRigidBody, or NodePoint with ObjectMassPoint; reference = start."""
    q0, v0 = record.initial_state()
    rigid = isinstance(record, RigidBody3D)
    node = build.add(
        "NodeRigidBodyEP" if rigid else "NodePoint",
        referenceCoordinates=list(q0),
        initialCoordinates=[0.0] * len(q0),
        initialVelocities=list(v0),
    )
    if isinstance(record, RigidBody3D):
        xy, xz, yz = record.inertia_products
        inertia = [*record.inertia, yz, xz, xy]
        item = build.add("ObjectRigidBody", nodeNumber=node, mass=record.mass, inertia=inertia)
    else:
        item = build.add("ObjectMassPoint", nodeNumber=node, mass=record.mass)
    build.bodies[record.name] = BodyItems(node, item, rigid, reference=tuple(q0))
    if any(build.model.gravity):
        marker = build.add("MarkerBodyMass", bodyNumber=item)
        build.add("LoadMassProportional", markerNumber=marker, loadVector=[*in_space(build.model.gravity)])
    node_columns(record, build, (node,), q0)
    if rigid:
        _derive(build, AngularVelocity(record.name, range(3, 7)), (record.name,))


def _derive(build: Build, group: Group, bodies: Sequence[str], work: Work | None = None) -> None:
    """Channels that follow from the coordinates of some bodies, in this order, as we make them of our own."""
    names = {body.name: body.coordinate_records() for body in build.model.bodies}
    records = [(body, record) for body in bodies for record in names[body]]

    def columns(found: dict[str, np.ndarray]) -> Columns:
        q, v, a = (
            np.stack([found[f"{body}.{name(record)}"] for body, record in records], axis=1)
            for name in (lambda r: r.name, lambda r: r.rate, lambda r: r.acceleration)
        )
        return Columns(q, v, a, np.zeros((len(q), 0)), lambda _: np.zeros(len(q)) if work is None else work(q))

    def one(k: int) -> Callable[[dict[str, np.ndarray]], np.ndarray]:
        return lambda found: group(columns(found))[:, k]

    build.derived += [Derived(channel.name, one(k)) for k, channel in enumerate(group.channels)]


def derive_coordinates(record: Joint3D | Screw3D, build: Build) -> None:
    """The joint's coordinates, turns counted along the samples from the start."""
    numbering = ModelNumbering(build.model)
    for coordinate in record.coordinates():
        bodies = [marker.body for marker in (coordinate.a, coordinate.b) if marker.body != GROUND]
        first, frames = 0, []
        for marker in (coordinate.a, coordinate.b):
            size = 0 if marker.body == GROUND else len(build.bodies[marker.body].reference)
            frames.append(Frame3D.of(marker, [first + k if k < size else -1 for k in range(7)]))
            first += size
        a, b = frames
        if coordinate.kind == "place":
            _derive(build, JointPosition(record.name, coordinate, a, b), bodies)
            continue
        start = numbering.start_angle(coordinate.a, coordinate.b)
        group = JointAngle(record.name, coordinate, a, b, start, coordinate.account)
        _derive(build, group, bodies, _turned(group))


def _turned(group: JointAngle) -> Work:
    """How far an angle has gone since the start, of which the first sample is within half a turn."""

    def turned(q: np.ndarray) -> np.ndarray:
        still, nothing = np.zeros_like(q), np.zeros((len(q), 0))
        angle = np.unwrap(group(Columns(q, still, still, nothing, lambda _: np.zeros(len(q))))[:, 0])
        return angle - angle[0]

    return turned


def placed(marker: Marker3D, build: Build, user: str, axes: np.ndarray | None = None) -> int:
    """A marker with its point and axes. Raises NotTranslatable if a point mass is asked for axes."""
    body = build.ground if marker.body == GROUND else build.bodies[marker.body].item
    if marker.body != GROUND and not build.bodies[marker.body].rigid:
        if axes is not None:
            raise NotTranslatable(f"'{user}' needs the axes of '{marker.body}', a point mass: make it a RigidBody3D")
        return int(
            build.add("MarkerBodyPosition", bodyNumber=body, localPosition=[*build.bodies[marker.body].local, 0.0])
        )
    transformation = np.eye(4)
    transformation[:3, 3] = marker.point
    if axes is not None:
        transformation[:3, :3] = axes
    return int(build.add("MarkerBodyRigid", bodyNumber=body, localHT=transformation))


@translates(Spherical3D)
def spherical(record: Spherical3D, build: Build) -> None:
    """ObjectJointSpherical, along the axes of space as ours."""
    markers = [placed(marker, build, record.name) for marker in (record.a, record.b)]
    held = [int(k not in build.redundant.get(record.name, ())) for k in range(3)]
    build.add("ObjectJointSpherical", markerNumbers=markers, constrainedAxes=held)


@translates(Joint3D, heirs=True)
def generic(record: Joint3D, build: Build) -> None:
    """ObjectJointGeneric, a user's own joints of such primitives too; its multipliers of rotations are no torques, so
    that only the motion is compared."""
    left_out = build.redundant.get(record.name, frozenset())
    constrained, order = held_axes(record, left_out, build.model)
    if left_out:
        build.notes.append(f"{record.name}: exudyn's holds {sum(constrained)} axes, without the redundant equations")
    markers = [placed(marker, build, record.name, marker.axes() @ order) for marker in (record.a, record.b)]
    build.add("ObjectJointGeneric", markerNumbers=markers, constrainedAxes=constrained)
    derive_coordinates(record, build)


@translates(RollingDisk3D)
def rolling_disk(record: RollingDisk3D, build: Build) -> None:
    """ObjectJointRollingDisc, which holds the disk's velocity on the ground. Raises NotTranslatable for a plane that
    moves and for a rounded rim."""
    if record.a.body != GROUND or record.rim_radius:
        raise NotTranslatable(
            f"'{record.name}' rolls on a body or on a rounded rim: exudyn's disk is sharp, on the ground"
        )
    # its axle is the x axis: others are not well tested, its manual says
    axes = (record.a.axes(), record.b.axes() @ YZ)
    markers = [placed(m, build, record.name, of) for m, of in zip((record.a, record.b), axes, strict=True)]
    build.add("ObjectJointRollingDisc", markerNumbers=markers, discRadius=record.radius)
