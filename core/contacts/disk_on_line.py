"""The record of a contact between a disk and a deformable line, and the pieces that its line is made of."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ..elements.base import Numbering, Row
from ..elements.geometry2d import place
from ..errors import ModelError
from ..laws.friction import CoulombFriction
from ..model.base import NonNegative, Record
from ..model.markers import GROUND, Marker2D
from ..rounding import SAME_PLACE
from .contact2d import Contact2D, Disk2D
from .line2d import PIECE_WIDTH, bristle_disk_on_line_kernel, disk_on_line_kernel, sliding_disk_on_line_kernel
from .segment2d import refuse_point_on_line

SHARPEST = math.radians(170.0)
"""Largest angle of a vertex: beyond it the line runs back on itself."""
FEWEST_CLOSED = 4
"""Nodes of a triangle, the first one twice."""
NO_END = -1
"""Number of a piece at whose ends the line goes on."""


class Line2D(Record):
    """A line along nodes on bodies that may move against each other, which it misses where it bends: it passes a node b
    on the inside by rounding/8 |a - 2 b + c|, its neighbours being a and c. `tlismni check` says by how much.

    Straight between two nodes but for the part `rounding` of each half segment beside a node, which a parabola takes.
    With rounding 1 it is a quadratic spline with its nodes as control points. What is made of points of a curve, such
    as a cam, is smaller than that curve, by (distance of the points)^2 rounding/8 times its curvature, and
    accelerations of what follows it are those of parabolas and straight pieces: take more points where that is too
    much, and a smaller rounding where the place counts more than the smoothness. Both sides can be touched.

    A line whose last node is its first one again (same body, same point) is closed: a cam, a ring. That vertex is
    rounded like all others, so that nothing tells where the line begins.
    """

    type: Literal["Line2D"] = "Line2D"
    nodes: Annotated[tuple[Marker2D, ...], Field(min_length=2)]
    """In their order along the line."""
    radius: NonNegative = 0.0
    """Half its thickness, m."""
    rounding: Annotated[float, Field(gt=0.0, le=1.0)] = 0.5
    """Part of each half segment beside a vertex that a parabola takes, dimensionless; 1 is a quadratic spline."""

    @property
    def closed(self) -> bool:
        """True if the last node is the first one again, but for rounding."""
        first, last = self.nodes[0], self.nodes[-1]
        if len(self.nodes) < FEWEST_CLOSED or first.body != last.body:
            return False
        size = max(abs(x) for node in self.nodes for x in node.point)
        return math.dist(first.point, last.point) <= SAME_PLACE * size

    @property
    def corners(self) -> tuple[Marker2D, ...]:
        """Its nodes, each once."""
        return self.nodes[:-1] if self.closed else self.nodes

    def missed(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """By how much the line passes each of its corners at these points (corners, 2), m: zero at open ends."""
        bends = np.roll(points, 1, axis=0) - 2.0 * points + np.roll(points, -1, axis=0)
        if not self.closed:
            bends[[0, -1]] = 0.0
        return self.rounding / 8.0 * np.hypot(bends[:, 0], bends[:, 1])


class DiskOnLine2D(Contact2D):
    """Contact of a disk (or point) with a deformable line: gap = distance from its nearest point - radii.

    One place of contact: a disk that touches the line twice, in a hollow narrower than itself, is not covered.
    Friction must be regularised: on a line that stretches there is no sliding distance that could be held constant.

    Raises
    ------
    ModelError : for a point on a line without thickness; for a disk on a body that carries a node; for Coulomb's
        friction.
    """

    type: Literal["DiskOnLine2D"] = "DiskOnLine2D"
    symbol: ClassVar[str] = "line"
    touch: ClassVar[str] = "line"
    kernel: ClassVar[Any] = disk_on_line_kernel
    sliding_kernel: ClassVar[Any] = sliding_disk_on_line_kernel
    bristle_kernel: ClassVar[Any] = bristle_disk_on_line_kernel
    width: ClassVar[int] = PIECE_WIDTH

    line: Line2D
    """The line."""
    disk: Disk2D
    """The disk."""

    @model_validator(mode="after")
    def _check_shapes(self) -> "DiskOnLine2D":
        refuse_point_on_line(self.name, "line", self.disk.radius, self.line.radius)
        body = self.disk.marker.body
        if body != GROUND and body in {node.body for node in self.line.nodes}:
            raise ValueError(
                f"contact '{self.name}': its disk is on '{body}', which carries a node of its line: the two would "
                "touch for ever; give the disk another body, or the line other nodes"
            )
        if isinstance(self.friction, CoulombFriction):
            raise ValueError(
                f"contact '{self.name}': Coulomb friction cannot be held on a line that deforms: give it a force law "
                "with regularised friction (BrownMcPhee, Tanh, ...), or leave friction out"
            )
        return self

    def extent(self) -> float:
        return self.disk.radius + self.line.radius

    def markers(self) -> Sequence[Marker2D]:
        return (*self.line.corners, self.disk.marker)

    def contact_rows(self, numbering: Numbering) -> Sequence[Row]:
        """One row a piece.

        Raises
        ------
        ModelError : if neighbouring nodes start at the same place, or the line turns back on itself.
        """
        nodes, closed, law = self.line.corners, self.line.closed, self._law_columns(numbering)
        start = self.corners_at_start(numbering)
        self._refuse_folds(start, closed)
        pieces = make_pieces(len(nodes), self.line.rounding, closed)
        rows = []
        for k, piece in enumerate(pieces):
            used = [None if i is None else nodes[i] for i in piece.nodes]
            points = [(0.0, 0.0) if node is None else node.point for node in used]
            bodies = [GROUND if node is None else node.body for node in used]
            coordinates = [i for body in (*bodies, self.disk.marker.body) for i in numbering.coordinates(body)]
            parameters = (
                self.extent(), self.disk.radius, *(0.0,) * 5, *law.parameters,
                *(x for point in (*points, self.disk.marker.point) for x in point),
                *piece.mixture.ravel(),
            )  # fmt: skip
            rows.append(Row(parameters, coordinates, (*law.extra, NO_END if closed else k, len(pieces))))
        return rows

    def corners_at_start(self, numbering: Numbering) -> NDArray[np.float64]:
        """Where the corners of the line start, (corners, 2), m."""
        return np.array([place(node.point, numbering.initial(node.body)) for node in self.line.corners])

    def _refuse_folds(self, start: NDArray[np.float64], closed: bool) -> None:
        count = len(start)
        legs = np.diff(start[[*range(count), *range(closed)]], axis=0)
        size = np.hypot(legs[:, 0], legs[:, 1])
        if np.any(size == 0.0):
            k = int(np.argmin(size))
            raise ModelError(
                f"nodes {k} and {(k + 1) % count} of the line of contact '{self.name}' start at the same place "
                f"{tuple(start[k])}: leave one out, or move it"
            )
        for k in range(1 - closed, len(legs)):
            angle = abs(_angle_between(legs[k - 1], legs[k]))
            if angle > SHARPEST:
                raise ModelError(
                    f"the line of contact '{self.name}' turns by {math.degrees(angle):.0f} degrees at node {k}: "
                    f"at most {math.degrees(SHARPEST):.0f} are possible"
                )


@dataclass(frozen=True)
class Piece:
    """A part of the line: a parabola whose control points are weighted sums of three nodes."""

    nodes: tuple[int | None, ...]
    """Numbers of its nodes, (3,); None: no node, with weights zero."""
    mixture: NDArray[np.float64]
    """Weights (3, 3) of the nodes in its control points."""

    def control(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Control points (3, 2) when the nodes are at `places` (nodes, 2)."""
        own = np.array([(0.0, 0.0) if i is None else places[i] for i in self.nodes])
        return np.asarray(self.mixture @ own)


def make_pieces(count: int, rounding: float, closed: bool = False) -> list[Piece]:
    """The pieces of a line with `count` different nodes, in their order; a closed one ends at its first piece again."""
    pieces, half = [], 0.5 * rounding
    for k in range(count if closed else count - 1):
        last = not closed and k == count - 2
        begin, end = 0.0 if k == 0 and not closed else half, 1.0 if last else 1.0 - half
        following, after = (k + 1) % count, (k + 2) % count
        if end > begin:
            places = (begin, 0.5 * (begin + end), end)
            pieces.append(Piece((k, following, None), np.array([(1.0 - u, u, 0.0) for u in places])))
        if not last:
            mixture = [(half, 1.0 - half, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0 - half, half)]
            pieces.append(Piece((k, following, after), np.array(mixture)))
    return pieces


def _angle_between(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
