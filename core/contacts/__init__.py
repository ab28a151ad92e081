"""Contacts: shapes and gaps, laws, friction, and what happens when they meet. A new one is a file and its name here."""

from typing import Annotated

from ..lazy_import import LateClasses, late_names
from ..model.open_union import OpenUnion
from .element import ContactElement

CONTACTS = LateClasses(
    __name__,
    "DiskOnHalfPlane2D DiskOnDisk2D DiskOnBox2D DiskOnSegment2D DiskOnLine2D DiskOnCable2D DiskInRing2D "
    "DiskOnPolygon2D Rope2D AngleStop2D CoordinateContact SphereOnHalfSpace3D SphereOnSphere3D "
    "SmoothOnHalfSpace3D SphereInSphere3D CapsuleOnCapsule3D SphereOnCable3D "
    "CableOnHalfSpace3D SphereOnMesh3D SphereOnSmooth3D SphereOnCylinder3D SphereOnRing3D "
    "EdgesOnEdges3D AngleStop3D SlideStop3D Rope3D DistanceStop3D",
)

Contact = Annotated[ContactElement, OpenUnion(CONTACTS, ContactElement)]
"""Contacts: two shapes, a law along the normal, and friction; a user's own subclasses of Contact2D too."""

__getattr__, __dir__ = late_names(
    __name__,
    {
        ".angle_stop2d": "AngleStop2D",
        ".ball_on_round3d": "SphereOnCylinder3D SphereOnRing3D SphereOnSmooth3D",
        ".disk_on_box2d": "DiskOnBox2D",
        ".contact2d": "DiskOnDisk2D DiskOnHalfPlane2D",
        ".contact3d": "SphereOnHalfSpace3D SphereOnSphere3D",
        ".coordinate_contact": "CoordinateContact",
        ".disk_on_cable": "DiskOnCable2D",
        ".disk_on_line": "DiskOnLine2D",
        ".edges3d": "EdgesOnEdges3D",
        ".group2d": "ContactGroup2D",
        ".group3d": "ContactGroup3D",
        ".on_cable3d": "CableOnHalfSpace3D SphereOnCable3D",
        ".on_mesh3d": "SphereOnMesh3D",
        ".polygon2d": "DiskOnPolygon2D",
        ".ring2d": "DiskInRing2D",
        ".rope2d": "Rope2D",
        ".round3d": "CapsuleOnCapsule3D SmoothOnHalfSpace3D SphereInSphere3D",
        ".segment2d": "DiskOnSegment2D",
        ".stop3d": "AngleStop3D DistanceStop3D Rope3D SlideStop3D",
    },
)
