"""How two shapes in space slide on each other, whatever the coordinates of the second one are."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import vec
from ..model.rotation3d import dot, less, plus, times
from .cable_slip3d import add_cable_slip, slip_on_cable
from .moving_point3d import on_cable
from .normal3d import RADIUS_A, RADIUS_B
from .tangent3d import NORMAL, U, W, add_directions, product_with, tangent_motion


@internal
def slip_of_batch(kind: int, b: Any, par: Any, coord: Any, held: Any, moves: Any, work: Any) -> Any:
    """`tangent_motion` of an element with the parameters par at the current point of a batch."""
    if on_cable(kind):
        return slip_on_cable(kind, b, par, coord, held, moves, work)
    return tangent_motion(
        kind, vec(b.q, b.n_extended), vec(b.v, b.n_extended), coord, held, moves, par[RADIUS_A], par[RADIUS_B], work
    )


@internal
def add_slip(
    kind: int, b: Any, par: Any, values: Any, slot: Any, coord: Any, held: Any, moves: Any, work: Any, beta_a: Any,
    beta_b: Any, size: float, force: Any, factor: float,
) -> None:  # fmt: skip
    """values += factor d(W^T force)/dq, the force held."""
    if on_cable(kind):
        add_cable_slip(kind, b, par, values, slot, coord, held, moves, force, factor)
        return
    q = vec(b.q, b.n_extended)
    add_directions(kind, values, slot, q, coord, held, moves, work, beta_a, beta_b, size, force, factor)


@internal
def speed_rate(n: Any, n_rate: Any, u: Any, u_rate: Any) -> float:
    """Rate of the sliding speed |u_T|, u_T = u - n (n.u), m/s2; at rest that with which it begins."""
    across = dot(n, u)
    slide, rate = less(u, times(across, n)), less(u_rate, times(across, n_rate))
    speed = math.sqrt(dot(slide, slide))
    if speed > 0.0:
        return float(dot(slide, rate) / speed)
    begins = less(rate, times(dot(n, rate), n))
    return math.sqrt(dot(begins, begins))


@internal
def speed_rate_of_batch(b: Any, coord: Any, work: Any, n: Any, u: Any, more: Any) -> float:
    """The same of an element whose n, u and matrices `slip_of_batch` has given; more : u' less W a + U v."""
    v, a = vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    u_rate = plus(more, plus(product_with(work, W, a, coord), product_with(work, U, v, coord)))
    return float(speed_rate(n, product_with(work, NORMAL, v, coord), u, u_rate))
