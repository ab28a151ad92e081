"""Channels of a joint in space: what it does to body b, seen from marker a."""

from collections.abc import Sequence

import numpy as np

from ..model.channels import Channel
from ..model.derived import NOT_KNOWN, Columns
from ..model.marker_channels3d import Floats, Frame3D
from .primitive3d import Motion3D, Primitive


class JointLoad:
    """Force (N) and torque (N m) of a joint on its body b at the point of marker b, along the axes of marker a.

    Rows that repeat others are left out of the equations and have no multiplier: the forces of redundant joints are
    then one of the many ways in which they may share the load.
    """

    def __init__(
        self, name: str, a: Frame3D, b: Frame3D, primitives: Sequence[tuple[Primitive, Sequence[int]]]
    ) -> None:
        self._a, self._b, self._primitives = a, b, primitives
        self.channels = tuple(
            Channel(f"{name}.{what}_{axis}", unit, f"{what} of the joint on its body b, along {axis} of marker a")
            for what, unit in (("force", "N"), ("torque", "N.m"))
            for axis in "xyz"
        )
        self.rate_of = (NOT_KNOWN,) * 6

    def __call__(self, columns: Columns) -> Floats:
        """All channels (N, 6)."""
        q = columns.q
        axes = self._a.axes(q)
        motion = Motion3D(self._a.point(q), axes, self._b.point(q), self._b.axes(q))
        force, torque = np.zeros((len(q), 3)), np.zeros((len(q), 3))
        for primitive, rows in self._primitives:
            of_force, of_torque = primitive.load(motion, columns.multipliers[:, list(rows)])
            force += of_force
            torque += of_torque
        return np.stack([_along(axes, k, x) for x in (force, torque) for k in range(3)], axis=1)


def _along(axes: Floats, k: int, x: Floats) -> Floats:
    return axes[:, 0, k] * x[:, 0] + axes[:, 1, k] * x[:, 1] + axes[:, 2, k] * x[:, 2]
