"""Rod along the x axis: linear bar finite elements between nodes x0 .. xN, whose coordinates are positions.

Element of length l with nodes i, j:  N = EA ((x_j - x_i) / l - 1) + EA tau (v_j - v_i) / l,
r += M_e (a_i, a_j) + (-N, N) - (halves of the weight);  M_e = rho A l [1/3 1/6; 1/6 1/3] (consistent) or rho A l I/2
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ..compiled.jit import internal
from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..errors import ModelError
from ..model.base import NonNegative, Positive
from ..model.channels import Channel
from ..rounding import ON_NODE
from .base import MOST_ELEMENTS, Form, Numbering, Part, Row
from .coordinate import Coordinate
from .flexible_body import FlexibleBody, PointShape, Section
from .massless_end import massless_end_kernel

End = Literal["left", "right"]
MassMatrix = Literal["consistent", "lumped"]
CONSISTENT, LUMPED = (1.0 / 3.0, 1.0 / 6.0), (0.5, 0.0)
"""Diagonal and off-diagonal entry of an element's mass matrix, in parts of its mass."""


@internal
def _add_forces(b: Any, e: int, first: int, count: int) -> None:
    """r of `count` equal elements, whose parameters are those of row e, between consecutive nodes from `first` on."""
    p = mat(b.par, b.count, 8)[e]
    m_ii, m_ij, m_jj, stiffness, damping, length = p[0], p[1], p[2], p[3], p[4], p[5]
    weight_i, weight_j, at = p[6], p[7], 8 * first
    q, v, a = vec(b.q + at, count + 1), vec(b.v + at, count + 1), vec(b.a + at, count + 1)
    r = vec(b.r + at, count + 1)
    q_i, v_i, a_i, left = q[0], v[0], a[0], 0.0
    for k in range(count):
        q_j, v_j, a_j = q[k + 1], v[k + 1], a[k + 1]
        force = stiffness * (q_j - q_i - length) + damping * (v_j - v_i)
        r[k] += left + m_ii * a_i + m_ij * a_j - force - weight_i
        left = m_ij * a_i + m_jj * a_j + force - weight_j
        q_i, v_i, a_i = q_j, v_j, a_j
    r[count] += left


@internal
def axial_rod_kernel(job: int, t: float, b: Any) -> None:
    par = mat(b.par, b.count, 8)  # m_ii, m_ij, m_jj, stiffness, damping, length, weight of i, of j
    coord, extra = imat(b.coord, b.count, 2), imat(b.extra, b.count, 2)
    if job == RESIDUAL:
        e = 0
        while e < b.count:
            _add_forces(b, e, coord[e, 0], extra[e, 1])
            e += extra[e, 1]
    elif job == TANGENT:
        values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
        slot = imat(b.slot_s, b.count, 4)
        for e in range(b.count):
            k = coef[0] * par[e, 3] + coef[1] * par[e, 4]
            values[slot[e, 0]] += par[e, 0] + k
            values[slot[e, 1]] += par[e, 1] - k
            values[slot[e, 2]] += par[e, 1] - k
            values[slot[e, 3]] += par[e, 2] + k
    elif job == ENERGY:
        q, v, energy = vec(b.q, b.n_extended), vec(b.v, b.n_extended), vec(b.energy, 3)
        for e in range(b.count):
            i, j = coord[e, 0], coord[e, 1]
            stretch = q[j] - q[i] - par[e, 5]
            energy[0] += 0.5 * (par[e, 0] * v[i] * v[i] + par[e, 2] * v[j] * v[j]) + par[e, 1] * v[i] * v[j]
            energy[1] -= par[e, 6] * q[i] + par[e, 7] * q[j]
            energy[2] += 0.5 * par[e, 3] * stretch * stretch
    elif job == POWER:
        v, a = vec(b.v, b.n_extended), vec(b.a, b.n_extended)
        e = 0
        while e < b.count:
            first, count = coord[e, 0], extra[e, 1]
            if par[e, 4] > 0.0:
                lost = 0.0
                for i in range(first, first + count):
                    rate = v[i + 1] - v[i]
                    lost += par[e, 4] * rate * rate
                a[extra[e, 0]] += lost
            e += count


