"""Nonnegative least squares from a Gram matrix, against scipy's."""

import numpy as np
import pytest
from scipy.optimize import nnls
from tlismni.core.compiled.jit import compiled
from tlismni.core.contact_solvers.nonnegative import nonnegative, nonnegative_size


@compiled
def solve(s, r, fixed, z, w, work):
    nonnegative(s, r, fixed, 1e-9, z, w, work.ctypes.data)


@pytest.mark.sampled(20)
@pytest.mark.parametrize("seed", range(60))
def test_it_solves_what_scipy_solves(seed):
    """Columns repeat each other in most of the problems: the matrix is singular, the gradient still unique."""
    rng = np.random.default_rng(seed)
    n, rank = int(rng.integers(2, 12)), int(rng.integers(1, 8))
    columns = rng.normal(size=(rank, n)) * 10.0 ** rng.uniform(-3, 3, n)
    if seed % 3 == 0 and n > 2:
        columns[:, 1] = 0.0
    fixed = int(rng.integers(n))
    s = np.ascontiguousarray(columns.T @ columns)
    z, w, size = np.full(n, np.nan), np.full(n, np.nan), nonnegative_size(n)
    work = np.concatenate([np.full(size, np.nan), np.full(20, 7.0)])
    solve(s, s[fixed].copy(), fixed, z, w, work)
    assert np.all(work[-20:] == 7.0)
    others = np.delete(np.arange(n), fixed)
    assert z[fixed] == 0.0 and np.all(z >= 0.0)
    wanted = columns[:, fixed] + columns[:, others] @ nnls(columns[:, others], -columns[:, fixed])[0]
    scale = np.sqrt(np.diag(s)) * np.linalg.norm(columns[:, fixed]) + 1e-300
    np.testing.assert_allclose(w / scale, columns.T @ wanted / scale, atol=2e-9)
