"""The error of a run is about the tolerance, and falls as it does, with all methods that control their own error."""

import numpy as np
import pytest
from space_trees import space_tree
from tlismni.core import OfScales, Simulation
from tlismni.core.methods.registry import get_formula
from tlismni.models import load

SEEDS = (0, 1, 3, 5)
T_END = 0.4


def models():
    return [load("chain", links=3).model, *(space_tree(seed)[0] for seed in SEEDS)]


def course(model, method, rtol, **options):
    """Coordinates at ten times (10, n), steps."""
    sim, rows = Simulation(model, method, rtol, OfScales(0.01 * rtol), record=False, **options), []
    for t in np.linspace(0.0, T_END, 11)[1:]:
        sim.run_to(T_END, until=float(t))
        rows.append(sim.sample()[sim.table.layout.q].copy())
    return np.array(rows), sim.assembly.is_angle[: len(rows[0])]


def difference(q, exact, angle):
    """Largest difference over half the range of the lengths or angles."""
    scale, half = np.ones(len(angle)), 0.5 * np.ptp(exact, axis=0)
    for kind in (True, False):
        if np.any(angle == kind):
            scale[angle == kind] = half[angle == kind].max()
    return float(np.max(np.abs(q - exact) / scale))


@pytest.fixture(scope="module")
def exact():
    return [course(model, "irk", 1e-9) for model in models()]


@pytest.mark.parametrize(
    "method, options",
    [
        ("bdf", {}),
        ("bdf", {"order": 2}),
        ("hht", {}),
        ("newmark", {}),
        ("trapezoidal", {}),
        ("park", {}),
        ("adams", {}),
        ("ebdf", {}),
    ],
)
def test_errors_are_about_the_tolerance_and_fall_as_it_does(exact, method, options):
    medians = []
    for rtol in (1e-3, 1e-4):
        errors = [
            difference(course(model, method, rtol, **options)[0], *reference) / rtol
            for model, reference in zip(models(), exact, strict=True)
        ]
        medians.append(float(np.median(errors)))
    assert all(0.03 < median < 3.0 for median in medians)
    assert 0.4 < medians[1] / medians[0] < 2.0


def test_only_formulas_that_are_judged_by_their_own_error_work_with_finer_tolerances():
    assert get_formula("hht", {}).working_tolerance(1e-4) == pytest.approx(1e-6)
    assert get_formula("bdf", {"order": 3}).working_tolerance(1e-6) == pytest.approx(1e-8)
    assert get_formula("hht", {}).working_tolerance(1e-8) == pytest.approx(1e-10)
    assert get_formula("bdf", {"order": 2}).working_tolerance(1e-11) == 1e-12
    assert get_formula("hht", {}).working_tolerance(1e-13) == 1e-13
    for method in ("ebdf", "mebdf", "irk", "hht_i3", "baumgarte"):
        assert get_formula(method, {}).working_tolerance(1e-6) == 1e-6
    # of order 1 it would take a million steps
    assert get_formula("newmark", {"gamma": 0.6, "beta": 0.3025}).working_tolerance(1e-6) == 1e-6
