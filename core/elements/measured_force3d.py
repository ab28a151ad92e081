"""Forces in space along a measure: an angle about or a place along the z axis of marker a, a distance of points."""

from collections.abc import Mapping, Sequence

from ..model.markers import Marker3D
from .base import BodyElement, Numbering
from .measure3d import Measure as Measure
from .measure3d import Pair, Pair3D, pair3d
from .measured_force import MeasuredForce
from .primitive3d import SIZE
from .spatial_body import start_of_marker
from .turn3d import CountsTurns3D
from .turning_bodies import refuse_points


class MeasuredForce3D(MeasuredForce, Pair3D):
    """Base of forces along a measure of two markers in space."""

    def width(self) -> int:
        return SIZE

    def pair(self, numbering: Numbering) -> Pair:
        return pair3d(self.acts_along, self.a, self.b, numbering)

    def ends(self, numbering: Numbering) -> Sequence[Sequence[float]]:
        return [start_of_marker(marker, numbering.bodies)[0].tolist() for marker in self.markers()]

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        if self.acts_along == "angle":
            refuse_points(self.name, self.markers(), bodies, "use a RigidBody3D")


class CountingForce3D(CountsTurns3D, MeasuredForce3D):
    """Base of those whose force along an angle depends on whole turns."""

    start_angle: float | None = None
    """Of an angle, rad: the one at the start, whole turns included; left out: as a joint, a driver or another element
    about the same axis says, or the turns by which attitudes are given, else between -pi and pi."""

    def counted_pair(self) -> tuple[Marker3D, Marker3D] | None:
        return (self.a, self.b) if self.acts_along == "angle" else None
