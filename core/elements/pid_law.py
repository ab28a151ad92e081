"""PID controller: a force or torque between two markers that brings what two others measure to a target.

With the error e = x - f(t) the force F = K (e + z) + D e' works against the growth of the driven measure; z = integral
of e dt / T is a state of its own, and K/T the integral gain. So z has the unit of x whatever the gains are.

A controller that saturates gives F (1 + (F/L)^8)^(-1/8) (`saturation.py`), and integrates only that part of the error
by which its force can still change: z' = e/T dF_out/dF. So it does not wind up (conditional integration, Astrom and
Hagglund 1995, section 3.5, made smooth).
"""

from collections.abc import Sequence
from functools import cache
from typing import Any, ClassVar

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, ivec, mat, vec
from ..model.base import Positive
from ..model.markers import Marker
from ..model.signals import INPUT_SIZE, Signal, evaluate_signal
from .base import ForceElement, Form, Numbering, Row, no_account
from .geometry2d import along
from .measure3d import Measure, Pair
from .measures import measure_of
from .saturation import saturated, slope_rate

DRIVEN, SENSED, START, GAIN, SHARE, RATE_GAIN, LIMIT, PACE, PAIRS = range(9)
"""Columns: both kinds of measures, the sensed angle at the start, numbers of the law, the first of the two pairs of
markers. Coordinates of the driven pair come first, then those of the sensed one, then z."""


@internal
def pid_controller_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    size, width, columns = b.ncoord, b.ncoord // 2, (b.npar - PAIRS) // 2
    state = size - 1
    par, coord, extra = mat(b.par, b.count, b.npar), imat(b.coord, b.count, size), imat(b.extra, b.count, 3)
    q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    slopes, bent = np.empty((2, width)), np.empty((2, width, width))
    for e in range(b.count):
        x = 0.0
        for side in range(2):
            where = ivec(b.coord + 8 * (e * size + width * side), width)
            own = vec(b.par + 8 * (e * b.npar + PAIRS + columns * side), columns)
            about = par[e, START] + v[extra[e, 2]] if side == 1 else 0.0
            kind = int(par[e, DRIVEN + side])
            x = measure_of(kind, q, where, own, about, slopes[side], bent[side], job == TANGENT)
        ours, theirs, z = coord[e, :width], coord[e, width:state], coord[e, state]
        gain, rate_gain, limit, pace = par[e, GAIN], par[e, RATE_GAIN], par[e, LIMIT], par[e, PACE]
        f, df, _ = evaluate_signal(pool, inputs, extra[e, 0], t)
        error = x - f
        # z stands in its table as a length, whatever x is: error control weighs it so
        force = gain * error + gain * par[e, SHARE] * v[z] + rate_gain * (along(slopes[1], v, theirs) - df)
        slope, bend = 1.0, 0.0
        if limit > 0.0:
            bend = slope_rate(force, limit)
            force, slope = saturated(force, limit)
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(width):
                r[ours[i]] += force * slopes[0, i]
            r[z] -= pace * slope * error
        elif job == TANGENT:
            values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * size * size * e, size, size)
            by_state, winding = coef[1] * gain * par[e, SHARE], pace * error * bend
            for j in range(width):
                change = 0.0
                for i in range(width):
                    change += bent[1, i, j] * v[theirs[i]]
                asked = (coef[0] * gain + coef[1] * rate_gain) * slopes[1, j] + coef[0] * rate_gain * change
                for i in range(width):
                    values[slot[i, width + j]] += slope * asked * slopes[0, i]
                    values[slot[i, j]] += coef[0] * force * bent[0, i, j]
                values[slot[state, width + j]] -= coef[0] * pace * slope * slopes[1, j] + winding * asked
                values[slot[j, state]] += slope * by_state * slopes[0, j]
            values[slot[state, state]] -= winding * by_state
        else:
            vec(b.a, b.n_extended)[extra[e, 1]] -= force * along(slopes[0], v, ours)


