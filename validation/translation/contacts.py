"""Contacts: disk on half-plane as a sphere on a large triangle, disk on disk as sphere on sphere.

The sphere's centre and force line are the disk's. exudyn's LinearSpringDamper with a user function would be
simpler, but applies its reaction at its first marker instead of on the line of the force, so that a
half-plane on a moving body gains angular momentum out of nothing (tried); the sphere on a triangle does not.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ...core.contacts.contact2d import Disk2D, DiskOnDisk2D, DiskOnHalfPlane2D, HalfPlane2D
from ...core.contacts.coordinate_contact import CoordinateContact
from ...core.contacts.disk_on_cable import DiskOnCable2D
from ...core.contacts.disk_on_line import DiskOnLine2D
from ...core.contacts.segment2d import DiskOnSegment2D
from ...core.elements import PlanarBody
from ...core.laws import KelvinVoigt
from ...core.model.markers import GROUND, Marker2D
from .contact_laws import contact_parameters, is_native
from .coordinate_contacts import add_coordinate_contact
from .kinematics import BodyStates, States, gap_motion
from .registry import Build, ContactColumns, no_equal, translates
from .user_contacts import add_user_contact

Shapes = tuple[HalfPlane2D, Disk2D] | tuple[Disk2D, Disk2D]
BeforeStep = Callable[[Any, float], None]


no_equal(
    "disks at the places that touch (DiskOnDisk2D, DiskOnHalfPlane2D on MaterialPoint2D); exudyn's circle-cable "
    "contact has one stiffness for each of its segments, and so another force law",
    DiskOnCable2D,
    DiskOnLine2D,
)
no_equal("a DiskOnHalfPlane2D, as long as the disk touches the segment and not its ends", DiskOnSegment2D)


@translates(CoordinateContact)
def coordinate_contact(record: CoordinateContact, build: Build) -> None:
    """ObjectContactCoordinate where the gap is a difference of two coordinates, else a user function."""
    contact_parameters(record.law, record.name)
    if not add_coordinate_contact(record, build):
        add_user_contact(record, build)


@translates(DiskOnHalfPlane2D)
def disk_on_half_plane(record: DiskOnHalfPlane2D, build: Build) -> None:
    """ObjectContactSphereTriangle; a user function for laws that exudyn lacks, and for friction.

    exudyn needs a sphere with a radius, and one deeper than its diameter passes through: so the sphere gets
    a large radius, and the triangle is drawn back as much, which leaves gap and force line unchanged.
    """
    if not _is_native(record, build):
        return add_user_contact(record, build)
    plane, disk = record.plane, record.disk
    size = _size(build)
    angle = plane.marker.angle
    axis, normal = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
    back = Marker2D(
        body=plane.marker.body,
        point=(plane.marker.point[0] - size * normal[0], plane.marker.point[1] - size * normal[1]),
    )
    reach = 1e3 * size
    ax, ay = reach * axis[0], reach * axis[1]
    corners = [[-ax, -ay, reach], [ax, ay, reach], [0.0, 0.0, -2.0 * reach]]
    _add(
        build,
        record,
        (plane, disk),
        1.0,
        "ObjectContactSphereTriangle",
        markerNumbers=[build.point(disk.marker), build.frame(back, record.name)],
        sphereRadius=disk.radius + size,
        trianglePoints=build.exudyn.core.Vector3DList(corners),
        includeEdges=0,
    )


@translates(DiskOnDisk2D)
def disk_on_disk(record: DiskOnDisk2D, build: Build) -> None:
    """ObjectContactSphereSphere; a user function for laws that exudyn lacks, and for friction."""
    if not _is_native(record, build):
        return add_user_contact(record, build)
    _add(
        build,
        record,
        (record.a, record.b),
        -1.0,
        "ObjectContactSphereSphere",
        markerNumbers=[build.point(record.a.marker), build.point(record.b.marker)],
        spheresRadii=[record.a.radius, record.b.radius],
    )


def _add(
    build: Build,
    record: DiskOnHalfPlane2D | DiskOnDisk2D,
    shapes: Shapes,
    sign: float,
    item_name: str,
    **fields: Any,
) -> None:
    """The contact object with its law and memory; `sign` is +1 if its Force acts on the second shape's body."""
    law = contact_parameters(record.law, record.name)
    gap, rate = _at_start(build, shapes)
    # the gap at the start: exudyn's active set begins with it
    memory = build.add("NodeGenericData", numberOfDataCoordinates=4, initialCoordinates=[gap, 0.0, 0.0, 0.0])
    releasing = record.law if isinstance(record.law, KelvinVoigt) and record.law.release == "force" else None
    acts = releasing is None or _pushes(releasing, gap, rate)
    item = build.add(item_name, nodeNumber=memory, activeConnector=acts, **fields, **law)
    if build.sensors:
        build.contacts.append(ContactColumns(record.name, shapes, build.sensor(item, "Force"), sign))
    if releasing is not None:
        build.before_step.append(_release(build, item, memory, releasing, shapes, acts))
        build.notes.append(f"{record.name}: switched off at the start of the step where its force would be tensile")


