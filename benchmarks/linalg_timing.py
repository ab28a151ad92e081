"""Time of one refactorisation and solve, beside scipy's splu, on the matrices of planar chains.

Run: python benchmarks/linalg_timing.py. The matrix of N links is [M Phi^T; Phi 0]: 3 N coordinates, 2 N joint
constraints, joint i couples bodies i - 1 and i.
"""

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
from numba import njit
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu
from tlismni.core.linalg import Factorization, factor, solve


def chain_matrix(links: int, angles: np.ndarray, mass: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and values of [M Phi^T; Phi 0] of a chain of bars of length 1 at the given angles."""
    rows, cols, values = list(range(3 * links)), list(range(3 * links)), [mass, mass, mass / 12] * links
    for joint in range(links):
        for body, sign in ((joint - 1, 1.0), (joint, -1.0)):
            if body < 0:
                continue
            arm = 0.5 * sign * np.array([-np.sin(angles[body]), np.cos(angles[body])])
            for axis in range(2):
                row = 3 * links + 2 * joint + axis
                for col, value in ((3 * body + axis, sign), (3 * body + 2, sign * arm[axis])):
                    rows += [row, col]
                    cols += [col, row]
                    values += [value, value]
    return np.array(rows), np.array(cols), np.array(values)


@njit(cache=True)
def repeat(lu: Any, values_address: int, b_address: int, n_factor: int, n_solve: int) -> int:
    """Factor and solve many times without returning to Python."""
    status = 0
    for _ in range(n_factor):
        status |= factor(lu, values_address)
    for _ in range(n_solve):
        solve(lu, b_address)
    return status


def best_time(run: Callable[[], object], repeats: int = 5) -> float:
    """Shortest of some runs, s."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        run()
        times.append(perf_counter() - start)
    return min(times)


def measure(n: int, rows: np.ndarray, cols: np.ndarray, values: np.ndarray, dense: bool | None = None) -> None:
    """Print one line of the table."""
    factorization = Factorization(n, rows, cols, np.arange(len(rows)), dense=dense)
    factorization.analyze(values)
    b = np.ones(n)
    lu, at, to = factorization.record, values.ctypes.data, b.ctypes.data
    repeat(lu, at, to, 1, 0)
    once = best_time(lambda: repeat(lu, at, to, 1, 1), 3)
    count = max(1, int(2e-2 / max(once, 2e-7)))
    factor_time = best_time(lambda: repeat(lu, at, to, count, 0)) / count
    b[:] = 0.0  # stays finite however often it is solved
    solve_time = best_time(lambda: repeat(lu, at, to, 0, count)) / count
    analyze_time = best_time(lambda: factorization.analyze(values), 3)
    matrix = csc_array((values, (rows, cols)), shape=(n, n))
    rhs = np.ones(n)
    splu_time = best_time(lambda: splu(matrix).solve(rhs), 5)
    print(
        f"{n:6d} {factorization.kind:>8s} {len(rows):7d} {factorization.fill:8d}"
        f" {factor_time * 1e6:10.2f} {solve_time * 1e6:9.2f} {(factor_time + solve_time) * 1e6:9.2f}"
        f" {splu_time * 1e6:10.1f} {analyze_time * 1e3:9.2f}",
        flush=True,
    )


def main() -> None:
    """Print the table."""
    generator = np.random.default_rng(1)
    print(
        f"{'n':>6s} {'kind':>8s} {'entries':>7s} {'fill':>8s} {'factor us':>10s} {'solve us':>9s}"
        f" {'sum us':>9s} {'splu us':>10s} {'analyse ms':>9s}"
    )
    for links in (1, 2, 3, 4, 10, 100, 1000, 10000):
        matrix = chain_matrix(links, generator.uniform(-np.pi, np.pi, links))
        for dense in (True, False) if links <= 4 else (False,):
            measure(5 * links, *matrix, dense=dense)
    for n in (5, 10, 16):
        rows, cols = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
        for dense in (True, False):
            measure(n, rows, cols, generator.normal(size=n * n), dense=dense)


if __name__ == "__main__":
    main()
