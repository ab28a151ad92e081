"""A massless frame that moves as it is told: Phi = (x - f_x(t), y - f_y(t), angle - f_angle(t))."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from ..compiled.jit import internal, interpreted
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, vec
from ..model.channels import Channel
from ..model.motion import evaluate_motion
from ..model.signals import INPUT_SIZE, Constant, InputSignal, Signal, Step, evaluate_signal
from .base import NO_INPUTS, BodyElement, Numbering, Row
from .coordinate import Coordinate, X, Y
from .planar_body import ANGLE_COORDINATE, PlanarFrame


@internal
def moving_frame2d_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    coord, row, extra = imat(b.coord, b.count, 3), imat(b.row, b.count, 3), imat(b.extra, b.count, 4)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    lam, r, values = vec(b.lam, b.m_extended), vec(b.r, b.n_extended), vec(b.values, b.n_values)
    phi, phid, phidd = vec(b.phi, b.m_extended), vec(b.phid, b.m_extended), vec(b.phidd, b.m_extended)
    slot_j, slot_jt = imat(b.slot_j, b.count, 9), imat(b.slot_jt, b.count, 9)
    for e in range(b.count):
        for l in range(3):
            i, k = coord[e, l], row[e, l]
            if job == TANGENT:
                values[slot_j[e, 4 * l]] += 1.0
                values[slot_jt[e, 4 * l]] += 1.0
                continue
            f, df, ddf = evaluate_motion(pool, inputs, extra[e, l], t)
            if job == RESIDUAL:
                phi[k] = q[i] - f
                phid[k] = v[i] - df
                phidd[k] = a[i] - ddf
                r[i] += lam[k]
            else:
                a[extra[e, 3]] -= lam[k] * df


class MovingFrame2D(PlanarFrame):
    """A frame without mass whose position and angle are given over time: a moving wall, support or hand.

    Shapes, joints and force elements are put on it by markers, as on a body. It starts where the motion says. Channels:
    the force and the torque of what is attached on the frame.
    """

    type: Literal["MovingFrame2D"] = "MovingFrame2D"
    symbol: ClassVar[str] = "frame"
    kernel: ClassVar[Any] = moving_frame2d_kernel
    constraint_rows: ClassVar[int] = 3
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 0), (1, 1), (2, 2))

    x: Signal = Constant(value=0.0)
    """m over time in s; an input channel moves with the velocity of its `rate` channel."""
    y: Signal = Constant(value=0.0)
    """m."""
    angle: Signal = Constant(value=0.0)
    """rad."""

    @model_validator(mode="after")
    def _check(self) -> "MovingFrame2D":
        for name, motion in zip(("x", "y", "angle"), self.motions(), strict=True):
            if isinstance(motion, Step):
                raise ValueError(
                    f"'{name}' of frame '{self.name}' is a Step: a jump in position is no motion; "
                    "use a Ramp, a Polynomial or a Table"
                )
        return self

    @property
    def linear(self) -> bool:
        return True

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, ANGLE_COORDINATE)

    def start_in(
        self, bodies: Mapping[str, BodyElement], inputs: Mapping[str, float] = NO_INPUTS
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0) where the motions are at t = 0."""
        found = [_start(motion, inputs) for motion in self.motions()]
        return tuple(x for x, _ in found), tuple(v for _, v in found)

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0) with all inputs at zero."""
        return self.start_in({})

    def row(self, numbering: Numbering) -> Row:
        extra = (*(numbering.motion(motion) for motion in self.motions()), numbering.work("input"))
        return Row((), numbering.coordinates(self.name), extra)

    def placed(self, numbering: Numbering) -> Sequence[int]:
        return numbering.coordinates(self.name)

    def signals(self) -> Sequence[Signal]:
        return self.motions()

    def motions(self) -> Sequence[Signal]:
        return (self.x, self.y, self.angle)

    def multiplier_channels(self) -> Sequence[Channel]:
        return (
            Channel(f"{self.name}.reaction_x", "N", "force on the frame by what is attached to it, x"),
            Channel(f"{self.name}.reaction_y", "N", "force on the frame by what is attached to it, y"),
            Channel(f"{self.name}.reaction_torque", "N.m", "torque on the frame, about its origin"),
        )


def _start(motion: Signal, inputs: Mapping[str, float]) -> tuple[float, float]:
    """Value and rate at t = 0."""
    if isinstance(motion, InputSignal):
        return motion.gain * inputs.get(motion.channel, 0.0), motion.gain * inputs.get(motion.rate or "", 0.0)
    x, v, _ = interpreted(evaluate_signal)(np.array(motion.pool({})), np.zeros(0), 0, 0.0)
    return float(x), float(v)