@cache
def _form(width: int) -> Form:
    """Of a controller with so many coordinates of each pair: driven ones depend on all, z on those that are sensed."""
    size = 2 * width + 1
    rows = [*((i, j) for i in range(width) for j in range(size)), *((size - 1, j) for j in range(width, size))]
    return Form(pid_controller_kernel, 0, tuple(rows), ())


class PIDSensing(ForceElement):
    """Base of the controllers: what they drive and sense."""

    width: ClassVar[int]
    """Number of coordinates of a pair of markers."""

    type: str
    target: Signal
    """What the sensed measure shall be, rad or m over s."""
    measure: Measure = "angle"
    sensor_a: Marker | None = None
    """The first marker that it senses; left out: `a`."""
    sensor_b: Marker | None = None
    """The second marker that it senses; left out: `b`."""
    sensed: Measure | None = None
    """What it senses of these two; left out: the same as `measure`."""

    @property
    def senses(self) -> Measure:
        """What it senses."""
        return self.sensed or self.measure

    def pairs(self, numbering: Numbering) -> tuple[Pair, Pair]:
        """The driven and the sensed measure in the tables."""
        raise NotImplementedError(f"{type(self).__name__} must say where its measures are")

    def turns(self, numbering: Numbering) -> tuple[float, int]:
        """Sensed angle at the start, rad, and index of the account of its turns, if it counts these."""
        return 0.0, no_account(numbering)

    def form(self) -> Form:
        return _form(type(self).width)


class PIDLaw(PIDSensing):
    """Base of the controllers: their gains. Behind `PIDSensing`, so that these are last in their JSON."""

    gain: float = 0.0
    """Force or torque for a unit of the error, N/m, N/rad, N m/m or N m/rad."""
    integral_gain: float = 0.0
    """For a unit of the error's integral over time: unit of `gain`, 1/s. It has the sign of `gain`."""
    rate_gain: float = 0.0
    """For a unit of the error's rate: unit of `gain`, s."""
    largest: Positive | None = None
    """Largest force or torque that it gives, N or N m, and then it integrates no further; left out: it gives any."""

    @model_validator(mode="after")
    def _check_gains(self) -> "PIDLaw":
        if self.gain == 0.0 and self.integral_gain == 0.0 and self.rate_gain == 0.0:
            raise ValueError(f"controller '{self.name}' has no gain, so it does nothing: give it one")
        if self.integral_gain * self.gain < 0.0 or (self.integral_gain != 0.0 and self.gain == 0.0):
            raise ValueError(
                f"controller '{self.name}' has integral_gain = {self.integral_gain:g} and gain = {self.gain:g}: these "
                "must have one sign, and an integral gain needs a gain beside it (their quotient is the integral time)"
            )
        if (self.sensor_a is None) != (self.sensor_b is None):
            raise ValueError(f"controller '{self.name}' has one sensor marker: give it both, or none to sense a and b")
        return self

    def row(self, numbering: Numbering) -> Row:
        # z in radians is a length as large as the mechanism for a radian
        unit = numbering.length if self.senses == "angle" else 1.0
        pace = unit * self.integral_gain / self.gain if self.integral_gain else 0.0
        (driven, sensed), (start, turned) = self.pairs(numbering), self.turns(numbering)
        numbers = (self.gain, 1.0 / unit, self.rate_gain, self.largest or 0.0, pace)
        columns = (float(driven.kind), float(sensed.kind), start, *numbers, *driven.columns, *sensed.columns)
        extra = (numbering.signal(self.target), numbering.work("input"), turned)
        places = (*driven.coordinates, *sensed.coordinates, *numbering.internal(self.name))
        return Row(columns, places, extra)

    def internal_coordinates(self) -> Sequence[str]:
        return ("integral",)

    def signals(self) -> Sequence[Signal]:
        return (self.target,)
