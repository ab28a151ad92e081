"""Planar clamp: two markers share a point and a direction.

Phi = (p_a - p_b, theta_a - theta_b + relative_angle): a revolute joint and a third row that is linear.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..model.channels import Channel
from .base import Numbering, Row
from .revolute2d import AngleHeld2D, hold_angle, hold_points


@internal
def clamp2d_kernel(job: int, t: float, b: Any) -> None:
    if job == RESIDUAL or job == TANGENT:
        hold_points(job, b)
        hold_angle(job, b, 2, -1.0)


class Clamp2D(AngleHeld2D):
    """Markers `a` and `b` are one: same point, and no turning against each other (a weld).

    Its force and torque channels are those on body b, N and N m about the common point.
    """

    type: Literal["Clamp2D"] = "Clamp2D"
    symbol: ClassVar[str] = "clamp"
    kernel: ClassVar[Any] = clamp2d_kernel
    constraint_rows: ClassVar[int] = 3
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((2, 2), (5, 5))
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        (0, 0), (0, 2), (0, 3), (0, 5), (1, 1), (1, 2), (1, 4), (1, 5), (2, 2), (2, 5),
    )  # fmt: skip

    relative_angle: float | None = None
    """theta_b - theta_a of the bodies, rad; left out: as in the start configuration."""

    def row(self, numbering: Numbering) -> Row:
        return Row((*self.a.point, *self.b.point, self.held_angle(numbering)), self.coordinates(numbering))

    def multiplier_channels(self) -> Sequence[Channel]:
        return (
            Channel(f"{self.name}.force_x", "N", "force of the clamp on its body b, x"),
            Channel(f"{self.name}.force_y", "N", "force of the clamp on its body b, y"),
            Channel(f"{self.name}.torque", "N.m", "torque of the clamp on its body b"),
        )
