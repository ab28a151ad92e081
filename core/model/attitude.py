"""Attitudes in space: where a frame's axes point, said in one of several ways, and their Euler parameters.

p = (e0, e1, e2, e3), a unit vector; the rotation matrix A(p) has the frame's axes as columns. p and -p mean the same.
Angles that a way is said by may be larger than half a turn; `turns` are these, which Euler parameters do not tell.
"""

import math
import re
from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ..rounding import NEARLY_PARALLEL
from .base import Record, Vector3

Vector4 = tuple[float, float, float, float]
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
Turn = tuple[Vector3, float]
"""Unit axis and angle, rad."""
SEQUENCE = re.compile(r"[xyz]{3}")


def product(p: Sequence[float], q: Sequence[float]) -> Vector4:
    """Euler parameters of the rotation q seen in a frame that is turned by p: A = A(p) A(q)."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
        p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
    )


def rotation_matrix(p: Sequence[float]) -> NDArray[np.float64]:
    """A(p) (3, 3) of Euler parameters p."""
    e0, e1, e2, e3 = p
    return np.array([
        [e0 * e0 + e1 * e1 - e2 * e2 - e3 * e3, 2.0 * (e1 * e2 - e0 * e3), 2.0 * (e1 * e3 + e0 * e2)],
        [2.0 * (e1 * e2 + e0 * e3), e0 * e0 - e1 * e1 + e2 * e2 - e3 * e3, 2.0 * (e2 * e3 - e0 * e1)],
        [2.0 * (e1 * e3 - e0 * e2), 2.0 * (e2 * e3 + e0 * e1), e0 * e0 - e1 * e1 - e2 * e2 + e3 * e3],
    ])  # fmt: skip


def parameters_of_matrix(matrix: NDArray[np.float64]) -> Vector4:
    """Euler parameters of a rotation matrix (3, 3), by the largest of them (Shepperd 1978, J. Guidance 1, 223)."""
    trace = float(np.trace(matrix))
    squares = np.array([trace, matrix[0, 0], matrix[1, 1], matrix[2, 2]])
    k = int(np.argmax(squares))
    lower = (matrix[2, 1], matrix[0, 2], matrix[1, 0])
    upper = (matrix[1, 2], matrix[2, 0], matrix[0, 1])
    if k == 0:
        e0 = 0.5 * math.sqrt(1.0 + trace)
        p = [e0, *((low - up) / (4.0 * e0) for low, up in zip(lower, upper, strict=True))]
    else:
        largest = 0.5 * math.sqrt(1.0 - trace + 2.0 * squares[k])
        p = [(lower[k - 1] - upper[k - 1]) / (4.0 * largest), 0.0, 0.0, 0.0]
        for i in range(3):
            p[i + 1] = largest if i == k - 1 else (matrix[i, k - 1] + matrix[k - 1, i]) / (4.0 * largest)
    return _unit(p)


def _unit(p: Sequence[float]) -> Vector4:
    size = math.sqrt(sum(x * x for x in p))
    return p[0] / size, p[1] / size, p[2] / size, p[3] / size


class EulerParameters(Record):
    """The attitude by its Euler parameters, the unit quaternion (e0, e1, e2, e3) with the scalar part first.

    They are brought to norm 1 once, here; during a run their norm is a constraint.
    """

    type: Literal["EulerParameters"] = "EulerParameters"
    values: Vector4 = (1.0, 0.0, 0.0, 0.0)
    """Scalar part first; of norm 1."""

    @model_validator(mode="after")
    def _check(self) -> "EulerParameters":
        if not math.hypot(*self.values) > 1e-100:
            raise ValueError(
                f"the Euler parameters {self.values} have norm 0, which is no rotation: give (1, 0, 0, 0) for none, "
                "or (cos(angle/2), sin(angle/2) times the unit axis)"
            )
        return self

    def parameters(self) -> Vector4:
        """Euler parameters of norm 1."""
        return _unit(self.values)

    def turns(self) -> Sequence[Turn]:
        """The turns that it is said by: none."""
        return ()


class RotationVector(Record):
    """The attitude by a turn about one axis: the vector's direction is the axis, its length the angle, rad."""

    type: Literal["RotationVector"] = "RotationVector"
    vector: Vector3
    """Axis times angle, rad."""

    def parameters(self) -> Vector4:
        """Euler parameters of norm 1."""
        angle = math.hypot(*self.vector)
        part = 0.5 if angle == 0.0 else math.sin(0.5 * angle) / angle
        return _unit((math.cos(0.5 * angle), *(part * x for x in self.vector)))

    def turns(self) -> Sequence[Turn]:
        """The turn that it is said by."""
        angle = math.hypot(*self.vector)
        if angle == 0.0:
            return ()
        x, y, z = self.vector
        return (((x / angle, y / angle, z / angle), angle),)


