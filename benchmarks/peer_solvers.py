"""General DAE solvers on the equations of `peer_equations.py`: scipy_dae's solve_dae and SUNDIALS' IDA.

Both get compiled residuals and analytic Jacobians, dense or sparse. Not among the project's requirements:
pip install scipy_dae scikit-sundae
"""

from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from time import perf_counter
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from peer_equations import Equations
from scipy.sparse import csc_matrix

Array = NDArray[np.float64]

LEAST_STEP = 2e-5
"""Seconds that a step of IDA takes at least."""
FREE = 1e10
"""Absolute tolerance of variables that shall not count in the error test."""


class PeerFailed(Exception):
    """A peer did not reach the end."""


def missing(module: str, package: str) -> str:
    """Why a peer cannot be run; "" if it can."""
    return "" if find_spec(module) else f"{package} is not installed (pip install {package})"


def installed(package: str) -> str:
    """Its version; "" if it is not there."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


class Pattern:
    """Compressed columns of the triplets of some kinds; sums what falls on the same place."""

    def __init__(self, equations: Equations, kinds: tuple[int, ...]) -> None:
        rows, columns, kind, _ = equations.triplets(equations.y0, equations.yp0)
        size = equations.size
        chosen = np.isin(kind, kinds)
        place = columns * size + rows
        self.places, slots = np.unique(place[chosen], return_inverse=True)
        self.slot = np.full(len(rows), -1)
        self.slot[chosen] = slots
        self.indices = (self.places % size).astype(np.int32)
        self.indptr = np.searchsorted(self.places, np.arange(size + 1) * size).astype(np.int32)
        self.shape = (size, size)

    def matrix(self, values: Array) -> csc_matrix:
        return csc_matrix((values, self.indices, self.indptr), shape=self.shape)


def _scatter(equations: Equations, patterns: tuple[Pattern, ...], dense: bool) -> Callable[..., None]:
    """scatter(y, yp, cj, first, second): dF/dy into `first`, dF/dy' into `second` (or cj times it into `first`)."""
    entries, most, size = equations.entries, equations.most, equations.size
    first_slot = patterns[0].slot
    second_slot = patterns[-1].slot
    together = len(patterns) == 1

    @njit
    def scatter(y: Any, yp: Any, cj: float, first: Any, second: Any) -> None:
        rows, columns, kinds = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most, np.int64)
        values = np.empty(most)
        count = entries(y, yp, rows, columns, kinds, values)
        first[:] = 0.0
        if not together:
            second[:] = 0.0
        for k in range(count):
            value = values[k] * (cj if together and kinds[k] == 1 else 1.0)
            target = second if kinds[k] == 1 and not together else first
            if dense:
                target[rows[k] * size + columns[k]] += value
            else:
                target[second_slot[k] if kinds[k] == 1 else first_slot[k]] += value

    return scatter


def dae_solver(
    equations: Equations, t_end: float, method: str, sparse: bool, limit: float = np.inf, **options: Any
) -> Callable[[float], tuple[float, Array]]:
    """run(tolerance) -> (seconds, q at the end) with solve_dae; all variables count in the error test.

    Runs longer than `limit` seconds raise PeerFailed.
    """
    from scipy_dae.integrate import solve_dae

    size, residual = equations.size, equations.residual
    patterns = (Pattern(equations, (0,)), Pattern(equations, (1,)))
    scatter = _scatter(equations, patterns, not sparse)

    stop_at = [np.inf]

    def fun(t: float, y: Array, yp: Array) -> Array:
        if perf_counter() > stop_at[0]:
            raise PeerFailed(f"solve_dae, {method}: longer than {limit:g} s")
        out = np.empty(size)
        residual(y, yp, out)
        return out

    def jac(t: float, y: Array, yp: Array) -> tuple[Any, Any]:
        if sparse:
            values = tuple(np.empty(len(p.places)) for p in patterns)
            scatter(y, yp, 0.0, *values)
            return patterns[0].matrix(values[0]), patterns[1].matrix(values[1])
        flat = np.empty((2, size * size))
        scatter(y, yp, 0.0, flat[0], flat[1])
        return flat[0].reshape(size, size), flat[1].reshape(size, size)

    def run(tolerance: float) -> tuple[float, Array]:
        start = perf_counter()
        stop_at[0] = start + limit
        result = solve_dae(
            fun, (0.0, t_end), equations.y0, equations.yp0, method=method, rtol=tolerance, atol=0.01 * tolerance,
            t_eval=[t_end], jac=jac, **options,
        )  # fmt: skip
        seconds = perf_counter() - start
        if not result.success:
            raise PeerFailed(f"solve_dae, {method}: {result.message}")
        return seconds, result.y[: equations.n, -1]

    return run


def ida(
    equations: Equations, t_end: float, linear_solver: str, limit: float = np.inf, max_order: int = 5
) -> Callable[[float], tuple[float, Array]]:
    """run(tolerance) -> (seconds, q at the end) with IDA; the multipliers do not count in the error test.

    Runs longer than about `limit` seconds raise PeerFailed: the steps are counted, as IDA cannot be interrupted.
    """
    from sksundae.ida import IDA

    n, size, residual = equations.n, equations.size, equations.residual
    pattern = Pattern(equations, (0, 1))
    sparse = linear_solver == "sparse"
    scatter = _scatter(equations, (pattern,), not sparse)
    unused = np.empty(0)
    most_steps = int(min(1e9, limit / LEAST_STEP))

    def resfn(t: float, y: Array, yp: Array, res: Array) -> None:
        residual(y, yp, res)

    def jacfn(t: float, y: Array, yp: Array, res: Array, cj: float, JJ: Array) -> None:
        scatter(y, yp, cj, JJ if sparse else JJ.reshape(-1), unused)

    options: dict[str, Any] = {"linsolver": linear_solver}
    if sparse:
        options["sparsity"] = pattern.matrix(np.ones(len(pattern.places)))

    def run(tolerance: float) -> tuple[float, Array]:
        atol = np.full(size, 0.01 * tolerance)
        atol[2 * n :] = FREE
        solver = IDA(
            resfn, jacfn=jacfn, rtol=tolerance, atol=atol, max_num_steps=most_steps, max_order=max_order,
            algebraic_idx=list(range(2 * n, size)) if equations.index == 2 else None, **options,
        )  # fmt: skip
        solver.init_step(0.0, equations.y0, equations.yp0)
        start = perf_counter()
        result = solver.step(t_end, method="normal", tstop=t_end)
        seconds = perf_counter() - start
        if not result.success:
            raise PeerFailed(f"IDA: {result.message}")
        return seconds, np.array(result.y).reshape(-1)[:n]

    return run
