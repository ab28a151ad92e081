"""Angular velocity of one body on another in space, w = w_b - w_a, and torques that go with it.

w_a = 2 E(p_a) p_a' (`space_axes`), along the axes of space. Coordinates are those of two frames, (14,) with the Euler
parameters from 3 and from 10 on; `pair` begins with the parameters of the markers' `rest` (`measure3d.columns_of`).
"""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..model.rotation3d import add_lever, along, four, less, onto, space_axes, times


@internal
def relative_spin(q: Any, v: Any, coord: Any, pair: Any) -> Any:
    """w of the second body on the first."""
    w_a = along(space_axes(four(q, coord, 3, pair[0])), four(v, coord, 3, 0.0))
    return times(2.0, less(along(space_axes(four(q, coord, 10, pair[1])), four(v, coord, 10, 0.0)), w_a))


@internal
def spin_by_coordinate(j: int, c_q: float, c_v: float, axes_a: Any, axes_b: Any, spin_a: Any, spin_b: Any) -> Any:
    """Derivative of w by coordinate j and its velocity: E(p) b = -E(b) p."""
    local = j % 7 - 3
    if local < 0:
        return (0.0, 0.0, 0.0)
    if j < 7:
        return less(times(2.0 * c_q, spin_a[local]), times(2.0 * c_v, axes_a[local]))
    return less(times(2.0 * c_v, axes_b[local]), times(2.0 * c_q, spin_b[local]))


@internal
def add_torque(b: Any, coord: Any, pair: Any, torque: Any) -> None:
    """A torque on the second body against the first, to the residual."""
    r, q = vec(b.r, b.n_extended), vec(b.q, b.n_extended)
    on_a, on_b = (
        onto(space_axes(four(q, coord, 3, pair[0])), torque),
        onto(space_axes(four(q, coord, 10, pair[1])), torque),
    )
    for i in range(4):
        r[coord[3 + i]] += 2.0 * on_a[i]
        r[coord[10 + i]] -= 2.0 * on_b[i]


@internal
def add_torque_by(b: Any, coord: Any, pair: Any, slot: Any, m: Any) -> None:
    """values[slot[j]] += derivative of the residual by f, the torque being f m: slot (14,)."""
    values, q = vec(b.values, b.n_values), vec(b.q, b.n_extended)
    on_a, on_b = onto(space_axes(four(q, coord, 3, pair[0])), m), onto(space_axes(four(q, coord, 10, pair[1])), m)
    for i in range(4):
        values[slot[3 + i]] += 2.0 * on_a[i]
        values[slot[10 + i]] -= 2.0 * on_b[i]


@internal
def add_torque_tangent(b: Any, coord: Any, pair: Any, slot: Any, torque: Any) -> None:
    """values += derivative of the residual with this torque on the second body, the torque held."""
    values, c_q = vec(b.values, b.n_values), vec(b.coef, 2)[0]
    add_lever(values, slot, 3, 2.0 * c_q, torque)
    add_lever(values, slot, 10, -2.0 * c_q, torque)


@internal
def add_torque_change(values: Any, slot: Any, j: int, axes_a: Any, axes_b: Any, change: Any) -> None:
    """values += derivative of the residual by coordinate j, by which the torque on the second body changes so."""
    on_a, on_b = onto(axes_a, change), onto(axes_b, change)
    for i in range(4):
        values[slot[3 + i, j]] += 2.0 * on_a[i]
        values[slot[10 + i, j]] -= 2.0 * on_b[i]
