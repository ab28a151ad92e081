"""A force that jumps or bends within a step, without an event that says so, is seen by estimates of the error. Those of
`adams` and `bdf` are of smooth motion; their starting steps are those of sdirk4."""

import numpy as np
import pytest
from tlismni.core import EquationSystem, simulate
from tlismni.core.methods.sdirk import DIFFERENCES, A, C
from tlismni.core.methods.tableaus import TABLEAUS

METHODS = [
    *(("irk", {"tableau": name}) for name in ("radau3", "gauss2", "gauss3", "sdirk4")),
    *((name, {}) for name in ("ebdf", "mebdf", "hht", "newmark")),
]
PLACE = 1.0
"""Where the force begins."""
WORST = 10.0
"""Error over the tolerance: what is told from smooth motion errs by no more than some differences of two formulas."""


def flight(kind, stiffness, speed):
    """A particle that flies freely up to PLACE; its coordinate and velocity at times t."""

    def force(t, q, v):
        beyond = max(q[0] - PLACE, 0.0)
        return np.array([-stiffness * (beyond if kind == "bend" else float(beyond > 0.0))])

    def exact(t):
        since = np.maximum(t - PLACE / speed, 0.0)
        if kind == "jump":
            course = speed * since - 0.5 * stiffness * since**2, speed - stiffness * since
        else:
            w = np.sqrt(stiffness)
            course = speed / w * np.sin(w * since), speed * np.cos(w * since)
        return np.minimum(speed * t, PLACE) + course[0], course[1]

    return EquationSystem(mass=lambda t, q: np.eye(1), force=force, q0=[0.0], v0=[speed]), exact


@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
@pytest.mark.parametrize("kind", ["jump", "bend"])
@pytest.mark.parametrize("method, options", METHODS, ids=lambda value: "-".join(map(str, np.atleast_1d(value))))
def test_forces_may_jump_within_a_step(method, options, kind, rtol):
    """Where in a step is for the speed to say; without a look at the start of a step one in four of sdirk4 saw nothing
    at all, and erred by the whole force."""
    rng = np.random.default_rng(1)
    for _ in range(12):
        stiffness, speed = rng.uniform(0.3, 3.0), rng.uniform(0.5, 2.0)
        system, exact = flight(kind, stiffness, speed)
        result = simulate(system, PLACE / speed + 0.4, method, rtol=rtol, atol=1e-2 * rtol, **options)
        q, v = exact(result.t)
        error = max(np.abs(result.q[:, 0] - q).max(), np.abs(result.v[:, 0] - v).max() / speed)
        assert error < WORST * rtol, (stiffness, speed, error / rtol)


def test_both_differences_of_sdirk4_meet_the_conditions_of_order_three():
    a, c = np.zeros((6, 6)), np.append(C, 0.0)
    a[:5, :5] = A
    for weights in DIFFERENCES:
        for right in (np.ones(6), c, c**2, a @ c):
            assert weights @ right == pytest.approx(0.0, abs=1e-14)
        assert np.abs(weights @ np.array([c**3, c * (a @ c), a @ c**2, a @ a @ c]).T).max() > 1e-3


@pytest.mark.parametrize("name", ["gauss2", "gauss3"])
def test_a_jump_anywhere_in_a_step_of_gauss_is_seen_and_a_linear_equation_is_not(name):
    tableau = TABLEAUS[name]
    weights, nodes = tableau.jump_difference(), np.array((0.0, *tableau.c, 1.0))
    for place in np.linspace(0.001, 0.999, 200):
        missed = abs((1.0 - place) - sum(b for b, x in zip(tableau.b, tableau.c, strict=True) if x > place))
        assert abs(weights[nodes > place].sum()) >= 0.2499 * missed
    # stages of y' = z y from y = 1 and their end lie on the collocation polynomial
    for z in (0.1, -3.0, 20.0j):
        stages = np.linalg.solve(np.eye(len(tableau.c)) - z * np.array(tableau.a), np.ones(len(tableau.c)))
        end = 1.0 + z * np.array(tableau.b) @ stages
        assert abs(weights @ np.array((1.0, *stages, end))) < 1e-12 * np.abs(weights).sum()
