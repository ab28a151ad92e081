"""A planar body in a floating frame whose reduced matrices are given: from a finite element programme, say."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from ..errors import ModelError
from ..model.base import Positive, Record, Vector2
from ..rounding import ON_NODE, SAME_PLACE
from .flexible_body import PointShape
from .floating_body2d import Array, FloatingBody2D, Invariants
from .linear_system import Matrix, Vector
from .reduced_checks import check_mass, check_sign, check_size, check_symmetry


class ReducedPoint(Record):
    """A point of a reduced body to which something can be attached."""

    point: Vector2
    """Undeformed position in the frame, m."""
    shape: Matrix
    """Displacement for unit amplitudes, (2, n)."""
    rotation: Vector | None = None
    """Rotation for unit amplitudes, (n,), rad; left out: none."""


class ReducedBody2D(FloatingBody2D):
    """A flexible planar body as reduced matrices over n modes: r = R + A(theta) (u0 + S p).

    Coordinates are those of the frame, `x`, `y`, `angle`, and the amplitudes `mode1` ... `moden`. The integrals are
    over the mass of the undeformed body, with u0 from the frame's origin; u x v = u_x v_y - u_y v_x. The model's
    gravity acts on it. A rigid motion has no place among the modes: the frame has it already. Its points have no term
    of second order: loads at them do not stiffen the body, unlike its inertia with the geometric integrals.

    Raises
    ------
    ModelError : for sizes that do not fit, matrices that are not symmetric (skew for `gyroscopic`), a mass matrix of
        frame and modes that is not positive definite, or stiffness or damping with a negative eigenvalue.
    """

    type: Literal["ReducedBody2D"] = "ReducedBody2D"

    inertia: Positive
    """int u0.u0 dm, kg m^2, about the frame's origin."""
    first_moment: Vector2 = (0.0, 0.0)
    """int u0 dm, kg m."""
    modal_mass: Annotated[Matrix, Field(min_length=1)]
    """int S^T S dm, (n, n), with rotary inertia if it counts."""
    centrifugal_mass: Matrix | None = None
    """int S^T S dm without rotary inertia, (n, n); left out: modal_mass."""
    stiffness: Matrix
    """(n, n), symmetric, without negative eigenvalues."""
    damping: Matrix | None = None
    """(n, n); its symmetric part without negative eigenvalues; left out: none."""
    modal_first_moment: Matrix | None = None
    """int S dm, (2, n); left out: zero."""
    modal_inertia: Vector | None = None
    """int u0.S dm, (n,); left out: zero."""
    modal_coupling: Vector | None = None
    """int u0 x S dm, (n,); left out: zero."""
    gyroscopic: Matrix | None = None
    """int S_k x S_l dm, (n, n), skew; left out: zero, as where all points move along parallel lines."""
    geometric_first_moment: tuple[Matrix, Matrix] | None = None
    """int g_kl dm, x and y, each (n, n), of the second-order displacement g_kl p_k p_l / 2; left out: no stiffening."""
    geometric_inertia: Matrix | None = None
    """int u0.g_kl dm, (n, n); left out: zero."""
    geometric_coupling: Matrix | None = None
    """int u0 x g_kl dm, (n, n); left out: zero."""
    points: tuple[ReducedPoint, ...] = ()
    """Points to which joints and contacts can be attached by a MaterialPoint2D."""

    @model_validator(mode="after")
    def _check(self) -> "ReducedBody2D":
        n = len(self.modal_mass)
        square, row = (n, n), (n,)
        sizes: dict[str, tuple[int, ...]] = {
            "modal_mass": square, "centrifugal_mass": square, "stiffness": square, "damping": square,
            "modal_first_moment": (2, n), "modal_inertia": row, "modal_coupling": row, "gyroscopic": square,
            "geometric_first_moment": (2, n, n), "geometric_inertia": square, "geometric_coupling": square,
            "amplitudes": row, "amplitude_rates": row,
        }  # fmt: skip
        rows = f"modal_mass has n = {n}"
        for name, size in sizes.items():
            check_size(self.name, name, getattr(self, name), size, rows)
        for point in self.points:
            check_size(self.name, f"shape of the point {point.point}", point.shape, (2, n), rows)
            check_size(self.name, f"rotation of the point {point.point}", point.rotation, row, rows)
        symmetric = ("modal_mass", "centrifugal_mass", "stiffness", "geometric_inertia", "geometric_coupling")
        for name in symmetric:
            check_symmetry(self.name, name, getattr(self, name))
        for table in self.geometric_first_moment or ():
            check_symmetry(self.name, "geometric_first_moment", table)
        check_symmetry(self.name, "gyroscopic", self.gyroscopic, -1.0)
        check_mass(self.name, self.invariants().mass_matrix(self.mass))
        check_sign(self.name, "stiffness", self.stiffness, "no strain has negative energy")
        check_sign(self.name, "damping", self.damping, "it would put energy in")
        return self

    def mode_names(self) -> tuple[str, ...]:
        return tuple(f"mode{k + 1}" for k in range(len(self.modal_mass)))

    def invariants(self) -> Invariants:
        n = len(self.modal_mass)
        mass = np.array(self.modal_mass)
        translational = mass if self.centrifugal_mass is None else np.array(self.centrifugal_mass)
        return Invariants(
            first_moment=np.array(self.first_moment),
            inertia=self.inertia,
            a=_or_zero(self.modal_inertia, (n,)),
            b=_or_zero(self.modal_coupling, (n,)),
            H=_or_zero(self.modal_first_moment, (2, n)),
            N=translational + _or_zero(self.geometric_inertia, (n, n)),
            Gamma=_or_zero(self.gyroscopic, (n, n)) + _or_zero(self.geometric_coupling, (n, n)),
            mass=mass,
            stiffness=np.array(self.stiffness),
            damping=_or_zero(self.damping, (n, n)),
            G=_or_zero(self.geometric_first_moment, (2, n, n)),
        )

    def material_point(self, point: Vector2) -> PointShape:
        size = max((abs(x) for given in self.points for x in given.point), default=0.0)
        for given in self.points:
            if np.allclose(given.point, point, rtol=ON_NODE, atol=SAME_PLACE * size):
                n = len(self.modal_mass)
                turn = np.vstack([np.zeros(n), _or_zero(given.rotation, (n,))])
                return self.point_shape(np.array(given.point), np.array(given.shape), turn)
        raise ModelError(
            f"'{self.name}' has no point {tuple(point)}; `points` gives {[given.point for given in self.points]}"
        )

    def drawn_points(self) -> Sequence[tuple[float, float]]:
        return [given.point for given in self.points]


def _or_zero(value: Sequence[Any] | None, shape: tuple[int, ...]) -> Array:
    return np.zeros(shape) if value is None else np.array(value, dtype=float)
