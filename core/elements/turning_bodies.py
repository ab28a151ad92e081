"""Which bodies in space can turn: what exerts a torque on one that cannot is refused."""

from collections.abc import Iterable, Mapping

from ..model.markers import Marker
from ..model.words import an
from .base import BodyElement
from .spatial_body import EULER, SpatialFrame


def refuse_points(user: str, markers: Iterable[Marker], bodies: Mapping[str, BodyElement], instead: str) -> None:
    """Raise ValueError if a marker of the element `user` is on a body that does not turn; `instead` says what to do."""
    for marker in markers:
        body = bodies.get(marker.body)
        if isinstance(body, SpatialFrame) and EULER[0].name not in body.coordinate_names:
            raise ValueError(
                f"'{user}' turns '{body.name}', or keeps it from turning, but {an(type(body).__name__)} is a point, "
                f"which does not turn: {instead}"
            )
