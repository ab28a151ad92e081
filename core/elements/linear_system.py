"""Linear system in generalised coordinates with constant matrices: r += M a + C v + K q - f.

Energies: kinetic v.M v / 2, strain q.K q / 2, potential -f.q; dissipated power v.C v.
"""

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.base import Name, Positive
from ..rounding import SYMMETRY
from .base import BodyElement, Form, Numbering, Row
from .coordinate import UNKNOWN_UNIT, Coordinate

Matrix = tuple[tuple[float, ...], ...]
Vector = tuple[float, ...]
PLANAR_UNITS = {"x": "m", "y": "m", "angle": "rad"}
"""Coordinates of these names mean the same everywhere."""


@internal
def linear_system_kernel(job: int, t: float, b: Any) -> None:
    n = b.ncoord
    square = n * n
    par = mat(b.par, b.count, b.npar)  # M, C, K row by row, f
    coord = imat(b.coord, b.count, n)
    q, v, a = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.a, b.n_extended)
    for e in range(b.count):
        if job == RESIDUAL:
            r = vec(b.r, b.n_extended)
            for i in range(n):
                total = -par[e, 3 * square + i]
                for j in range(n):
                    k, c = n * i + j, coord[e, j]
                    total += par[e, k] * a[c] + par[e, square + k] * v[c] + par[e, 2 * square + k] * q[c]
                r[coord[e, i]] += total
        elif job == TANGENT:
            values = vec(b.values, b.n_values)
            coef = vec(b.coef, 2)
            slot = imat(b.slot_s, b.count, square)
            for k in range(square):
                values[slot[e, k]] += par[e, k] + coef[1] * par[e, square + k] + coef[0] * par[e, 2 * square + k]
        elif job == ENERGY:
            energy = vec(b.energy, 3)
            for i in range(n):
                for j in range(n):
                    k, c, d = n * i + j, coord[e, i], coord[e, j]
                    energy[0] += 0.5 * par[e, k] * v[c] * v[d]
                    energy[2] += 0.5 * par[e, 2 * square + k] * q[c] * q[d]
                energy[1] -= par[e, 3 * square + i] * q[coord[e, i]]
        elif job == POWER:
            lost = 0.0
            for i in range(n):
                for j in range(n):
                    lost += par[e, square + n * i + j] * v[coord[e, i]] * v[coord[e, j]]
            a[imat(b.extra, b.count, 1)[e, 0]] += lost


