"""Planar contact: a gap function between two shapes, and a law.

The gap's value, rate and acceleration always stand in phi, phid and phidd of the contact's row; only a closed
contact makes them part of the constraints. A contact that acts as a force adds -F dg/dq to r.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..elements.base import Element, Numbering, Row
from ..elements.geometry2d import (
    FULL_PATTERN,
    HESSIAN_PAIRS,
    ROW_PATTERN,
    add_hessian,
    along,
    constrain,
    curvature,
    distance,
    height_over_line,
)
from ..model.base import NonNegative, Record
from ..model.markers import Marker2D
from .laws import ContactLaw, ForceLaw, call_law
from .modes import ACTIVE, APPROACH_SPEED, CLOSED, MEMORY_SIZE, MODE


@internal
def _add_force(b: Any, job: int, e: int, k: int, g: float, gradient: Any, hessian: Any) -> None:
    """The force law of element e, contact k: what it adds for `job`."""
    coord = imat(b.coord, b.count, 6)[e]
    par = mat(b.par, b.count, 11)
    extra = imat(b.extra, b.count, 5)
    v = vec(b.v, b.n_extended)
    memory = mat(b.memory, b.n_memory, MEMORY_SIZE)
    rate = along(gradient, v, coord)
    f, f_d, f_dd, elastic, energy = call_law(
        extra[e, 1], max(-g, 0.0), -rate, memory[k, APPROACH_SPEED], par[e, 7], par[e, 8], par[e, 9], par[e, 10]
    )
    active = memory[k, MODE] == ACTIVE
    if job == RESIDUAL:
        vec(b.monitor, b.n_monitor)[k] = f
        if active:
            r = vec(b.r, b.n_extended)
            for i in range(6):
                r[coord[i]] -= f * gradient[i]
    elif active and job == TANGENT:
        values = vec(b.values, b.n_values)
        coef = vec(b.coef, 2)
        slot = imat(b.slot_s, b.count, 36)[e]
        add_hessian(values, slot, hessian, -coef[0] * f)
        for i in range(6):
            for j in range(6):
                values[slot[6 * i + j]] += (coef[0] * f_d + coef[1] * f_dd) * gradient[i] * gradient[j]
        for m in range(21):
            i, j = HESSIAN_PAIRS[m, 0], HESSIAN_PAIRS[m, 1]
            for p in range(6):
                values[slot[6 * p + j]] += coef[0] * f_dd * gradient[p] * hessian[m] * v[coord[i]]
                if i != j:
                    values[slot[6 * p + i]] += coef[0] * f_dd * gradient[p] * hessian[m] * v[coord[j]]
    elif active and job == ENERGY:
        vec(b.energy, 3)[2] += energy
    elif active and job == POWER:
        a = vec(b.a, b.n_extended)
        a[extra[e, 2]] += f
        a[extra[e, 3]] += (elastic - f) * rate


@internal
def _act(b: Any, job: int, e: int, g: float, gradient: Any, hessian: Any) -> None:
    """What element e of a batch of contacts adds for `job`, given its gap."""
    row = imat(b.row, b.count, 1)[e, 0]
    k = imat(b.extra, b.count, 5)[e, 0]
    force_law = imat(b.extra, b.count, 5)[e, 1] != 0
    lam = vec(b.lam, b.m_extended)
    closed = vec(b.memory, MEMORY_SIZE * b.n_memory)[MEMORY_SIZE * k + MODE] == CLOSED
    if job == RESIDUAL and not closed:
        coord = imat(b.coord, b.count, 6)[e]
        v = vec(b.v, b.n_extended)
        vec(b.phi, b.m_extended)[row] = g
        vec(b.phid, b.m_extended)[row] = along(gradient, v, coord)
        vec(b.phidd, b.m_extended)[row] = along(gradient, vec(b.a, b.n_extended), coord) + curvature(hessian, v, coord)
        if not force_law:
            vec(b.monitor, b.n_monitor)[k] = 0.0
    elif job == RESIDUAL or (job == TANGENT and closed):
        constrain(b, job, e, row, 0, 1.0, g, gradient, hessian)
        vec(b.monitor, b.n_monitor)[k] = -lam[row]
    if force_law:
        _add_force(b, job, e, k, g, gradient, hessian)
    elif job == POWER and closed:
        vec(b.a, b.n_extended)[imat(b.extra, b.count, 5)[e, 2]] -= lam[row]


@internal
def disk_on_half_plane_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, 11)
    coord = imat(b.coord, b.count, 6)
    for e in range(b.count):
        g, gradient, hessian = height_over_line(
            vec(b.q, b.n_extended), coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3], par[e, 4]
        )
        _act(b, job, e, g - par[e, 5], gradient, hessian)


@internal
def disk_on_disk_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, 11)
    coord = imat(b.coord, b.count, 6)
    for e in range(b.count):
        d, gradient, hessian = distance(vec(b.q, b.n_extended), coord[e], par[e, 0], par[e, 1], par[e, 2], par[e, 3])
        _act(b, job, e, d - par[e, 5], gradient, hessian)


class HalfPlane2D(Record):
    """The half-plane behind a line through the marker; its outward normal is the marker's second axis
    (angle + 90 degrees): a half-plane on the ground with angle 0 is a floor."""

    type: Literal["HalfPlane2D"] = "HalfPlane2D"
    marker: Marker2D = Marker2D()


class Disk2D(Record):
    """A disk about the marker; radius 0 is a point."""

    type: Literal["Disk2D"] = "Disk2D"
    marker: Marker2D
    radius: NonNegative = 0.0
    """m."""


Shape2D = Annotated[HalfPlane2D | Disk2D, Field(discriminator="type")]


class _Contact2D(Element):
    tangent_pattern: ClassVar[Sequence[tuple[int, int]]] = FULL_PATTERN
    jacobian_pattern: ClassVar[Sequence[tuple[int, int]]] = ROW_PATTERN
    constraint_rows: ClassVar[int] = 1

    law: ContactLaw
    """What happens when the gap closes."""

    def extent(self) -> float:
        """Distance over which the shapes could pass through each other, m; infinite for a half-plane."""
        return math.inf

    def _row(self, numbering: Numbering, a: Marker2D, b: Marker2D, angle: float, radius: float) -> Row:
        if isinstance(self.law, ForceLaw):
            parameters = self.law.formula_parameters()
            address = numbering.law_address(self.law)
        else:
            parameters, address = (0.0, 0.0, 0.0, 0.0), 0
        return Row(
            (*a.point, *b.point, angle, radius, 0.0, *parameters),
            (*numbering.coordinates(a.body), *numbering.coordinates(b.body)),
            (
                numbering.contact(self.name),
                address,
                numbering.work(f"{self.name}.impulse"),
                numbering.work(f"{self.name}.dissipation"),
                0,
            ),
        )


class DiskOnHalfPlane2D(_Contact2D):
    """Contact of a disk (or point) with a half-plane: gap = height of the centre over the line - radius."""

    type: Literal["DiskOnHalfPlane2D"] = "DiskOnHalfPlane2D"
    kernel: ClassVar[Any] = disk_on_half_plane_kernel

    plane: HalfPlane2D
    disk: Disk2D

    def row(self, numbering: Numbering) -> Row:
        angle = self.plane.marker.angle + 0.5 * math.pi
        return self._row(numbering, self.plane.marker, self.disk.marker, angle, self.disk.radius)

    def markers(self) -> Sequence[Marker2D]:
        return (self.plane.marker, self.disk.marker)


class DiskOnDisk2D(_Contact2D):
    """Contact of two disks: gap = distance of the centres - sum of the radii."""

    type: Literal["DiskOnDisk2D"] = "DiskOnDisk2D"
    kernel: ClassVar[Any] = disk_on_disk_kernel

    a: Disk2D
    b: Disk2D

    def extent(self) -> float:
        return self.a.radius + self.b.radius or math.inf

    def row(self, numbering: Numbering) -> Row:
        return self._row(numbering, self.a.marker, self.b.marker, 0.0, self.a.radius + self.b.radius)

    def markers(self) -> Sequence[Marker2D]:
        return (self.a.marker, self.b.marker)
