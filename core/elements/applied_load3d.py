"""Applied force and torque at a marker in space, as time functions or input channels.

f_R = F, f_p = B(p, u)^T F of a force F at R + A u; f_p = 2 E^T n of a torque n in space, 2 G^T n of one in the body.
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import inlined, internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.markers import GROUND, Marker3D
from ..model.rotation3d import add_bend, add_torque_bend, constant, dot, four, onto, plus, times, turned, turning
from ..model.signals import INPUT_SIZE, Constant, Signal, evaluate_signal
from .base import BodyElement, ForceElement, Numbering, Row
from .spatial_body import PointMass3D

NOTHING = Constant(value=0.0)


@inlined
def of_torque(p: Any, n: Any, sign: float) -> Any:
    """G^T n (sign 1) or E^T n (sign -1)."""
    return (
        -p[1] * n[0] - p[2] * n[1] - p[3] * n[2],
        p[0] * n[0] + sign * (p[2] * n[2] - p[3] * n[1]),
        p[0] * n[1] + sign * (p[3] * n[0] - p[1] * n[2]),
        p[0] * n[2] + sign * (p[1] * n[1] - p[2] * n[0]),
    )


@inlined
def _vector(pool: Any, inputs: Any, extra: Any, first: int, t: float) -> Any:
    x, _, _ = evaluate_signal(pool, inputs, extra[first], t)
    y, _, _ = evaluate_signal(pool, inputs, extra[first + 1], t)
    z, _, _ = evaluate_signal(pool, inputs, extra[first + 2], t)
    return x, y, z


@inlined
def _in_body(par: Any, f: Any) -> Any:
    """A vector along the marker's axes in those of the body."""
    x, y, z = constant(par, 4), constant(par, 7), constant(par, 10)
    return plus(times(f[0], x), plus(times(f[1], y), times(f[2], z)))


@internal
def applied_load3d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    par, coord, extra = mat(b.par, b.count, 14), imat(b.coord, b.count, 7), imat(b.extra, b.count, 7)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    for e in range(b.count):
        u, follower = constant(par[e], 1), par[e, 13] != 0.0
        force, torque = _vector(pool, inputs, extra[e], 0, t), _vector(pool, inputs, extra[e], 3, t)
        p = four(vec(b.q, b.n_extended), coord[e], 3, par[e, 0])
        arms, sign = turning(p, u), -1.0
        directions, own = arms, force
        if follower:
            sign, torque = 1.0, _in_body(par[e], torque)
            own = _in_body(par[e], force)
            directions = turning(p, own)
            force = turned(directions, p)
        moment, turn = onto(arms, force), of_torque(p, torque, sign)
        if job == TANGENT:
            values, c_q = vec(b.values, b.n_values), vec(b.coef, 2)[0]
            slot = imat(b.slot_s + 8 * 49 * e, 7, 7)
            add_bend(values, slot, 3, -c_q, force, u)
            if follower:
                for j in range(4):
                    for i in range(3):
                        values[slot[i, 3 + j]] -= c_q * directions[j][i]
                    for i in range(4):
                        values[slot[3 + i, 3 + j]] -= c_q * dot(arms[i], directions[j])
            add_torque_bend(values, slot, times(-2.0 * c_q, torque), sign)
            continue
        v, r = vec(b.v, b.n_extended), vec(b.r, b.n_extended)
        power = 0.0
        for i in range(3):
            power += force[i] * v[coord[e, i]]
            if job == RESIDUAL:
                r[coord[e, i]] -= force[i]
        for i in range(4):
            power += (moment[i] + 2.0 * turn[i]) * v[coord[e, 3 + i]]
            if job == RESIDUAL:
                r[coord[e, 3 + i]] -= moment[i] + 2.0 * turn[i]
        if job == POWER:
            vec(b.a, b.n_extended)[extra[e, 6]] += power


class _AppliedLoad3D(ForceElement):
    kernel: ClassVar[Any] = applied_load3d_kernel
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = (
        *((i, 3 + j) for i in range(3) for j in range(4)), *((3 + i, 3 + j) for i in range(4) for j in range(4)),
    )  # fmt: skip

    marker: Marker3D
    """Where it acts."""
    follower: bool = False
    """Whether the components are along the marker's axes, which turn with the body, and not along those of space."""

    def markers(self) -> Sequence[Marker3D]:
        return (self.marker,)

    def _row(self, numbering: Numbering, signals: Sequence[Signal]) -> Row:
        marker = self.marker
        axes = marker.axes().T.ravel().tolist()
        parameters = (numbering.at_rest(marker)[3], *marker.point, *axes, float(self.follower))
        extra = (*(numbering.signal(signal) for signal in signals), numbering.work("input"))
        return Row(parameters, numbering.frame(marker), extra)


class AppliedForce3D(_AppliedLoad3D):
    """Force at `marker`: components in N, along the axes of space, or along the marker's own if `follower`."""

    type: Literal["AppliedForce3D"] = "AppliedForce3D"
    arrow: ClassVar[str] = "signals"
    force_x: Signal = NOTHING
    """Along x, N."""
    force_y: Signal = NOTHING
    """Along y, N."""
    force_z: Signal = NOTHING
    """Along z, N."""

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, (*self.signals(), NOTHING, NOTHING, NOTHING))

    def signals(self) -> Sequence[Signal]:
        return (self.force_x, self.force_y, self.force_z)


class AppliedTorque3D(_AppliedLoad3D):
    """Torque on the body of `marker`: components in N m, along the axes of space, or along the marker's own if
    `follower`."""

    type: Literal["AppliedTorque3D"] = "AppliedTorque3D"
    torque_x: Signal = NOTHING
    """About x, N m."""
    torque_y: Signal = NOTHING
    """About y, N m."""
    torque_z: Signal = NOTHING
    """About z, N m."""

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        if self.marker.body != GROUND and isinstance(bodies.get(self.marker.body), PointMass3D):
            raise ValueError(
                f"torque '{self.name}' acts on point mass '{self.marker.body}', which does not turn: use a RigidBody3D"
            )

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, (NOTHING, NOTHING, NOTHING, *self.signals()))

    def signals(self) -> Sequence[Signal]:
        return (self.torque_x, self.torque_y, self.torque_z)
