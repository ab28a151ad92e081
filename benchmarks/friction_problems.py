"""Time and residual of `solve_friction` on a collection of contact problems and on stacks, beside the dense solver.

Run: python benchmarks/friction_problems.py [COLLECTION.npz] [--dense] [--least]. COLLECTION has the keys `NAME|data`,
`NAME|indices`, `NAME|indptr` of a Delassus matrix by rows, blocks of normal, tangent, tangent, and `NAME|q`, `NAME|mu`;
without it there are the stacks alone. --dense adds the compiled solver of impacts, which takes a dense matrix (compiled
at first where there is no machine code, in minutes); --least the forces of equally compliant contacts. Times are of the
process, the best of three, in ms.
"""

import argparse
import logging
from collections.abc import Callable, Iterator
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from scipy import sparse
from tlismni.core import solve_friction

Problem = tuple[str, Any, Any, Any]


def collected(path: Path) -> Iterator[Problem]:
    with np.load(path) as file:
        for name in sorted({key.split("|")[0] for key in file.files}):
            data, indices, indptr, q, mu = (file[f"{name}|{part}"] for part in ("data", "indices", "indptr", "q", "mu"))
            yield name, sparse.csr_array((data, indices, indptr), shape=(len(q), len(q))), q, mu


def stack(boxes: int, columns: int, mu: float = 0.5) -> Problem:
    """Columns of cubes of 1 kg and 1 m, each of which meets the one below with four corners; all fall, and drift."""
    random = np.random.default_rng(boxes)
    rows, cols, values = [], [], []
    n = 0
    for column in range(columns):
        for box in range(boxes):
            for x in (-0.5, 0.5):
                for y in (-0.5, 0.5):
                    for body, z, sign in ((box, -0.5, 1.0), (box - 1, 0.5, -1.0)):
                        if body < 0:
                            continue
                        turning = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])
                        block = sign * np.hstack([np.eye(3), turning])[[2, 0, 1]]
                        at = 6 * (column * boxes + body)
                        rows += np.repeat(3 * n + np.arange(3), 6).tolist()
                        cols += np.tile(at + np.arange(6), 3).tolist()
                        values += block.ravel().tolist()
                    n += 1
    g = sparse.csr_array((values, (rows, cols)), shape=(3 * n, 6 * boxes * columns))
    inverse = np.tile([1.0, 1.0, 1.0, 6.0, 6.0, 6.0], boxes * columns)
    motion = np.tile([0.0, 0.0, -0.1, 0.0, 0.0, 0.0], boxes * columns)
    motion += 0.02 * random.normal(size=len(motion))
    return f"{columns} x {boxes} boxes", (g * inverse) @ g.T, g @ motion, np.full(n, mu)


def best_time(call: Callable[[], Any]) -> tuple[float, Any]:
    """CPU time of the best of three calls, ms, and what it gave."""
    times = []
    for _ in range(3):
        began = process_time()
        found = call()
        times.append(1e3 * (process_time() - began))
    return min(times), found


def dense_solver() -> Callable[[Any, Any, Any], tuple[bool, Any]]:
    """The compiled solver of impacts: whether it found forces, and those, in the order of `solve_friction`."""
    import numba
    from tlismni.core.compiled.jit import address_of
    from tlismni.core.contact_solvers.friction_cones import (
        CONES_SOLVED,
        MOST_SWEEPS,
        friction_cones_size,
        solve_friction_cones,
    )
    from tlismni.core.linalg.small import LEAST_NORM_SIGNATURE, least_norm

    address = address_of(least_norm, LEAST_NORM_SIGNATURE)

    @numba.njit
    def call(n: int, a: Any, b: Any, mu: Any, nothing: Any, way: Any, p: Any, work: int) -> int:
        return solve_friction_cones(address, n, a, b, mu, nothing, nothing, way, p, work, MOST_SWEEPS)

    def solve(w: Any, q: Any, mu: Any) -> tuple[bool, Any]:
        n = len(mu)
        order = np.arange(3 * n).reshape(n, 3).T.ravel()
        a, b = np.ascontiguousarray(w.toarray()[np.ix_(order, order)]), q[order]
        p, work = np.zeros(3 * n), np.zeros(friction_cones_size(n))
        status = call(n, a, b, mu.astype(float), np.zeros(n), np.zeros((2, n)), p, work.ctypes.data)
        forces = np.empty(3 * n)
        forces[order] = p
        return status == CONES_SOLVED, forces

    return solve


def main() -> None:
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("collection", nargs="?", type=Path)
    words.add_argument("--dense", action="store_true")
    words.add_argument("--least", action="store_true")
    asked = words.parse_args()
    logging.disable(logging.WARNING)
    problems = list(collected(asked.collection)) if asked.collection else []
    problems += [stack(boxes, columns) for boxes, columns in ((1, 1), (5, 1), (10, 1), (10, 5), (10, 20), (10, 60))]
    dense = dense_solver() if asked.dense else None
    print(f"{'problem':32} contacts     ms  residual  first  newton" + "   dense ms  found" * asked.dense)
    for name, w, q, mu in sorted(problems, key=lambda problem: len(problem[3])):
        time, found = best_time(lambda w=w, q=q, mu=mu: solve_friction(w, q, mu, least=asked.least))
        line = f"{name:32} {len(mu):8d} {time:6.1f}   {found.residual:.1e} {found.first_order_iterations:6d}"
        line += f" {found.newton_iterations:7d}"
        if dense is not None and len(mu) <= 300:
            time, (good, _) = best_time(lambda w=w, q=q, mu=mu: dense(w, q, mu))
            line += f" {time:10.1f}  {'yes' if good else 'no'}"
        print(line, flush=True)


if __name__ == "__main__":
    main()
