"""The damping study: what it measures, and that both methods damp a rod's impact alike."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tlismni.validation.study.damping import DampingProblem, DampingRow, amplitudes, fifth_claim, measure

STEP = 1.0 / 20 / 5188.7452
ROD = DampingProblem("rod", "rod_wall", "wall", STEP, {"elements": 20, "step": STEP})


def test_amplitude_of_a_sine_is_found_at_its_frequency() -> None:
    t = np.arange(1000) * 1e-3
    frequencies, found = amplitudes(t, 0.7 * np.sin(2.0 * math.pi * 50.0 * t) + 3.0)
    assert frequencies[np.argmax(found)] == pytest.approx(50.0) and np.max(found) == pytest.approx(0.7, rel=1e-3)


def test_damping_inside_tlismni_and_on_ggl_is_the_same_for_a_linear_constraint() -> None:
    """Phi_q is constant: the formula on the independent coordinates is that on all of them."""
    rows = {(m, a): measure(ROD, m, a) for m in ("hht", "hht_ggl") for a in (0.0, -0.3)}
    for alpha in (0.0, -0.3):
        inside, on_ggl = rows["hht", alpha], rows["hht_ggl", alpha]
        assert on_ggl.rms == pytest.approx(inside.rms, rel=1e-5)
        assert inside.mean == pytest.approx(1270.8275, rel=0.02)
        assert np.max(np.abs(on_ggl.spectrum - inside.spectrum)) < 1e-5 * inside.peak
    assert rows["hht", -0.3].late < 0.2 * rows["hht", 0.0].late
    verdict, lines = fifth_claim(list(rows.values()))
    assert verdict == "does not hold here" and len(lines) == 1


def test_a_difference_would_be_seen_and_a_failed_run_is_told() -> None:
    nothing = np.zeros(0)
    rows = [
        DampingRow(ROD, method, -0.1, 1.0, rms, rms, rms, nothing, nothing)
        for method, rms in (("hht", 0.1), ("hht_ggl", 0.2))
    ]
    assert fifth_claim(rows)[0] == "holds"
    later = [replace(rows[0], late=0.09), replace(rows[0], method="hht_ggl", late=0.001)]
    assert fifth_claim(later)[0] == "holds"
    assert fifth_claim([rows[0], replace(rows[0], method="hht_ggl")])[0] == "does not hold here"
    lost = DampingRow(ROD, "hht", 0.0, *(math.nan,) * 4, nothing, nothing, "it chatters")
    verdict, lines = fifth_claim([lost])
    assert verdict == "open" and "no pair" in lines[0]
