"""Applied load on one coordinate of a body, as a time function or an input channel: r_k -= f(t)."""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal

from ..compiled.jit import internal
from ..compiled.kernels import POWER, RESIDUAL
from ..compiled.views import imat, vec
from ..model.base import Name
from ..model.signals import INPUT_SIZE, Signal, evaluate_signal
from .base import ForceElement, Numbering, Row


@internal
def coordinate_load_kernel(job: int, t: float, b: Any) -> None:
    if job != RESIDUAL and job != POWER:
        return
    coord = imat(b.coord, b.count, 1)
    extra = imat(b.extra, b.count, 2)
    for e in range(b.count):
        i = coord[e, 0]
        f, _, _ = evaluate_signal(vec(b.signals, b.n_signals), vec(b.inputs, INPUT_SIZE * b.n_inputs), extra[e, 0], t)
        if job == RESIDUAL:
            vec(b.r, b.n_extended)[i] -= f
        else:
            vec(b.a, b.n_extended)[extra[e, 1]] += f * vec(b.v, b.n_extended)[i]


class CoordinateLoad(ForceElement):
    """Generalised force `load`(t) on coordinate `coordinate` of `body`: its power is load times the coordinate's rate.

    On x and y of a planar body a force in N, on its angle a torque in N m.
    """

    type: Literal["CoordinateLoad"] = "CoordinateLoad"
    symbol: ClassVar[str] = "load"
    kernel: ClassVar[Any] = coordinate_load_kernel

    body: Name
    """Name of the body."""
    coordinate: Name
    """"x", "y" or "angle" of a planar body, or the name of one of a LinearSystem's."""
    load: Signal
    """Over time, N or N m: it does work on the coordinate."""

    @property
    def linear(self) -> bool:
        return True

    def row(self, numbering: Numbering) -> Row:
        index = numbering.coordinate(self.body, self.coordinate)
        return Row((), (index,), (numbering.signal(self.load), numbering.work("input")))

    def moved_coordinates(self) -> Sequence[tuple[str, str]]:
        return ((self.body, self.coordinate),)

    def signals(self) -> Sequence[Signal]:
        return (self.load,)
