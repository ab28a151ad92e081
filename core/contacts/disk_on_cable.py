"""The record of a contact between a disk and an ANCF cable. Its kernel is in `cable_line.py`."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, cast

from pydantic import model_validator

from ..elements.base import BodyElement, Numbering, Row
from ..elements.cable2d import Cable2D
from ..elements.cable_kernel import NODAL
from ..elements.material_point2d import MaterialPoint2D
from ..model.base import Name, NonNegative
from ..model.markers import Marker2D
from .cable_line import LINE_WIDTH, disk_on_cable_kernel
from .contact2d import Contact2D, Disk2D
from .segment2d import refuse_point_on_line


class DiskOnCable2D(Contact2D):
    """Contact of a disk (or point) with a cable anywhere along it: gap = distance from its axis - radii.

    Both sides of the cable can be touched. The place of contact moves from element to element without a jump. One place
    of contact: a disk that touches the cable twice, in a bend narrower than itself, is not covered. Without friction: a
    disk that should be dragged along takes a Line2D through points of the cable.

    Raises
    ------
    ModelError : for a point on a cable without thickness; with friction; for a disk on a point of the cable itself.
    """

    type: Literal["DiskOnCable2D"] = "DiskOnCable2D"
    touch: ClassVar[str] = "cable"
    kernel: ClassVar[Any] = disk_on_cable_kernel
    width: ClassVar[int] = LINE_WIDTH

    cable: Name
    """Name of the Cable2D."""
    thickness: NonNegative = 0.0
    """Distance of the cable's surface from its axis, m."""
    disk: Disk2D
    """The disk."""

    @model_validator(mode="after")
    def _check_shapes(self) -> "DiskOnCable2D":
        refuse_point_on_line(self.name, "cable", self.disk.radius, self.thickness)
        if self.friction is not None:
            raise ValueError(f"contact '{self.name}' of a disk with a cable has no friction: leave it out, or use a "
                             "DiskOnLine2D through MaterialPoint2Ds of the cable")  # fmt: skip
        return self

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        cable, on = bodies.get(self.cable), bodies.get(self.disk.marker.body)
        if not isinstance(cable, Cable2D):
            cables = sorted(name for name, body in bodies.items() if isinstance(body, Cable2D))
            raise ValueError(f"contact '{self.name}' is with '{self.cable}', which is no Cable2D of this model; there "
                             f"are {cables}")  # fmt: skip
        if isinstance(on, MaterialPoint2D) and on.body == self.cable:
            raise ValueError(f"contact '{self.name}': its disk is on '{on.name}', a point of '{self.cable}' itself: "
                             "the two would touch for ever; give the disk another body")  # fmt: skip

    def acts_on(self) -> frozenset[str]:
        return super().acts_on() | {self.cable}

    def extent(self) -> float:
        return self.disk.radius + self.thickness

    def markers(self) -> Sequence[Marker2D]:
        return (self.disk.marker,)

    def contact_rows(self, numbering: Numbering) -> Sequence[Row]:
        """One row an element of the cable."""
        cable, own = cast(Cable2D, numbering.bodies[self.cable]), numbering.coordinates(self.cable)
        law, disk = self._law_columns(numbering), numbering.coordinates(self.disk.marker.body)
        parameters = (
            self.extent(), *(0.0,) * 6, *law.parameters, *self.disk.marker.point, cable.length / cable.elements,
        )  # fmt: skip
        return [
            Row(parameters, (*own[4 * k : 4 * k + NODAL], *disk), (*law.extra, k, cable.elements))
            for k in range(cable.elements)
        ]
