"""Contacts: shapes and gaps, laws, friction, and what happens when they meet. A new one is a file and its name here."""

from typing import Annotated

from pydantic import Field

from .contact2d import DiskOnDisk2D, DiskOnHalfPlane2D
from .coordinate_contact import CoordinateContact
from .disk_on_cable import DiskOnCable2D
from .disk_on_line import DiskOnLine2D
from .segment2d import DiskOnSegment2D

CONTACTS = (DiskOnHalfPlane2D, DiskOnDisk2D, DiskOnSegment2D, DiskOnLine2D, DiskOnCable2D, CoordinateContact)

Contact = Annotated[
    DiskOnHalfPlane2D | DiskOnDisk2D | DiskOnSegment2D | DiskOnLine2D | DiskOnCable2D | CoordinateContact,
    Field(discriminator="type"),
]
