"""Scalar measures of two markers, in the plane and in space, with one interface: what forces and friction act along.

A measure is a compiled function of the coordinates of both bodies that gives its value, gradient and Hessian, in
`measure2d.py` or `measure3d.py`. A new one needs a line in `measure_of` and one in the table of its kinds there.
"""

from typing import Any

from ..compiled.jit import internal
from .measure2d import PLANAR_ANGLE, measure2d
from .measure3d import measure


@internal
def measure_of(
    kind: int, q: Any, coord: Any, par: Any, about: float, gradient: Any, hessian: Any, bent: bool
) -> float:  # fmt: skip
    """The measure of this kind for coordinates (n,) and parameters of a pair of markers; its derivatives go into
    gradient (n,) and hessian (n, n), which may be left as it is unless `bent`. Of angles that differ by whole turns it
    is the one nearest to `about`, in space; planar bodies count turns."""
    if kind >= PLANAR_ANGLE:
        return measure2d(kind, q, coord, par, gradient, hessian, bent)
    return measure(kind, q, coord, par, about, gradient, hessian)


@internal
def add_force_tangent(
    values: Any, slot: Any, gradient: Any, hessian: Any, v: Any, coord: Any, force: float, by_value: float,
    by_rate: float,
) -> None:  # fmt: skip
    """Tangent of a force along a measure: values += force H + gradient (by_value gradient + by_rate H v)^T."""
    n = len(gradient)
    for j in range(n):
        change = 0.0
        for i in range(n):
            change += hessian[i, j] * v[coord[i]]
        right = by_value * gradient[j] + by_rate * change
        for i in range(n):
            values[slot[i, j]] += force * hessian[i, j] + gradient[i] * right
