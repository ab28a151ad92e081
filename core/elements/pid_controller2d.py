"""PID controller: a force or torque between two markers that brings what two others measure to a target.

With the error e = x - f(t) the force F = K (e + z) + D e' works against the growth of the driven measure; z = integral
of e dt / T is a state of its own, and K/T the integral gain. So z has the unit of x whatever the gains are.

A controller that saturates gives F (1 + (F/L)^8)^(-1/8) (see `servo2d`), and integrates only that part of the error by
which its force can still change: z' = e/T dF_out/dF. So it does not wind up (conditional integration, Astrom and
Hagglund 1995, section 3.5, made smooth).
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, Literal

from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Positive
from ..model.markers import Marker2D
from ..model.signals import INPUT_SIZE, Signal, evaluate_signal
from .base import Form, Numbering, PairElement2D, Row
from .formula2d import MARKER_COLUMNS, Arguments, FormKey, caller_of, form_ahead
from .geometry2d import add_hessian, add_product, along
from .measures2d import MEASURES, Measure
from .pid_law import PIDLaw
from .saturation import saturated, slope_rate

KIND = "pid_controller2d"
ENDS, SENSORS = Arguments(("a", "b"), ()), Arguments(("sensing_a", "sensing_b"), ())
WIDTH = 6
"""Coordinates of two markers: the driven ones come first, then those that are sensed, then z."""
STATE = 2 * WIDTH
SIZE = STATE + 1


@cache
def _kernel(driven: str, sensed: str) -> Any:
    from ..compiled.formula_code import formula_internal
    from ..compiled.jet_functions import gradient_of, hessian_of, value_of

    # a measure calls its two markers a and b, whichever they are of the controller's four
    drive, sense = (caller_of(MEASURES[name], ENDS, k * 2 * MARKER_COLUMNS) for k, name in enumerate((driven, sensed)))
    first = 4 * MARKER_COLUMNS

    def pid_controller2d_kernel(job: int, t: float, b: Any) -> None:
        if job != RESIDUAL and job != TANGENT and job != POWER:
            return
        par, coord, extra = mat(b.par, b.count, b.npar), imat(b.coord, b.count, SIZE), imat(b.extra, b.count, 2)
        q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
        pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
        for e in range(b.count):
            ours, theirs, z = coord[e, :WIDTH], coord[e, WIDTH:STATE], coord[e, STATE]
            gain, share, rate_gain, limit = par[e, first], par[e, first + 1], par[e, first + 2], par[e, first + 3]
            y, x = drive(q, ours, par[e]), sense(q, theirs, par[e])
            along_y, bent_y = gradient_of(y), hessian_of(y)
            along_x, bent_x = gradient_of(x), hessian_of(x)
            f, df, _ = evaluate_signal(pool, inputs, extra[e, 0], t)
            error = value_of(x) - f
            # z stands in its table as a length, whatever x is: error control weighs it so
            force = gain * error + gain * share * v[z] + rate_gain * (along(along_x, v, theirs) - df)
            slope, bend = 1.0, 0.0
            if limit > 0.0:
                bend = slope_rate(force, limit)
                force, slope = saturated(force, limit)
            pace = par[e, first + 4]
            if job == RESIDUAL:
                r = vec(b.r, b.n_extended)
                for i in range(len(along_y)):
                    r[ours[i]] += force * along_y[i]
                r[z] -= pace * slope * error
            elif job == TANGENT:
                values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
                slot = imat(b.slot_s + 8 * SIZE * SIZE * e, SIZE, SIZE)
                add_hessian(values, slot, along_y, bent_y, coef[0] * force)
                by_value, by_rate = coef[0] * gain + coef[1] * rate_gain, coef[0] * rate_gain
                by_state, winding = coef[1] * gain * share, pace * error * bend
                theirs_of = slot[:, WIDTH:STATE]
                add_product(
                    values, theirs_of, along_y, along_x, bent_x, v, theirs, slope * by_value, slope * by_rate
                )  # fmt: skip
                for i in range(len(along_y)):
                    values[slot[i, STATE]] += slope * by_state * along_y[i]
                add_product(
                    values, theirs_of[STATE:], (1.0,), along_x, bent_x, v, theirs,
                    -coef[0] * pace * slope - winding * by_value, -winding * by_rate,
                )  # fmt: skip
                values[slot[STATE, STATE]] -= winding * by_state
            else:
                vec(b.a, b.n_extended)[extra[e, 1]] -= force * along(along_y, v, ours)

    formulas = (MEASURES[driven], MEASURES[sensed], evaluate_signal, saturated, slope_rate)
    return formula_internal(pid_controller2d_kernel, formulas)


class PIDController2D(PIDLaw, PairElement2D):
    """A force or torque between markers `a` and `b` that brings what it senses to `target`(t): gains on the error, on
    its integral and on its rate.

    It senses the `measure` from `a` to `b`, or what is said by `sensor_a`, `sensor_b` and `sensed`: the angle of a
    pole whose cart it pushes, say. It works against the growth of the driven measure; a gain below zero, along it.
    """

    type: Literal["PIDController2D"] = "PIDController2D"

    target: Signal
    """What the sensed measure shall be, rad or m over s."""
    measure: Measure = "angle"
    """What it drives from `a` to `b`: the angle by a torque, the slide along a's axis or the distance by a force."""
    sensor_a: Marker2D | None = None
    """The first marker that it senses; left out: `a`."""
    sensor_b: Marker2D | None = None
    """The second marker that it senses; left out: `b`."""
    sensed: Measure | None = None
    """What it senses of these two; left out: the same as `measure`."""
    gain: float = 0.0
    """Force or torque for a unit of the error, N/m, N/rad, N m/m or N m/rad."""
    integral_gain: float = 0.0
    """For a unit of the error's integral over time: unit of `gain`, 1/s. It has the sign of `gain`."""
    rate_gain: float = 0.0
    """For a unit of the error's rate: unit of `gain`, s."""
    largest: Positive | None = None
    """Largest force or torque that it gives, N or N m, and then it integrates no further; left out: it gives any."""

    @property
    def sensing_a(self) -> Marker2D:
        """The first marker that it senses."""
        return self.sensor_a or self.a

    @property
    def sensing_b(self) -> Marker2D:
        """The second one."""
        return self.sensor_b or self.b

    @property
    def senses(self) -> Measure:
        """What it senses of them."""
        return self.sensed or self.measure

    def markers(self) -> Sequence[Marker2D]:
        sensors = () if self.sensor_a is None else (self.sensing_a, self.sensing_b)
        return (self.a, self.b, *sensors)

    def formulas(self) -> tuple[Any, Any]:
        """Of the driven and of the sensed measure."""
        return MEASURES[self.measure], MEASURES[self.senses]

    def arguments(self) -> Arguments:
        """What these take, by name."""
        return ENDS

    def form_key(self) -> FormKey:
        """Kind and formulas of its kernel, by which the library of machine code has it."""
        return KIND, self.formulas()

    def form(self) -> Form:
        ahead = form_ahead(*self.form_key(), ENDS)
        if ahead is not None:
            return ahead
        rows = (*range(WIDTH), STATE)
        pattern = {(i, j) for i in rows for j in range(WIDTH, SIZE)} | {(i, j) for i in rows[:-1] for j in range(WIDTH)}
        return Form(_kernel(self.measure, self.senses), 0, tuple(sorted(pattern)), ())

    def row(self, numbering: Numbering) -> Row:
        numbers = self.numbers(numbering, self.senses == "angle")
        columns = (*ENDS.columns(self), *SENSORS.columns(self), *numbers)
        places = (*ENDS.coordinates(self, numbering), *SENSORS.coordinates(self, numbering))
        extra = (numbering.signal(self.target), numbering.work("input"))
        return Row(columns, (*places, *numbering.internal(self.name)), extra)
