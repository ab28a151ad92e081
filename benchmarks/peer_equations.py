"""Planar mechanisms as a DAE in absolute coordinates, compiled, for general DAE solvers.

y = (q, v, lambda, mu), n + n + m + m entries, stabilised after Gear, Gupta and Leimkuhler (1985):
  q' - v + G^T mu = 0,  M v' - Q(q) + G^T lambda = 0,  G v = 0,  g(q) = 0                                  (index 2)
With `index=1` the multipliers are derivatives, y = (q, v, L, U), L' = lambda, U' = mu: "stabilised index 1"
(Anantharaman and Hiller 1991). It shares nothing with the solver: neither kernels nor tangents.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from tlismni.core import Bushing2D, Model, Prismatic2D, Revolute2D, RigidBody2D

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mechanism:
    """What the equations need of a model; bodies are numbered, -1 is the ground."""

    mass: Array
    """(n,) kg, kg m^2."""
    force: Array
    """(n,) weights, N, N m."""
    pins: Array
    """(p, 6): bodies a and b, points on a and b, m."""
    held: Array
    """(f, 2): coordinate and its value."""
    bushings: Array
    """(s, 7): bodies a and b, points on a and b, stiffness N/m."""
    q0: Array
    v0: Array

    @property
    def n(self) -> int:
        return len(self.mass)

    @property
    def m(self) -> int:
        return 2 * len(self.pins) + len(self.held)


def mechanism(model: Model) -> Mechanism:
    """Read the tables off a model. Raises ValueError for an element that is not provided for."""
    number = {body.name: k for k, body in enumerate(model.bodies)}
    mass: list[float] = []
    for body in model.bodies:
        if not isinstance(body, RigidBody2D):
            raise ValueError(f"body '{body.name}' is a {type(body).__name__}; only RigidBody2D is provided for")
        mass += [body.mass, body.mass, body.inertia]
    gravity = np.tile([*model.gravity[:2], 0.0], len(model.bodies))
    start = [body.initial_state() for body in model.bodies]
    pins, held, bushings = [], [], []
    for element in (*model.joints, *model.forces):
        if isinstance(element, Revolute2D | Bushing2D):
            ends = [number.get(element.a.body, -1), number.get(element.b.body, -1), *element.a.point, *element.b.point]
            if isinstance(element, Revolute2D):
                pins.append(ends)
                continue
            if element.damping or element.rotational_stiffness or element.rotational_damping:
                raise ValueError(f"bushing '{element.name}' may have a stiffness only")
            bushings.append([*ends, element.stiffness])
        elif isinstance(element, Prismatic2D) and element.a.body == "ground" and element.a.angle == 0.0:
            if element.b.point != (0.0, 0.0):
                raise ValueError(f"joint '{element.name}' must guide the centre of mass")
            k = number[element.b.body]
            held += [[3 * k + 1, element.a.point[1]], [3 * k + 2, start[k][0][2]]]
        else:
            raise ValueError(f"element '{element.name}' ({type(element).__name__}) is not provided for")
    weights = np.array(mass) * gravity
    q0, v0 = (np.concatenate([s[i] for s in start]) for i in range(2))
    tables = [np.array(table, float).reshape(len(table), width) for table, width in
              ((pins, 6), (held, 2), (bushings, 7))]  # fmt: skip
    return Mechanism(np.array(mass), weights, *tables, q0, v0)


@dataclass(frozen=True)
class Equations:
    """The DAE of a mechanism, compiled, with consistent initial values."""

    n: int
    m: int
    index: int
    residual: Callable[..., None]
    """residual(y, yp, out)."""
    entries: Callable[..., int]
    """entries(y, yp, rows, columns, of_derivative, values): triplets of dF/dy (0) and dF/dy' (1); returns how many."""
    y0: Array
    yp0: Array

    @property
    def size(self) -> int:
        return 2 * (self.n + self.m)

    def triplets(self, y: Array, yp: Array) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], Array]:
        """(rows, columns, of_derivative, values) at a point."""
        rows, columns, kinds = (np.zeros(self.most, np.int64) for _ in range(3))
        values = np.zeros(self.most)
        count = self.entries(y, yp, rows, columns, kinds, values)
        return rows[:count], columns[:count], kinds[:count], values[:count]

    @property
    def most(self) -> int:
        """Bound of the number of triplets."""
        return 5 * self.n + 40 * self.m + 200


