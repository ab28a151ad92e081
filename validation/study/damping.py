"""Damping of the oscillation that an impact excites: HHT inside TLISMNI against HHT on the form of Gear, Gupta and
Leimkuhler (claim C5).

While a contact is closed its multiplier shows what the impact has left in the waves: the elements' highest modes, which
a mesh has but a rod has not. Both methods damp by the same alpha. TLISMNI's acts on the independent accelerations, the
other's on all coordinates and on the multipliers' forces.

The oscillation is the multiplier less its trend: for the rod its mean, which is the whole of the exact solution, for
the beam, whose force follows the bending of the beam, a polynomial through the contact.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core import Result, SimulationError, simulate
from ...models import load

METHODS = ("hht", "hht_ggl")
ALPHAS = (0.0, -0.05, -0.1, -0.2, -0.3)
QUICK_ALPHAS = (0.0, -0.3)
SAME = 0.02
"""Oscillations that differ by less than this part are damped alike."""


@dataclass(frozen=True)
class DampingProblem:
    """An impact, how it is run, and which part of the contact is looked at."""

    label: str
    scenario: str
    contact: str
    step: float
    """s."""
    parameters: Mapping[str, Any] = field(default_factory=dict)
    window: tuple[float, float] = (0.05, 0.95)
    """Part of the contact that is looked at."""
    degree: int = 0
    """Of the polynomial that is the trend."""


def _rod(courant: float, elements: int = 50) -> DampingProblem:
    rod = load("rod_wall", elements=elements).model.bodies[0]
    step = courant * rod.length / elements / rod.wave_speed  # type: ignore[attr-defined]
    return DampingProblem(
        f"rod_wall, h = {courant:g} l/c", "rod_wall", "wall", step, {"elements": elements, "step": step}
    )


def problems() -> tuple[DampingProblem, ...]:
    """The rod with a step that follows its elements' waves and with a longer one, and the beam on the hub: undamped in
    a floating frame, and with the scenario's damping in ANCF elements (whose axial vibrations let Newton's iteration of
    HHT on GGL diverge with steps of 1e-5 s and more)."""
    hub = {"formulation": "floating", "damping_time": 0.0}
    beam = ("hub_beam_stop", "stop")
    return (
        _rod(0.2),
        _rod(1.0),
        DampingProblem("hub_beam_stop, floating", *beam, 2e-5, hub, degree=6),
        DampingProblem("hub_beam_stop, ANCF", *beam, 5e-6, {"formulation": "ancf"}, degree=6),
    )


@dataclass(frozen=True)
class DampingRow:
    """One run. Forces in parts of their mean; NaN where there was no run."""

    problem: DampingProblem
    method: str
    alpha: float
    mean: float
    """N."""
    rms: float
    """Of the oscillation."""
    late: float
    """The same in the middle half of the window's second half: what is left of it after a while."""
    peak: float
    """Largest oscillation."""
    frequencies: NDArray[np.float64]
    """Hz."""
    spectrum: NDArray[np.float64]
    """Amplitude of the oscillation at each of them (Hann window)."""
    failure: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain data, without the spectrum's arrays."""
        return {
            "problem": self.problem.label, "method": self.method, "alpha": self.alpha, "mean": self.mean,
            "rms": self.rms, "late": self.late, "peak": self.peak, "failure": self.failure,
        }  # fmt: skip


def damping_study(
    *, quick: bool = False, progress: Callable[[float], None] | None = None, which: Sequence[DampingProblem] = ()
) -> tuple[DampingRow, ...]:
    """All problems with both methods and all alphas (`quick`: the ends only); `progress` gets the share done."""
    cases = [
        (problem, method, alpha)
        for problem in which or problems()
        for alpha in (QUICK_ALPHAS if quick else ALPHAS)
        for method in METHODS
    ]
    rows = []
    for problem, method, alpha in cases:
        rows.append(measure(problem, method, alpha))
        if progress is not None:
            progress(len(rows) / len(cases))
    return tuple(rows)


