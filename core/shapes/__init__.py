"""Contacts: shapes and gaps, laws, friction, and what happens when they meet. A new one is a file and its name here."""

from typing import Annotated

from ..model.open_union import OpenUnion
from .angle_stop2d import AngleStop2D
from .box2d import DiskOnBox2D
from .contact2d import Contact2D, DiskOnDisk2D, DiskOnHalfPlane2D
from .coordinate_contact import CoordinateContact
from .disk_on_cable import DiskOnCable2D
from .disk_on_line import DiskOnLine2D
from .rope2d import Rope2D
from .segment2d import DiskOnSegment2D

CONTACTS = (
    DiskOnHalfPlane2D,
    DiskOnDisk2D,
    DiskOnBox2D,
    DiskOnSegment2D,
    DiskOnLine2D,
    DiskOnCable2D,
    Rope2D,
    AngleStop2D,
    CoordinateContact,
)

Contact = Annotated[Contact2D, OpenUnion(CONTACTS, Contact2D)]
"""Planar contacts: two shapes, a law along the normal, and friction; a user's own subclasses of Contact2D too."""
