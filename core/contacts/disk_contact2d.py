"""Contacts of a disk whose gap is a formula of the disk's centre."""

from ..model.markers import Marker2D
from .contact2d import Disk2D
from .scalar_contact2d import ScalarContact2D


class DiskContact2D(ScalarContact2D):
    """Base of contacts of a disk with another shape: what its formula says of the disk."""

    disk: Disk2D
    """The disk."""

    @property
    def centre(self) -> Marker2D:
        """Of the disk."""
        return self.disk.marker

    @property
    def radius(self) -> float:
        """Of the disk, m."""
        return self.disk.radius
