"""One long step by Gauss collocation of any number of stages, each with matrices of its own.

It integrates q'' = a(P(q, v)), P the projection onto the constraints and a the acceleration that the augmented system
gives there: the motion is a solution, so that the order is the full one, 2 s, and no partition is needed. Newton's
method for all stages together; away from the singular position no stage knows that there is one (the matrix of one
stage is no help at another: on the other side of the position its least singular value has the other sign).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.evaluate import evaluate_power, evaluate_residuals, evaluate_tangent
from ..assembly.levels import position_level, rate_level
from ..rounding import EXACTLY_MET, NEARLY_MET

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation

Floats = NDArray[np.float64]

MOST_ITERATIONS = 16
CONVERGED = 0.01
"""Of the error weights."""
STALLED, EXPLODES = 0.5, 1e3
"""Contraction beyond which increments are rounding if they are small, and beyond which they lead away."""
MOST_CORRECTIONS = 9
LARGEST_DENSE = 60
"""Unknowns up to which matrices are full: beyond, LAPACK takes several threads, which costs more than it wins."""


@dataclass(frozen=True)
class Gauss:
    """Gauss collocation: nodes c, coefficients a, squared ones a2 = a a, weights b, and b a."""

    c: Floats
    a: Floats
    a2: Floats
    b: Floats
    ba: Floats


@cache
def gauss(stages: int) -> Gauss:
    """The method of so many stages; order 2 s (Hairer and Wanner II, IV.5). Integrals of the Lagrange polynomials by
    their expansion in Legendre polynomials, which is exact at these nodes."""
    x, w = np.polynomial.legendre.leggauss(stages)
    values = np.polynomial.legendre.legvander(x, stages)
    integrals = np.empty((stages, stages))
    integrals[:, 0] = 0.5 * (x + 1.0)
    for k in range(1, stages):
        integrals[:, k] = 0.5 * (values[:, k + 1] - values[:, k - 1]) / (2 * k + 1)
    a = (integrals * (2.0 * np.arange(stages) + 1.0)) @ (values[:, :stages] * (0.5 * w)[:, None]).T
    b = 0.5 * w
    return Gauss(0.5 * (x + 1.0), a, a @ a, b, b @ a)


@dataclass
class Points:
    """Points of a motion: times (k,), q, v, a (k, n), multipliers lam (k, m_act), work accounts and their rates."""

    times: Floats
    q: Floats
    v: Floats
    a: Floats
    lam: Floats
    work: Floats
    power: Floats

    def at(self, times: Floats) -> "Points":
        """The polynomials through all points, at other times."""
        values = (self.q, self.v, self.a, self.lam, self.work, self.power)
        matrix = interpolation_matrix(self.times, times)
        return Points(np.asarray(times), *(matrix @ x for x in values))


def interpolation_matrix(nodes: Floats, times: Any) -> Floats:
    """Weights (times, nodes) of the polynomial through values at the nodes (barycentric, Berrut and Trefethen 2004)."""
    span = float(np.ptp(nodes)) or 1.0
    x, t = np.asarray(nodes) / span, np.atleast_1d(times) / span
    gaps = 4.0 * (x[:, None] - x[None, :])
    np.fill_diagonal(gaps, 1.0)
    weights = 1.0 / np.prod(gaps, axis=1)
    distance = t[:, None] - x[None, :]
    exact = distance == 0.0
    terms = weights / np.where(exact, 1.0, distance)
    terms[exact.any(axis=1)] = 0.0
    terms[exact] = 1.0
    return np.asarray(terms / terms.sum(axis=1, keepdims=True))


class Collocation:
    """Long steps from one point of a run.

    Parameters
    ----------
    start : the point, one row in each of its arrays.
    trusted : trusted(t): whether the constraints determine the point of time t; False too near a singular position.
    noise : increments, in units of the error weights, that may be rounding.
    """

    def __init__(self, sim: "Simulation", start: Points, trusted: Callable[[float], bool], noise: float) -> None:
        self.workspace, self.start, self.trusted, self.noise = sim.workspace, start, trusted, noise
        self.n, self.n_ext = sim.assembly.n, sim.assembly.n_extended
        self.n_work = len(sim.assembly.work_names)
        self.active = self.workspace.structure.active.copy()
        self.rows = self.workspace.structure.multiplier_rows.copy()
        self.t0 = float(start.times[0])
        scale, rtol = sim.assembly.coordinate_scale, sim.rtol
        # to see whether the iteration converges: rounding moves coordinates that stand still as much as large ones
        self.weights = tuple(
            np.asarray(sim.workspace.arrays[name][: self.n] + rtol * scale * np.max(np.abs(x[0] / scale)))
            for name, x in (("weight_q", start.q), ("weight_v", start.v))
        )

    def step(self, h: float, stages: int, guess: Points) -> Points | None:
        """The points at the start, at the stages and at the end of a step of size h; None if it does not converge.

        `guess` gives the first accelerations and multipliers at the times of the stages.
        """
        table = gauss(stages)
        times = self.t0 + table.c * h
        a, lam = guess.a.copy(), guess.lam.copy()
        q, v = np.empty_like(a), np.empty_like(a)
        previous, norm = np.inf, np.inf
        for _ in range(MOST_ITERATIONS):
            found = self._newton(h, table, times, a, lam, q, v)
            if found is None:
                return None
            da, dlam, norm = found
            a += da
            lam += dlam
            contraction = norm / previous
            if norm <= CONVERGED or (norm < previous < np.inf and norm * contraction <= CONVERGED):
                break
            if not contraction <= STALLED:
                # rounding, if the increments have been small before; the difference from another number of stages tells
                if norm <= self.noise:
                    break
                if contraction > EXPLODES:
                    return None
            previous = norm
        else:
            if not norm <= self.noise:
                return None
        return self._points(h, table, times, a, lam)

    def _predict(self, h: float, table: Gauss, a: Floats) -> tuple[Floats, Floats]:
        start = self.start
        return start.q[0] + h * table.c[:, None] * start.v[0] + h * h * (table.a2 @ a), start.v[0] + h * (table.a @ a)

    def _newton(
        self, h: float, table: Gauss, times: Floats, a: Floats, lam: Floats, q: Floats, v: Floats
    ) -> tuple[Floats, Floats, float] | None:
        """Increments of the accelerations and multipliers of all stages, and the norm of what they move."""
        q[:], v[:] = self._predict(h, table, a)
        arrays, n, m, s = self.workspace.arrays, self.n, len(self.rows), len(times)
        blocks, rhs = [], np.empty((s, n + m))
        for i in range(s):
            if not self._place(float(times[i]), q[i], v[i], a[i], lam[i]):
                return None
            rhs[i, :n] = -arrays["r"][:n]
            rhs[i, n:] = self._left()
            plain = self._values(0.0, 0.0)
            blocks.append((plain, self._values(0.0, 1.0) - plain, self._values(1.0, 0.0) - plain))
        increment = self._solve_coupled(h, table, blocks, rhs.ravel())
        if increment is None:
            return None
        increment = increment.reshape(s, n + m)
        da = increment[:, :n]
        of_q = h * h * (table.a2 @ da) / self.weights[0]
        of_v = h * (table.a @ da) / self.weights[1]
        norm = float(np.sqrt(max(np.mean(of_q**2, axis=1).max(), np.mean(of_v**2, axis=1).max())))
        return da, increment[:, n:], norm

    def _solve_coupled(self, h: float, table: Gauss, blocks: list[Any], rhs: Floats) -> Floats | None:
        """Solve with the matrix of all stages: block (i, j) is h a_ij D_i + h^2 a2_ij K_i, and that of [M, Phi_q^T;
        Phi_q, 0] at the stage is added for i = j."""
        structure, s = self.workspace.structure, len(blocks)
        rows, cols, size = structure.rows, structure.cols, self.n + len(self.rows)
        if s * size <= LARGEST_DENSE:
            matrix = np.zeros((s, size, s, size))
            for i, (plain, of_v, of_q) in enumerate(blocks):
                for j in range(s):
                    matrix[i, rows, j, cols] = h * table.a[i, j] * of_v + h * h * table.a2[i, j] * of_q
                matrix[i, rows, i, cols] += plain
            return _solve(matrix.reshape(s * size, s * size), rhs)
        # importing scipy costs more than most runs: only who needs it pays
        from scipy.sparse import coo_matrix

        entries = []
        for i, (plain, of_v, of_q) in enumerate(blocks):
            beside = np.flatnonzero((of_v != 0.0) | (of_q != 0.0))
            entries.append((i * size + rows, i * size + cols, plain))
            for j in range(s):
                value = h * table.a[i, j] * of_v[beside] + h * h * table.a2[i, j] * of_q[beside]
                entries.append((i * size + rows[beside], j * size + cols[beside], value))
        places = [np.concatenate([entry[k] for entry in entries]) for k in range(3)]
        return _solve(coo_matrix((places[2], (places[0], places[1])), shape=(s * size, s * size)).tocsc(), rhs)

    def _left(self) -> Floats:
        """What accelerations leave of the constraints, and multipliers of the rows of compatibility: its negative."""
        structure, arrays = self.workspace.structure, self.workspace.arrays
        parts = structure.compatibility * arrays["lam"][self.rows[structure.sharing]]
        shared = np.bincount(structure.sharing_row, parts, structure.n_implied)
        return -np.concatenate([arrays["phidd"][self.active], shared])

    def _values(self, c_q: float, c_v: float) -> Floats:
        """Entries of [M + c_v D + c_q K, Phi_q^T; Phi_q, 0] at the current point."""
        evaluate_tangent(self.workspace.record, c_q, c_v)
        return np.asarray(self.workspace.arrays["values"][: self.workspace.structure.nnz].copy())

    def _kkt(self, rhs: Floats) -> Floats | None:
        """Solve with [M, Phi_q^T; Phi_q, 0] of the current point."""
        structure, size = self.workspace.structure, len(rhs)
        values = self._values(0.0, 0.0)
        if size <= LARGEST_DENSE:
            matrix = np.zeros((size, size))
            matrix[structure.rows, structure.cols] = values
            return _solve(matrix, rhs)
        from scipy.sparse import coo_matrix

        return _solve(coo_matrix((values, (structure.rows, structure.cols)), shape=(size, size)).tocsc(), rhs)

    def _place(self, t: float, q: Floats, v: Floats, a: Floats, lam: Floats) -> bool:
        """Make this the current point, with q and v brought onto the constraints (in place) by corrections of least
        M-norm."""
        arrays, n = self.workspace.arrays, self.n
        arrays["t"][0] = t
        arrays["q"][:n], arrays["v"][:n], arrays["a"][:n] = q, v, a
        arrays["lam"][self.rows] = lam
        evaluate_residuals(self.workspace.record)
        met = len(self.active) == 0 or not self.trusted(t) or (self._meet("phi", "q") and self._meet("phid", "v"))
        q[:], v[:] = arrays["q"][:n], arrays["v"][:n]
        return met

    def _meet(self, residual: str, x: str) -> bool:
        """One level of the constraints down to rounding."""
        arrays, n = self.workspace.arrays, self.n
        previous = np.inf
        for _ in range(MOST_CORRECTIONS):
            violation = arrays[residual][self.active]
            size = float(np.max(np.abs(violation) / arrays["row_scale"][self.active]))
            level = position_level(self.workspace.record) if x == "q" else rate_level(self.workspace.record)
            if size <= EXACTLY_MET * level or (size > 0.5 * previous and size <= NEARLY_MET * level):
                return True
            if not size <= 10.0 * previous:
                return False
            previous = size
            rest = np.zeros(len(self.rows) - len(self.active))
            correction = self._kkt(np.concatenate([np.zeros(n), -violation, rest]))
            if correction is None:
                return False
            arrays[x][:n] += correction[:n]
            evaluate_residuals(self.workspace.record)
        return False

    def _points(self, h: float, table: Gauss, times: Floats, a: Floats, lam: Floats) -> Points | None:
        """Start, stages and end from the accelerations of the stages."""
        start, arrays, w = self.start, self.workspace.arrays, self.n_ext - self.n_work
        q, v = self._predict(h, table, a)
        power = np.zeros((len(times), self.n_work))
        for i in range(len(times)):
            if not self._place(float(times[i]), q[i], v[i], a[i], lam[i]):
                return None
            evaluate_power(self.workspace.record)
            power[i] = arrays["a"][w:]
        work = start.work[0] + h * (table.a @ power)
        end_matrix = interpolation_matrix(table.c, 1.0)
        q_end = start.q[0] + h * start.v[0] + h * h * (table.ba @ a)
        v_end = start.v[0] + h * (table.b @ a)
        a_end, lam_end = (end_matrix @ a)[0], (end_matrix @ lam)[0]
        t_end = self.t0 + h
        if not self._place(t_end, q_end, v_end, a_end, lam_end):
            return None
        if self.trusted(t_end):
            for _ in range(3):
                rhs = np.concatenate([-arrays["r"][: self.n], self._left()])
                increment = self._kkt(rhs)
                if increment is None:
                    return None
                arrays["a"][: self.n] += increment[: self.n]
                arrays["lam"][self.rows] += increment[self.n :]
                evaluate_residuals(self.workspace.record)
            a_end, lam_end = arrays["a"][: self.n].copy(), arrays["lam"][self.rows].copy()
        evaluate_power(self.workspace.record)
        work_end, power_end = start.work[0] + h * (table.b @ power), arrays["a"][w:].copy()
        return Points(
            np.concatenate([[self.t0], times, [t_end]]),
            np.vstack([start.q, q, q_end]),
            np.vstack([start.v, v, v_end]),
            np.vstack([start.a, a, a_end]),
            np.vstack([start.lam, lam, lam_end]),
            np.vstack([start.work, work, work_end]),
            np.vstack([start.power, power, power_end]),
        )


def _solve(matrix: Any, rhs: Floats) -> Floats | None:
    """The solution; None where there is none."""
    if isinstance(matrix, np.ndarray):
        try:
            found = np.linalg.solve(matrix, rhs)
        except np.linalg.LinAlgError:
            return None
    else:
        from scipy.sparse.linalg import splu

        try:
            found = splu(matrix).solve(rhs)
        except RuntimeError:  # exactly singular
            return None
    return np.asarray(found) if np.all(np.isfinite(found)) else None