class AxialRod(FlexibleBody):
    """An elastic rod along the x axis, in linear bar elements.

    Its coordinates are the positions `x0` (left end) to `xN` (right end) of its nodes, so that a CoordinateContact
    between a node and a wall, or between nodes of two rods, has a gap that is a distance. Channels are `NAME.xk`,
    `NAME.vxk`, `NAME.axk`. The gravity of the model acts on it along x. Its material points are (s, 0), s m from the
    left end of the unstrained rod; they stay on the axis.

    Raises
    ------
    ModelError : for massless ends of a rod with fewer elements than they need.
    """

    type: Literal["AxialRod"] = "AxialRod"
    kernel: ClassVar[Any] = axial_rod_kernel

    elements: Annotated[int, Field(ge=1, le=MOST_ELEMENTS)]
    """N."""
    length: Positive
    """L of the unstrained rod, m."""
    axial_stiffness: Positive
    """EA, N."""
    mass_per_length: Positive
    """rho A, kg/m."""
    mass_matrix: MassMatrix = "consistent"
    """Of the elements: consistent with the linear shape functions, or half of the mass at each node."""
    damping_time: NonNegative = 0.0
    """tau of the viscous stress E tau strain rate (Kelvin and Voigt), s."""
    position: float = 0.0
    """Initial x of the left end, m; the rod starts unstrained."""
    velocity: float = 0.0
    """Initial velocity of all of it, m/s."""
    massless_ends: tuple[End, ...] = ()
    """Ends whose node gets no mass (mass redistribution after Khenous, Laborde and Renard, "Mass redistribution method
    for finite element contact problems in elastodynamics", Eur. J. Mech. A/Solids 27 (2008) 918): closing there takes
    no impulse and no energy. All mass of the last element goes to its inner node, by which the centre of mass moves by
    L / (2 N^2); shared with the node beyond so that it stays, the force oscillates ten times as much. Made for contacts
    as constraints: while all of its contacts are open the end follows its neighbour, so that loads on it act as if its
    element were rigid. That element has no viscous stress."""

    @model_validator(mode="after")
    def _check(self) -> "AxialRod":
        if len(set(self.massless_ends)) < len(self.massless_ends):
            raise ValueError(f"massless_ends of '{self.name}' = {self.massless_ends} names an end twice")
        if self.massless_ends and self.elements < 2:
            raise ValueError(
                f"'{self.name}' has {self.elements} element: the mass of a massless end goes to its neighbour, use "
                "elements >= 2"
            )
        return self

    @property
    def wave_speed(self) -> float:
        """c = sqrt(EA / (rho A)), m/s."""
        return float(np.sqrt(self.axial_stiffness / self.mass_per_length))

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Distance of the nodes of the unstrained rod from its left end (N + 1,), m."""
        return np.linspace(0.0, self.length, self.elements + 1)

    @property
    def linear(self) -> bool:
        return True

    def matrices(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mass and stiffness (N + 1, N + 1), dense."""
        size = self.elements + 1
        mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
        for e, (m_ii, m_ij, m_jj, k, *_) in enumerate(self._parameters(0.0).tolist()):
            here = np.ix_((e, e + 1), (e, e + 1))
            mass[here] += [[m_ii, m_ij], [m_ij, m_jj]]
            stiffness[here] += [[k, -k], [-k, k]]
        return mass, stiffness

    def weight(self, gravity: float) -> NDArray[np.float64]:
        """Forces (N + 1,) on the nodes, N, of gravity along x, m/s^2."""
        table = self._parameters(gravity)
        return np.append(table[:, 6], 0.0) + np.append(0.0, table[:, 7])

    def coordinate_records(self) -> Sequence[Coordinate]:
        return _coordinates(self.elements + 1, self.length)

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        return tuple((self.position + self.nodes).tolist()), (self.velocity,) * (self.elements + 1)

    def form(self) -> Form:
        return Form(type(self).kernel, 0, ((0, 0), (0, 1), (1, 0), (1, 1)), ())

    def lengths(self) -> Sequence[float]:
        return (self.length,)

    def rows(self, numbering: Numbering) -> Sequence[Row]:
        """One row an element; the first of equal ones says how many there are."""
        account = numbering.work("dampers")
        index = numbering.coordinates(self.name)
        table = self._parameters(numbering.gravity[0])
        starts = np.flatnonzero(np.concatenate(([True], np.any(table[1:] != table[:-1], axis=1))))
        runs = np.zeros(self.elements, dtype=np.int64)
        runs[starts] = np.diff(np.append(starts, self.elements))
        return [
            Row(parameters, (index[e], index[e + 1]), (account, run))
            for e, (parameters, run) in enumerate(zip(table.tolist(), runs.tolist(), strict=True))
        ]

    def parts(self, numbering: Numbering) -> Sequence[Part]:
        index, length = numbering.coordinates(self.name), self.length / self.elements
        found = [Part(self.form(), self.rows(numbering))]
        for end in self.massless_ends:
            node, neighbour = (index[0], index[1]) if end == "left" else (index[-1], index[-2])
            rest = -length if end == "left" else length
            form = Form(massless_end_kernel, 1, (), ((0, 0), (0, 1)))
            found.append(Part(form, (Row((rest,), (node, neighbour)),), massless=node))
        return found

    def material_point(self, point: tuple[float, float]) -> PointShape:
        """The point (s, 0), s m along the unstrained rod. Raises ModelError beyond it, and off its axis."""
        if point[1] != 0.0:
            raise ModelError(f"point {point} of '{self.name}' is off the axis: a rod has points (s, 0) only")
        (e,), (xi,) = self._places(np.array([float(point[0])]))
        shape = np.array([[1.0 - xi, xi], [0.0, 0.0]])
        return PointShape(None, (f"x{e}", f"x{e + 1}"), (0.0, 0.0), (1.0, 0.0), shape, np.zeros((2, 2)))

    def drawn_points(self) -> Sequence[tuple[float, float]]:
        return ((0.0, 0.0), (self.length, 0.0))

    def typical_mass(self) -> float:
        return self.mass_per_length * self.length

    def section(self, points: NDArray[np.float64], q: NDArray[np.float64], v: NDArray[np.float64]) -> Section:
        """Strain and axial force of the elements at `points`; at a node those of the element to its right."""
        length = self.length / self.elements
        e, _ = self._places(points)
        strain = (q[:, e + 1] - q[:, e]) / length - 1.0
        rate = (v[:, e + 1] - v[:, e]) / length
        tau = np.full(self.elements, self.damping_time)
        for end in self.massless_ends:
            tau[0 if end == "left" else -1] = 0.0
        nothing = np.zeros_like(strain)
        return Section(strain, nothing, self.axial_stiffness * (strain + tau[e] * rate), nothing)

    def _places(self, points: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Elements and places in them, 0 to 1. Raises ModelError for points beyond the rod."""
        outside = points[~((points >= 0.0) & (points <= self.length))]
        if len(outside):
            raise ModelError(
                f"point {outside[0]:g} m lies outside '{self.name}', which reaches from 0 to {self.length:g} m"
            )
        x = points / self.length * self.elements
        # a node counts as one, in spite of rounding
        x = np.where(np.abs(x - np.round(x)) < ON_NODE * self.elements, np.round(x), x)
        e = np.minimum(x.astype(np.int64), self.elements - 1)
        return e, x - e

    def multiplier_channels(self) -> Sequence[Channel]:
        text = (
            "force that keeps the massless end at its neighbour while its contacts are open: zero without loads on it"
        )
        return tuple(Channel(f"{self.name}.{end}_end_force", "N", text) for end in self.massless_ends)

    def _parameters(self, gravity: float) -> NDArray[np.float64]:
        """Parameters of the elements (N, 8)."""
        length = self.length / self.elements
        mass, stiffness = self.mass_per_length * length, self.axial_stiffness / length
        diagonal, beside = CONSISTENT if self.mass_matrix == "consistent" else LUMPED
        row = (mass * diagonal, mass * beside, mass * diagonal, stiffness, stiffness * self.damping_time, length)
        weight = 0.5 * mass * gravity
        table = np.tile((*row, weight, weight), (self.elements, 1))
        ends = [(0, 1, 0, 6) if end == "left" else (-1, -2, 2, 7) for end in self.massless_ends]
        for last, *_ in ends:
            table[last, [0, 1, 2, 4, 6, 7]] = 0.0
        for _, beside_it, near, weight_near in ends:
            # columns of the node next to the end, in the element beside the end's
            table[beside_it, near] += mass
            table[beside_it, weight_near] += 2.0 * weight
        return table


@lru_cache(maxsize=8)
def _coordinates(count: int, scale: float) -> tuple[Coordinate, ...]:
    """Of `count` nodes: asked for many times, and large."""
    return tuple(Coordinate(f"x{k}", "m", f"vx{k}", f"ax{k}", scale) for k in range(count))
