"""Spring whose force over its length is a table: F = f(l) + c l', f a cubic spline."""

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import NonNegative
from ..model.signals import INPUT_SIZE, evaluate_signal
from .base import Numbering, PairElement2D, Row
from .geometry2d import FULL_PATTERN, add_hessian, add_product, along, distance
from .table_energy import energy_of_table
from .table_law import TableLaw


@internal
def table_spring2d_kernel(job: int, t: float, b: Any) -> None:
    par, coord, extra = mat(b.par, b.count, 5), imat(b.coord, b.count, 6), imat(b.extra, b.count, 2)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    for e in range(b.count):
        length, gradient, hessian = distance(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        c = par[e, 4]
        rate = along(gradient, v, coord[e])
        elastic, stiffness, _ = evaluate_signal(pool, inputs, extra[e, 0], length)
        force = elastic + c * rate
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(6):
                r[coord[e, i]] += force * gradient[i]
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 36 * e, 6, 6)
            add_hessian(values, slot, gradient, hessian, coef[0] * force)
            by_value, by_rate = coef[0] * stiffness + coef[1] * c, coef[0] * c
            add_product(values, slot, gradient, gradient, hessian, v, coord[e], by_value, by_rate)
        elif job == ENERGY:
            vec(b.energy, 3)[2] += energy_of_table(pool, extra[e, 0], length)
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 1]] += c * rate * rate


class TableSpring2D(TableLaw, PairElement2D):
    """Spring between markers `a` and `b` with a measured characteristic: `forces` over `lengths`, a cubic spline.

    Pulling is positive. Beyond the table the first or last cubic goes on. The markers must not meet.
    """

    type: Literal["TableSpring2D"] = "TableSpring2D"
    kernel: ClassVar[Any] = table_spring2d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL_PATTERN

    lengths_table: Annotated[tuple[float, ...], Field(min_length=4)]
    """Lengths, m, growing."""
    forces: Annotated[tuple[float, ...], Field(min_length=4)]
    """Force at each length, N."""
    damping: NonNegative = 0.0
    """N s/m."""

    def lengths(self) -> Sequence[float]:
        return (self.farthest,)

    def row(self, numbering: Numbering) -> Row:
        table = numbering.signal(self.table)
        parameters = (*self.a.point, *self.b.point, self.damping)
        return Row(parameters, self.coordinates(numbering), (table, numbering.work("dampers")))
