"""The compiled linear solver against numpy, and what its statuses promise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from tlismni.core.compiled import vec
from tlismni.core.linalg import (
    NO_PIVOT,
    OK,
    REANALYSE,
    Factorization,
    SingularMatrixError,
    determinant_sign,
    factor,
    factorization,
    independent_columns,
    lu_at,
    pivot_rows,
    solve,
)
from tlismni.core.linalg.record import IN_INDEX

seeds = st.integers(0, 2**32 - 1)


def chain(links, angles, mass=1.0):
    """Rows, columns, values of [M Phi^T; Phi 0] of a chain of bars; all values of Phi explicit, zeros too."""
    rows, cols, values = list(range(3 * links)), list(range(3 * links)), [mass, mass, mass / 12] * links
    for joint in range(links):
        for body, sign in ((joint - 1, 1.0), (joint, -1.0)):
            if body < 0:
                continue
            arm = (-0.5 * sign * np.sin(angles[body]), 0.5 * sign * np.cos(angles[body]))
            for axis in range(2):
                row = 3 * links + 2 * joint + axis
                for col, value in ((3 * body + axis, sign), (3 * body + 2, sign * arm[axis])):
                    rows += [row, col]
                    cols += [col, row]
                    values += [value, value]
    return np.array(rows), np.array(cols), np.array(values)


def random_matrix(n, rng, per_row=3):
    """A sparse matrix with a random heavy permuted diagonal: well conditioned, pivots off the diagonal."""
    place = {(i, int(j)): 4.0 * rng.choice([-1, 1]) for i, j in enumerate(rng.permutation(n))}
    for _ in range(per_row * n):
        place.setdefault((int(rng.integers(n)), int(rng.integers(n))), rng.uniform(-1, 1))
    rows, cols = np.array(list(place)).T
    return rows, cols, np.array(list(place.values()))


def full(n, rows, cols, values):
    a = np.zeros((n, n))
    a[rows, cols] = values
    return a


def backward_error(a, x, b):
    return np.abs(a @ x - b).max() / (np.abs(a).sum(axis=1).max() * np.abs(x).max() + np.abs(b).max())


@pytest.fixture(params=["program", "columns"])
def sparse_kind(request, monkeypatch):
    """Both ways of the sparse refactorisation, whatever the operation count."""
    monkeypatch.setattr(factorization, "PROGRAM_LIMIT", 10**9 if request.param == "program" else 0)
    return request.param


@settings(deadline=None, max_examples=60)
@given(seed=seeds, n=st.integers(1, 60), per_row=st.integers(0, 8), dense=st.sampled_from([True, False, None]))
def test_solution_is_that_of_numpy(seed, n, per_row, dense):
    rng = np.random.default_rng(seed)
    rows, cols, values = random_matrix(n, rng, per_row)
    slots = rng.permutation(len(values) + 5)[: len(values)]
    source = np.full(len(values) + 5, np.nan)  # what no slot names is not read
    source[slots] = values
    lu = Factorization(n, rows, cols, slots, dense=dense, source_size=len(source))
    lu.analyze(source)
    b = rng.normal(size=n)
    a = full(n, rows, cols, values)
    x = lu.solve(b)
    assert backward_error(a, x, b) < 1e-12
    assert np.allclose(x, np.linalg.solve(a, b), rtol=1e-8, atol=1e-10 * np.linalg.cond(a))


@settings(deadline=None, max_examples=60)
@given(seed=seeds, n=st.integers(1, 40), per_row=st.integers(0, 8), dense=st.booleans())
def test_sign_of_the_determinant_is_that_of_numpy(seed, n, per_row, dense):
    rng = np.random.default_rng(seed)
    rows, cols, values = random_matrix(n, rng, per_row)
    lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=dense)
    lu.analyze(values)
    for k in range(3):
        if k > 0:  # a row the other way round, with the pivots that are there
            values = np.where(rows == rng.integers(n), -values, values)
            assert lu.factor(values) == OK
        assert determinant_sign(lu.record) == np.linalg.slogdet(full(n, rows, cols, values))[0]


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e3])
def test_new_values_of_a_chain_seldom_need_a_new_analysis(mass):
    """Of all shapes that a chain can take, about one in a thousand has a pivot too small for the order of another."""
    rng = np.random.default_rng(5)
    asked, tried = 0, 0
    for links in (*range(1, 31), *range(1, 31)):
        rows, cols, values = chain(links, rng.uniform(-np.pi, np.pi, links), mass)
        n = 5 * links
        lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=False)
        lu.analyze(values)
        for _ in range(3):
            values = chain(links, rng.uniform(-np.pi, np.pi, links), mass)[2]
            tried += 1
            if lu.factor(values) != OK:
                asked += 1
                lu.analyze(values)
            b = rng.normal(size=n)
            assert backward_error(full(n, rows, cols, values), lu.solve(b), b) < 1e-12
    assert asked <= 0.01 * tried


@given(seed=seeds)
@settings(deadline=None, max_examples=25)
def test_pivots_follow_from_the_values_alone(seed):
    """Whatever was factorised before: bars that turn make other pivots, and come back to the same bits."""
    rng = np.random.default_rng(seed)
    links = int(rng.integers(2, 12))
    turns = [chain(links, rng.uniform(-np.pi, np.pi, links), mass=10.0 ** rng.uniform(-3, 3)) for _ in range(4)]
    rows, cols, _ = turns[0]
    worn = Factorization(5 * links, rows, cols, np.arange(len(rows)), dense=False)
    for k in rng.integers(0, len(turns), 12):
        values = turns[k][2]
        worn.analyze(values)
        fresh = Factorization(5 * links, rows, cols, np.arange(len(rows)), dense=False)
        fresh.analyze(values)
        assert all(np.array_equal(x, y) for x, y in zip(worn.analysis(), fresh.analysis(), strict=True))
        assert worn.lu_values.tobytes() == fresh.lu_values.tobytes()
        x = rng.normal(size=5 * links)
        assert np.allclose(worn.solve(full(5 * links, rows, cols, values) @ x), x, rtol=1e-7, atol=1e-7)


def test_many_analyses_one_after_the_other():
    n, rng = 12, np.random.default_rng(7)
    rows, cols = (x.ravel() for x in np.indices((n, n)))
    lu = Factorization(n, rows, cols, np.arange(n * n), dense=False)
    for _ in range(140):
        values = np.zeros((n, n))
        values[rng.permutation(n), np.arange(n)] = 10.0
        values += rng.uniform(-0.1, 0.1, (n, n))
        lu.analyze(values.ravel())
        x = rng.normal(size=n)
        assert np.allclose(lu.solve(values @ x), x)


@pytest.mark.parametrize("links", [2, 40, 400])
def test_dense_program_and_columns_agree(links, monkeypatch):
    rng = np.random.default_rng(links)
    n = 5 * links
    rows, cols, values = chain(links, rng.uniform(-np.pi, np.pi, links))
    b = rng.normal(size=n)
    solutions, kinds = [], []
    for dense, limit in ((False, 16), (False, 0), (True, 16)):
        monkeypatch.setattr(factorization, "PROGRAM_LIMIT", limit)
        if dense and n > 500:
            continue
        lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=dense)
        lu.analyze(values)
        solutions.append(lu.solve(b))
        kinds.append(lu.kind)
    assert kinds[:2] == ["program", "columns"]
    assert np.array_equal(solutions[0], solutions[1])
    assert np.allclose(solutions[0], solutions[-1], rtol=1e-8, atol=1e-9)


def test_entries_zero_by_chance_at_analysis_keep_their_place(sparse_kind):
    links, n = 20, 100
    rng = np.random.default_rng(3)
    rows, cols, straight = chain(links, np.zeros(links))  # every sine is zero
    lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=False)
    lu.analyze(straight)
    assert lu.kind == sparse_kind
    values = chain(links, rng.uniform(-np.pi, np.pi, links))[2]
    assert lu.factor(values) == OK
    b = rng.normal(size=n)
    assert backward_error(full(n, rows, cols, values), lu.solve(b), b) < 1e-12


@settings(deadline=None, max_examples=40)
@given(seed=seeds, n=st.integers(2, 40))
def test_any_entry_off_the_pivots_may_be_zero_at_analysis(seed, n):
    rng = np.random.default_rng(seed)
    rows, cols, values = random_matrix(n, rng)
    light = np.where((np.abs(values) < 4.0) & (rng.random(len(values)) < 0.7), 0.0, values)
    lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=False)
    lu.analyze(light)
    status = lu.factor(values)
    b = rng.normal(size=n)
    if status != OK:
        lu.analyze(values)
    assert backward_error(full(n, rows, cols, values), lu.solve(b), b) < 1e-11


@pytest.mark.parametrize("dense", [True, False])
@pytest.mark.parametrize(
    ("matrix", "place"),
    [
        ([[1.0, 2.0, 0.0], [2.0, 4.0, 0.0], [0.0, 0.0, 1.0]], "row 1 is a combination of rows 0"),
        ([[1.0, 2.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 1.0]], "row 1 is zero"),
        ([[1.0, 0.0, 0.0], [2.0, 0.0, 4.0], [0.0, 0.0, 1.0]], "column 1 is zero"),
        ([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9]], "row 2 is a combination of rows 0, 1"),
    ],
)
def test_singular_matrix_is_named(dense, matrix, place):
    values = np.array(matrix).ravel()
    rows, cols = np.divmod(np.arange(9), 3)
    lu = Factorization(3, rows, cols, np.arange(9), dense=dense)
    with pytest.raises(SingularMatrixError, match=f"3 x 3.*{place}"):
        lu.analyze(values)
    lu.analyze(np.eye(3).ravel())
    assert lu.factor(values) == NO_PIVOT


@pytest.mark.parametrize("dense", [True, False])
def test_scaling_does_not_make_a_matrix_singular(dense):
    links, n = 3, 15
    rng = np.random.default_rng(8)
    rows, cols, values = chain(links, rng.uniform(-np.pi, np.pi, links))
    scale = 10.0 ** rng.uniform(-9, 9, n)
    values = values * scale[rows] * scale[cols]
    lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=dense)
    lu.analyze(values)
    if not dense:  # partial pivoting on unscaled rows loses digits, pivots taken on scaled ones do not
        b = rng.normal(size=n) * scale
        x = lu.solve(b)
        a = full(n, rows, cols, values)
        assert np.max(np.abs(a @ x - b) / (np.abs(a) @ np.abs(x) + np.abs(b))) < 1e-12


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_value_that_is_not_finite_is_reported(bad, sparse_kind):
    for dense in (True, False):
        rows, cols = np.array([0, 0, 1, 2]), np.array([0, 2, 1, 2])  # (0, 2) reaches no pivot
        lu = Factorization(3, rows, cols, np.arange(4), dense=dense)
        lu.analyze(np.ones(4))
        assert lu.factor(np.array([1.0, bad, 1.0, 1.0])) == NO_PIVOT
        with pytest.raises(SingularMatrixError, match=r"entry \(0, 2\)"):
            lu.analyze(np.array([1.0, bad, 1.0, 1.0]))
        assert lu.factor(np.ones(4)) == OK


def test_degraded_pivots_are_reported_and_analysis_repairs_them(sparse_kind):
    n = 30
    rng = np.random.default_rng(1)
    rows, cols = np.divmod(np.arange(n * n), n)
    good = (10.0 * np.eye(n) + rng.uniform(-1, 1, (n, n))).ravel()
    bad = (1e-9 * np.eye(n) + np.roll(10.0 * np.eye(n), 1, axis=0)).ravel()
    lu = Factorization(n, rows, cols, np.arange(n * n), dense=False)
    lu.analyze(good)
    assert lu.factor(good) == OK
    assert lu.factor(bad) == REANALYSE
    zero = np.roll(np.eye(n), 1, axis=0).ravel()
    assert lu.factor(zero) == NO_PIVOT  # these pivots; others would do
    for values in (bad, zero):
        lu.analyze(values)
        assert lu.factor(values) == OK
        b = rng.normal(size=n)
        assert backward_error(values.reshape(n, n), lu.solve(b), b) < 1e-14


def test_factor_before_analysis_asks_for_it():
    lu = Factorization(2, [0, 1], [0, 1], [0, 1], dense=False)
    assert lu.factor(np.ones(2)) == REANALYSE


@pytest.mark.parametrize("dense", [True, False])
def test_stored_analysis_restores_every_bit(dense, sparse_kind):
    links, n = 8, 40
    rng = np.random.default_rng(5)
    rows, cols, first = chain(links, rng.uniform(-np.pi, np.pi, links))
    then = chain(links, rng.uniform(-np.pi, np.pi, links))[2]
    b = rng.normal(size=n)
    one = Factorization(n, rows, cols, np.arange(len(rows)), dense=dense)
    one.analyze(first)
    assert one.factor(then) == OK
    x = one.solve(b)
    values, pivots = one.lu_values.copy(), one.pivots.copy()
    other = Factorization(n, rows, cols, np.arange(len(rows)), dense=dense)
    other.analyze_with(*one.analysis())
    for name in IN_INDEX if not dense else ("entry_to", "entry_from"):
        places = [lu.record[name] - lu.record["index"] for lu in (one, other)]
        assert places[0] == places[1], name
    used = 2 * len(rows) if dense else (one.record["sum_right"] - one.record["index"]) // 4 + one.record["n_sums"]
    assert np.array_equal(one._at("index", used, np.uint32), other._at("index", used, np.uint32))
    assert other.factor(then) == OK
    assert np.array_equal(other.solve(b), x)
    other.factor(first)
    other.lu_values[:] = values
    other.pivots[:] = pivots
    assert np.array_equal(other.solve(b), x)
    assert np.array_equal(other.lu_values, one.lu_values)


@njit
def _factor_and_solve_at(address, values_address, b_address):
    lu = lu_at(address)
    status = factor(lu, values_address)
    solve(lu, b_address)
    return status, vec(b_address, lu.n)[0]


def test_holders_of_the_address_see_a_new_analysis():
    n = 10
    rng = np.random.default_rng(2)
    rows, cols, values = random_matrix(n, rng)
    lu = Factorization(n, rows, cols, np.arange(len(rows)), dense=False)
    address, record = lu.address, lu.record
    for _ in range(2):
        lu.analyze(values)
        assert lu.address == address
        assert record["values"] == lu.lu_values.ctypes.data
        b = rng.normal(size=n)
        x = b.copy()
        status, first = _factor_and_solve_at(address, values.ctypes.data, x.ctypes.data)
        assert status == OK
        assert first == x[0]
        assert backward_error(full(n, rows, cols, values), x, b) < 1e-12
        values = values * rng.uniform(0.5, 2, len(values))


@settings(deadline=None, max_examples=60)
@given(seed=seeds, n=st.integers(1, 40), density=st.floats(0, 0.4))
def test_fill_pattern_is_that_of_elimination(seed, n, density):
    rng = np.random.default_rng(seed)
    pattern = (rng.random((n, n)) < density) | np.eye(n, dtype=bool)
    row, col = np.nonzero(pattern)
    mixed = rng.permutation(len(row))
    lu = Factorization(n, row[mixed], col[mixed], np.arange(len(row)), dense=False)
    lu.analyze(np.where(row[mixed] == col[mixed], 10.0 * n, 1.0))
    place_c = lu.analysis()[1]
    place_r = rng.permutation(n)
    lu.analyze_with(place_r, place_c)
    pattern = pattern[np.argsort(place_r)][:, np.argsort(place_c)]
    for k in range(n):
        pattern[k + 1 :, k + 1 :] |= np.outer(pattern[k + 1 :, k], pattern[k, k + 1 :])
    for name, expected in (("l", np.tril(pattern, -1)), ("u", np.triu(pattern, 1))):
        col, row = np.nonzero(expected.T)
        count = lu.record[f"n{name}"]
        assert np.array_equal(lu._at(f"{name}_row", count, np.uint32), row)
        assert np.array_equal(lu._at(f"{name}_col", count, np.uint32), col)
        assert np.array_equal(np.diff(lu._at(f"{name}_start", n + 1, np.uint32)), expected.sum(axis=0))


def test_empty_matrix():
    lu = Factorization(0, [], [], [])
    lu.analyze(np.empty(0))
    assert lu.factor(np.empty(0)) == OK
    assert lu.solve([]).shape == (0,)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((2, [0, 0], [1, 1], [0, 1]), r"entry \(0, 1\) is given more than once"),
        ((2, [0, 2], [0, 1], [0, 1]), "rows must be in 0..1"),
        ((2, [0, 1], [0, -1], [0, 1]), "cols must be in 0..1"),
        ((2, [0, 1], [0, 1], [0]), "one length"),
        ((2, [0, 1], [0, 1], [0, 7], None, 3), "slots must be in 0..2"),
        ((-1, [], [], []), "negative"),
    ],
)
def test_wrong_input_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Factorization(*arguments)


def test_wrong_vectors_are_refused():
    lu = Factorization(2, [0, 1], [0, 1], [0, 1], dense=False)
    with pytest.raises(ValueError, match="needs 2 values"):
        lu.analyze(np.ones(1))
    with pytest.raises(ValueError, match="permutation"):
        lu.analyze_with([0, 0], [0, 1])
    lu.analyze(np.ones(2))
    with pytest.raises(ValueError, match="shape"):
        lu.solve(np.ones(3))


def csr(a):
    a = np.asarray(a, float)
    keep = [np.flatnonzero(row) for row in a]
    data = np.concatenate([row[k] for row, k in zip(a, keep, strict=True)])
    return *a.shape, np.cumsum([0, *map(len, keep)]), np.concatenate(keep), data


def test_pivot_is_the_largest_scaled_entry_and_the_lowest_of_equals():
    a = [[1.0, -1.0, 0.5, 0.0], [1.0, 1.0, 0.0, 0.5]]
    assert list(pivot_rows(*csr(a)).pivot_column) == [0, 1]
    assert list(pivot_rows(*csr(a), column_scale=[1, 1, 10, 1]).pivot_column) == [2, 0]
    m, n, indptr, indices, data = csr(a)
    pivots, rank = independent_columns(m, n, indptr, indices, data, np.ones(n), 1e-10)
    assert list(pivots) == [0, 1]
    assert rank == 2


@settings(deadline=None, max_examples=60)
@given(seed=seeds, m=st.integers(1, 12), extra=st.integers(0, 8), repeats=st.integers(0, 4))
def test_redundant_rows_and_what_they_repeat(seed, m, extra, repeats):
    rng = np.random.default_rng(seed)
    n = m + extra
    a = [*(4.0 * np.eye(m, n)[:, rng.permutation(n)] + rng.uniform(-1, 1, (m, n)) * (rng.random((m, n)) < 0.2))]
    if np.linalg.cond(np.array(a)) > 1e6:
        return
    expected = []
    for _ in range(repeats):
        used = np.sort(rng.choice(m, rng.integers(0, min(m, 3) + 1), replace=False))
        a.append(rng.uniform(0.5, 2, len(used)) @ np.array(a)[used] if len(used) else np.zeros(n))
        expected.append(used)
    found = pivot_rows(*csr(a))
    assert found.rank == m
    assert list(found.redundant) == list(range(m, m + repeats))
    for rows, used in zip(found.depends_on, expected, strict=True):
        assert list(rows) == list(used)
    pivots = found.pivot_column[:m]
    assert len(set(pivots)) == m
    assert np.linalg.cond(np.array(a[:m])[:, pivots]) < 1e8


def test_duplicated_row_and_zero_row():
    found = pivot_rows(*csr([[1, 2, 0], [0, 0, 0], [0, 1, 1], [1, 2, 0], [1, 3, 1]]))
    assert list(found.pivot_column >= 0) == [True, False, True, False, False]
    assert found.rank == 2
    assert [list(rows) for rows in found.depends_on] == [[], [0], [0, 2]]


def test_constraints_of_a_long_chain_are_independent_and_a_repeated_joint_is_found():
    links = 300
    rng = np.random.default_rng(4)
    rows, cols, values = chain(links, rng.uniform(-np.pi, np.pi, links))
    keep = (rows >= 3 * links) & (cols < 3 * links)
    r, c, v = rows[keep] - 3 * links, cols[keep], values[keep]
    again = r == 417
    r, c, v = (
        np.append(r, np.full(again.sum(), 2 * links)),
        np.append(c, c[again]),
        np.append(v, -2 * v[again]),
    )
    order = np.lexsort((c, r))
    indptr = np.concatenate(([0], np.cumsum(np.bincount(r))))
    found = pivot_rows(2 * links + 1, 3 * links, indptr, c[order], v[order])
    assert found.rank == 2 * links
    assert list(found.redundant) == [2 * links]
    assert list(found.depends_on[0]) == [417]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"indptr": [0, 1]}, "indptr"),
        ({"indices": [0, 5]}, "indices must be in 0..1"),
        ({"data": [1.0]}, "must have 2 values"),
        ({"data": [1.0, np.nan]}, "row 1"),
        ({"column_scale": [1.0, 0.0]}, "positive"),
        ({"tol": 0.0}, "tol"),
    ],
)
def test_wrong_rows_are_refused(changes, message):
    arguments = {"m": 2, "n": 2, "indptr": [0, 1, 2], "indices": [0, 1], "data": [1.0, 1.0], **changes}
    with pytest.raises(ValueError, match=message):
        pivot_rows(**arguments)


@pytest.mark.parametrize("kind", ["chain", "grid"])
def test_large_matrices_are_ordered_for_neighbours_without_more_fill(kind: str) -> None:
    """A chain keeps its order up to a reversal, a grid the order of least fill; both are solved to rounding."""
    n = 5000 if kind == "chain" else 70 * 70
    if kind == "chain":
        shuffled = np.random.default_rng(1).permutation(n)
        i, j = shuffled[:-1], shuffled[1:]
    else:
        nodes = np.arange(n).reshape(70, 70)
        i = np.concatenate([nodes[:-1].ravel(), nodes[:, :-1].ravel()])
        j = np.concatenate([nodes[1:].ravel(), nodes[:, 1:].ravel()])
    rows, cols = np.concatenate([np.arange(n), i, j]), np.concatenate([np.arange(n), j, i])
    values = np.concatenate([np.full(n, 4.5), np.full(2 * len(i), -1.0)])
    solver = Factorization(n, rows, cols, np.arange(len(rows)))
    solver.analyze(values)
    exact = np.linspace(-1.0, 1.0, n)
    b = np.bincount(rows, values * exact[cols], n)
    assert np.max(np.abs(solver.solve(b) - exact)) < 1e-12
    if kind == "chain":
        assert solver.fill < 3 * n
        place = solver.analysis()[1]
        assert np.max(np.abs(np.diff(place[shuffled]))) == 1
