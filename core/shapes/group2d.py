"""Contacts between groups of shapes, instead of pairs listed by hand.

Which pairs can touch follows from the shapes: a disk with a half-plane, a disk, a box, a polygon, a segment or a ring
around it; a box or polygon with a half-plane and with others by the corners; in space a sphere or a capsule with a
half-space, a sphere and a capsule, what has corners or is smooth with a half-space, a cable with a sphere or a
half-space, a mesh with a sphere. Pairs on one body are left out.
Pairs that are far from touching cost nothing during a run: contacts sleep until their margin is used up
(`location/asleep.py`).
"""

from collections.abc import Iterable, Sequence
from itertools import combinations, product
from typing import Literal

from ..errors import ModelError
from ..laws import ContactLaw
from ..laws.friction import Friction, TurningFriction
from ..model.markers import GROUND
from ..model.words import an
from .box2d import Box2D, DiskOnBox2D
from .contact2d import Contact2D, Disk2D, DiskOnDisk2D, DiskOnHalfPlane2D, HalfPlane2D
from .contact3d import Contact3D, HalfSpace3D, Sphere3D, SphereOnHalfSpace3D, SphereOnSphere3D
from .cornered3d import Capsule3D, Cornered3D, Cylinder3D
from .groups import ContactGroup
from .mesh3d import TriangleMesh3D
from .on_cable3d import CableLine3D, CableOnHalfSpace3D, CableSpot, SphereOnCable3D
from .on_mesh3d import MeshPart, SphereOnMesh3D, mesh_parts
from .polygon2d import DiskOnPolygon2D, Polygon2D
from .ring2d import DiskInRing2D, Ring2D
from .round3d import CapsuleOnCapsule3D, SmoothOnHalfSpace3D
from .segment2d import DiskOnSegment2D, Segment2D
from .support3d import SmoothShape3D

PlanarShape = Disk2D | HalfPlane2D | Box2D | Polygon2D | Segment2D | Ring2D
ANGULAR = (Box2D, Polygon2D)
"""What has corners in the plane."""
SpatialShape = Sphere3D | HalfSpace3D | Cornered3D | SmoothShape3D | CableLine3D
GroupShape = PlanarShape | SpatialShape

MOST_PAIRS = 200_000


def contacts_between(
    name: str,
    shapes: Iterable[GroupShape],
    others: Iterable[GroupShape] | None = None,
    *,
    law: ContactLaw,
    friction: Friction | None = None,
    turning: TurningFriction | None = None,
    except_bodies: Iterable[tuple[str, str]] = (),
) -> tuple[Contact2D | Contact3D, ...]:
    """Contacts of all pairs of `shapes` with each other, or of `shapes` with `others`, for a model's `contacts`.

    Parameters
    ----------
    name : the contacts are called name_body1_body2, with a number behind where two bodies have several.
    law, friction : of all of them.
    turning : friction against rolling and spinning, of those in space.
    except_bodies : pairs of bodies that do not touch, such as those that a joint holds together.

    Raises
    ------
    ModelError : for more than MOST_PAIRS pairs, and shapes of which no pair can touch.
    """
    first = tuple(shapes)
    second = None if others is None else tuple(others)
    count = len(first) * (len(first) - 1) // 2 if second is None else len(first) * len(second)
    if count > MOST_PAIRS:
        raise ModelError(f"group '{name}' has {count} pairs of shapes, more than {MOST_PAIRS}: make smaller groups")
    pairs = combinations(first, 2) if second is None else product(first, second)
    apart = {frozenset(pair) for pair in except_bodies}
    named: dict[str, list[tuple[GroupShape, GroupShape | CableSpot | MeshPart]]] = {}
    for a, b in pairs:
        bodies = _body(a), _body(b)
        if bodies[0] == bodies[1] or frozenset(bodies) in apart:
            continue
        found = [*_touching(a, b)]
        named.setdefault(f"{name}_{bodies[0]}_{bodies[1]}", []).extend(found)
    made = []
    for label, touching in named.items():
        for k, (one, other) in enumerate(touching):
            own = label if len(touching) == 1 else f"{label}_{k + 1}"
            made.append(_contact(own, one, other, law, friction, turning))
    if not made:
        raise ModelError(
            f"group '{name}' has no two shapes that can touch: disks touch all shapes, boxes touch boxes and "
            "half-planes, and shapes of one body never touch each other"
        )
    return tuple(made)


