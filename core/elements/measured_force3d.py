"""Forces in space along a measure x of two markers: an angle, a place along an axis, a distance.

One kernel for all laws, r += F dx/dq with the force F against the growth of x:

    spring    k (x - x_0) + c x'           x_0 a number or a time function, whose motion puts in -k (x - x_0) x_0'
    table     f(x) + c x'                  f a cubic spline
    friction  T tanh(x'/w)
    load      -f(t)
    servo     g (x - f(t)) + d (x' - f'(t)), or d (x' - f(t)); saturated as in `servo2d`

What springs and tables hold is strain energy, what dampers and friction take goes to the account of dampers; the power
of loads and servos counts as put in.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..errors import ConsistencyError
from ..model.markers import Marker3D
from ..model.said_angle import CountedAngle, SaidAngle
from ..model.signals import INPUT_SIZE, evaluate_signal
from ..rounding import MEETING
from .base import BodyElement, ForceElement, Numbering, Part, Row
from .measure3d import ANGLE, COLUMNS, DISTANCE, PLACE, add_force_tangent, columns_of, coordinates_of, measure, product
from .saturation import saturated
from .spatial_body import start_of_marker
from .start_angle3d import check_start_angle
from .table_energy import energy_of_table
from .turn3d import LOOSE, account_of, turn_part
from .turning_bodies import refuse_points

SPRING, TABLE, FRICTION, LOAD, SERVO = range(5)
KIND, START, LAW, FIRST, SECOND, THIRD, FOURTH = range(COLUMNS, COLUMNS + 7)
"""Columns behind those of the markers: kind of measure, the angle at the start, the law and its numbers."""
DAMPERS, TURNED, SIGNAL, INPUTS = range(4)
"""Columns of the indices: accounts of dampers and of turns, the time function, the account of inputs."""
NO_SIGNAL = -1
FULL = tuple((i, j) for i in range(14) for j in range(14))

Measure3D = Literal["angle", "slide", "distance"]
MEASURE_KINDS: dict[Measure3D, int] = {"angle": ANGLE, "slide": PLACE, "distance": DISTANCE}


@internal
def force_of(par: Any, pool: Any, inputs: Any, signal: int, t: float, x: float, rate: float) -> Any:
    """(force against the growth of x, its derivatives by x and by x', power that is lost, power that is put in, energy
    of a linear spring)."""
    law, first, second = int(par[LAW]), par[FIRST], par[SECOND]
    if law == FRICTION:
        part = math.tanh(rate / second)
        force = first * part
        return force, 0.0, first * (1.0 - part * part) / second, force * rate, 0.0, 0.0
    f, df = par[THIRD], 0.0
    if signal >= 0:
        f, df, _ = evaluate_signal(pool, inputs, signal, x if law == TABLE else t)
    if law == TABLE:
        return f + second * rate, df, second, second * rate * rate, 0.0, 0.0
    if law == SPRING:
        elastic = first * (x - f)
        return elastic + second * rate, first, second, second * rate * rate, -elastic * df, 0.5 * elastic * (x - f)
    if law == LOAD:
        return -f, 0.0, 0.0, 0.0, f * rate, 0.0
    force = first * (x - f) + second * (rate - df)
    if par[THIRD] != 0.0:
        force = second * (rate - f)
    limit, slope = par[FOURTH], 1.0
    if limit > 0.0:
        force, slope = saturated(force, limit)
    return force, slope * first, slope * second, 0.0, -force * rate, 0.0


@internal
def measured_force3d_kernel(job: int, t: float, b: Any) -> None:
    par, coord, extra = mat(b.par, b.count, FOURTH + 1), imat(b.coord, b.count, 14), imat(b.extra, b.count, 4)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    gradient, hessian = np.empty(14), np.empty((14, 14))
    for e in range(b.count):
        about, signal = par[e, START] + v[extra[e, TURNED]], extra[e, SIGNAL]
        x = measure(int(par[e, KIND]), q, coord[e], par[e], about, gradient, hessian)
        rate = product(gradient, v, coord[e])
        force, by_value, by_rate, lost, given, stored = force_of(par[e], pool, inputs, signal, t, x, rate)
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(14):
                r[coord[e, i]] += force * gradient[i]
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 196 * e, 14, 14)
            c_q, c_v = coef[0], coef[1]
            add_force_tangent(
                values, slot, gradient, hessian, v, coord[e], c_q * force, c_q * by_value + c_v * by_rate,
                c_q * by_rate,
            )  # fmt: skip
        elif job == ENERGY:
            vec(b.energy, 3)[2] += energy_of_table(pool, signal, x) if int(par[e, LAW]) == TABLE else stored
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, DAMPERS]] += lost
            vec(b.a, b.n_extended)[extra[e, INPUTS]] += given


class Pair3D(ForceElement):
    """Base of what acts between two markers in space."""

    a: Marker3D
    """The first marker."""
    b: Marker3D
    """The second marker."""

    def markers(self) -> Sequence[Marker3D]:
        return (self.a, self.b)


class MeasuredForce3D(Pair3D):
    """Base of forces along a measure: a subclass says which, its law with its numbers, and its time function."""

    kernel: ClassVar[Any] = measured_force3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL
    law: ClassVar[int]
    counts: ClassVar[bool] = False
    """Whether its force depends on how often an angle has gone round."""

    def kind(self) -> int:
        """ANGLE, PLACE or DISTANCE."""
        raise NotImplementedError(f"{type(self).__name__} must say what it measures")

    def numbers(self) -> tuple[float, float, float, float]:
        """Of its law."""
        return (0.0, 0.0, 0.0, 0.0)

    def signal_in(self, numbering: Numbering) -> int:
        """Offset of the time function or table in the pool; NO_SIGNAL without one."""
        return NO_SIGNAL

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        if self.kind() == ANGLE:
            refuse_points(self.name, self.markers(), bodies, "use a RigidBody3D")

    def row(self, numbering: Numbering) -> Row:
        """Raises ConsistencyError if the ends of a distance meet at the start: the force would have no direction."""
        if self.kind() == DISTANCE:
            self._refuse_meeting(numbering)
        counts, nothing = self.counts and self.kind() == ANGLE, numbering.frame(Marker3D())[0]
        start = numbering.start_angle(self.a, self.b, self.name) if counts else 0.0
        account = numbering.work(account_of(self.name), LOOSE) if counts else nothing
        given = numbering.work("input") if self.signals() else nothing
        numbers = (float(self.kind()), start, float(self.law), *self.numbers())
        extra = (numbering.work("dampers"), account, self.signal_in(numbering), given)
        return Row((*columns_of(self.a, self.b, numbering), *numbers), coordinates_of(self.a, self.b, numbering), extra)

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        if not self.counts or self.kind() != ANGLE:
            return super().parts(numbering)
        return [*super().parts(numbering), turn_part(self.name, self.a, self.b, numbering)]

    def _refuse_meeting(self, numbering: Numbering) -> None:
        a, b = (start_of_marker(marker, numbering.bodies)[0] for marker in (self.a, self.b))
        found = math.dist(a, b)
        if found <= MEETING * max(*self.lengths(), 0.0, float(np.max(np.abs([a, b])))):
            raise ConsistencyError(
                f"'{self.name}' starts with length {found:.3g} m: its markers on '{self.a.body}' and "
                f"'{self.b.body}' are both at ({a[0]:g}, {a[1]:g}, {a[2]:g}), so its force has no direction; start "
                "with the markers apart, or use a Bushing3D"
            )


class CountingForce3D(MeasuredForce3D):
    """Base of those whose force along an angle depends on whole turns."""

    counts: ClassVar[bool] = True

    start_angle: float | None = None
    """Of an angle, rad: the one at the start, whole turns included; left out: as a joint, a driver or another element
    about the same axis says, or the turns by which attitudes are given, else between -pi and pi."""

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        if self.kind() == ANGLE:
            check_start_angle(self.name, self.a, self.b, self.start_angle, bodies)
        elif self.start_angle is not None:
            raise ValueError(f"'{self.name}' acts on no angle: leave `start_angle` out")

    def counted_angles(self) -> Sequence[CountedAngle]:
        """Its angle, if it acts on one."""
        return (CountedAngle(f"{self.name}.angle", self.a, self.b),) if self.kind() == ANGLE else ()

    def said_angles(self, inputs: Mapping[str, float], t: float) -> Sequence[SaidAngle]:
        """What it says of the angle at the start."""
        return () if self.start_angle is None else (SaidAngle(self.a, self.b, self.start_angle, f"'{self.name}'"),)
