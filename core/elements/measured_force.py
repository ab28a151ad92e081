"""Forces along a measure x of two markers, in the plane and in space: an angle, a place along an axis, a distance.

One kernel for all laws and measures, r += F dx/dq with the force F against the growth of x:

    spring    k (x - x_0) + c x'           x_0 a number or a time function, whose motion puts in -k (x - x_0) x_0'
    table     f(x) + c x'                  f a cubic spline
    friction  T tanh(x'/w)
    load      -f(t)
    servo     g (x - f(t)) + d (x' - f'(t)), or d (x' - f(t)); saturated as in `saturation.py`

What springs and tables hold is strain energy, what dampers and friction take goes to the account of dampers; the power
of loads and servos counts as put in. A new law is a number and a branch of `force_of`, and a base of its records.
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..errors import ConsistencyError
from ..model.signals import INPUT_SIZE, evaluate_signal
from ..rounding import MEETING
from .base import ForceElement, Form, Numbering, PairElement2D, Row, full_pattern, no_account
from .geometry2d import add_hessian, add_product, along
from .measure2d import PLANAR_ANGLE, ends2d, pair2d, two_points, width2d
from .measure3d import Measure, Pair
from .measures import add_force_tangent, measure_of
from .saturation import saturated
from .table_energy import energy_of_table

SPRING, TABLE, FRICTION, LOAD, SERVO = range(5)
KIND, START, LAW, FIRST, SECOND, THIRD, FOURTH, PAIR = range(8)
"""Columns: kind of measure, the angle at the start, the law and its numbers, the first of the pair of markers."""
DAMPERS, TURNED, SIGNAL, INPUTS = range(4)
"""Columns of the indices: accounts of dampers and of turns, the time function, the account of inputs."""
NO_SIGNAL = -1
Numbers = tuple[float, float, float, float]


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
def _act_in_plane(b: Any, job: int, t: float, e: int, kind: int, par: Any, coord: Any, pair: Any, signal: int) -> None:
    """RESIDUAL and TANGENT of element e along a planar slide or distance. Arrays of derivatives take twice the time."""
    v, pool, inputs = vec(b.v, b.n_extended), vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    x, gradient, hessian = two_points(kind, vec(b.q, b.n_extended), coord, pair)
    rate = along(gradient, v, coord)
    force, by_value, by_rate, _, _, _ = force_of(par, pool, inputs, signal, t, x, rate)
    if job == RESIDUAL:
        r = vec(b.r, b.n_extended)
        for i in range(6):
            r[coord[i]] += force * gradient[i]
        return
    values, coef, slot = vec(b.values, b.n_values), vec(b.coef, 2), imat(b.slot_s + 8 * 36 * e, 6, 6)
    c_q, c_v = coef[0], coef[1]
    add_hessian(values, slot, gradient, hessian, c_q * force)
    add_product(
        values, slot, gradient, gradient, hessian, v, coord, c_q * by_value + c_v * by_rate, c_q * by_rate
    )  # fmt: skip


@internal
def measured_force_kernel(job: int, t: float, b: Any) -> None:
    n, width = b.ncoord, b.npar - PAIR
    par, coord, extra = mat(b.par, b.count, b.npar), imat(b.coord, b.count, n), imat(b.extra, b.count, 4)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    gradient, hessian = np.empty(n), np.empty((n, n))
    for e in range(b.count):
        about, signal = par[e, START] + v[extra[e, TURNED]], extra[e, SIGNAL]
        pair, kind = vec(b.par + 8 * (e * b.npar + PAIR), width), int(par[e, KIND])
        if kind > PLANAR_ANGLE and (job == RESIDUAL or job == TANGENT):
            _act_in_plane(b, job, t, e, kind, par[e], coord[e], pair, signal)
            continue
        x = measure_of(kind, q, coord[e], pair, about, gradient, hessian, job == TANGENT)
        rate = along(gradient, v, coord[e])
        force, by_value, by_rate, lost, given, stored = force_of(par[e], pool, inputs, signal, t, x, rate)
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(n):
                r[coord[e, i]] += force * gradient[i]
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * n * n * e, n, n)
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


class MeasuredForce(ForceElement):
    """Base of forces along a measure: of the laws, which say their numbers and time function, and of `MeasuredForce2D`
    and `MeasuredForce3D`, which say where the measure is."""

    law: ClassVar[int]
    noun: ClassVar[str] = "force"
    """What messages call it."""
    own_measure: ClassVar[Measure | None] = None
    """What it acts along; None: its field `measure` says that."""
    dissipates: ClassVar[bool] = True
    """Whether its law takes energy that goes to the account of dampers."""

    if TYPE_CHECKING:
        measure: Measure

    @property
    def acts_along(self) -> Measure:
        """What it acts along."""
        return type(self).own_measure or self.measure

    def numbers(self) -> Numbers:
        """Of its law."""
        return (0.0, 0.0, 0.0, 0.0)

    def signal_in(self, numbering: Numbering) -> int:
        """Offset of the time function or table in the pool; NO_SIGNAL without one."""
        return next((numbering.signal(signal) for signal in self.signals()), NO_SIGNAL)

    def pair(self, numbering: Numbering) -> Pair:
        """Its measure in the tables."""
        raise NotImplementedError(f"{type(self).__name__} must say where its measure is")

    def ends(self, numbering: Numbering) -> Sequence[Sequence[float]]:
        """Where the points of its markers are at the start, m."""
        raise NotImplementedError(f"{type(self).__name__} must say where its markers are")

    def turns(self, numbering: Numbering) -> tuple[float, int]:
        """Angle at the start, rad, and index of the account of its turns, if it counts these."""
        return 0.0, no_account(numbering)

    def form(self) -> Form:
        return Form(measured_force_kernel, 0, full_pattern(self.width()), ())

    def width(self) -> int:
        """Number of coordinates of its measure."""
        raise NotImplementedError(f"{type(self).__name__} must say how many coordinates its measure has")

    def row(self, numbering: Numbering) -> Row:
        """Raises ConsistencyError if the ends of a distance meet at the start: the force would have no direction."""
        if self.acts_along == "distance":
            self._refuse_meeting(numbering)
        pair, nothing = self.pair(numbering), no_account(numbering)
        dampers = numbering.work("dampers") if self.dissipates else nothing
        start, turned = self.turns(numbering)
        given = numbering.work("input") if self.signals() else nothing
        numbers = (float(pair.kind), start, float(self.law), *self.numbers())
        return Row((*numbers, *pair.columns), pair.coordinates, (dampers, turned, self.signal_in(numbering), given))

    def _refuse_meeting(self, numbering: Numbering) -> None:
        a, b = self.ends(numbering)
        found = math.dist(a, b)
        if found <= MEETING * max(*self.lengths(), 0.0, float(np.max(np.abs([a, b])))):
            first, second = (marker.body for marker in self.markers())
            at_a, at_b = (", ".join(f"{x:g}" for x in end) for end in (a, b))
            raise ConsistencyError(
                f"{self.noun} '{self.name}' starts with length {found:.3g} m: marker a on '{first}' is at ({at_a}), "
                f"marker b on '{second}' at ({at_b}), so its force has no direction; start with the markers apart, "
                f"use a Bushing{len(a)}D, or two springs across each other"
            )


class MeasuredForce2D(MeasuredForce, PairElement2D):
    """Base of those between planar markers: "angle" counts turns, "slide" is along the first axis of marker a."""

    def width(self) -> int:
        return width2d(self.acts_along)

    def pair(self, numbering: Numbering) -> Pair:
        return pair2d(self.acts_along, self.a, self.b, numbering)

    def ends(self, numbering: Numbering) -> Sequence[Sequence[float]]:
        return ends2d(self.a, self.b, numbering)