class ContactGroup2D(ContactGroup):
    """Shapes of which each may touch each other: one record for all their contacts.

    A model makes the contacts of all pairs that can touch, as `contacts_between` does, and calls them
    name_body1_body2. They sleep while they are far apart. Law and friction are changed here, for all of them.
    """

    type: Literal["ContactGroup2D"] = "ContactGroup2D"
    disks: tuple[Disk2D, ...] = ()
    """They touch all shapes."""
    boxes: tuple[Box2D, ...] = ()
    """They touch boxes, polygons and half-planes by their corners, and disks."""
    polygons: tuple[Polygon2D, ...] = ()
    """They touch what boxes touch."""
    segments: tuple[Segment2D, ...] = ()
    """They touch disks."""
    half_planes: tuple[HalfPlane2D, ...] = ()
    """They touch disks, boxes and polygons."""
    rings: tuple[Ring2D, ...] = ()
    """They hold disks in them, every one of the group."""
    law: ContactLaw
    """What happens when a gap closes."""
    friction: Friction | None = None
    """What resists sliding; left out: nothing."""
    except_bodies: tuple[tuple[str, str], ...] = ()
    """Pairs of bodies that do not touch, such as those that a joint holds together."""

    def contacts(self) -> tuple[Contact2D | Contact3D, ...]:
        """Its contacts. Raises ModelError as `contacts_between` does."""
        shapes: tuple[GroupShape, ...] = (
            *self.disks, *self.boxes, *self.polygons, *self.segments, *self.half_planes, *self.rings,
        )  # fmt: skip
        return contacts_between(
            self.name, shapes, law=self.law, friction=self.friction, except_bodies=self.except_bodies
        )


def _body(shape: GroupShape) -> str:
    return shape.cable if isinstance(shape, CableLine3D) else str(shape.marker.body)


def _touching(a: GroupShape, b: GroupShape) -> Sequence[tuple[GroupShape, GroupShape | CableSpot | MeshPart]]:
    """Pairs (what, disk or sphere, or place on a cable) that say the contact of two shapes."""
    if isinstance(a, SpatialShape) or isinstance(b, SpatialShape):
        return _touching_in_space(a, b)
    if isinstance(b, Disk2D):
        return ((a, b),)
    if isinstance(a, Disk2D):
        return ((b, a),)
    if isinstance(a, ANGULAR) and isinstance(b, ANGULAR):
        return (*((a, corner) for corner in b.corners()), *((b, corner) for corner in a.corners()))
    if isinstance(a, ANGULAR):
        a, b = b, a
    if isinstance(b, ANGULAR):
        if isinstance(a, HalfPlane2D):
            return tuple((a, corner) for corner in b.corners())
        remedy = "make the segment a thin box" if isinstance(a, Segment2D) else "put disks at its corners"
        raise ModelError(f"{_named(b)} and {_named(a)} have no contact: {remedy}")
    if _body(a) == _body(b) == GROUND:
        return ()
    raise ModelError(f"{_named(a)} and {_named(b)} have no contact: give one of them disks at its corners")


def _named(shape: GroupShape) -> str:
    return f"{an(type(shape).__name__)} on '{_body(shape)}'"


