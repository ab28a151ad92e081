"""Base of the planar bodies in a floating frame: their invariants, as rows of the kernel's tables."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .base import Form, Numbering, Row
from .coordinate import Coordinate, X, Y
from .flexible_body import FlexibleBody, PointShape
from .floating_kernel2d import floating_body2d_kernel
from .planar_body import ANGLE_COORDINATE, PlanarBody

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Invariants:
    """What the equations of motion of a body with n modes need of it (see `floating_kernel2d`), SI units for amplitudes
    in m."""

    first_moment: Array
    """h0 = int u0 dm, (2,)."""
    inertia: float
    """J0 about the frame's origin, kg m^2."""
    a: Array
    """int u0.S dm, (n,)."""
    b: Array
    """int u0 x S dm, with the rotary inertia's part, (n,)."""
    H: Array
    """int S dm, (2, n)."""
    N: Array
    """int S^T S dm + int u0.g dm, (n, n)."""
    Gamma: Array
    """int S_k x S_l dm + int u0 x g_kl dm, (n, n)."""
    mass: Array
    """int S^T S dm and the rotary inertia, (n, n)."""
    stiffness: Array
    damping: Array
    G: Array
    """int g dm, (2, n, n)."""

    def mass_matrix(self, mass: float) -> Array:
        """Of the undeformed body at angle 0 in (x, y, angle, p), (3 + n, 3 + n)."""
        n = len(self.a)
        full = np.zeros((3 + n, 3 + n))
        full[0, 0] = full[1, 1] = mass
        full[2, :2] = -self.first_moment[1], self.first_moment[0]
        full[2, 2] = self.inertia
        full[3:, :2], full[3:, 2] = self.H.T, self.b
        full = full + np.tril(full, -1).T
        full[3:, 3:] = self.mass
        return full


class FloatingBody2D(PlanarBody, FlexibleBody):
    """Base of the bodies in a floating frame: coordinates x, y, angle of the frame, then the modal amplitudes.

    A marker on the body is one on its frame.
    """

    kernel: ClassVar[Any] = floating_body2d_kernel

    angle: float = 0.0
    """Initial angle of the frame, rad."""
    angular_velocity: float = 0.0
    """Initial angular velocity of the frame, rad/s."""
    amplitudes: tuple[float, ...] | None = None
    """Initial modal amplitudes; left out: zero."""
    amplitude_rates: tuple[float, ...] | None = None
    """Their initial rates, 1/s; left out: zero."""

    def invariants(self) -> Invariants:
        """Its invariants."""
        raise NotImplementedError(f"{type(self).__name__} must give its invariants")

    def mode_names(self) -> tuple[str, ...]:
        """Names of the amplitudes."""
        raise NotImplementedError(f"{type(self).__name__} must name its modes")

    def point_shape(self, offset: Array, shape: Array, slope: Array, second: Array | None = None) -> PointShape:
        """A point at `offset` (2,), moved by `shape` (2, n) and by `second` (2, n, n) in second order, on an axis along
        x whose tangent `slope` (2, n) turns."""
        place = (float(offset[0]), float(offset[1]))
        return PointShape(("x", "y", "angle"), self.mode_names(), place, (1.0, 0.0), shape, slope, second)

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (
            X,
            Y,
            ANGLE_COORDINATE,
            *(Coordinate(name, "m", f"d_{name}", f"dd_{name}") for name in self.mode_names()),
        )

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        zero = (0.0,) * len(self.mode_names())
        return (
            (*self.position, self.angle, *(self.amplitudes or zero)),
            (*self.velocity, self.angular_velocity, *(self.amplitude_rates or zero)),
        )

    def form(self) -> Form:
        n = 3 + len(self.mode_names())
        pattern = tuple((i, j) for i in range(n) for j in range(n) if (i, j) not in ((0, 1), (1, 0)))
        return Form(type(self).kernel, 0, pattern, ())

    def row(self, numbering: Numbering) -> Row:
        i = self.invariants()
        tables = (i.a, i.b, *i.H, i.N, i.Gamma, i.mass, i.stiffness, i.damping, *i.G)
        parameters = (
            self.mass,
            *i.first_moment,
            i.inertia,
            *numbering.gravity[:2],
            *(x for t in tables for x in t.flat),
        )
        indices = tuple(numbering.coordinate(self.name, name) for name in self.coordinate_names)
        return Row(tuple(float(x) for x in parameters), indices, (numbering.work("dampers"),))
