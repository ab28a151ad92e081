"""What a flexible body is to the others: named coordinates, and material points that move with them.

A new flexible body derives from `FlexibleBody` and says in `material_point` how a point of it moves. That is all that
`MaterialPoint2D`, and with it every joint, force, contact and output, needs to know of it. `drawn_points` tells which
of its points show it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from .base import BodyElement

CURVE = 40
"""Straight pieces that look like a curve."""


@dataclass(frozen=True)
class PointShape:
    """A material point as a function of its body's coordinates.

    With the floating frame (R, theta) and n local coordinates w: place p = R + A(theta) u with u = offset + shape w +
    second(w, w)/2, tangent of the body's axis A(theta) (tangent + slope w). Without a floating frame R = 0 and A = 1.
    """

    frame: tuple[str, str, str] | None
    """Names of the body's coordinates x, y, angle of its floating frame."""
    local: tuple[str, ...]
    """Names of the n local coordinates that move the point."""
    offset: tuple[float, float]
    """m."""
    tangent: tuple[float, float]
    shape: NDArray[np.float64]
    """(2, n)."""
    slope: NDArray[np.float64]
    """(2, n)."""
    second: NDArray[np.float64] | None = None
    """Displacement of second order (2, n, n), symmetric; None: none."""

    def local_place(self, local: NDArray[np.float64]) -> NDArray[np.float64]:
        """u (2, N) in the floating frame for local coordinates (N, n)."""
        u = np.asarray(self.offset)[:, None] + self.shape @ local.T
        return u if self.second is None else u + 0.5 * np.einsum("ckl,tk,tl->ct", self.second, local, local)

    def place(self, frame: Sequence[float], local: Sequence[float]) -> tuple[float, float, float]:
        """(x, y, angle of the tangent) for the frame's coordinates (x, y, angle) and the local ones (n,)."""
        w, turn = np.asarray(local, dtype=float), _rotation(frame[2])
        x, y = np.asarray(frame[:2]) + turn @ self.local_place(w[None, :])[:, 0]
        tx, ty = np.asarray(self.tangent) + self.slope @ w
        return float(x), float(y), float(frame[2] + np.arctan2(ty, tx))

    def rates(
        self, frame: Sequence[float], local: Sequence[float], frame_rates: Sequence[float], rates: Sequence[float]
    ) -> tuple[float, float, float]:
        """Rates of `place`."""
        w, dw, turn = np.asarray(local, dtype=float), np.asarray(rates, dtype=float), _rotation(frame[2])
        ux, uy = self.local_place(w[None, :])[:, 0]
        moved = self.shape @ dw + frame_rates[2] * np.array([-uy, ux])
        if self.second is not None:
            moved = moved + self.second @ dw @ w
        x, y = np.asarray(frame_rates[:2]) + turn @ moved
        tx, ty = np.asarray(self.tangent) + self.slope @ w
        dtx, dty = self.slope @ dw
        return float(x), float(y), float(frame_rates[2] + (tx * dty - ty * dtx) / (tx * tx + ty * ty))


@dataclass(frozen=True)
class Section:
    """What the cross-sections at some points do over time, each (N, points)."""

    axial_strain: NDArray[np.float64]
    """1."""
    curvature: NDArray[np.float64]
    """1/m."""
    axial_force: NDArray[np.float64]
    """N, tension positive."""
    bending_moment: NDArray[np.float64]
    """N m."""


class FlexibleBody(BodyElement):
    """Base of the flexible bodies."""

    def material_point(self, point: tuple[float, float]) -> PointShape:
        """How the material point at `point` (in the undeformed body, m) moves. Raises ModelError for a point outside
        the body."""
        raise NotImplementedError(f"{type(self).__name__} must say how its material points move")

    def drawn_points(self) -> Sequence[tuple[float, float]]:
        """Material points whose line shows its shape (in the undeformed body, m)."""
        raise NotImplementedError(f"{type(self).__name__} must say by which of its points it is drawn")

    def section(self, points: NDArray[np.float64], q: NDArray[np.float64], v: NDArray[np.float64]) -> Section:
        """Strains and internal forces at `points` (s along the undeformed axis, m), from the history of its coordinates
        and their rates, each (N, n) in the order of `coordinate_records`.

        Raises
        ------
        ModelError : for a point outside the body, or if it does not tell them.
        """
        raise ModelError(f"'{self.name}' is a {type(self).__name__}, which does not tell its internal forces")


def along_axis(length: float, pieces: int = CURVE) -> list[tuple[float, float]]:
    """Material points (s, 0), m, that divide an axis into equal pieces; as many as look like a curve if not told."""
    return [(float(s), 0.0) for s in np.linspace(0.0, length, pieces + 1)]


def _rotation(angle: float) -> NDArray[np.float64]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