def _is_native(record: DiskOnHalfPlane2D | DiskOnDisk2D, build: Build) -> bool:
    native = is_native(record, _on_flexible(record, build))
    return native and record.name not in build.laid and record.name not in build.clamped


def _on_flexible(record: DiskOnHalfPlane2D | DiskOnDisk2D, build: Build) -> bool:
    items = [build.bodies[m.body] for m in record.markers() if m.body != GROUND]
    return any(body.elements or body.mesh_points for body in items)


def _pushes(law: KelvinVoigt, gap: float, rate: float) -> bool:
    """Whether the contact is to be on: its gap is open, or its force is not tensile."""
    return gap > 0.0 or law.stiffness * gap + law.damping * rate <= 0.0


def _release(build: Build, item: Any, memory: Any, law: KelvinVoigt, shapes: Shapes, acts: bool) -> BeforeStep:
    """Switch the contact off when the force has come to zero, and on again when the gap has opened."""
    names = {marker.body for marker in (shapes[0].marker, shapes[1].marker)} - {GROUND}
    nodes = {name: (build.bodies[name].node, np.asarray(build.bodies[name].reference)) for name in names}
    core, active = build.exudyn.core, [acts]

    def before_step(mbs: Any, t: float) -> None:
        # while the contact is on, exudyn keeps its gap in the data node: nearly all steps are done with here
        if active[0] and mbs.GetNodeOutput(memory, core.OutputVariableType.Coordinates)[0] > 0.0:
            return
        bodies = {}
        for name, (node, start) in nodes.items():
            q = mbs.GetNodeOutput(node, core.OutputVariableType.Coordinates) + start
            v = mbs.GetNodeOutput(node, core.OutputVariableType.Coordinates_t)
            q, v = (*q, 0.0)[:3], (*v, 0.0)[:3]
            bodies[name] = BodyStates(*(np.atleast_1d(x) for x in (*q, *v)))
        motion = gap_motion(shapes, States(1, bodies))
        gap, rate = float(motion.gap[0]), float(motion.rate[0])
        wanted = _pushes(law, gap, rate)
        if wanted != active[0] and (gap > 0.0 or active[0]):
            active[0] = wanted
            mbs.SetObjectParameter(item, "activeConnector", wanted)

    return before_step


def _at_start(build: Build, shapes: Shapes) -> tuple[float, float]:
    """Gap (m) and its rate at the start."""
    names = {shape.marker.body for shape in shapes}
    bodies = {
        name: BodyStates(*(np.atleast_1d(x) for level in build.start(name) for x in level)) for name in names - {GROUND}
    }
    motion = gap_motion(shapes, States(1, bodies))
    return float(motion.gap[0]), float(motion.rate[0])


def _size(build: Build) -> float:
    """A length of the model's order of magnitude or above, m."""
    lengths = [1.0]
    for element in build.model.elements():
        lengths += [abs(x) for marker in element.markers() for x in marker.point]
    for body in build.model.bodies:
        if isinstance(body, PlanarBody):
            lengths += [abs(x) for x in body.position]
    return max(lengths)
