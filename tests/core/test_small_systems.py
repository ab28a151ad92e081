"""Small dense systems of any rank in compiled code, against numpy's."""

import numpy as np
import pytest
from tlismni.core.compiled.jit import compiled
from tlismni.core.linalg.small import least_norm, least_norm_size, solve_square


@compiled
def least(a, b, x, tolerance, work):
    return least_norm(a, b, x, tolerance, work.ctypes.data)


@compiled
def square(a, b):
    return solve_square(a, b)


def scratch(m, n, p):
    """NaN, and behind it what has to stay."""
    size = least_norm_size(m, n, p)
    return np.concatenate([np.full(size, np.nan), np.full(20, 7.0)])


def solved(a, b, tolerance):
    x, work = np.full((a.shape[1], b.shape[1]), np.nan), scratch(*a.shape, b.shape[1])
    rank = least(a.copy(), b.copy(), x, tolerance, work)
    assert np.all(work[-20:] == 7.0)
    return x, rank


def problems():
    rng = np.random.default_rng(1)
    for k in range(400):
        m, n, p = rng.integers(1, 25, 3)
        a = rng.normal(size=(m, n))
        if k % 2:
            rank = rng.integers(0, 10)
            a = rng.normal(size=(m, rank)) @ rng.normal(size=(rank, n))
        if k % 3 == 0:
            a *= 10.0 ** rng.uniform(-4.0, 0.0, n)
        yield a, rng.normal(size=(m, p)) if k % 5 else a @ rng.normal(size=(n, p))


def test_least_solutions_are_those_of_numpy():
    for a, b in problems():
        wanted, _, rank, values = np.linalg.lstsq(a, b, rcond=1e-11)
        x, found = solved(a, b, 1e-11)
        assert found == rank
        condition = values[0] / values[rank - 1] if rank else 1.0
        assert np.max(np.abs(x - wanted)) <= 1e-13 * a.shape[1] * condition * max(np.max(np.abs(wanted)), 1e-300)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("decades", [2, 6, 9, 14])
@pytest.mark.parametrize("n", [3, 12, 40])
def test_singular_values_that_fall_evenly(n, decades):
    """No gap tells the rank: the singular values do, and what counts is solved."""
    rng = np.random.default_rng(n)
    left, right = (np.linalg.qr(rng.normal(size=(n, n)))[0] for _ in range(2))
    a = left * np.logspace(0.0, -decades, n) @ right
    b = a @ rng.normal(size=(n, 1))
    wanted, _, rank, values = np.linalg.lstsq(a, b, rcond=3e-11)
    x, found = solved(a, b, 3e-11)
    assert found == rank
    assert np.max(np.abs(x - wanted)) < 1e-14 * n / values[rank - 1]
    assert np.max(np.abs(a @ x - b)) < 2.0 * np.max(np.abs(a @ wanted - b)) + 1e-14 * n


def test_square_systems():
    rng = np.random.default_rng(2)
    for n in (1, 2, 5, 30):
        a, b = rng.normal(size=(n, n)), rng.normal(size=n)
        x = b.copy()
        assert square(a.copy(), x) == np.sign(np.linalg.det(a))
        assert np.max(np.abs(a @ x - b)) < 1e-13 * n * max(1.0, np.max(np.abs(x)))
    assert not square(np.zeros((2, 2)), np.ones(2))
    assert not square(np.ones((3, 3)), np.ones(3))


def test_what_is_no_number_ends_too():
    a = np.array([[1.0, np.nan], [0.0, 1.0]])
    x, _ = solved(a, np.ones((2, 1)), 1e-11)
    assert x.shape == (2, 1)
    assert solved(np.zeros((3, 2)), np.ones((3, 1)), 1e-11)[1] == 0
