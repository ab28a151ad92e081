"""Quaternions in compiled code: tuples of four, as parts of vectors too."""

from typing import Any

from ..compiled.jit import inlined, internal


@inlined
def four_of(x: Any, i: int) -> Any:
    return x[i], x[i + 1], x[i + 2], x[i + 3]


@inlined
def put_four(x: Any, i: int, y: Any) -> None:
    x[i], x[i + 1], x[i + 2], x[i + 3] = y


@inlined
def plus_times(a: Any, b: Any, factor: float) -> Any:
    """a + factor b"""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2], a[3] + factor * b[3]


@inlined
def conjugate(a: Any) -> Any:
    return a[0], -a[1], -a[2], -a[3]


@internal
def product(a: Any, b: Any) -> Any:
    """Of two quaternions."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
        a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1],
    )


@internal
def normalised(a: Any) -> Any:
    """a, a unit quaternion to rounding, with less of that. A factor near 1 would round to below it more often."""
    return plus_times(a, a, 0.5 * (1.0 - (a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + a[3] * a[3])))


@internal
def turned_by(f: Any, a: Any) -> Any:
    """f a f^-1 of a unit quaternion f."""
    return product(product(f, a), conjugate(f))