@njit
def _arm(q: Any, body: int, x: float, y: float) -> Any:
    """Offset R u of a point from the centre of mass and its position."""
    if body < 0:
        return 0.0, 0.0, x, y
    c, s = np.cos(q[3 * body + 2]), np.sin(q[3 * body + 2])
    rx, ry = c * x - s * y, s * x + c * y
    return rx, ry, q[3 * body] + rx, q[3 * body + 1] + ry


@njit
def _moved(local: int, rx: float, ry: float) -> Any:
    """How a point at offset (rx, ry) moves with coordinate `local` (0 x, 1 y, 2 angle) of its body."""
    if local == 2:
        return -ry, rx
    return (1.0, 0.0) if local == 0 else (0.0, 1.0)


def _residual(data: Mechanism, index: int) -> Callable[..., None]:
    mass, force, pins, held, bushings = data.mass, data.force, data.pins, data.held, data.bushings
    n, m = data.n, data.m

    @njit
    def residual(y: Any, yp: Any, out: Any) -> None:
        q, v = y[:n], y[n : 2 * n]
        multipliers = y[2 * n :] if index == 2 else yp[2 * n :]
        for i in range(n):
            out[i] = yp[i] - v[i]
            out[n + i] = mass[i] * yp[n + i] - force[i]
        row = 0
        for k in range(len(pins)):
            for side in range(2):
                body = int(pins[k, side])
                sign = 1.0 - 2.0 * side
                rx, ry, px, py = _arm(q, body, pins[k, 2 + 2 * side], pins[k, 3 + 2 * side])
                if side == 0:
                    for level in range(2 * n, 2 * n + 2 * m, m):
                        out[level + row], out[level + row + 1] = 0.0, 0.0
                out[2 * n + m + row] += sign * px
                out[2 * n + m + row + 1] += sign * py
                if body < 0:
                    continue
                x = 3 * body
                out[2 * n + row] += sign * (v[x] - ry * v[x + 2])
                out[2 * n + row + 1] += sign * (v[x + 1] + rx * v[x + 2])
                for level in range(2):  # mu acts on q', lambda on v'
                    wx, wy = multipliers[(1 - level) * m + row], multipliers[(1 - level) * m + row + 1]
                    out[level * n + x] += sign * wx
                    out[level * n + x + 1] += sign * wy
                    out[level * n + x + 2] += sign * (rx * wy - ry * wx)
            row += 2
        for k in range(len(held)):
            i = int(held[k, 0])
            out[2 * n + row] = v[i]
            out[2 * n + m + row] = q[i] - held[k, 1]
            out[i] += multipliers[m + row]
            out[n + i] += multipliers[row]
            row += 1
        for k in range(len(bushings)):
            a, b = int(bushings[k, 0]), int(bushings[k, 1])
            ax, ay, pax, pay = _arm(q, a, bushings[k, 2], bushings[k, 3])
            bx, by, pbx, pby = _arm(q, b, bushings[k, 4], bushings[k, 5])
            fx, fy = bushings[k, 6] * (pbx - pax), bushings[k, 6] * (pby - pay)
            if a >= 0:
                out[n + 3 * a] -= fx
                out[n + 3 * a + 1] -= fy
                out[n + 3 * a + 2] -= ax * fy - ay * fx
            if b >= 0:
                out[n + 3 * b] += fx
                out[n + 3 * b + 1] += fy
                out[n + 3 * b + 2] += bx * fy - by * fx

    return residual


