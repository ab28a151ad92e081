"""Lyapunov exponents of systems with joints and impacts.

Benettin's method: an orthonormal basis of neighbouring motions is carried along the run by the variational equation and
the saltation matrices, and made orthonormal again after every step and every event; the exponents are the mean rates at
which the logarithms of its lengths grow (Benettin, Galgani, Giorgilli & Strelcyn, Meccanica 15 (1980) 9; with impacts:
Mueller, Chaos, Solitons & Fractals 5 (1995) 1671).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..events import Event
from ..simulation.simulation import Simulation
from ..tolerances import DEFAULT_ATOL
from .variation import Variation

Floats = NDArray[np.float64]

BATCHES = 20


@dataclass(frozen=True)
class LyapunovResult:
    """Lyapunov exponents, how they converged, and the identity that their sum must meet."""

    exponents: Floats
    """(k,), 1/s, largest first. -inf for every direction that was lost when a contact closed for good (two each)."""
    errors: Floats
    """(k,), 1/s: standard error of each, from the scatter of the means over BATCHES parts of the run. It means
    something where the run is long compared to the time over which the motion forgets; NaN for lost directions."""
    times: Floats
    """(N,), s: ends of steps at which running estimates are taken, the last one at the end of the run."""
    running: Floats
    """(N, k), 1/s: estimates from the end of the transient to each of `times`."""
    start: float
    """s: end of the transient, from where the growth counts."""
    impacts: int
    """Impacts since then."""
    events: tuple[Event, ...]
    """Events since then."""
    volume_rate: float
    """1/s: mean divergence of the flow plus 2 ln e of each impact. The sum of all exponents; -inf with lost directions,
    NaN if not all exponents were asked for."""
    stats: dict[str, float]
    """Counters of the run."""

    @property
    def sum_residual(self) -> float:
        """Sum of the exponents less `volume_rate`, 1/s: error of the variational equation and of the saltation
        matrices. NaN if directions were lost, or not all exponents were asked for."""
        total = float(np.sum(self.exponents))
        return total - self.volume_rate if math.isfinite(total) else math.nan

    @property
    def kaplan_yorke_dimension(self) -> float:
        """Dimension of the attractor after Kaplan and Yorke: j + (l_1 + ... + l_j)/|l_j+1|, in the space of states
        without time. NaN if the sum of all exponents that were asked for is not negative."""
        sums = np.cumsum(self.exponents)
        negative = np.flatnonzero(sums < 0.0)
        if len(negative) == 0:
            return math.nan
        j = int(negative[0])
        return j + (float(sums[j - 1]) if j else 0.0) / abs(float(self.exponents[j]))

    def to_dict(self) -> dict[str, Any]:
        """Plain data, without the running estimates and the events."""
        return {
            "exponents": self.exponents.tolist(),
            "errors": self.errors.tolist(),
            "start": self.start,
            "end": float(self.times[-1]),
            "impacts": self.impacts,
            "volume_rate": self.volume_rate,
            "sum_residual": self.sum_residual,
            "kaplan_yorke_dimension": self.kaplan_yorke_dimension,
            "stats": self.stats,
        }


def lyapunov_exponents(
    system: Any,
    t_end: float,
    method: str = "irk",
    rtol: float = 1e-7,
    atol: float | Mapping[str, float] = DEFAULT_ATOL,
    *,
    t0: float = 0.0,
    transient: float = 0.0,
    count: int | None = None,
    samples: int = 400,
    progress: Callable[[float], None] | None = None,
    **options: Any,
) -> LyapunovResult:
    """Lyapunov exponents of a system with joints and contacts as constraints.

    The state is that of the independent coordinates and velocities: 2f exponents for f degrees of freedom. Time is no
    part of it: a forced system has no zero exponent for it, an autonomous one that does not come to rest has one.

    Parameters
    ----------
    system : Model or EquationSystem; its contacts, if any, with NewtonImpact.
    t_end : end of the run, s.
    method, rtol, atol, options : how the motion is computed, as for `simulate`. Left out: irk with gauss3 (order 6).
    t0 : start, s.
    transient : time in which the basis turns into its directions and the motion onto its attractor; it does not count.
    count : how many exponents, from the largest; None: all.
    samples : number of running estimates (at least 20; fewer if there are fewer steps).
    progress : called with the time reached, now and then.

    Returns
    -------
    LyapunovResult.

    Raises
    ------
    ModelError : for bad arguments, or contacts that are forces.
    SimulationError : if the run fails, or where the exponents are not defined: contacts that strike at one instant.
    """
    for name, value in (("t0", t0), ("t_end", t_end), ("transient", transient)):
        if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
            raise ModelError(f"{name} must be a finite number, not {value!r}")
    if transient < 0.0 or t0 + transient >= t_end:
        raise ModelError(
            f"the exponents are means from t0 + transient = {t0 + transient:g} to t_end = {t_end:g}: the transient "
            "must be >= 0 and end before t_end"
        )
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 1:
        raise ModelError(f"samples = {samples!r} must be a whole number, at least 1")
    if method == "irk":
        options = {"tableau": "gauss3", **options}
    sim = Simulation(system, method, rtol, atol, t0=t0, **options)
    variation = Variation(sim, count)
    start = t0 + transient
    variation.run_to(start, start, progress)
    growth, volume, impacts, seen = variation.growth.copy(), variation.volume, variation.impacts, len(sim.events)
    lost = np.isneginf(growth)
    times: list[float] = []
    totals: list[NDArray[np.float64]] = []
    for mark in np.linspace(start, t_end, max(samples, BATCHES) + 1)[1:]:
        # estimates stand at the ends of the steps that pass the marks: a stop at each would cost steps
        if not times or times[-1] < mark:
            variation.run_to(t_end, float(mark), progress)
            times.append(variation.sim.t_internal)
            # directions lost in the transient are lost for good: no difference of infinities
            totals.append(np.where(lost, -np.inf, variation.growth - np.where(lost, 0.0, growth)))
    impacts = variation.impacts - impacts
    volume = variation.volume - volume if math.isfinite(volume) else -math.inf
    return _result(variation, start, np.array(times), np.array(totals), volume, impacts, seen)


def _result(
    variation: Variation, start: float, times: Floats, totals: Floats, volume: float, impacts: int, seen: int
) -> LyapunovResult:
    sim, duration = variation.sim, float(times[-1]) - start
    running = totals / (times - start)[:, None]
    order = np.argsort(-running[-1], kind="stable")
    rate = math.nan
    if variation.complete:
        rate = volume / duration if np.all(np.isfinite(running[-1])) else -math.inf
    return LyapunovResult(
        exponents=running[-1][order],
        errors=_errors(start, times, totals)[order],
        times=times,
        running=running[:, order],
        start=start,
        impacts=impacts,
        events=tuple(sim.events[seen:]),
        volume_rate=rate,
        stats={name: float(value) for name, value in sim.stats.items()},
    )


def _errors(start: float, times: Floats, totals: Floats) -> Floats:
    """Standard errors (k,) of the means, from those of BATCHES parts (fewer, if there were few steps)."""
    ends = np.searchsorted(times, np.linspace(start, times[-1], BATCHES + 1)[1:])
    ends = np.unique(np.minimum(ends, len(times) - 1))
    if len(ends) < 2:
        return np.full(totals.shape[1], np.nan)
    at, when = np.vstack([np.zeros(totals.shape[1]), totals[ends]]), np.concatenate([[start], times[ends]])
    with np.errstate(invalid="ignore"):
        means = np.diff(at, axis=0) / np.diff(when)[:, None]
        errors = np.std(means, axis=0, ddof=1) / math.sqrt(len(means))
    return np.where(np.isneginf(totals[-1]), np.nan, errors)
