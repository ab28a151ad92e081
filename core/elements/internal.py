"""Internal coordinates of elements: the unit mass that makes a state's rate an acceleration, r += a."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import ivec, vec


@internal
def internal_coordinates_kernel(job: int, t: float, b: Any) -> None:
    if job == RESIDUAL:
        a, r, coord = vec(b.a, b.n_extended), vec(b.r, b.n_extended), ivec(b.coord, b.count)
        for e in range(b.count):
            r[coord[e]] += a[coord[e]]
    elif job == TANGENT:
        values, slot = vec(b.values, b.n_values), ivec(b.slot_s, b.count)
        for e in range(b.count):
            values[slot[e]] += 1.0
