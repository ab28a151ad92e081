"""Planar distance joint: two markers keep their distance.

Phi = (d . d - L^2) / (2 L): polynomial, regular for L > 0, and with |Phi_q| = 1 as for |d| - L.
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Positive
from ..model.channels import Channel
from .base import Numbering, PairElement2D, Row
from .geometry2d import FULL_PATTERN, ROW_PATTERN, constrain, half_square_distance


@internal
def distance2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT:
        return
    par = mat(b.par, b.count, 5)
    coord = imat(b.coord, b.count, 6)
    row = imat(b.row, b.count, 1)
    q = vec(b.q, b.n_extended)
    for e in range(b.count):
        half, gradient, hessian = half_square_distance(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        length = par[e, 4]
        constrain(b, job, e, row[e, 0], 0, 1.0 / length, half - 0.5 * length * length, gradient, hessian)


class Distance2D(PairElement2D):
    """Markers `a` and `b` keep the distance `length` (a massless rod). Channel: force in it, tension positive."""

    type: Literal["Distance2D"] = "Distance2D"
    kernel: ClassVar[Any] = distance2d_kernel
    constraint_rows: ClassVar[int] = 1
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL_PATTERN
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ROW_PATTERN

    length: Positive
    """m."""

    def row(self, numbering: Numbering) -> Row:
        return Row(
            (*self.a.point, *self.b.point, self.length),
            self.coordinates(numbering),
        )

    def lengths(self) -> Sequence[float]:
        return (self.length,)

    def multiplier_channels(self) -> Sequence[Channel]:
        return (Channel(f"{self.name}.tension", "N", "force in the rod, tension positive"),)
