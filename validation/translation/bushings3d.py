"""Bushings in space: an ObjectGenericODE2 that shares the bodies' nodes, with the generalised force as user function.

exudyn's ObjectConnectorRigidBodySpringDamper is another law: its angles are Tait-Bryan angles (or a rotation vector,
between half-way frames), ours 2 sin(angle/2) about the axis of turning; and its force on a, at a's point, leaves out
the moment that balances the one on b. Both differ by the square of the deflections, so that it is not taken.
"""

from collections.abc import Sequence
from operator import add, mul

import numpy as np

from ...core.elements import Bushing3D
from ...core.elements.measure3d import Pair3D
from ...core.model.markers import Marker3D
from .registry import Build, translates
from .space_contacts import End, Vector, check_bodies, cross, dot, plus, vector
from .user_gaps import Nodes, Numbers

Quaternion = tuple[float, float, float, float]


@translates(Bushing3D)
def bushing(record: Bushing3D, build: Build) -> None:
    """Forces of K z and of C u, u the rates of the places and the angular velocity, along and about the axes of a."""
    check_bodies(record, build)
    nodes = Nodes(build, (record.a.body, record.b.body))
    if not nodes.nodes:
        return  # between two markers on the ground nothing moves
    deflection = Deflection(build, record, nodes)
    stiffness, damping = (_matrix(given) for given in (record.stiffness, record.damping))

    def force(mbs: object, t: float, item: int, q: Numbers, v: Numbers) -> list[float]:
        z, rows, spins = deflection(list(map(add, nodes.reference, q)))
        rates = np.array([sum(map(mul, row, v)) for row in spins])
        load = stiffness @ np.array(z) @ np.array(rows) + damping @ rates @ np.array(spins)
        return [float(x) for x in -load]

    build.add("ObjectGenericODE2", nodeNumbers=list(nodes.nodes), forceUserFunction=force)
    build.notes.append(f"{record.name}: a user function; exudyn's own connector has other angles")


def _matrix(given: Sequence[object]) -> np.ndarray:
    array = np.array(given, dtype=float)
    return np.diag(array) if array.ndim == 1 else array


class Deflection:
    """(s, f) of marker b seen from a: places, m, and 2 sin(angle/2) about the axis of turning, along the axes of a."""

    def __init__(self, build: Build, record: Pair3D, nodes: Nodes) -> None:
        self.a, self.b = End(build, record.a, nodes), End(build, record.b, nodes)
        self.axes: list[Vector] = [vector(axis) for axis in record.a.axes().T]
        self.turns = _attitude(record.a), _attitude(record.b)
        e0 = self._turned(nodes.reference)[0]
        self.sign = 1.0 if e0 >= 0.0 else -1.0

    def __call__(self, x: Numbers) -> tuple[list[float], list[list[float]], list[list[float]]]:
        """(z (6,), what z' and u are of the rates (6, n))."""
        z: list[float] = []
        rows: list[list[float]] = []
        spins: list[list[float]] = []
        axes = [self.a.turned(x, axis) for axis in self.axes]
        place = self.b.place(x)
        way = plus(place, self.a.place(x), -1.0)
        for axis in axes:
            row = [0.0] * len(x)
            # matter of a at the place of b says how the axis turns
            self.b.add(row, x, axis, place, 1.0)
            self.a.add(row, x, axis, place, -1.0)
            z.append(dot(axis, way))
            rows.append(row)
            spins.append(row)
        e0, *e = (self.sign * value for value in self._turned(x))
        for k in range(3):
            # f' = e0 w + w x e along the axes of a, with w the rate of turning of b seen from a
            unit = vector(np.eye(3)[k])
            mix = plus(cross(vector(e), unit), unit, e0)
            about = plus(plus(plus((0.0, 0.0, 0.0), axes[0], mix[0]), axes[1], mix[1]), axes[2], mix[2])
            z.append(2.0 * e[k])
            rows.append(self._turning(x, about))
            spins.append(self._turning(x, axes[k]))
        return z, rows, spins

    def _turning(self, x: Numbers, axis: Vector) -> list[float]:
        """What the rate of turning of b seen from a is of the rates, about an axis in space."""
        row = [0.0] * len(x)
        self.b.add_turn(row, x, axis, 1.0)
        self.a.add_turn(row, x, axis, -1.0)
        return row

    def _turned(self, x: Numbers) -> Quaternion:
        """Euler parameters of b seen from a."""
        of_a, of_b = (_product(_of_body(end, x), own) for end, own in zip((self.a, self.b), self.turns, strict=True))
        return _product((of_a[0], -of_a[1], -of_a[2], -of_a[3]), of_b)


def _of_body(end: End, x: Numbers) -> Quaternion:
    if not end.turns:
        return 1.0, 0.0, 0.0, 0.0
    e0, e1, e2, e3 = (x[k] for k in end.at[3:])
    return e0, e1, e2, e3


def _attitude(marker: Marker3D) -> Quaternion:
    e0, e1, e2, e3 = (float(value) for value in marker.attitude.parameters())
    return e0, e1, e2, e3


def _product(p: Quaternion, q: Quaternion) -> Quaternion:
    scalar = p[0] * q[0] - dot(p[1:], q[1:])
    mixed = plus(plus(cross(p[1:], q[1:]), q[1:], p[0]), p[1:], q[0])
    return scalar, *mixed
