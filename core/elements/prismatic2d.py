"""Planar prismatic joint: marker b slides along the axis of marker a, without turning against it.

Phi_1 = n . (p_b - p_a) with n normal to the axis of a, Phi_2 = theta_b - theta_a - relative_angle.
"""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from .base import Numbering, Row
from .geometry2d import FULL_PATTERN, constrain, height_over_line
from .revolute2d import AngleHeld2D, hold_angle


@internal
def prismatic2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par, coord, row = mat(b.par, b.count, 6), imat(b.coord, b.count, 6), imat(b.row, b.count, 2)
    q = vec(b.q, b.n_extended)
    for e in range(b.count):
        g, gradient, hessian = height_over_line(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3], par[e, 4])
        constrain(b, job, e, row[e, 0], 0, g, gradient, hessian)
    hold_angle(job, b, 1, 1.0)


class Prismatic2D(AngleHeld2D):
    """Marker `b` slides along the first axis of marker `a` and keeps the relative angle of the bodies.

    Its channels are the normal force and the torque on body a's side of the constraint (multipliers with the
    sign of the force on body b reversed, as M a + Phi_q^T lambda = Q has it).
    """

    type: Literal["Prismatic2D"] = "Prismatic2D"
    symbol: ClassVar[str] = "guide"
    kernel: ClassVar[Any] = prismatic2d_kernel
    constraint_rows: ClassVar[int] = 2
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL_PATTERN
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = (*((0, j) for j in range(6)), (1, 2), (1, 5))

    relative_angle: float | None = None
    """theta_b - theta_a, rad; left out: as in the start configuration."""

    def force_rows(self) -> Sequence[int]:
        return (0,)

    def row(self, numbering: Numbering) -> Row:
        columns = (*self.a.point, *self.b.point, self.a.angle + 0.5 * math.pi, self.held_angle(numbering))
        return Row(columns, self.coordinates(numbering))

    def multiplier_channels(self) -> Sequence[Channel]:
        return (
            Channel(f"{self.name}.normal_force", "N", "force of body b on body a along the normal of the axis"),
            Channel(f"{self.name}.torque", "N.m", "torque of body b on body a"),
        )