def measure(problem: DampingProblem, method: str, alpha: float) -> DampingRow:
    """Run one case."""
    scenario = load(problem.scenario, **problem.parameters)
    try:
        result = simulate(scenario.model, scenario.t_end, method, step=problem.step, alpha=alpha)
    except SimulationError as error:
        nothing = np.zeros(0)
        return DampingRow(problem, method, alpha, *(math.nan,) * 4, nothing, nothing, str(error))
    span = longest_contact(result, problem.contact)
    if span is None:
        return DampingRow(problem, method, alpha, *(math.nan,) * 4, *(np.zeros(0),) * 2, "no contact closes and opens")
    t, force = contact_force(result, problem, span)
    mean = float(np.mean(force))
    x = 2.0 * (t - t[0]) / (t[-1] - t[0]) - 1.0
    oscillation = (force - np.polyval(np.polyfit(x, force, problem.degree), x)) / mean
    frequencies, spectrum = amplitudes(t, oscillation)
    late = oscillation[(x > 0.25) & (x < 0.75)]
    return DampingRow(
        problem, method, alpha, mean, float(np.sqrt(np.mean(oscillation**2))),
        float(np.sqrt(np.mean((late - np.mean(late)) ** 2))), float(np.max(np.abs(oscillation))), frequencies, spectrum,
    )  # fmt: skip


def longest_contact(result: Result, contact: str) -> tuple[float, float] | None:
    """Begin and end (s) of the longest time for which the contact is closed; None if it never closes and opens."""
    events = [e for e in result.events if e.contact == contact and e.kind in ("close", "rest", "open")]
    spans = [(a.t, b.t) for a, b in pairwise(events) if a.kind != "open" and b.kind == "open"]
    return max(spans, key=lambda span: span[1] - span[0], default=None)


def contact_force(
    result: Result, problem: DampingProblem, span: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times (s) and multiplier (N) in the window of a contact from span[0] to span[1], at equal distances."""
    start, end = span
    low, high = (start + part * (end - start) for part in problem.window)
    inside = (result.t >= start) & (result.t <= end)
    t = np.arange(low, high, problem.step)
    return t, np.interp(t, result.t[inside], result[f"{problem.contact}.normal_force"][inside])


def amplitudes(t: NDArray[np.float64], x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies (Hz) and amplitudes of x at equal distances in t, with a Hann window."""
    weight = np.hanning(len(x))
    found = 2.0 * np.abs(np.fft.rfft(weight * (x - np.mean(x)))) / np.sum(weight)
    return np.asarray(np.fft.rfftfreq(len(x), float(t[1] - t[0])), dtype=np.float64), np.asarray(
        found, dtype=np.float64
    )


def fifth_claim(rows: Sequence[DampingRow]) -> tuple[str, list[str]]:
    """Verdict on C5 ("HHT inside TLISMNI and inside GGL damp the oscillation differently") and what was observed."""
    lines, differences = [], []
    for label in dict.fromkeys(row.problem.label for row in rows):
        found = {(r.method, r.alpha): r for r in rows if r.problem.label == label and not r.failure}
        gaps = {
            alpha: _difference(found["hht", alpha], found["hht_ggl", alpha])
            for alpha in sorted({r.alpha for r in rows})
            if ("hht", alpha) in found and ("hht_ggl", alpha) in found
        }
        if not gaps:
            lost = next((r for r in rows if r.problem.label == label and r.failure), None)
            lines.append(f"{label}: no pair of runs to compare" + (f"; {lost.method}: {lost.failure}" if lost else ""))
            continue
        worst = max(gaps, key=gaps.__getitem__)
        differences.append(gaps[worst])
        ends = [found["hht", a].rms for a in (max(gaps), min(gaps))]
        lines.append(
            f"{label}: rms {ends[0]:.3g} at alpha = {max(gaps):g}, {ends[1]:.3g} at {min(gaps):g} inside TLISMNI; "
            f"on GGL rms, peak and spectrum differ by at most {gaps[worst]:.1e} of that (alpha = {worst:g})"
        )
    if not differences:
        return "open", lines
    return ("holds" if max(differences) > SAME else "does not hold here"), lines


def _difference(inside: DampingRow, on_ggl: DampingRow) -> float:
    """Largest difference of rms, later rms, peak and any amplitude of the spectra, in parts of the rms inside."""
    figures = [abs(getattr(inside, name) - getattr(on_ggl, name)) for name in ("rms", "late", "peak")]
    if len(inside.spectrum) == len(on_ggl.spectrum):
        figures.append(float(np.max(np.abs(inside.spectrum - on_ggl.spectrum), initial=0.0)))
    return max(figures) / inside.rms
