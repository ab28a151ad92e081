"""Contacts: shapes and gaps, laws, friction, and what happens when they meet. A new one is a file and its name here."""

from typing import Annotated

from ..model.open_union import OpenUnion
from .angle_stop2d import AngleStop2D
from .box2d import DiskOnBox2D
from .contact2d import DiskOnDisk2D, DiskOnHalfPlane2D
from .contact3d import SphereOnHalfSpace3D, SphereOnSphere3D
from .coordinate_contact import CoordinateContact
from .disk_on_cable import DiskOnCable2D
from .disk_on_line import DiskOnLine2D
from .element import ContactElement
from .on_cable3d import CableOnHalfSpace3D, SphereOnCable3D
from .on_mesh3d import SphereOnMesh3D
from .polygon2d import DiskOnPolygon2D
from .ring2d import DiskInRing2D
from .rope2d import Rope2D
from .round3d import CapsuleOnCapsule3D, SmoothOnHalfSpace3D, SphereInSphere3D
from .segment2d import DiskOnSegment2D
from .stop3d import AngleStop3D, Rope3D, SlideStop3D

CONTACTS = (
    DiskOnHalfPlane2D,
    DiskOnDisk2D,
    DiskOnBox2D,
    DiskOnSegment2D,
    DiskOnLine2D,
    DiskOnCable2D,
    DiskInRing2D,
    DiskOnPolygon2D,
    Rope2D,
    AngleStop2D,
    CoordinateContact,
    SphereOnHalfSpace3D,
    SphereOnSphere3D,
    SmoothOnHalfSpace3D,
    SphereInSphere3D,
    CapsuleOnCapsule3D,
    SphereOnCable3D,
    CableOnHalfSpace3D,
    SphereOnMesh3D,
    AngleStop3D,
    SlideStop3D,
    Rope3D,
)

Contact = Annotated[ContactElement, OpenUnion(CONTACTS, ContactElement)]
"""Contacts: two shapes, a law along the normal, and friction; a user's own subclasses of Contact2D too."""
