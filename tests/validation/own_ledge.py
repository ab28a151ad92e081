"""A pair of shapes from outside of the package, the edge of a table and a disk: all that is said of it is said here."""

import math
from collections.abc import Sequence

from tlismni.core import Disk2D, Marker2D, ScalarContact2D, Shape2D, scalar_contact
from tlismni.core.contacts.pair_table import pair
from tlismni.core.model.base import Positive


class Ledge2D(Shape2D):
    """A table that ends at the marker: all that is below its first axis and behind its second one."""

    marker: Marker2D = Marker2D()
    """At the edge."""
    shown: Positive = 1.0
    """How much of it is drawn, m."""

    def outline(self) -> Sequence[tuple[float, float]]:
        """For drawings."""
        return ((-self.shown, -self.shown), (0.0, -self.shown), (0.0, 0.0), (-self.shown, 0.0))


def ledge_gap(ledge, centre, radius):
    dx, dy = centre.x - ledge.x, centre.y - ledge.y
    x, y = dx * ledge.ex + dy * ledge.ey, dy * ledge.ex - dx * ledge.ey
    if x > 0.0 and y > 0.0:
        return math.sqrt(x * x + y * y) - radius
    return (x if x > y else y) - radius


def ledge_slide(ledge, centre, radius):
    """Way of the place of contact to the right, round the edge, and what the disk has rolled."""
    dx, dy = centre.x - ledge.x, centre.y - ledge.y
    x, y = dx * ledge.ex + dy * ledge.ey, dy * ledge.ex - dx * ledge.ey
    rolled = radius * (centre.angle - ledge.angle)
    if x > 0.0 and y > 0.0:
        return radius * math.atan2(x, y) + rolled
    if x > y:
        return 0.5 * math.pi * radius - y + rolled
    return x + rolled


class DiskOnLedge2D(ScalarContact2D):
    """A disk on the edge of a table."""

    formula = scalar_contact(ledge_gap, ledge_slide, convex=True)
    ledge_shape: Ledge2D
    disk: Disk2D

    ledge = property(lambda self: self.ledge_shape.marker)
    centre = property(lambda self: self.disk.marker)
    radius = property(lambda self: self.disk.radius)

    def disks(self) -> Sequence[Disk2D]:
        return (self.disk,)


pair(DiskOnLedge2D, ledge_shape=Ledge2D, disk=Disk2D)
