"""Applied force at a marker and applied torque on a body, as time functions or input channels."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Name
from ..model.markers import Marker2D
from ..model.signals import INPUT_SIZE, Constant, Signal, evaluate_signal
from .base import ForceElement, Numbering, Row


@internal
def applied_load2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    par = mat(b.par, b.count, 4)  # offset of the point, 1 if the force turns with the body, its angle there
    coord = imat(b.coord, b.count, 3)
    extra = imat(b.extra, b.count, 4)
    q = vec(b.q, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    for e in range(b.count):
        fx, _, _ = evaluate_signal(pool, inputs, extra[e, 0], t)
        fy, _, _ = evaluate_signal(pool, inputs, extra[e, 1], t)
        torque, _, _ = evaluate_signal(pool, inputs, extra[e, 2], t)
        i, j, k = coord[e, 0], coord[e, 1], coord[e, 2]
        c, s = math.cos(q[k]), math.sin(q[k])
        x, y = c * par[e, 0] - s * par[e, 1], s * par[e, 0] + c * par[e, 1]
        if par[e, 2] != 0.0:
            turned = q[k] + par[e, 3]
            along, across = math.cos(turned), math.sin(turned)
            fx, fy = along * fx - across * fy, across * fx + along * fy
        moment = x * fy - y * fx + torque
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            r[i] -= fx
            r[j] -= fy
            r[k] -= moment
        elif job == TANGENT:
            values = vec(b.values, b.n_values)
            c_q = vec(b.coef, 2)[0]
            slot = imat(b.slot_s, b.count, 9)
            if par[e, 2] != 0.0:
                values[slot[e, 2]] += c_q * fy
                values[slot[e, 5]] -= c_q * fx
            else:
                values[slot[e, 8]] += c_q * (x * fx + y * fy)
        else:
            v = vec(b.v, b.n_extended)
            vec(b.a, b.n_extended)[extra[e, 3]] += fx * v[i] + fy * v[j] + moment * v[k]


class _AppliedLoad2D(ForceElement):
    kernel: ClassVar[Any] = applied_load2d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 2), (1, 2), (2, 2))


class AppliedForce2D(_AppliedLoad2D):
    """Force at `marker`: components in N, in the inertial frame, or along the marker's own axes if `follower`."""

    type: Literal["AppliedForce2D"] = "AppliedForce2D"
    symbol: ClassVar[str] = "force"
    arrow: ClassVar[str] = "signals"
    marker: Marker2D
    """Where the force acts."""
    force_x: Signal = Constant(value=0.0)
    """Along x of space (with `follower`: of the marker), N."""
    force_y: Signal = Constant(value=0.0)
    """Along y of space (with `follower`: of the marker), N."""
    follower: bool = False
    """Whether the components are along the marker's axes, which turn with the body, instead of those of space."""

    def row(self, numbering: Numbering) -> Row:
        zero = Constant(value=0.0)
        return Row(
            (*self.marker.point, float(self.follower), self.marker.angle),
            numbering.coordinates(self.marker.body),
            (
                numbering.signal(self.force_x),
                numbering.signal(self.force_y),
                numbering.signal(zero),
                numbering.work("input"),
            ),
        )

    def markers(self) -> Sequence[Marker2D]:
        return (self.marker,)

    def signals(self) -> Sequence[Signal]:
        return (self.force_x, self.force_y)


class AppliedTorque2D(_AppliedLoad2D):
    """Torque on `body`, N m, counter-clockwise positive."""

    type: Literal["AppliedTorque2D"] = "AppliedTorque2D"
    symbol: ClassVar[str] = "torque"
    body: Name
    """Name of the body."""
    torque: Signal
    """About the axis out of the plane, counter-clockwise positive, N m."""

    def row(self, numbering: Numbering) -> Row:
        zero = numbering.signal(Constant(value=0.0))
        return Row(
            (0.0, 0.0, 0.0, 0.0),
            numbering.coordinates(self.body),
            (zero, zero, numbering.signal(self.torque), numbering.work("input")),
        )

    def markers(self) -> Sequence[Marker2D]:
        return (Marker2D(body=self.body),)

    def moved_coordinates(self) -> Sequence[tuple[str, str]]:
        return ((self.body, "angle"),)

    def signals(self) -> Sequence[Signal]:
        return (self.torque,)
