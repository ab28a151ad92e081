"""Driver: one coordinate of a body follows a time function. Phi = q_k - f(t)."""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from pydantic import model_validator

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, vec
from ..model.base import Name
from ..model.channels import Channel
from ..model.motion import evaluate_motion
from ..model.signals import INPUT_SIZE, InputSignal, Signal, Step
from .base import JointElement, Numbering, Row
from .coordinate import UNKNOWN_UNIT


@internal
def coordinate_driver_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != TANGENT and job != POWER:
        return
    coord = imat(b.coord, b.count, 1)
    row = imat(b.row, b.count, 1)
    extra = imat(b.extra, b.count, 2)
    lam = vec(b.lam, b.m_extended)
    a = vec(b.a, b.n_extended)
    pool, inputs = vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs)
    for e in range(b.count):
        i, k = coord[e, 0], row[e, 0]
        if job == TANGENT:
            values = vec(b.values, b.n_values)
            values[imat(b.slot_j, b.count, 1)[e, 0]] += 1.0
            values[imat(b.slot_jt, b.count, 1)[e, 0]] += 1.0
            continue
        f, df, ddf = evaluate_motion(pool, inputs, extra[e, 0], t)
        if job == RESIDUAL:
            vec(b.phi, b.m_extended)[k] = vec(b.q, b.n_extended)[i] - f
            vec(b.phid, b.m_extended)[k] = vec(b.v, b.n_extended)[i] - df
            vec(b.phidd, b.m_extended)[k] = a[i] - ddf
            vec(b.r, b.n_extended)[i] += lam[k]
        else:
            a[extra[e, 1]] -= lam[k] * df


class CoordinateDriver(JointElement):
    """Coordinate `coordinate` of `body` follows `motion`(t). Channel: the driving force or torque."""

    type: Literal["CoordinateDriver"] = "CoordinateDriver"
    symbol: ClassVar[str] = "driver"
    kernel: ClassVar[Any] = coordinate_driver_kernel
    constraint_rows: ClassVar[int] = 1
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ((0, 0),)

    body: Name
    """Name of the body."""
    coordinate: Name
    """"x", "y" or "angle" of a planar body, or the name of one of a LinearSystem's."""
    motion: Signal
    """Position in m or rad over time in s. An input channel moves with the velocity of its `rate` channel, and the
    coordinate starts where it says; see `tlismni.core.model.motion` for what happens when the input changes.
    At the ends of a Ramp the velocity jumps: an impact of the driver, with a warning in the log."""

    @model_validator(mode="after")
    def _check(self) -> "CoordinateDriver":
        if isinstance(self.motion, Step):
            raise ValueError(
                f"motion of driver '{self.name}' is a Step: a jump in position is no motion; "
                "use a Ramp, a Polynomial or a Table"
            )
        return self

    @property
    def linear(self) -> bool:
        return True

    def row(self, numbering: Numbering) -> Row:
        index = numbering.coordinate(self.body, self.coordinate)
        return Row((), (index,), (numbering.motion(self.motion), numbering.work("input")))

    def motions(self) -> Sequence[Signal]:
        return (self.motion,)

    def placed(self, numbering: Numbering) -> Sequence[int]:
        by_input = isinstance(self.motion, InputSignal)
        return (numbering.coordinate(self.body, self.coordinate),) if by_input else ()

    def moved_coordinates(self) -> Sequence[tuple[str, str]]:
        return ((self.body, self.coordinate),)

    def signals(self) -> Sequence[Signal]:
        return (self.motion,)

    def multiplier_channels(self) -> Sequence[Channel]:
        unit = {"x": "N", "y": "N", "angle": "N.m"}.get(self.coordinate, UNKNOWN_UNIT)
        return (Channel(f"{self.name}.reaction", unit, "reaction of the body on the driver"),)
