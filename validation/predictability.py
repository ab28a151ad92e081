"""How long two runs of one motion can stay together: the largest Lyapunov exponent over the run, and its time.

A difference grows as exp(t/T) in a chaotic motion, T the Lyapunov time: after some of them nothing is left to compare,
whoever is right. The exponent is that of this run, not of an attractor: its error bar is wide where the run is short.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ..core.analysis import lyapunov_exponents
from ..core.errors import TlismniError
from ..models import Scenario
from .comparisons.common import our_run

MULTIPLE = 3.0
"""Lyapunov times up to which runs are compared: an error has grown twentyfold then."""
PUSH = 1e-8
"""Of the neighbour: a change of gravity, in parts of it (in m/s^2 without)."""
WINDOWS = 8
"""Parts of the run, from whose growth the error bar follows."""
FIRST = 0.1
"""Part of the run that the push needs to become a difference in the direction that grows."""


@dataclass(frozen=True)
class Predictability:
    """Largest Lyapunov exponent over the run and its standard error, 1/s, and how it was found."""

    exponent: float
    error: float
    how: str

    @property
    def time(self) -> float:
        """The Lyapunov time, s; infinite where neighbours do not part."""
        return 1.0 / self.exponent if self.exponent > 0.0 else math.inf

    @property
    def limit(self) -> float:
        """s, up to which runs are compared."""
        return MULTIPLE * self.time

    def text(self) -> str:
        """For notes and reasons."""
        found = f"largest Lyapunov exponent over the run {self.exponent:.3g} ± {self.error:.2g} 1/s ({self.how})"
        if math.isinf(self.time):
            return f"{found}: neighbours do not part"
        return f"{found}, Lyapunov time {self.time:.3g} s"


def predictability(scenario: Scenario) -> Predictability:
    """By the variational equation and saltation matrices; by two near-by runs where contacts act as forces or rub."""
    try:
        found = lyapunov_exponents(scenario.model, scenario.t_end, count=1)
    except TlismniError:
        return _by_neighbours(scenario)
    return Predictability(float(found.exponents[0]), float(found.errors[0]), "tangent")


def _by_neighbours(scenario: Scenario) -> Predictability:
    gravity = scenario.model.gravity
    push = PUSH * max(math.hypot(*gravity), 1.0)
    pushed = scenario.model.model_copy(update={"gravity": tuple(g + push for g in gravity)})
    times = np.linspace(0.0, scenario.t_end, 401)
    a, b = (our_run(chosen, times) for chosen in (scenario, replace(scenario, model=pushed)))
    known = np.intersect1d(a.t, b.t)
    rows = [(r.q[np.searchsorted(r.t, known)], r.v[np.searchsorted(r.t, known)]) for r in (a, b)]
    # a speed counts as the way that it makes in a twentieth of the run
    apart = np.sqrt(
        np.sum((rows[0][0] - rows[1][0]) ** 2, axis=1)
        + (0.05 * scenario.t_end) ** 2 * np.sum((rows[0][1] - rows[1][1]) ** 2, axis=1)
    )
    marks = np.linspace(FIRST * scenario.t_end, scenario.t_end, WINDOWS + 1)
    # the mean around a mark: at an event the velocities differ for an instant
    near = [np.exp(np.mean(np.log(apart[np.abs(known - m) < 0.03 * scenario.t_end]))) for m in marks]
    rates = np.diff(np.log(near)) / np.diff(marks)
    return Predictability(float(np.mean(rates)), float(np.std(rates, ddof=1) / math.sqrt(WINDOWS)), "two near-by runs")
