"""Rotations by Euler parameters p = (e0, e) inside kernels: vectors that turn with a body, and their derivatives by p.

A u = (e0^2 - e.e) u + 2 e (e.u) + 2 e0 e x u is quadratic in p, so B(p, u) = d(A u)/dp is linear in p, and with it
    A u = B(p, u) p / 2    (A u)' = B(p, u) p'    (A u)'' = B(p, u) p'' + B(p', u) p'
The second derivative of f . (A u) by p is a constant symmetric matrix, `bend(f, u)`. The angular velocity in the body
is w = 2 G p' with G(p) = [-e, e0 I - e~]. (Nikravesh, Computer-Aided Analysis of Mechanical Systems, 1988, chapter 6.)

Vectors are tuples of 3; matrices of 4 columns are tuples of these.
"""

from typing import Any

from ..compiled.jit import inlined, internal
from ..compiled.views import vec


@inlined
def dot(a: Any, b: Any) -> Any:
    """a . b"""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Any, b: Any) -> Any:
    """a x b"""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def less(a: Any, b: Any) -> Any:
    """a - b"""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def plus(a: Any, b: Any) -> Any:
    """a + b"""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def times(factor: float, a: Any) -> Any:
    """factor a"""
    return factor * a[0], factor * a[1], factor * a[2]


@inlined
def three(x: Any, coord: Any, first: int) -> Any:
    """x at three local coordinates from `first`."""
    return x[coord[first]], x[coord[first + 1]], x[coord[first + 2]]


@inlined
def four(x: Any, coord: Any, first: int, rest: float) -> Any:
    """x at four local coordinates from `first`; `rest` is added to the first: 1 for the Euler parameters of a frame
    that has none and does not turn, whose coordinates are all the place at rest."""
    return x[coord[first]] + rest, x[coord[first + 1]], x[coord[first + 2]], x[coord[first + 3]]


@internal
def turning(p: Any, u: Any) -> Any:
    """B(p, u) as its four columns."""
    e0, x, y, z = 2.0 * p[0], 2.0 * p[1], 2.0 * p[2], 2.0 * p[3]
    u0, u1, u2 = u[0], u[1], u[2]
    eu = x * u0 + y * u1 + z * u2
    return (
        (e0 * u0 + y * u2 - z * u1, e0 * u1 + z * u0 - x * u2, e0 * u2 + x * u1 - y * u0),
        (eu, y * u0 - x * u1 - e0 * u2, z * u0 - x * u2 + e0 * u1),
        (x * u1 - y * u0 + e0 * u2, eu, z * u1 - y * u2 - e0 * u0),
        (x * u2 - z * u0 - e0 * u1, y * u2 - z * u1 + e0 * u0, eu),
    )


@inlined
def along(columns: Any, x: Any) -> Any:
    """The matrix of these columns times the four numbers x."""
    a, b, c, d = columns
    return (
        a[0] * x[0] + b[0] * x[1] + c[0] * x[2] + d[0] * x[3],
        a[1] * x[0] + b[1] * x[1] + c[1] * x[2] + d[1] * x[3],
        a[2] * x[0] + b[2] * x[1] + c[2] * x[2] + d[2] * x[3],
    )


@inlined
def onto(columns: Any, f: Any) -> Any:
    """The transposed matrix of these columns times f: four numbers."""
    a, b, c, d = columns
    return dot(a, f), dot(b, f), dot(c, f), dot(d, f)


@inlined
def turned(columns: Any, p: Any) -> Any:
    """A u, from the columns of B(p, u)."""
    return times(0.5, along(columns, p))


@inlined
def space_axes(p: Any) -> Any:
    """E(p) = [-e, e0 I + e~] as its four columns: the angular velocity in space is 2 E p'."""
    return (
        (-p[1], -p[2], -p[3]),
        (p[0], p[3], -p[2]),
        (-p[3], p[0], p[1]),
        (p[2], -p[1], p[0]),
    )


@inlined
def add_lever(values: Any, slot: Any, first: int, factor: float, y: Any) -> None:
    """values += factor d(E(p)^T y)/dp = factor [[0, -y^T], [y, y~]] in the Euler parameters from `first`."""
    y0, y1, y2 = factor * y[0], factor * y[1], factor * y[2]
    values[slot[first, first + 1]] -= y0
    values[slot[first, first + 2]] -= y1
    values[slot[first, first + 3]] -= y2
    values[slot[first + 1, first]] += y0
    values[slot[first + 2, first]] += y1
    values[slot[first + 3, first]] += y2
    values[slot[first + 1, first + 2]] -= y2
    values[slot[first + 1, first + 3]] += y1
    values[slot[first + 2, first + 1]] += y2
    values[slot[first + 2, first + 3]] -= y0
    values[slot[first + 3, first + 1]] -= y1
    values[slot[first + 3, first + 2]] += y0


