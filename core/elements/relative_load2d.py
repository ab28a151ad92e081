"""Force or torque between two bodies as a time function or an input: f(t) along the growth of a measure.

The bodies take it with opposite signs: r -= f(t) dx/dq for the measure x(a, b). Its power f x' counts as put in.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, ClassVar, Literal

from pydantic import model_validator

from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.signals import INPUT_SIZE, Signal, evaluate_signal
from .base import ForceElement, Form, Numbering, Row
from .formula2d import Arguments, caller_of
from .geometry2d import add_hessian, along
from .measured2d import MeasuredElement2D
from .measures2d import MEASURES

KIND = "relative_load2d"


@cache
def _kernel(measure: str, arguments: Arguments) -> Any:
    from ..compiled.formula_code import formula_internal
    from ..compiled.jet_functions import gradient_of, hessian_of

    formula = MEASURES[measure]
    call, n = caller_of(formula, arguments, 0), arguments.size

    def relative_load2d_kernel(job: int, t: float, b: Any) -> None:
        if job != RESIDUAL and job != TANGENT and job != POWER:
            return
        par, coord, extra = mat(b.par, b.count, b.npar), imat(b.coord, b.count, n), imat(b.extra, b.count, 2)
        q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
        pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
        for e in range(b.count):
            g = call(q, coord[e], par[e])
            gradient, hessian = gradient_of(g), hessian_of(g)
            f, _, _ = evaluate_signal(pool, inputs, extra[e, 0], t)
            if job == RESIDUAL:
                r = vec(b.r, b.n_extended)
                for i in range(len(gradient)):
                    r[coord[e, i]] -= f * gradient[i]
            elif job == TANGENT:
                slot = imat(b.slot_s + 8 * n * n * e, n, n)
                add_hessian(vec(b.values, b.n_values), slot, gradient, hessian, -vec(b.coef, 2)[0] * f)
            else:
                vec(b.a, b.n_extended)[extra[e, 1]] += f * along(gradient, v, coord[e])

    return formula_internal(relative_load2d_kernel, (formula, evaluate_signal), arguments)


class RelativeLoad2D(ForceElement, MeasuredElement2D):
    """`load`(t) between markers `a` and `b`: a force or torque that makes a measure grow where it is positive.

    measure "angle": a torque on b's body, and against it on a's, N m, an ideal motor; "slide": a force on b along a's
    first axis, N; "distance": a force that pushes the points apart, N, a cylinder whose pressure is given.
    """

    type: Literal["RelativeLoad2D"] = "RelativeLoad2D"
    form_kind: ClassVar[str] = KIND

    load: Signal
    """Over time, N m or N; positive makes the measure grow."""

    @model_validator(mode="after")
    def _two_bodies(self) -> "RelativeLoad2D":
        if self.a.body == self.b.body:
            raise ValueError(
                f"load '{self.name}': both markers are on '{self.a.body}', which would feel nothing of it: give it two "
                "bodies, or ground and a body"
            )
        return self

    def form(self) -> Form:
        return self.form_of(_kernel)

    def row(self, numbering: Numbering) -> Row:
        arguments = self.arguments()
        extra = (numbering.signal(self.load), numbering.work("input"))
        return Row(arguments.columns(self), arguments.coordinates(self, numbering), extra)

    def signals(self) -> Sequence[Signal]:
        return (self.load,)