def _touching_in_space(a: GroupShape, b: GroupShape) -> Sequence[tuple[GroupShape, GroupShape | CableSpot | MeshPart]]:
    if isinstance(a, Sphere3D) and isinstance(b, Sphere3D):
        # two points never touch
        return ((a, b),) if a.radius + b.radius > 0.0 else ()
    if isinstance(b, HalfSpace3D):
        a, b = b, a
    if isinstance(a, HalfSpace3D) and isinstance(b, Sphere3D | SmoothShape3D):
        return ((a, b),)
    if isinstance(a, HalfSpace3D) and isinstance(b, Cylinder3D) and b.rim_points == 0:
        return tuple((a, rim) for rim in b.rims())
    if isinstance(a, HalfSpace3D) and isinstance(b, Cornered3D):
        return tuple((a, corner) for corner in b.corners())
    if isinstance(b, CableLine3D | TriangleMesh3D):
        a, b = b, a
    if isinstance(a, TriangleMesh3D) and isinstance(b, Sphere3D):
        return tuple((b, MeshPart(a, k)) for k in range(len(mesh_parts(a))))
    if isinstance(a, CableLine3D) and isinstance(b, Sphere3D):
        return ((a, b),)
    if isinstance(a, CableLine3D) and isinstance(b, HalfSpace3D):
        return tuple((b, CableSpot(a, place)) for place in a.places)
    if isinstance(b, Capsule3D):
        a, b = b, a
    if isinstance(a, Capsule3D) and isinstance(b, Capsule3D | Sphere3D):
        return ((a, b),)
    if _body(a) == _body(b) == GROUND:
        return ()
    raise ModelError(
        f"{_named(a)} and {_named(b)} have no contact: in space a "
        "sphere or capsule touches spheres, capsules and half-spaces, all others touch half-spaces, cables and meshes "
        "spheres too; give it spheres or capsules in their place"
    )


def _contact(
    name: str, a: GroupShape, disk: GroupShape | CableSpot | MeshPart, law: ContactLaw, friction: Friction | None,
    turning: TurningFriction | None,
) -> Contact2D | Contact3D:  # fmt: skip
    if isinstance(disk, MeshPart):
        assert isinstance(a, Sphere3D)
        return SphereOnMesh3D(
            name=name, mesh=disk.mesh, part=disk.part, sphere=a, law=law, friction=friction, turning=turning
        )
    if isinstance(disk, CableSpot):
        assert isinstance(a, HalfSpace3D)
        on = disk.line
        return CableOnHalfSpace3D(
            name=name, plane=a, cable=on.cable, thickness=on.thickness, place=disk.place, law=law, friction=friction,
            turning=turning,
        )  # fmt: skip
    if isinstance(a, CableLine3D) and isinstance(disk, Sphere3D):
        return SphereOnCable3D(
            name=name, cable=a.cable, thickness=a.thickness, sphere=disk, law=law, friction=friction, turning=turning
        )
    if isinstance(a, Capsule3D) and isinstance(disk, Capsule3D | Sphere3D):
        return CapsuleOnCapsule3D(name=name, a=a, b=disk, law=law, friction=friction, turning=turning)
    if isinstance(a, HalfSpace3D) and isinstance(disk, SmoothShape3D):
        return SmoothOnHalfSpace3D(name=name, plane=a, shape=disk, law=law, friction=friction, turning=turning)
    if isinstance(disk, Sphere3D):
        if isinstance(a, HalfSpace3D):
            return SphereOnHalfSpace3D(name=name, plane=a, sphere=disk, law=law, friction=friction, turning=turning)
        if isinstance(a, Sphere3D):
            return SphereOnSphere3D(name=name, a=a, b=disk, law=law, friction=friction, turning=turning)
    if not isinstance(disk, Disk2D):
        raise TypeError("the second shape of a pair is a disk")
    if isinstance(a, HalfPlane2D):
        return DiskOnHalfPlane2D(name=name, plane=a, disk=disk, law=law, friction=friction)
    if isinstance(a, Disk2D):
        return DiskOnDisk2D(name=name, a=a, b=disk, law=law, friction=friction)
    if isinstance(a, Box2D):
        return DiskOnBox2D(name=name, shape=a, disk=disk, law=law, friction=friction)
    if isinstance(a, Polygon2D):
        return DiskOnPolygon2D(name=name, shape=a, disk=disk, law=law, friction=friction)
    if isinstance(a, Ring2D):
        return DiskInRing2D(name=name, shape=a, disk=disk, law=law, friction=friction)
    if isinstance(a, Segment2D):
        return DiskOnSegment2D(name=name, segment=a, disk=disk, law=law, friction=friction)
    raise TypeError("a disk touches no shapes of space")
