"""Motor between two bodies: an angle, a way or a distance between two markers follows a time function.

Phi = x(a, b) - f(t).
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from ..model.motion import evaluate_motion
from ..model.signals import INPUT_SIZE, Signal, Step
from .base import Form, JointElement, Numbering, Row, full_pattern
from .geometry2d import constrain
from .measure2d import MeasuredElement2D, measure2d, pair2d, width2d
from .measure3d import Measure, pack

EFFORTS: Mapping[Measure, tuple[str, str]] = {
    "angle": ("torque", "N.m"), "slide": ("force", "N"), "distance": ("force", "N"),
}  # fmt: skip
"""Name and unit of what works against the growth of each."""


@internal
def relative_motor2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    n = b.ncoord
    par, coord, row = mat(b.par, b.count, b.npar), imat(b.coord, b.count, n), imat(b.row, b.count, 1)
    extra, q = imat(b.extra, b.count, 2), vec(b.q, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    gradient, hessian, packed = np.empty(n), np.empty((n, n)), np.empty(n * (n + 1) // 2)
    for e in range(b.count):
        k = row[e, 0]
        f, df, ddf = evaluate_motion(pool, inputs, extra[e, 0], t)
        if job == POWER:
            vec(b.a, b.n_extended)[extra[e, 1]] -= vec(b.lam, b.m_extended)[k] * df
            continue
        x = measure2d(int(par[e, 0]), q, coord[e], par[e, 1:], gradient, hessian, True)
        pack(hessian, packed)
        constrain(b, job, e, k, 0, x, gradient, packed)
        if job == RESIDUAL:
            vec(b.phi, b.m_extended)[k] -= f
            vec(b.phid, b.m_extended)[k] -= df
            vec(b.phidd, b.m_extended)[k] -= ddf


class RelativeMotor2D(JointElement, MeasuredElement2D):
    """The angle, way or distance from marker `a` to marker `b` follows `motion`(t).

    measure "angle": from a's first axis to b's, rad, a motor on a revolute joint; "slide": of b along a's first axis,
    m, a drive on a prismatic joint; "distance": of the two points, m, a cylinder. Channel: torque or force that the
    bodies put against its growth.
    """

    type: Literal["RelativeMotor2D"] = "RelativeMotor2D"
    symbol: ClassVar[str] = "actuator"

    motion: Signal
    """What it follows, rad or m over s. The bodies must start where it says; an input leads them there."""

    @model_validator(mode="after")
    def _check(self) -> "RelativeMotor2D":
        if isinstance(self.motion, Step):
            raise ValueError(
                f"motion of motor '{self.name}' is a Step: a jump in position is no motion; use a Ramp, a Polynomial "
                "or a Table"
            )
        if self.a.body == self.b.body:
            raise ValueError(f"motor '{self.name}': both markers are on '{self.a.body}': give it two bodies")
        return self

    def form(self) -> Form:
        n = width2d(self.measure)
        return Form(relative_motor2d_kernel, 1, full_pattern(n), tuple((0, j) for j in range(n)))

    def row(self, numbering: Numbering) -> Row:
        pair = pair2d(self.measure, self.a, self.b, numbering)
        extra = (numbering.motion(self.motion), numbering.work("input"))
        return Row((float(pair.kind), *pair.columns), pair.coordinates, extra)

    def motions(self) -> Sequence[Signal]:
        return (self.motion,)

    def signals(self) -> Sequence[Signal]:
        return (self.motion,)

    def multiplier_channels(self) -> Sequence[Channel]:
        name, unit = EFFORTS[self.measure]
        return (Channel(f"{self.name}.{name}", unit, f"{name} of the bodies against the growth of its {self.measure}"),)