def _entries(data: Mechanism, index: int) -> Callable[..., int]:
    mass, pins, held, bushings = data.mass, data.pins, data.held, data.bushings
    n, m = data.n, data.m
    of_multipliers = 0 if index == 2 else 1

    @njit
    def add(at: int, tables: Any, row: int, column: int, kind: int, value: float) -> int:
        rows, columns, kinds, values = tables
        rows[at], columns[at], kinds[at], values[at] = row, column, kind, value
        return at + 1

    @njit
    def entries(y: Any, yp: Any, rows: Any, columns: Any, kinds: Any, values: Any) -> int:
        tables = (rows, columns, kinds, values)
        q, v = y[:n], y[n : 2 * n]
        multipliers = y[2 * n :] if index == 2 else yp[2 * n :]
        at = 0
        for i in range(n):
            at = add(at, tables, i, i, 1, 1.0)
            at = add(at, tables, i, n + i, 0, -1.0)
            at = add(at, tables, n + i, n + i, 1, mass[i])
        row = 0
        for k in range(len(pins)):
            for side in range(2):
                body = int(pins[k, side])
                if body < 0:
                    continue
                sign = 1.0 - 2.0 * side
                rx, ry, _, _ = _arm(q, body, pins[k, 2 + 2 * side], pins[k, 3 + 2 * side])
                x = 3 * body
                for axis in range(2):
                    arm = rx if axis else -ry
                    for column, value in ((x + axis, sign), (x + 2, sign * arm)):
                        at = add(at, tables, 2 * n + row + axis, n + column, 0, value)
                        at = add(at, tables, 2 * n + m + row + axis, column, 0, value)
                        at = add(at, tables, column, 2 * n + m + row + axis, of_multipliers, value)
                        at = add(at, tables, n + column, 2 * n + row + axis, of_multipliers, value)
                    second = ry if axis else rx
                    at = add(at, tables, 2 * n + row + axis, x + 2, 0, -sign * second * v[x + 2])
                for level in range(2):
                    wx, wy = multipliers[(1 - level) * m + row], multipliers[(1 - level) * m + row + 1]
                    at = add(at, tables, level * n + x + 2, x + 2, 0, -sign * (rx * wx + ry * wy))
            row += 2
        for k in range(len(held)):
            i = int(held[k, 0])
            at = add(at, tables, 2 * n + row, n + i, 0, 1.0)
            at = add(at, tables, 2 * n + m + row, i, 0, 1.0)
            at = add(at, tables, i, 2 * n + m + row, of_multipliers, 1.0)
            at = add(at, tables, n + i, 2 * n + row, of_multipliers, 1.0)
            row += 1
        for e in range(len(bushings)):
            a, b, stiffness = int(bushings[e, 0]), int(bushings[e, 1]), bushings[e, 6]
            ax, ay, pax, pay = _arm(q, a, bushings[e, 2], bushings[e, 3])
            bx, by, pbx, pby = _arm(q, b, bushings[e, 4], bushings[e, 5])
            dx, dy = pbx - pax, pby - pay
            # the force on b is -stiffness (dx, dy)
            for i in range(6):
                bi, rix, riy = (b, bx, by) if i >= 3 else (a, ax, ay)
                if bi < 0:
                    continue
                si = 1.0 if i >= 3 else -1.0
                jix, jiy = _moved(i % 3, rix, riy)
                for j in range(6):
                    bj, rjx, rjy = (b, bx, by) if j >= 3 else (a, ax, ay)
                    if bj < 0:
                        continue
                    sj = 1.0 if j >= 3 else -1.0
                    jjx, jjy = _moved(j % 3, rjx, rjy)
                    value = si * sj * (jix * jjx + jiy * jjy)
                    if i == j and i % 3 == 2:
                        value -= si * (rix * dx + riy * dy)
                    at = add(at, tables, n + 3 * bi + i % 3, 3 * bj + j % 3, 0, stiffness * value)
        return at

    return entries


def equations(model: Model, index: int) -> Equations:
    """The DAE of `model` with index 1 or 2, with consistent accelerations and multipliers at the start."""
    data = mechanism(model)
    n, m = data.n, data.m
    residual, entries = _residual(data, index), _entries(data, index)
    y, yp = np.concatenate((data.q0, data.v0, np.zeros(2 * m))), np.zeros(2 * (n + m))
    yp[:n] = data.v0
    found = Equations(n, m, index, residual, entries, y, yp)
    rows, columns, kinds, values = found.triplets(y, yp)
    jacobian = np.zeros((2, found.size, found.size))
    np.add.at(jacobian, (kinds, rows, columns), values)
    # M a + G^T lambda = Q,  G a = -(G v)_q v
    system = np.zeros((n + m, n + m))
    G = jacobian[0, 2 * n : 2 * n + m, n : 2 * n]
    system[:n, :n], system[:n, n:], system[n:, :n] = np.diag(data.mass), G.T, G
    out = np.zeros(found.size)
    residual(y, yp, out)
    solution = np.linalg.solve(system, np.concatenate((-out[n : 2 * n], -jacobian[0, 2 * n : 2 * n + m, :n] @ data.v0)))
    yp[n : 2 * n] = solution[:n]
    (y if index == 2 else yp)[2 * n : 2 * n + m] = solution[n:]
    return found
