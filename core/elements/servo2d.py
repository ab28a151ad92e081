"""Servo between two bodies: a spring and damper whose end a time function or an input moves.

F = gain (x - f(t)) + rate_gain (x' - f'(t)) works against the growth of x: a position servo. Without gain and with the
rate as target (`of_rate`), F = rate_gain (x' - f(t)): a velocity servo. All of its power counts as put in.

A servo that saturates gives F (1 + (F/L)^8)^(-1/8) instead, L its largest force: F itself while that is below L/2 (to
5e-4), and no more than L. It is smooth, so that nothing has to be located.
"""

from functools import cache
from typing import Any, ClassVar, Literal

from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import NonNegative, Positive
from ..model.signals import INPUT_SIZE, Signal, evaluate_signal
from .base import Form, Numbering, Row
from .formula2d import MARKER_COLUMNS, Arguments, caller_of
from .geometry2d import add_hessian, add_product, along
from .measured2d import MeasuredElement2D
from .measures2d import MEASURES
from .saturation import saturated
from .servo_law import ServoLaw

KIND = "servo2d"


@cache
def _kernel(measure: str, arguments: Arguments) -> Any:
    from ..compiled.formula_code import formula_internal
    from ..compiled.jet_functions import gradient_of, hessian_of, value_of

    formula = MEASURES[measure]
    call, n, own = caller_of(formula, arguments, 0), arguments.size, MARKER_COLUMNS * len(arguments.markers)

    def servo2d_kernel(job: int, t: float, b: Any) -> None:
        if job != RESIDUAL and job != TANGENT and job != POWER:
            return
        par, coord, extra = mat(b.par, b.count, b.npar), imat(b.coord, b.count, n), imat(b.extra, b.count, 2)
        q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
        pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
        for e in range(b.count):
            gain, rate_gain, of_rate = par[e, own], par[e, own + 1], par[e, own + 2]
            g = call(q, coord[e], par[e])
            x, gradient, hessian = value_of(g), gradient_of(g), hessian_of(g)
            rate = along(gradient, v, coord[e])
            f, df, _ = evaluate_signal(pool, inputs, extra[e, 0], t)
            if of_rate != 0.0:
                force = rate_gain * (rate - f)
            else:
                force = gain * (x - f) + rate_gain * (rate - df)
            limit, slope = par[e, own + 3], 1.0
            if limit > 0.0:
                force, slope = saturated(force, limit)
            if job == RESIDUAL:
                r = vec(b.r, b.n_extended)
                for i in range(len(gradient)):
                    r[coord[e, i]] += force * gradient[i]
            elif job == TANGENT:
                values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
                slot = imat(b.slot_s + 8 * n * n * e, n, n)
                add_hessian(values, slot, gradient, hessian, coef[0] * force)
                by_value, by_rate = slope * (coef[0] * gain + coef[1] * rate_gain), slope * coef[0] * rate_gain
                add_product(values, slot, gradient, gradient, hessian, v, coord[e], by_value, by_rate)
            else:
                vec(b.a, b.n_extended)[extra[e, 1]] -= force * rate

    return formula_internal(servo2d_kernel, (formula, evaluate_signal, saturated), arguments)


class Servo2D(ServoLaw, MeasuredElement2D):
    """Drives the angle, way or distance from marker `a` to `b` (`measure`, as in `RelativeMotor2D`) to `target`(t).

    A position servo has a `gain` and a `rate_gain`; a velocity servo has `of_rate` and a `rate_gain` alone.
    """

    type: Literal["Servo2D"] = "Servo2D"
    form_kind: ClassVar[str] = KIND

    target: Signal
    """rad or m over s; with `of_rate` rad/s or m/s."""
    gain: NonNegative = 0.0
    """N m/rad or N/m."""
    rate_gain: NonNegative = 0.0
    """N m s/rad or N s/m."""
    of_rate: bool = False
    """Whether `target` is a rate, not a position."""
    largest: Positive | None = None
    """Largest force or torque that it gives, N or N m; left out: it gives any."""

    def form(self) -> Form:
        return self.form_of(_kernel, by_rates=True)

    def row(self, numbering: Numbering) -> Row:
        arguments = self.arguments()
        extra = (numbering.signal(self.target), numbering.work("input"))
        return Row((*arguments.columns(self), *self.numbers()), arguments.coordinates(self, numbering), extra)
