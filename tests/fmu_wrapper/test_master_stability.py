"""The master on split oscillators: what feeds energy in, stable steps, controlled steps."""

import numpy as np
import pytest

pytest.importorskip("fmpy")

from split_oscillators import COUPLING, START, Oscillators, state
from tlismni.fmu_wrapper.master import CouplingError

UNDAMPED = Oscillators()
LOOSE = {"method": "irk", "rtol": 1e-8, "atol": 1e-11}
"""Where growth or a step control is looked at, not the coupling alone."""


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("algorithm", "weight"), [("jacobi", None), ("iterated", 1.0)])
def test_stability_limit(algorithm, weight):
    """Inputs that lag (Jacobi) or lead (end) by h/2 feed energy in, more than the dampers take beyond a step."""
    damped = Oscillators(dampers=(0.8, 0.4), solver=LOOSE)
    limit = next(h for h in np.linspace(0.005, 0.5, 1000) if damped.radius(algorithm, h, weight) > 1.0)
    assert limit < 0.04
    hold = {} if weight is None else {"hold": "end", "tolerance": 1e-10}
    for part, grows in ((0.5, False), (2.0, True)):
        found = damped.run(algorithm, part * limit, 100 * part * limit, **hold)
        early, late = (np.linalg.norm(state(found, k)) for k in (20, -1))
        assert (late > early) == grows


@pytest.mark.sampled(1)
@pytest.mark.parametrize("algorithm", ["gauss-seidel", "newton"])
def test_what_lags_on_one_side_and_leads_on_the_other_is_stable_with_any_step(algorithm):
    """Undamped, with steps of up to two periods: the eigenvalues of the map stay on the unit circle."""
    assert all(UNDAMPED.radius(algorithm, h) < 1.0 + 1e-9 for h in np.linspace(0.01, 1.5, 300))
    found = Oscillators(solver=LOOSE).run(algorithm, 0.8, 60.0)
    start = np.linalg.norm(START)
    assert max(np.linalg.norm([found[f"{i}.mass.x"][k] for i in "ab"]) for k in range(len(found.t))) < 3.0 * start


def test_the_mean_of_both_ends_keeps_the_energy_that_held_values_feed():
    """Undamped: Jacobi's held forces lag and pump energy in; held means do not drift to first order."""

    def energy(z):
        (m1, m2), (k1, k2) = UNDAMPED.masses, UNDAMPED.springs
        return 0.5 * (m1 * z[1] ** 2 + m2 * z[3] ** 2 + k1 * z[0] ** 2 + k2 * z[2] ** 2 + COUPLING * (z[0] - z[2]) ** 2)

    gains = {}
    for algorithm in ("jacobi", "newton"):
        found = UNDAMPED.run(algorithm, 0.02, 4.0)
        gains[algorithm] = energy(state(found)) / energy(START) - 1.0
    assert gains["jacobi"] > 0.5
    assert abs(gains["newton"]) < 0.02


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("algorithm", "estimate"), [("gauss-seidel", "doubling"), ("newton", "doubling"), ("iterated", "iteration")]
)
def test_controlled_step_follows_its_tolerance(algorithm, estimate):
    halves = Oscillators(solver=LOOSE)
    t_end, errors, steps = 1.0, [], []
    for tolerance in (3e-3, 1.5e-4):
        control = {"estimate": estimate, "tolerance": tolerance}
        found = halves.run(algorithm, 0.3, t_end, control=control)
        assert found.t[-1] == t_end and np.all(np.diff(found.t) > 0.0)
        assert found.stats["rejected"] > 0  # the first step is far too long
        errors.append(max(np.linalg.norm(state(found, k) - UNDAMPED.monolithic(t)) for k, t in enumerate(found.t)))
        steps.append(found.stats["communication_steps"])
    assert errors[0] > errors[1] and steps[0] < steps[1]
    # displacements are coupled: whatever is held, they are off by h^3 = tolerance after one step (that the mean of both
    # ends is right only shows in velocities), and by h^p at the end
    order = 1 if algorithm == "gauss-seidel" else 2
    slope = np.log(errors[0] / errors[1]) / np.log(20.0)
    assert slope == pytest.approx(order / 3.0, rel=0.25)


def test_a_step_that_fails_is_done_anew_with_a_shorter_one():
    """The fixed point diverges with long steps; under control the run goes on with shorter ones."""
    stiff, t_end = Oscillators(masses=(0.02, 0.02), springs=(0.0, 0.0), solver=LOOSE), 0.1
    settings = {"hold": "end", "sweep": "jacobi"}
    with pytest.raises(CouplingError, match="does not converge"):
        stiff.run("iterated", 0.1, t_end, **settings)
    settings["hold"] = "mean"
    found = stiff.run("iterated", 0.1, t_end, control={"tolerance": 1e-5}, **settings)
    exact = stiff.monolithic(t_end)
    assert found.stats["rejected"] > 0
    assert np.linalg.norm(state(found) - exact) < 0.05 * np.linalg.norm(exact)
