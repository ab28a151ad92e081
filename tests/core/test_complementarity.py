"""The complementarity solvers against the conditions themselves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tlismni.core.contact_solvers.complementarity import Delassus, independent, solve_contacts
from tlismni.core.contact_solvers.lcp import NoComplementarySolution, solve_lcp


def largest_violation(m, q, z):
    w = m @ z + q
    return max(np.max(-z), np.max(-w), np.max(np.abs(z * w)))


@settings(max_examples=200, deadline=None)
@given(st.integers(1, 8), st.integers(1, 10), st.integers(0, 2**32 - 1))
def test_positive_semidefinite_problems(n, rank, seed):
    """M = G G^T with fewer columns than rows is the matrix of redundant contacts; q in its range has a solution."""
    rng = np.random.default_rng(seed)
    g = rng.normal(size=(n, rank))
    m, q = g @ g.T, g @ rng.normal(size=rank)
    z = solve_lcp(m, q)
    assert largest_violation(m, q, z) < 1e-9 * (1.0 + np.abs(z).max())


def test_a_problem_without_solution_says_so():
    with pytest.raises(NoComplementarySolution, match="no solution"):
        solve_lcp(np.zeros((1, 1)), np.array([-1.0]))


def test_equal_rows_are_no_obstacle():
    m = np.ones((4, 4))
    z = solve_lcp(m, np.array([-1.0, -1.0, -1.0, 2.0]))
    assert z.sum() == pytest.approx(1.0, rel=1e-14)
    assert largest_violation(m, np.array([-1.0, -1.0, -1.0, 2.0]), z) < 1e-14


@settings(max_examples=300, deadline=None)
@given(st.integers(1, 5), st.integers(1, 3), st.integers(0, 2**32 - 1), st.booleans())
def test_contacts_with_friction(n, bodies, seed, twice):
    rng = np.random.default_rng(seed)
    inverse_mass = np.diag(rng.uniform(0.3, 3.0, 3 * bodies))
    normal, tangential = rng.normal(size=(2, n, 3 * bodies))
    if twice and n > 1:
        normal[-1], tangential[-1] = normal[0], tangential[0]
    a = Delassus(normal @ inverse_mass @ normal.T, normal @ inverse_mass @ tangential.T,
                 tangential @ inverse_mass @ tangential.T)  # fmt: skip
    v, mu = rng.normal(size=3 * bodies), rng.choice([0.0, 0.1, 0.3, 0.6], n)
    try:
        found = solve_contacts(a, normal @ v, tangential @ v, mu, np.zeros(n))
    except NoComplementarySolution:
        # possible only where friction can turn the effect of a normal force round
        assert np.any(mu > 0.0)
        return
    after = v + inverse_mass @ (normal.T @ found.normal + tangential.T @ found.tangential)
    opens, slides = normal @ after, tangential @ after
    limit = mu * found.normal
    tolerance = 1e-9 * (1.0 + found.normal.max())
    assert largest_violation(a.nn, normal @ v + a.nt @ found.tangential, found.normal) < tolerance
    assert np.all(np.abs(found.tangential) <= limit + tolerance)
    # where it slides, friction is at its limit and against the motion
    assert (
        np.max(np.minimum(np.abs(slides), np.abs(found.tangential + limit * np.sign(slides)))[mu > 0], initial=0.0)
        < tolerance
    )
    assert found.normal_motion == pytest.approx(opens, abs=tolerance)
    assert found.tangential_motion == pytest.approx(slides, abs=tolerance)


def test_least_friction_forces_of_a_block_on_two_feet():
    """No tangential load: nothing is clamped between the feet, though that too would be a solution."""
    a = Delassus(np.array([[2.0, 0.5], [0.5, 2.0]]), np.zeros((2, 2)), np.ones((2, 2)))
    found = solve_contacts(a, np.array([-1.0, -1.0]), np.zeros(2), np.full(2, 0.5), np.zeros(2))
    assert found.sticks and np.all(found.tangential == 0.0)


def test_independent_directions_come_normals_first():
    a = Delassus(np.array([[2.0, 0.5], [0.5, 2.0]]), np.zeros((2, 2)), np.ones((2, 2)))
    assert independent(a, np.array([0, 1]), np.array([0, 1])) == ([0, 1], [0])


@pytest.mark.parametrize("push", [0.0, 2.0, 5.0])
def test_a_block_on_many_feet(push):
    """Weight and push of a block that stands on twenty feet: what they bear together is known, and nothing moves until
    the push is more than friction; then each foot has the same share of its friction."""
    weight, mu = 9.81, 0.3
    x = np.linspace(-1.0, 1.0, 20)
    feet = (
        np.column_stack([np.zeros(20), np.ones(20), x]),
        np.column_stack([np.ones(20), np.zeros(20), np.full(20, 0.1)]),
    )
    inverse_mass, load = np.diag([1.0, 1.0, 3.0]), np.array([push, -weight, 0.1 * push])
    normal, tangential = feet
    a = Delassus(normal @ inverse_mass @ normal.T, normal @ inverse_mass @ tangential.T,
                 tangential @ inverse_mass @ tangential.T)  # fmt: skip
    free = inverse_mass @ load
    found = solve_contacts(a, normal @ free, tangential @ free, np.full(20, mu), np.zeros(20))
    assert np.min(found.normal) >= 0.0
    assert np.sum(found.normal) == pytest.approx(weight, rel=1e-12)
    held = min(push, mu * weight)
    assert np.sum(found.tangential) == pytest.approx(-held, rel=1e-12)
    assert np.sum(found.normal * x) == pytest.approx(0.1 * (held - push), abs=1e-11)
    if not found.sticks:
        share = found.tangential + held / weight * found.normal
        assert np.max(np.abs(share)) < 1e-11
    assert np.all(np.abs(found.tangential) <= mu * found.normal * (1.0 + 1e-11))
    assert np.max(np.abs(found.normal_motion)) < 1e-11
    assert np.max(np.abs(found.tangential_motion - (push - held))) < 1e-11
    assert found.sticks == (push < mu * weight)
