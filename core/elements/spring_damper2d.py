"""Translational spring-damper between two markers: F = k (l - l0) + c l', along the line of the markers.

The natural length l0 may be a time function: what moves it puts in the power -k (l - l0) l0'.
"""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..errors import ConsistencyError
from ..model.base import NonNegative
from ..model.signals import INPUT_SIZE, Signal, evaluate_signal
from ..rounding import MEETING
from .base import ForceElement, Numbering, PairElement2D, Row
from .geometry2d import FULL_PATTERN, add_hessian, add_product, along, distance, place

FIXED = -1
"""In place of a signal: the natural length is a number."""


@internal
def spring_damper2d_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, 7)
    coord = imat(b.coord, b.count, 6)
    extra = imat(b.extra, b.count, 3)  # account of dampers; of a natural length that moves its signal and account
    q = vec(b.q, b.n_extended)
    v = vec(b.v, b.n_extended)
    for e in range(b.count):
        length, gradient, hessian = distance(q, coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        k, c = par[e, 4], par[e, 5]
        natural, moving = par[e, 6], 0.0
        if extra[e, 1] >= 0:
            pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
            natural, moving, _ = evaluate_signal(pool, inputs, extra[e, 1], t)
        stretch = length - natural
        rate = along(gradient, v, coord[e])
        force = k * stretch + c * rate
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(6):
                r[coord[e, i]] += force * gradient[i]
        elif job == TANGENT:
            values = vec(b.values, b.n_values)
            coef = vec(b.coef, 2)
            slot = imat(b.slot_s + 8 * 36 * e, 6, 6)
            add_hessian(values, slot, gradient, hessian, coef[0] * force)
            by_value, by_rate = coef[0] * k + coef[1] * c, coef[0] * c
            add_product(values, slot, gradient, gradient, hessian, v, coord[e], by_value, by_rate)
        elif job == ENERGY:
            vec(b.energy, 3)[2] += 0.5 * k * stretch * stretch
        elif job == POWER:
            vec(b.a, b.n_extended)[extra[e, 0]] += c * rate * rate
            if extra[e, 1] >= 0:
                vec(b.a, b.n_extended)[extra[e, 2]] -= k * stretch * moving


class SpringDamper2D(PairElement2D, ForceElement):
    """Spring and damper between markers `a` and `b`."""

    type: Literal["SpringDamper2D"] = "SpringDamper2D"
    kernel: ClassVar[Any] = spring_damper2d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL_PATTERN

    stiffness: NonNegative
    """N/m."""
    damping: NonNegative = 0.0
    """N s/m."""
    natural_length: NonNegative | Signal
    """m, a number or a time function, an input too. The force has the direction of the line: the markers must not meet
    (a Bushing2D's may)."""

    @property
    def fixed_length(self) -> float:
        """The natural length, m; 0 where a time function says it."""
        return float(self.natural_length) if isinstance(self.natural_length, int | float) else 0.0

    def lengths(self) -> Sequence[float]:
        return (self.fixed_length,) if self.fixed_length > 0.0 else ()

    def signals(self) -> Sequence[Signal]:
        return () if isinstance(self.natural_length, int | float) else (self.natural_length,)

    def row(self, numbering: Numbering) -> Row:
        """Raises ConsistencyError if the markers meet at the start: the force would have no direction."""
        a, b = (place(marker.point, numbering.initial(marker.body)) for marker in (self.a, self.b))
        size = max(self.fixed_length, *(abs(x) for x in (*a, *b)))
        if math.dist(a, b) <= MEETING * size:
            raise ConsistencyError(
                f"spring '{self.name}' starts with length {math.dist(a, b):.3g} m: marker a on '{self.a.body}' is at "
                f"({a[0]:g}, {a[1]:g}), marker b on '{self.b.body}' at ({b[0]:g}, {b[1]:g}), so its force has no "
                "direction; start with the markers apart, use a Bushing2D, or two springs across each other"
            )
        dampers = numbering.work("dampers")
        moved = [(numbering.signal(signal), numbering.work("input")) for signal in self.signals()]
        parameters = (*self.a.point, *self.b.point, self.stiffness, self.damping, self.fixed_length)
        return Row(parameters, self.coordinates(numbering), (dampers, *(moved[0] if moved else (FIXED, dampers))))
