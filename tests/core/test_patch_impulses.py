"""One contact on a patch: the impulses meet their conditions, whatever the inverse masses."""

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tlismni.core.contact_solvers.patch_friction import one_patch


@numba.njit
def solve(a, b, mu, base, p):
    one_patch(a, b, mu, base, p)


def solved(a, b, mu, base=0.0):
    p = np.empty(4)
    solve(a, b, mu, base, p)
    return p, b + a @ p


def check(a, b, mu, base=0.0):
    """0 <= w_N, P_N - base >= 0, their product 0; |P| <= mu P_N, and P = -mu P_N w/|w| where w is not zero."""
    p, w = solved(a, b, mu, base)
    size, most = np.abs(b).max(), mu * p[0]
    assert p[0] >= base and w[0] >= -1e-9 * size
    assert (p[0] - base) * w[0] <= 1e-9 * size * max(p[0], size / a[0, 0])
    friction, speed = np.linalg.norm(p[1:]), np.linalg.norm(w[1:])
    assert friction <= most * (1.0 + 1e-9) + 1e-12
    if speed > 1e-6 * size:
        assert p[1:] == pytest.approx(-most * w[1:] / speed, rel=1e-7, abs=1e-9 * max(most, 1e-9))


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.1, 0.5]), st.sampled_from([0.0, 1.5]))
def test_impulses_meet_their_conditions(seed, mu, base):
    """Coupled so weakly that friction does not press: no paradox."""
    random = np.random.default_rng(seed)
    half = np.eye(4) + 0.15 * random.normal(size=(4, 4))
    scale = np.diag(10.0 ** random.uniform(-1.0, 1.0, 4))
    scale[0, 0] = 1.0
    a = scale @ (half @ half.T) @ scale if mu < 0.2 else half @ half.T
    check(a, random.normal(size=4) * np.array([1.0, *10.0 ** random.uniform(-3.0, 1.0, 3)]), mu, base)


def test_what_can_not_turn_has_friction_of_a_point_but_for_its_spin():
    """A spin that nothing changes takes its part of the friction, and no impulse."""
    a, mu = np.diag([1.0, 3.5, 3.5, 0.0]), 0.3
    p, w = solved(a, np.array([-2.0, 3.0, 0.0, 0.0]), mu)
    assert p == pytest.approx([2.0, -0.6, 0.0, 0.0], rel=1e-12)
    p, w = solved(a, np.array([-2.0, 3.0, 0.0, 4.0]), mu)
    assert p[3] == 0.0 and p[1] == pytest.approx(-0.6 * w[1] / np.hypot(w[1], 4.0), rel=1e-12)


def test_it_sticks_where_friction_holds_all_of_it():
    a = np.diag([1.0, 3.5, 3.5, 2.0])
    p, w = solved(a, np.array([-2.0, 0.9, -0.3, 0.4]), 0.3)
    assert p == pytest.approx([2.0, -0.9 / 3.5, 0.3 / 3.5, -0.2], rel=1e-12)
    assert np.abs(w).max() < 1e-12
