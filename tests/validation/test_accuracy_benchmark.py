"""The accuracy benchmark: its peers solve the equations that we solve, and its references are solutions of ours."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tlismni.core import simulate
from tlismni.models import load

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
EQUATIONS = [("chain", 1), ("slider_crank", 2), ("slider_crank_stiff", 1)]
"""Problems and indices of the peer's DAE: to compile one takes seconds."""


@pytest.fixture(scope="module")
def bench(monkeypatch_module):
    """The benchmark's modules."""
    monkeypatch_module.syspath_prepend(str(BENCHMARKS))
    import accuracy_problems
    import peer_equations

    # each is compiled for its model
    equations, kept = peer_equations.equations, {}

    def once(model, index):
        key = model.model_dump_json(), index
        if key not in kept:
            kept[key] = equations(model, index)
        return kept[key]

    monkeypatch_module.setattr(peer_equations, "equations", once)
    yield accuracy_problems, peer_equations
    for name in ("accuracy_problems", "peer_equations", "reference"):
        sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def monkeypatch_module():
    patch = pytest.MonkeyPatch()
    yield patch
    patch.undo()


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("name", "index"), EQUATIONS)
def test_peers_equations(bench, name, index):
    """They hold at our solution, and their Jacobian is the derivative of their residual."""
    problems, peers = bench
    problem = next(p for p in problems.problems() if p.name == name)
    equations = peers.equations(problem.model, index)
    _holds_at_our_solution(problem, equations, index)
    _jacobian_is_the_derivative(equations)


def _holds_at_our_solution(problem, equations, index):
    """Residual of the peer's DAE with our q, v, a and multipliers: the same joints, signs and points."""
    result = simulate(problem.model, 0.02, "irk", rtol=1e-9, atol=1e-11)
    n, m = equations.n, equations.m
    assert result.q.shape[1] == n
    bushing = max((f.stiffness for f in problem.model.forces), default=0.0)
    # constraints hold to 1e-12, and what that moves a bushing counts with its stiffness
    tolerance = 1e-8 + 1e-13 * bushing
    out = np.full(equations.size, np.nan)
    for k in (0, len(result.t) // 2, len(result.t) - 1):
        y, yp = np.zeros(equations.size), np.zeros(equations.size)
        y[:n], y[n : 2 * n] = result.q[k], result.v[k]
        yp[:n], yp[n : 2 * n] = result.v[k], result.a[k]
        # the same joints in the same order: pins have two rows, and so has a guide
        (y if index == 2 else yp)[2 * n : 2 * n + m] = _in_peers_order(problem.model, result.multipliers[k])
        equations.residual(y, yp, out)
        assert np.abs(out).max() < tolerance


def _in_peers_order(model, multipliers):
    """Pins first, then guides, as the peers number them; the guide's normal points along y."""
    pins = [j for j, joint in enumerate(model.joints) if joint.type == "Revolute2D"]
    guides = [j for j, joint in enumerate(model.joints) if joint.type == "Prismatic2D"]
    assert len(multipliers) == 2 * len(model.joints)
    return np.concatenate([multipliers[2 * j : 2 * j + 2] for j in pins + guides])


def _jacobian_is_the_derivative(equations):
    """Central differences at a point off the constraints, where every term counts."""
    generator = np.random.default_rng(3)
    y = equations.y0 + generator.normal(size=equations.size) * 1e-2
    yp = equations.yp0 + generator.normal(size=equations.size)
    rows, columns, of_derivative, values = equations.triplets(y, yp)
    jacobian = np.zeros((2, equations.size, equations.size))
    np.add.at(jacobian, (of_derivative, rows, columns), values)
    step = 1e-5
    for kind in range(2):
        found = np.zeros_like(jacobian[kind])
        for j in range(equations.size):
            ends = []
            for sign in (1.0, -1.0):
                moved = [y.copy(), yp.copy()]
                moved[kind][j] += sign * step
                out = np.zeros(equations.size)
                equations.residual(*moved, out)
                ends.append(out)
            found[:, j] = (ends[0] - ends[1]) / (2.0 * step)
        assert np.abs(found - jacobian[kind]).max() < 1e-7 * np.abs(jacobian).max()


# what the reference of a slider-crank is made of takes twelve seconds to compile
@pytest.mark.parametrize("name", ["chain", pytest.param("slider_crank", marks=pytest.mark.full)])
def test_references_are_what_our_solver_converges_to(bench, name):
    problems, _ = bench
    problem = next(p for p in problems.problems() if p.name == name)
    result = simulate(problem.model, problem.t_end, rtol=1e-9, atol=1e-11, record=False)
    assert problem.error(result.q[-1]) < 1e-7


def test_reference_of_the_stiff_slider_crank_follows_its_equations(bench):
    """Over a short time, in which our steps are short enough to follow the vibrations."""
    problems, _ = bench
    problem = next(p for p in problems.problems() if p.name == "slider_crank_stiff")
    short = replace(problem, t_end=0.01)
    result = simulate(short.model, short.t_end, "ebdf", k=3, rtol=1e-9, atol=1e-12, record=False)
    assert short.error(result.q[-1]) < 1e-9


def test_model_that_the_peers_have_no_equations_for_is_refused(bench):
    _, peers = bench
    with pytest.raises(ValueError, match="is not provided for"):
        peers.mechanism(load("pendulum_stop").model)