class AxisAngles(Record):
    """The attitude by three turns in a row, each about an axis of the frame as it is turned by then.

    "zxz" are Euler's angles (precession, nutation, spin), "zyx" yaw, pitch and roll, "xyz" Cardan's angles.
    """

    type: Literal["AxisAngles"] = "AxisAngles"
    sequence: Annotated[str, Field(json_schema_extra={"pattern": f"^{SEQUENCE.pattern}$"})] = "xyz"
    """Axes of the three turns."""
    angles: Vector3
    """rad."""

    @model_validator(mode="after")
    def _check(self) -> "AxisAngles":
        if not SEQUENCE.fullmatch(self.sequence):
            raise ValueError(
                f"sequence {self.sequence!r} must be three small letters out of x, y and z, one for each turn: 'zxz' "
                "(Euler's angles), 'xyz' (Cardan's), 'zyx' (yaw, pitch, roll) or any other without a letter twice "
                "running"
            )
        if self.sequence[0] == self.sequence[1] or self.sequence[1] == self.sequence[2]:
            raise ValueError(
                f"sequence '{self.sequence}' turns about one axis twice running, which is one turn: take another axis "
                "between, as in 'xyz' or 'zxz'"
            )
        return self

    def parameters(self) -> Vector4:
        """Euler parameters of norm 1."""
        p: Vector4 = (1.0, 0.0, 0.0, 0.0)
        for axis, angle in zip(self.sequence, self.angles, strict=True):
            x, y, z = (math.sin(0.5 * angle) * part for part in AXES[axis])
            p = product(p, (math.cos(0.5 * angle), x, y, z))
        return _unit(p)

    def turns(self) -> Sequence[Turn]:
        """The turns that it is said by, about axes of the frame around it."""
        p: Vector4 = (1.0, 0.0, 0.0, 0.0)
        found: list[Turn] = []
        for axis, angle in zip(self.sequence, self.angles, strict=True):
            x, y, z = (rotation_matrix(_unit(p)) @ AXES[axis]).tolist()
            found.append(((x, y, z), angle))
            u, v, w = (math.sin(0.5 * angle) * part for part in AXES[axis])
            p = product(p, (math.cos(0.5 * angle), u, v, w))
        return found


class Axes(Record):
    """The attitude by where its z axis points, and about where its x axis does: what is along z is taken off that.

    Without `x`, the frame is turned the shortest way that brings its z axis there (about x for half a turn).
    """

    type: Literal["Axes"] = "Axes"
    z: Vector3
    """A direction of any length."""
    x: Vector3 | None = None
    """Where the x axis points, about; left out: by the shortest turn of z."""

    @model_validator(mode="after")
    def _check(self) -> "Axes":
        size = math.hypot(*self.z)
        if not size > 1e-100:
            raise ValueError(f"z = {self.z} has no direction: give a vector that is not zero")
        if self.x is not None:
            other = math.hypot(*self.x)
            if not other > 1e-100:
                raise ValueError(f"x = {self.x} has no direction: give a vector that is not zero, or leave it out")
            if math.hypot(*np.cross(self.z, self.x)) <= NEARLY_PARALLEL * size * other:
                raise ValueError(f"x = {self.x} is parallel to z = {self.z}: give a direction across it")
        return self

    def parameters(self) -> Vector4:
        """Euler parameters of norm 1."""
        z = np.array(self.z) / math.hypot(*self.z)
        if self.x is None:
            # half way between both z axes lies the axis about which half a turn exchanges them
            if z[2] < -1.0 + NEARLY_PARALLEL:
                return 0.0, 1.0, 0.0, 0.0
            return _unit((1.0 + z[2], -z[1], z[0], 0.0))
        near = np.array(self.x)
        x = near - (near @ z) * z
        x /= np.linalg.norm(x)
        return parameters_of_matrix(np.stack([x, np.cross(z, x), z], axis=1))

    def turns(self) -> Sequence[Turn]:
        """The turns that it is said by: none."""
        return ()


Attitude = Annotated[EulerParameters | RotationVector | AxisAngles | Axes, Field(discriminator="type")]
"""Any of these."""
UPRIGHT = EulerParameters()
"""The axes of the frame around it."""
