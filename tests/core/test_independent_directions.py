"""Directions that do not repeat one another, and rows that hold one unknown alone: against numpy."""

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tlismni.core.contact_solvers.complementarity import Delassus, independent
from tlismni.core.linalg.single_rows import take_single_rows


def chosen(rows, inverse, normals):
    """Of rows (count, coordinates), of which the first ones are normals."""
    n, tangents = normals, len(rows) - normals
    assert n == tangents
    a = rows @ inverse @ rows.T
    delassus = Delassus(a[:n, :n], a[:n, n:], a[n:, n:], directions=rows, responses=rows @ inverse)
    kept_n, kept_t = independent(delassus, np.arange(n), np.arange(tangents))
    return kept_n, kept_t


@pytest.mark.sampled(15)
@pytest.mark.parametrize("seed", range(50))
def test_normals_come_first_and_what_is_kept_spans_all(seed):
    rng = np.random.default_rng(seed)
    coordinates, count = int(rng.integers(2, 8)), int(rng.integers(2, 9))
    base = rng.normal(size=(int(rng.integers(1, coordinates + 1)), coordinates))
    rows = rng.normal(size=(2 * count, len(base))) @ base
    mass = rng.normal(size=(coordinates, coordinates))
    kept_n, kept_t = chosen(rows, mass @ mass.T + np.eye(coordinates), count)
    rank = np.linalg.matrix_rank
    assert len(kept_n) == rank(rows[:count]) == rank(rows[kept_n])
    kept = [*kept_n, *(count + i for i in kept_t)]
    assert len(kept) == rank(rows) == rank(rows[kept])


@pytest.mark.parametrize("distance", [1e-3, 1e-5, 1e-7])
def test_of_feet_that_are_close_one_is_kept_with_one_that_is_far(distance):
    """A beam on three feet, the most important two next to each other: with these two alone, rounding would tip it."""
    places = np.array([0.5, 0.5 - distance, -0.5])
    normals = np.column_stack([np.zeros(3), np.ones(3), places])
    tangents = np.column_stack([np.ones(3), np.zeros(3), np.full(3, 0.1)])
    rows, inverse = np.vstack([normals, tangents]), np.diag([1.0, 1.0, 12.0])
    kept_n, kept_t = chosen(rows, inverse, 3)
    assert kept_n == [0, 2]
    kept = rows[[*kept_n, *(3 + i for i in kept_t)]] @ np.sqrt(inverse)
    assert np.linalg.cond(kept) < 10.0


@numba.njit
def _take(matrix, x, right, kept):
    return take_single_rows(matrix.ctypes.data, len(x), x, right, kept)


@settings(deadline=None, max_examples=200)
@given(st.integers(1, 12), st.integers(0, 12), st.integers(0, 10_000))
def test_single_rows(m, alone, seed):
    """The system that is left has the solution of the whole one."""
    rng = np.random.default_rng(seed)
    matrix, b = rng.normal(size=(m, m)) + 4.0 * np.eye(m), rng.normal(size=m)
    for i in rng.permutation(m)[: min(alone, m)]:
        matrix[i] = 0.0
        matrix[i, i] = rng.uniform(0.5, 2.0)
    wanted = np.linalg.solve(matrix, b)
    work, x, right, kept = matrix.copy(), b.copy(), np.zeros(m), np.zeros(m)
    left = _take(work, x, right, kept)
    assert left == np.sum(np.count_nonzero(matrix, axis=1) > 1)
    if left > 0:
        x[kept[:left].astype(int)] = np.linalg.solve(work.ravel()[: left * left].reshape(left, left), right[:left])
    np.testing.assert_allclose(x, wanted, rtol=1e-9, atol=1e-12 * np.linalg.cond(matrix))


def test_a_row_of_zeros_gives_zero():
    matrix, x = np.array([[0.0, 0.0], [1.0, 2.0]]), np.array([3.0, 8.0])
    right, kept = np.zeros(2), np.zeros(2)
    assert _take(matrix, x, right, kept) == 1
    assert x[0] == 0.0 and (matrix[0, 0], right[0], kept[0]) == (2.0, 8.0, 1.0)
