"""PID controller in space: a force or torque between two markers that brings what two others measure to a target.

The formulas are those of `pid_controller2d`: with e = x - f(t), F = K (e + z) + D e' works against the growth of the
driven measure y, z = integral of e dt / T is a state of its own; saturated, F is as in `saturation`, and z' = e/T
dF_out/dF.
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Positive
from ..model.markers import Marker3D
from ..model.said_angle import CountedAngle, SaidAngle
from ..model.signals import INPUT_SIZE, Signal, evaluate_signal
from .base import BodyElement, Numbering, Part, Row
from .measure3d import ANGLE, COLUMNS, columns_of, coordinates_of, measure, product
from .measured_force3d import MEASURE_KINDS, Measure3D, Pair3D
from .pid_law import PIDLaw
from .saturation import saturated, slope_rate
from .start_angle3d import check_start_angle
from .turn3d import LOOSE, account_of, turn_part
from .turning_bodies import refuse_points

WIDTH = 14
"""Coordinates of two markers: the driven ones come first, then those that are sensed, then z."""
STATE = 2 * WIDTH
SIZE = STATE + 1
DRIVEN, SENSED, START, GAIN, SHARE, RATE_GAIN, LIMIT, PACE = range(2 * COLUMNS, 2 * COLUMNS + 8)
"""Columns behind those of the markers: both kinds of measures, the sensed angle at the start, numbers of the law."""


@internal
def pid_controller3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    par, coord, extra = mat(b.par, b.count, PACE + 1), imat(b.coord, b.count, SIZE), imat(b.extra, b.count, 3)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    along, bent = np.empty((2, WIDTH)), np.empty((2, WIDTH, WIDTH))
    for e in range(b.count):
        x = 0.0
        for side in range(2):
            where, own = (
                coord[e, WIDTH * side : WIDTH * side + WIDTH],
                par[e, COLUMNS * side : COLUMNS * side + COLUMNS],
            )
            about = par[e, START] + v[extra[e, 2]] if side == 1 else 0.0
            x = measure(int(par[e, DRIVEN + side]), q, where, own, about, along[side], bent[side])
        ours, theirs, z = coord[e, :WIDTH], coord[e, WIDTH:STATE], coord[e, STATE]
        gain, rate_gain, limit, pace = par[e, GAIN], par[e, RATE_GAIN], par[e, LIMIT], par[e, PACE]
        f, df, _ = evaluate_signal(pool, inputs, extra[e, 0], t)
        error = x - f
        # z stands in its table as a length, whatever x is: error control weighs it so
        force = gain * error + gain * par[e, SHARE] * v[z] + rate_gain * (product(along[1], v, theirs) - df)
        slope, bend = 1.0, 0.0
        if limit > 0.0:
            bend = slope_rate(force, limit)
            force, slope = saturated(force, limit)
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(WIDTH):
                r[ours[i]] += force * along[0, i]
            r[z] -= pace * slope * error
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * SIZE * SIZE * e, SIZE, SIZE)
            by_state, winding = coef[1] * gain * par[e, SHARE], pace * error * bend
            for j in range(WIDTH):
                change = 0.0
                for i in range(WIDTH):
                    change += bent[1, i, j] * v[theirs[i]]
                asked = (coef[0] * gain + coef[1] * rate_gain) * along[1, j] + coef[0] * rate_gain * change
                for i in range(WIDTH):
                    values[slot[i, WIDTH + j]] += slope * asked * along[0, i]
                    values[slot[i, j]] += coef[0] * force * bent[0, i, j]
                values[slot[STATE, WIDTH + j]] -= coef[0] * pace * slope * along[1, j] + winding * asked
                values[slot[j, STATE]] += slope * by_state * along[0, j]
            values[slot[STATE, STATE]] -= winding * by_state
        else:
            vec(b.a, b.n_extended)[extra[e, 1]] -= force * product(along[0], v, ours)


class PIDController3D(PIDLaw, Pair3D):
    """A force or torque between markers `a` and `b` that brings what it senses to `target`(t): gains on the error, on
    its integral and on its rate.

    It senses the `measure` from `a` to `b`, or what is said by `sensor_a`, `sensor_b` and `sensed`: the angle of a
    pole whose cart it pushes, say. It works against the growth of the driven measure; a gain below zero, along it.
    """

    type: Literal["PIDController3D"] = "PIDController3D"
    kernel: ClassVar[Any] = pid_controller3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        *((i, j) for i in range(WIDTH) for j in range(SIZE)), *((STATE, j) for j in range(WIDTH, SIZE)),
    )  # fmt: skip

    target: Signal
    """What the sensed measure shall be, rad or m over s."""
    measure: Measure3D = "angle"
    """What it drives from `a` to `b`: the angle about the z axis of a by a torque, the place along it or the distance
    by a force."""
    sensor_a: Marker3D | None = None
    """The first marker that it senses; left out: `a`."""
    sensor_b: Marker3D | None = None
    """The second marker that it senses; left out: `b`."""
    sensed: Measure3D | None = None
    """What it senses of these two; left out: the same as `measure`."""
    start_angle: float | None = None
    """Of a sensed angle, rad: the one at the start, whole turns included; left out: as a joint, a driver or another
    element about the same axis says, or the turns by which attitudes are given, else between -pi and pi."""
    gain: float = 0.0
    """Force or torque for a unit of the error, N/m, N/rad, N m/m or N m/rad."""
    integral_gain: float = 0.0
    """For a unit of the error's integral over time: unit of `gain`, 1/s. It has the sign of `gain`."""
    rate_gain: float = 0.0
    """For a unit of the error's rate: unit of `gain`, s."""
    largest: Positive | None = None
    """Largest force or torque that it gives, N or N m, and then it integrates no further; left out: it gives any."""

    @model_validator(mode="after")
    def _check(self) -> "PIDController3D":
        if self.start_angle is not None and self.senses != "angle":
            raise ValueError(f"controller '{self.name}' senses no angle: leave `start_angle` out")
        return self

    @property
    def sensing_a(self) -> Marker3D:
        """The first marker that it senses."""
        return self.sensor_a or self.a

    @property
    def sensing_b(self) -> Marker3D:
        """The second one."""
        return self.sensor_b or self.b

    @property
    def senses(self) -> Measure3D:
        """What it senses of them."""
        return self.sensed or self.measure

    def markers(self) -> Sequence[Marker3D]:
        sensors = () if self.sensor_a is None else (self.sensing_a, self.sensing_b)
        return (self.a, self.b, *sensors)

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        pairs = ((self.measure, self.a, self.b), (self.senses, self.sensing_a, self.sensing_b))
        for what, a, b in pairs:
            if what == "angle":
                refuse_points(self.name, (a, b), bodies, "use a RigidBody3D")
        check_start_angle(self.name, self.sensing_a, self.sensing_b, self.start_angle, bodies)

    def counted_angles(self) -> Sequence[CountedAngle]:
        """The angle that it senses, if it does."""
        if self.senses != "angle":
            return ()
        return (CountedAngle(f"{self.name}.angle", self.sensing_a, self.sensing_b),)

    def said_angles(self, inputs: Mapping[str, float], t: float) -> Sequence[SaidAngle]:
        """What it says of the angle at the start."""
        if self.start_angle is None:
            return ()
        return (SaidAngle(self.sensing_a, self.sensing_b, self.start_angle, f"'{self.name}'"),)

    def row(self, numbering: Numbering) -> Row:
        a, b, kind = self.sensing_a, self.sensing_b, MEASURE_KINDS[self.senses]
        start, account = 0.0, numbering.frame(Marker3D())[0]
        if kind == ANGLE:
            start, account = numbering.start_angle(a, b, self.name), numbering.work(account_of(self.name), LOOSE)
        numbers = (float(MEASURE_KINDS[self.measure]), float(kind), start, *self.numbers(numbering, kind == ANGLE))
        columns = (*columns_of(self.a, self.b, numbering), *columns_of(a, b, numbering), *numbers)
        places = (*coordinates_of(self.a, self.b, numbering), *coordinates_of(a, b, numbering))
        extra = (numbering.signal(self.target), numbering.work("input"), account)
        return Row(columns, (*places, *numbering.internal(self.name)), extra)

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        counted = [turn_part(self.name, self.sensing_a, self.sensing_b, numbering)] if self.senses == "angle" else []
        return [*super().parts(numbering), *counted]
