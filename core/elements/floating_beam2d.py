"""A straight Euler-Bernoulli beam in a floating frame of reference, reduced by modes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from ..errors import ModelError
from ..model.base import NonNegative, Positive, Record, Vector2
from ..rounding import BEYOND_END, ON_NODE
from .beam_modes import GAUSS_POINTS, Array, BoundaryConditions, Grid, bending, make_grid, stretching
from .flexible_body import PointShape, Section, along_axis
from .floating_body2d import FloatingBody2D, Invariants

ELEMENTS_PER_MODE = 4
LEAST_ELEMENTS = 20
MOST_MODES = 200


class Attachment(Record):
    """A point at which a load comes in: its static shape is taken among the modes, so that the beam's compliance there
    is exact."""

    position: NonNegative
    """Distance from the beam's first end, m."""
    direction: Literal["transverse", "axial", "moment"] = "transverse"


class FloatingBeam2D(FloatingBody2D):
    """A straight, uniform Euler-Bernoulli beam, small strains and deflections in a frame that moves freely.

    The boundary conditions of the modes say what the frame is: "cantilever" the tangent at the first end,
    "simply_supported" the chord, with its origin at the first end, "free" the mean axes, with their origin at the
    centre of mass. A marker on the beam is one on this frame; points along the beam are those of a MaterialPoint2D.

    The amplitudes `mode1` ... are the largest displacements of the modes, m: bending modes, shapes of transverse
    attachments, then axial modes and shapes of axial attachments.

    Raises
    ------
    ModelError : for no modes at all, attachments beyond the ends or dependent on the modes, axial modes without axial
        stiffness, or as many damping ratios as there are not modes.
    """

    type: Literal["FloatingBeam2D"] = "FloatingBeam2D"

    length: Positive
    """m."""
    bending_stiffness: Positive
    """EI, N m^2."""
    axial_stiffness: Positive | None = None
    """EA, N; left out: the beam keeps its length."""
    rotary_inertia: NonNegative = 0.0
    """Of the sections, rho I, kg m."""
    boundary_conditions: BoundaryConditions = "cantilever"
    """Of the modes, and so which frame the coordinates are those of."""
    modes: Annotated[int, Field(ge=0, le=MOST_MODES)] = 3
    """Number of bending modes."""
    axial_modes: Annotated[int, Field(ge=0, le=MOST_MODES)] = 0
    """Number of axial modes; they need `axial_stiffness`."""
    attachments: tuple[Attachment, ...] = ()
    """Points whose static shapes join the modes."""
    damping_ratio: NonNegative | tuple[NonNegative, ...] = 0.0
    """Of all modes, or one of each."""
    geometric_stiffening: bool = False
    """Whether the beam shortens as it bends, so that centrifugal forces, axial acceleration, weight and axial forces at
    its points stiffen it."""
    elements: Annotated[int, Field(ge=2, le=2000)] | None = None
    """Finite elements behind the modes; left out: four a mode, twenty at least."""

    @model_validator(mode="after")
    def _check(self) -> "FloatingBeam2D":
        beyond = [a.position for a in self.attachments if a.position > self.length * (1.0 + BEYOND_END)]
        if beyond:
            raise ValueError(f"attachments of '{self.name}' at {beyond} m lie beyond its length {self.length:g} m")
        axial = self.axial_modes or any(a.direction == "axial" for a in self.attachments)
        if axial and self.axial_stiffness is None:
            raise ValueError(f"axial modes and attachments of '{self.name}' need axial_stiffness (EA, N)")
        n = len(self.mode_names())
        if n == 0:
            raise ValueError(f"'{self.name}' has no modes: give `modes`, or use a RigidBody2D")
        for name in ("amplitudes", "amplitude_rates", "damping_ratio"):
            value = getattr(self, name)
            if isinstance(value, tuple) and len(value) != n:
                raise ValueError(f"{name} of '{self.name}' has {len(value)} entries, needed is one for each of its {n} "
                                 "modes: bending and transverse attachments, then axial ones")  # fmt: skip
        beam_modes(self)
        return self

    def lengths(self) -> Sequence[float]:
        return (self.length,)

    def mode_names(self) -> tuple[str, ...]:
        return tuple(f"mode{k + 1}" for k in range(self.modes + self.axial_modes + len(self.attachments)))

    def frequencies(self) -> Array:
        """Natural frequencies of the modes, (n,), rad/s."""
        return np.sqrt(beam_modes(self).squares)

    def invariants(self) -> Invariants:
        return beam_modes(self).invariants(self)

    def material_point(self, point: Vector2) -> PointShape:
        modes, (s, y) = beam_modes(self), point
        self._refuse_beyond(s)
        (wy, slope), (ux, strain) = (
            [(modes.grid.shape(np.array([s]), k) @ x)[0] for k in range(2)] for x in (modes.w, modes.u)
        )
        second = modes.foreshortening(s) if self.geometric_stiffening else None
        return self.point_shape(
            np.array([s - modes.origin, y]), np.array([ux - y * slope, wy]), np.array([strain, slope]), second
        )

    def drawn_points(self) -> Sequence[tuple[float, float]]:
        return along_axis(self.length)

    def section(self, points: Array, q: Array, v: Array) -> Section:
        """Strains and internal forces; the axial force is NaN where the beam has no axial modes to tell it.

        Modal damping is that of the strain rates: a mode with damping ratio zeta and frequency w has the internal force
        of its amplitude + (2 zeta/w) times its rate.
        """
        for s in points:
            self._refuse_beyond(float(s))
        modes = beam_modes(self)
        p, dp = q[:, 3:], v[:, 3:]
        lag = 2.0 * np.broadcast_to(np.asarray(self.damping_ratio, dtype=float), p.shape[1:]) / np.sqrt(modes.squares)
        bent, stretched = modes.grid.shape(points, 2) @ modes.w, modes.grid.shape(points, 1) @ modes.u
        tells = self.axial_stiffness is not None and bool(np.any(modes.u))
        axial = (p + lag * dp) @ stretched.T * (self.axial_stiffness or 0.0)
        return Section(
            p @ stretched.T, p @ bent.T, axial if tells else np.full_like(axial, np.nan),
            self.bending_stiffness * (p + lag * dp) @ bent.T,
        )  # fmt: skip

    def _refuse_beyond(self, s: float) -> None:
        if not -ON_NODE * self.length <= s <= self.length * (1.0 + ON_NODE):
            raise ModelError(f"'{self.name}' has no point at s = {s:g} m: it reaches from 0 to {self.length:g} m")


