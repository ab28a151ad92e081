"""Boxes in space: what touches are their corners, each a point."""

from itertools import product
from typing import Literal

import numpy as np

from ..model.base import Positive, Record
from ..model.markers import Marker3D
from .contact3d import Sphere3D


class Box3D(Record):
    """A box about the marker, its edges along the marker's axes."""

    type: Literal["Box3D"] = "Box3D"
    marker: Marker3D
    size: tuple[Positive, Positive, Positive]
    """Lengths of the edges along the marker's x, y and z axes, m."""

    def corners(self) -> tuple[Sphere3D, ...]:
        """Its eight corners as points."""
        axes, found = self.marker.axes(), []
        for signs in product((0.5, -0.5), repeat=3):
            place = np.array(self.marker.point) + axes @ (np.array(signs) * np.array(self.size))
            x, y, z = place.tolist()
            found.append(Sphere3D(marker=Marker3D(body=self.marker.body, point=(x, y, z))))
        return tuple(found)
