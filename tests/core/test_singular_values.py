"""Smallest singular values of constraint Jacobians: those from sparse factors are those of the dense matrix."""

import numpy as np
import pytest
from linkages import four_bar
from scipy.sparse import csr_array
from tlismni.core import Simulation
from tlismni.core.assembly import singular_values
from tlismni.core.assembly.singular_values import ScaledJacobian, least_singular_value, singular_directions
from tlismni.core.linalg.smallest_singular import most_values, smallest_singular
from tlismni.core.recovery.singular_position import find_singular, natural_step
from tlismni.models import load

NOISE = 1e-14
"""Of the largest singular value: rounding of either way."""


def jacobian(rng, m=240, n=320):
    """Rows that couple neighbours, as joints do, and some that couple what lies far apart, as loops do."""
    dense = np.zeros((m, n))
    for i in range(m):
        near = min(i * n // m, n - 6) + rng.permutation(6)[:4]
        dense[i, near] = rng.uniform(-1.0, 1.0, 4)
        if rng.random() < 0.05:
            dense[i, rng.integers(n)] = 1.0
    return dense


def of_scaled_rows(dense):
    return dense / np.abs(dense).max(axis=1, keepdims=True)


def compare(dense, count):
    """Values, and the projection onto the space of those directions whose values stand apart from the next ones."""
    _, values, directions = np.linalg.svd(dense, full_matrices=False)
    found, across = smallest_singular(csr_array(dense), count)
    assert found == pytest.approx(values[-count:], rel=1e-6, abs=10 * NOISE * values[0])
    assert across @ across.T == pytest.approx(np.eye(count), abs=1e-6)
    clear = found > 1e-10 * values[0]  # the direction of what rounding leaves of a zero is any
    rounding = NOISE * values[0] / found[clear].min(initial=values[0])
    assert np.linalg.norm(dense @ across[clear].T, axis=0) == pytest.approx(found[clear], rel=1e-6, abs=rounding)
    if values[-count] < 0.5 * values[-count - 1]:
        expected = directions[-count:][clear]
        assert across[clear].T @ across[clear] == pytest.approx(expected.T @ expected, abs=1e-5 + rounding)


@pytest.mark.parametrize("seed", range(6))
def test_full_rank(seed):
    rng = np.random.default_rng(seed)
    compare(of_scaled_rows(jacobian(rng)), 1 + seed % 3)


@pytest.mark.parametrize("left_out", range(1, 6))
def test_rows_that_repeat_others(left_out):
    """The least value that is not zero stands before as many zeros as rows repeat others."""
    rng = np.random.default_rng(left_out)
    dense = jacobian(rng)
    mixed = rng.standard_normal((left_out, 3))
    repeated = [mixed[k] @ dense[rng.permutation(len(dense))[:3]] for k in range(left_out)]
    compare(of_scaled_rows(np.vstack([dense, repeated])), left_out + 1)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("exponent", range(3, 13))
def test_nearly_dependent_rows(exponent):
    rng = np.random.default_rng(exponent)
    dense = jacobian(rng)
    apart = 10.0**-exponent * rng.standard_normal(dense.shape[1])
    dense[100] = dense[101] - 0.7 * dense[105] + 0.4 * dense[90] + apart
    compare(of_scaled_rows(dense), 1)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(4))
def test_coordinates_of_all_sizes(seed):
    rng = np.random.default_rng(seed)
    compare(of_scaled_rows(jacobian(rng) * 10.0 ** rng.uniform(-3.0, 3.0, 320)), 1)


@pytest.mark.parametrize("spread", [0.0, 1e-9, 1e-5, 1e-2])
def test_many_values_that_nearly_coincide(spread):
    """More of them than a block has vectors, as in a row of loops that are all alike; and all of them singular."""
    rng = np.random.default_rng(3)
    for size in (1e-2, 1e-6):
        near = np.eye(40, 54) * size * (1.0 + spread * rng.random(40))[:, None]
        dense = np.zeros((240, 324))
        dense[:40, :54] = near
        dense[40:, 54:] = jacobian(rng, 200, 270)
        found, _ = smallest_singular(csr_array(dense), 1)
        assert found[0] == pytest.approx(np.linalg.svd(dense, compute_uv=False)[-1], rel=1e-6 + 0.3 * spread)


def test_more_values_than_can_be_found_are_refused():
    matrix = csr_array(np.eye(60, 80))
    with pytest.raises(ValueError, match=r"17 singular values of a 60 x 80 matrix: at most 16"):
        smallest_singular(matrix, most_values(60) + 1)
    with pytest.raises(ValueError, match="m <= n needed"):
        smallest_singular(csr_array(matrix.T), 1)


def near_position(loops, rtol=1e-7):
    """A row of four-bar loops some steps before its singular position."""
    sim = Simulation(four_bar(loops, 0.3, -6.0), "ebdf", rtol, 0.01 * rtol, record=False)
    sim.run_to(0.04)
    return sim


@pytest.mark.parametrize("loops", [42, pytest.param(60, marks=pytest.mark.full)])
def test_both_ways_agree_on_a_mechanism(loops, monkeypatch):
    sim = near_position(loops)
    assert sim.assembly.m_joints > singular_values.DENSE_ROWS
    position = find_singular(sim, natural_step(sim))
    sparse, few = least_singular_value(sim.workspace), singular_directions(sim.workspace, 1e-9)
    monkeypatch.setattr(singular_values, "DENSE_ROWS", 10_000)
    values, directions = singular_directions(sim.workspace)
    assert sparse == pytest.approx(values[-1], rel=1e-8) == least_singular_value(sim.workspace)
    assert few[0] == pytest.approx(values[-len(few[0]) :], rel=1e-6)
    assert np.abs(few[1][-1] @ directions[-1]) == pytest.approx(1.0, abs=1e-6)
    assert position == pytest.approx(find_singular(sim, natural_step(sim)), rel=1e-3)


@pytest.mark.parametrize("loops", [42, pytest.param(120, marks=pytest.mark.full)])
def test_a_look_for_a_singular_position_never_makes_the_dense_matrix(loops, monkeypatch):
    """Nor does it take other than thin ones apart, however long the mechanism is."""
    sim, shapes, svd = near_position(loops), [], np.linalg.svd
    monkeypatch.setattr(ScaledJacobian, "matrix", property(lambda _: pytest.fail("the dense matrix was made")))
    monkeypatch.setattr(np.linalg, "svd", lambda a, **options: shapes.append(a.shape) or svd(a, **options))
    assert find_singular(sim, natural_step(sim)) is not None
    assert shapes
    assert max(shape[1] for shape in shapes) <= 8 * 5
    assert len(shapes) < 1000


@pytest.mark.full
def test_steps_of_a_long_chain_that_fail_make_no_dense_matrix(monkeypatch):
    """As a look does in the test above, within a run. Of high order and loose tolerances: the second derivative of its
    rows is far off, so steps fail and a singular position is looked for, which took eight seconds for each of eighty
    points."""
    monkeypatch.setattr(ScaledJacobian, "matrix", property(lambda _: pytest.fail("the dense matrix was made")))
    looks, look = [], singular_values.smallest_singular
    monkeypatch.setattr(singular_values, "smallest_singular", lambda *a: looks.append(a) or look(*a))
    sim = Simulation(load("chain", links=1000).model, "adams", 0.1, 1e-3, record=False, order=8)
    sim.run_to(0.5)
    assert looks
    assert sim.t == 0.5