@dataclass(frozen=True)
class BeamModes:
    """The modes of a beam: nodal values of deflection w and stretch u, (unknowns, n), scaled to the largest value 1."""

    grid: Grid
    origin: float
    w: Array
    u: Array
    modal_mass: Array
    squares: Array
    """Angular frequencies squared, (n,)."""

    def invariants(self, beam: FloatingBeam2D) -> Invariants:
        """The integrals over the mass, and of the foreshortening g_kl(s) = -int w_k' w_l' from the origin to s."""
        grid, density = self.grid, beam.mass / beam.length
        x, dm = grid.points - self.origin, density * grid.weights
        sx, sy, slope = grid.shape(grid.points, 0) @ self.u, grid.shape(grid.points, 0) @ self.w, self._slope()
        rotary = beam.rotary_inertia * grid.weights
        n = len(self.squares)
        shortening, turning = np.zeros((n, n)), np.zeros((n, n))
        if beam.geometric_stiffening:
            # mass, and its first moment, that a slope at s draws towards the origin
            outer = x > 0.0
            far = np.where(outer, beam.length - self.origin, self.origin)
            drawn = np.where(outer, -density * (far - x), density * (far + x))
            shortening = slope.T @ ((grid.weights * drawn)[:, None] * slope)
            turning = slope.T @ ((-0.5 * density * grid.weights * (far**2 - x**2))[:, None] * slope)
        translational = sx.T @ (dm[:, None] * sx) + sy.T @ (dm[:, None] * sy)
        ratio = np.broadcast_to(np.asarray(beam.damping_ratio, dtype=float), (n,))
        gyroscopic = sx.T @ (dm[:, None] * sy)
        return Invariants(
            first_moment=np.array([dm @ x, 0.0]),
            inertia=float(dm @ x**2 + rotary.sum()),
            a=sx.T @ (dm * x),
            b=sy.T @ (dm * x) + slope.T @ rotary,
            H=np.array([dm @ sx, dm @ sy]),
            N=translational + turning,
            Gamma=gyroscopic - gyroscopic.T,
            mass=np.diag(self.modal_mass),
            stiffness=np.diag(self.squares * self.modal_mass),
            damping=np.diag(2.0 * ratio * np.sqrt(self.squares) * self.modal_mass),
            G=np.array([shortening, np.zeros((n, n))]),
        )

    def foreshortening(self, s: float) -> Array:
        """g of the point at s, (2, n, n): that of the axis."""
        grid = self.grid
        # points and weights from the origin to s, element by element
        low, high = min(s, self.origin), max(s, self.origin)
        cuts = np.unique(np.clip(grid.nodes, low, high))
        z, w = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        half = 0.5 * np.diff(cuts)
        points = (cuts[:-1, None] + half[:, None] * (z + 1.0)).ravel()
        weights = (half[:, None] * w).ravel() * np.sign(self.origin - s)
        slope = grid.shape(points, 1) @ self.w
        return np.array([slope.T @ (weights[:, None] * slope), np.zeros(2 * slope.shape[1:])])

    def _slope(self) -> Array:
        return self.grid.shape(self.grid.points, 1) @ self.w


@lru_cache(maxsize=64)
def beam_modes(beam: FloatingBeam2D) -> BeamModes:
    """The modes of `beam`."""
    origin = 0.5 * beam.length if beam.boundary_conditions == "free" else 0.0
    special = sorted({min(a.position, beam.length) for a in beam.attachments} | {origin})
    elements = beam.elements or max(LEAST_ELEMENTS, ELEMENTS_PER_MODE * max(beam.modes, beam.axial_modes))
    grid = make_grid(beam.length, elements, special)
    density = beam.mass / beam.length
    bent = bending(grid, beam.bending_stiffness, density, beam.rotary_inertia, beam.boundary_conditions, origin)
    loads: dict[bool, list[Array]] = {False: [], True: []}
    for a in beam.attachments:
        load = grid.shape(np.array([min(a.position, beam.length)]), int(a.direction == "moment"))[0]
        loads[a.direction == "axial"].append(load)
    w, w_squares = bent.reduce(beam.modes, loads[False])
    u, u_squares = np.zeros((len(w), 0)), np.zeros(0)
    if beam.axial_stiffness is not None:
        stretched = stretching(grid, beam.axial_stiffness, density, beam.boundary_conditions)
        u, u_squares = stretched.reduce(beam.axial_modes, loads[True])
    n = w.shape[1] + u.shape[1]
    shapes = np.zeros((2, len(w), n))
    shapes[0, :, : w.shape[1]], shapes[1, :, w.shape[1] :] = w, u
    nodal = shapes.sum(axis=0)[0::2]
    largest = nodal[np.argmax(np.abs(nodal) > (1.0 - 1e-6) * np.abs(nodal).max(axis=0), axis=0), np.arange(n)]
    return BeamModes(
        grid, origin, shapes[0] / largest, shapes[1] / largest, 1.0 / largest**2, np.append(w_squares, u_squares)
    )