class LinearSystem(BodyElement):
    """M q'' + C q' + K q = f in generalised coordinates: modes of a structure, a toy linearised about its rest, ...

    It has coordinates but no points, so no marker can be put on it: CoordinateDriver and CoordinateLoad act on its
    coordinates by name. The model's gravity does not act on it: weight belongs into `force`. Channels are
    `NAME.COORDINATE`, with `d_` and `dd_` before the coordinate for its rates.

    Raises
    ------
    ModelError : for sizes that do not fit, a mass or stiffness matrix that is not symmetric, or a mass matrix with a
        negative eigenvalue.
    """

    type: Literal["LinearSystem"] = "LinearSystem"
    kernel: ClassVar[Any] = linear_system_kernel

    coordinates: Annotated[tuple[Name, ...], Field(min_length=1)]
    """Names of the n coordinates. x and y are lengths and angle is an angle, as of any body."""
    mass: Matrix
    """M (n, n), symmetric."""
    damping: Matrix | None = None
    """C (n, n); its skew part (gyroscopic forces) does no work. Left out: none."""
    stiffness: Matrix | None = None
    """K (n, n), symmetric. Left out: none."""
    force: Vector | None = None
    """f (n,), constant. Left out: none."""
    position: Vector | None = None
    """Initial q (n,); left out: zero."""
    velocity: Vector | None = None
    """Initial q' (n,); left out: zero."""
    units: tuple[str, ...] | None = None
    """SI unit of each coordinate, e.g. "m" or "rad", "-" where it is left open; left out: "-" for all but x, y, angle.
    Absolute tolerances of angles are those that count for "rad"."""
    scales: tuple[Positive, ...] | None = None
    """Typical magnitude of each coordinate; left out: 1."""

    @model_validator(mode="after")
    def _check(self) -> "LinearSystem":
        n, names = len(self.coordinates), self.coordinates
        channels = [*names, *(f"d_{name}" for name in names), *(f"dd_{name}" for name in names)]
        twice = sorted({name for name in channels if channels.count(name) > 1})
        if twice:
            raise ValueError(f"coordinates of '{self.name}', with d_ and dd_ for their rates, need names of their own; "
                             f"used twice: {twice}")  # fmt: skip
        for name in ("mass", "damping", "stiffness"):
            value = getattr(self, name)
            if value is not None and (len(value) != n or any(len(row) != n for row in value)):
                raise ValueError(f"{name} of '{self.name}' has rows of lengths {[len(row) for row in value]}: {n} rows "
                                 f"of {n} numbers are needed, one for each of {list(names)}")  # fmt: skip
        for name in ("force", "position", "velocity", "units", "scales"):
            value = getattr(self, name)
            if value is not None and len(value) != n:
                raise ValueError(f"{name} of '{self.name}' has {len(value)} entries, needed is one for each of "
                                 f"{list(names)}")  # fmt: skip
        for coordinate, unit in zip(names, self.units or (), strict=False):
            if unit != PLANAR_UNITS.get(coordinate, unit):
                raise ValueError(f"coordinate '{coordinate}' of '{self.name}' is in {PLANAR_UNITS[coordinate]} "
                                 f"everywhere, not in {unit!r}: choose another name")  # fmt: skip
        for name in ("mass", "stiffness"):
            value = np.array(getattr(self, name) or np.zeros((n, n)))
            if np.abs(value - value.T).max() > SYMMETRY * np.abs(value).max():
                i, j = np.unravel_index(int(np.argmax(np.abs(value - value.T))), value.shape)
                raise ValueError(f"{name} of '{self.name}' must be symmetric, else it has no energy; entries ({i}, {j})"
                                 f" and ({j}, {i}) are {value[i, j]:g} and {value[j, i]:g}")  # fmt: skip
        least = np.linalg.eigvalsh(np.array(self.mass))
        if least[0] < -SYMMETRY * np.abs(least).max():
            raise ValueError(f"mass of '{self.name}' has the negative eigenvalue {least[0]:g}: no motion has negative "
                             "kinetic energy")  # fmt: skip
        return self

    @property
    def linear(self) -> bool:
        return True

    def form(self) -> Form:
        n = len(self.coordinates)
        return Form(type(self).kernel, 0, tuple((i, j) for i in range(n) for j in range(n)), ())

    def row(self, numbering: Numbering) -> Row:
        n = len(self.coordinates)
        matrices: list[NDArray[np.float64]] = [
            np.zeros((n, n)) if value is None else np.array(value)
            for value in (self.mass, self.damping, self.stiffness)
        ]
        parameters = (*(float(x) for matrix in matrices for x in matrix.flat), *(self.force or (0.0,) * n))
        return Row(parameters, numbering.coordinates(self.name), (numbering.work("dampers"),))

    def coordinate_records(self) -> Sequence[Coordinate]:
        n = len(self.coordinates)
        units = self.units or tuple(PLANAR_UNITS.get(name, UNKNOWN_UNIT) for name in self.coordinates)
        return tuple(
            Coordinate(name, unit, f"d_{name}", f"dd_{name}", scale)
            for name, unit, scale in zip(self.coordinates, units, self.scales or (1.0,) * n, strict=True)
        )

    def typical_mass(self) -> float:
        units = [c.unit for c in self.coordinate_records()]
        return max((row[i] for i, row in enumerate(self.mass) if units[i] == "m"), default=0.0)

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        zero = (0.0,) * len(self.coordinates)
        return self.position or zero, self.velocity or zero
