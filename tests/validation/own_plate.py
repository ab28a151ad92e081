"""A shape in space from outside of the package, a plate, and what it touches: all that is said of it is said here."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from tlismni.core import HalfSpace3D, Marker3D, Shape3D, Sphere3D, SphereOnHalfSpace3D
from tlismni.core.contacts.pair_table import Make, touching
from tlismni.core.model.base import Positive

CORNERS = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
FACES = ((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
         (1, 5, 7), (1, 7, 3))  # fmt: skip


class Plate3D(Shape3D):
    """A wide plate about the marker, whose upper face is touched."""

    marker: Marker3D = Marker3D()
    width: Positive = 1.0
    thickness: Positive

    def surface(self) -> tuple[tuple[tuple[float, float, float], ...], tuple[tuple[int, int, int], ...]]:
        """For drawings."""
        w, h = self.width, self.thickness
        return tuple((w * x, w * y, h * z) for x, y, z in CORNERS), FACES

    def top(self) -> HalfSpace3D:
        up = 0.5 * self.thickness * self.marker.axes()[:, 2]
        x, y, z = (np.array(self.marker.point) + up).tolist()
        return HalfSpace3D(marker=self.marker.model_copy(update={"point": (x, y, z)}))


@touching(Plate3D, Sphere3D)
def _on_plate(plate: Plate3D, sphere: Sphere3D) -> Sequence[Make]:
    return (partial(SphereOnHalfSpace3D, plane=plate.top(), sphere=sphere),)