@internal
def bend(f: Any, u: Any) -> Any:
    """Second derivative of f . (A u) by p, its upper triangle row by row (10)."""
    fu = 2.0 * dot(f, u)
    c = cross(u, f)
    return (
        fu, 2.0 * c[0], 2.0 * c[1], 2.0 * c[2],
        4.0 * u[0] * f[0] - fu, 2.0 * (u[0] * f[1] + f[0] * u[1]), 2.0 * (u[0] * f[2] + f[0] * u[2]),
        4.0 * u[1] * f[1] - fu, 2.0 * (u[1] * f[2] + f[1] * u[2]),
        4.0 * u[2] * f[2] - fu,
    )  # fmt: skip


@inlined
def add_bend(values: Any, slot: Any, first: int, factor: float, f: Any, u: Any) -> None:
    """values[slot] += factor `bend(f, u)` in the rows and columns of the four local coordinates from `first`."""
    bent, k = bend(f, u), 0
    for i in range(4):
        for j in range(i, 4):
            values[slot[first + i, first + j]] += factor * bent[k]
            if i != j:
                values[slot[first + j, first + i]] += factor * bent[k]
            k += 1


@internal
def add_torque_bend(values: Any, slot: Any, y: Any, sign: float) -> None:
    """values[slot] += d(G^T y)/dp, or with sign -1 d(E^T y)/dp: [[0, -y^T], [y, -+y~]], in the rows and columns 3 to 6
    of the Euler parameters."""
    a, b, c = y
    values[slot[3, 4]] -= a
    values[slot[3, 5]] -= b
    values[slot[3, 6]] -= c
    values[slot[4, 3]] += a
    values[slot[5, 3]] += b
    values[slot[6, 3]] += c
    values[slot[4, 5]] += sign * c
    values[slot[4, 6]] -= sign * b
    values[slot[5, 4]] -= sign * c
    values[slot[5, 6]] += sign * a
    values[slot[6, 4]] += sign * b
    values[slot[6, 5]] -= sign * a


@inlined
def body_rate(p: Any, rate: Any) -> Any:
    """G(p) p', half the angular velocity in the body; and G(p) b for any b."""
    return (
        p[0] * rate[1] - p[1] * rate[0] - p[2] * rate[3] + p[3] * rate[2],
        p[0] * rate[2] - p[2] * rate[0] - p[3] * rate[1] + p[1] * rate[3],
        p[0] * rate[3] - p[3] * rate[0] - p[1] * rate[2] + p[2] * rate[1],
    )


@inlined
def space_rate(p: Any, rate: Any) -> Any:
    """E(p) p', half the angular velocity in space."""
    return (
        p[0] * rate[1] - p[1] * rate[0] + p[2] * rate[3] - p[3] * rate[2],
        p[0] * rate[2] - p[2] * rate[0] + p[3] * rate[1] - p[1] * rate[3],
        p[0] * rate[3] - p[3] * rate[0] + p[1] * rate[2] - p[2] * rate[1],
    )


@inlined
def of_body_torque(p: Any, n: Any) -> Any:
    """G(p)^T n: half the forces on the Euler parameters by a torque n in the body."""
    return (
        -p[1] * n[0] - p[2] * n[1] - p[3] * n[2],
        p[0] * n[0] + p[2] * n[2] - p[3] * n[1],
        p[0] * n[1] + p[3] * n[0] - p[1] * n[2],
        p[0] * n[2] + p[1] * n[1] - p[2] * n[0],
    )


@inlined
def body_axes(p: Any) -> Any:
    """G(p) as its four columns."""
    return (
        (-p[1], -p[2], -p[3]),
        (p[0], -p[3], p[2]),
        (p[3], p[0], -p[1]),
        (-p[2], p[1], p[0]),
    )


@inlined
def turns(b: Any, coord: Any, first: int, rest: float, u: Any) -> Any:
    """Columns of B(p, u), A u and its two rates, for the frame whose Euler parameters begin at `first`."""
    p = four(vec(b.q, b.n_extended), coord, first, rest)
    rate = four(vec(b.v, b.n_extended), coord, first, 0.0)
    second = four(vec(b.a, b.n_extended), coord, first, 0.0)
    columns = turning(p, u)
    curved = plus(along(columns, second), along(turning(rate, u), rate))
    return columns, turned(columns, p), along(columns, rate), curved


@inlined
def columns_at(b: Any, coord: Any, first: int, rest: float, u: Any) -> Any:
    """Columns of B(p, u), and A u."""
    p = four(vec(b.q, b.n_extended), coord, first, rest)
    columns = turning(p, u)
    return columns, turned(columns, p)


@inlined
def constant(par: Any, first: int) -> Any:
    """Three parameters from `first`, as a vector."""
    return par[first], par[first + 1], par[first + 2]
