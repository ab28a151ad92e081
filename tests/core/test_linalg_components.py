"""Solutions with the pivots of one component of a matrix, against numpy."""

import numpy as np
import pytest
from numba import njit
from test_linalg import chain, full
from tlismni.core.compiled.views import uvec
from tlismni.core.linalg import Factorization, factorization
from tlismni.core.linalg.components import RIGHT_SIDES, find_components, solve_component
from tlismni.core.linalg.record import MATRIX_KINDS


@njit
def _solve(lu, b, component, start, pivots, place, x):
    """Solutions x for the right sides b (n, RIGHT_SIDES), each component on its own; how many there are."""
    count, y, n = find_components(lu, component, start, pivots, place), np.zeros_like(b), len(b)
    for i in range(n):
        for k in range(RIGHT_SIDES):
            y[place[i], k] = b[i, k]
    for c in range(count):
        solve_component(lu, pivots, start[c], start[c + 1], y)
    col_at = uvec(lu.col_at, n)
    for j in range(n):
        for k in range(RIGHT_SIDES):
            x[np.int64(col_at[j]), k] = y[j, k]
    return count


@pytest.mark.parametrize("kind", ["program", "columns"])
@pytest.mark.parametrize("seed", range(4))
def test_components_are_solved_alone(kind, seed, monkeypatch):
    """Chains without a joint between them, in any order of rows and columns."""
    monkeypatch.setattr(factorization, "PROGRAM_LIMIT", 10**9 if kind == "program" else 0)
    rng = np.random.default_rng(seed)
    links, parts, n = rng.integers(2, 9, 5).tolist(), [], 0
    for count in links:
        rows, cols, values = chain(count, rng.uniform(-np.pi, np.pi, count))
        parts.append((rows + n, cols + n, values))
        n += 5 * count
    rows, cols, values = (np.concatenate(each) for each in zip(*parts, strict=True))
    new = rng.permutation(n)
    rows, cols, owner = new[rows], new[cols], np.empty(n, dtype=int)
    owner[new] = np.repeat(range(5), 5 * np.array(links))
    lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=False)
    lu.analyze(values)
    assert MATRIX_KINDS[int(lu.record["kind"])] == kind
    b, x = rng.normal(size=(n, RIGHT_SIDES)), np.empty((n, RIGHT_SIDES))
    component, pivots, place = (np.empty(n, dtype=np.int64) for _ in range(3))
    start = np.empty(n + 1, dtype=np.int64)
    assert _solve(lu.record, b, component, start, pivots, place, x) == 5
    assert len({(owner[i], component[place[i]]) for i in range(n)}) == 5
    assert np.allclose(x, np.linalg.solve(full(n, rows, cols, values), b), rtol=1e-9, atol=1e-9)
