"""Parameters of a model from measured courses and times of impacts: least squares, with confidence intervals.

What is measured is y_k = channel(t_k; p) + noise. The parameters minimise the sum of ((y_k - channel)/sigma)^2 (scipy's
trust region, with bounds); their covariance is (J^T J)^-1 times the variance of what is left, intervals are those of
Student's distribution. Each holds its own parameter with the probability `level`; that all hold theirs at once is less
likely, and so `simultaneous` are wider: Bonferroni's, each at 1 - (1 - level)/p (Dunn, Journal of the American
Statistical Association 56, 1961, 52). J comes from central differences of runs at tight tolerances.

Positions answer smoothly to parameters through impacts; velocities jump there, and a sample beside a jump says little:
give positions, or times of impacts.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..compiled_model import CompiledModel, compile_model
from ..errors import ModelError, SimulationError, TlismniError
from ..methods.default import DEFAULT_METHOD
from ..simulate_one import check_times
from ..worker_threads import in_threads

Floats = NDArray[np.float64]

CHANGE = 1e-5
"""Relative change of a parameter in a central difference."""
TIGHT = 1e-10
"""Relative tolerance of the runs."""


@dataclass(frozen=True)
class Measurement:
    """What was measured.

    Attributes
    ----------
    t : times of the samples (k,), s, growing. channels : values (k,) by the name of a channel; NaN: not measured then.
    sigma : standard deviation of the noise by the name of a channel; needed if several things are measured, since it
        weighs them.
    impacts : times of the first impacts of contacts, by name, s. impact_sigma : standard deviation of these, s.
    """

    t: ArrayLike
    channels: Mapping[str, ArrayLike]
    sigma: Mapping[str, float] = field(default_factory=dict)
    impacts: Mapping[str, ArrayLike] = field(default_factory=dict)
    impact_sigma: float | None = None


@dataclass(frozen=True)
class Fit:
    """Parameters that fit a measurement.

    Attributes
    ----------
    names, values : of the parameters (p,).
    errors : their standard deviations (p,). covariance : (p, p).
    intervals : confidence intervals (p, 2) at `level`, of each parameter by itself.
    simultaneous : wider ones (p, 2), which hold all parameters at once with the probability `level` at least.
    residuals : what is left, in parts of sigma, (r,). noise : its standard deviation: about 1 where all sigma were
        given and the model is right.
    runs : of the model that it took.
    """

    names: tuple[str, ...]
    values: Floats
    errors: Floats
    covariance: Floats
    intervals: Floats
    simultaneous: Floats
    level: float
    residuals: Floats
    noise: float
    runs: int
    model: Any

    def __getitem__(self, name: str) -> float:
        """Value of a parameter. Raises KeyError for an unknown name."""
        if name not in self.names:
            raise KeyError(f"'{name}' was not fitted; {list(self.names)} were")
        return float(self.values[self.names.index(name)])

    def __str__(self) -> str:
        lines = [
            f"{name} = {x:.6g}, {self.level:.0%} within {low:.6g} to {high:.6g}"
            for name, x, (low, high) in zip(self.names, self.values, self.intervals, strict=True)
        ]
        return "\n".join(lines)


def fit(
    model: Any,
    data: Measurement,
    parameters: Mapping[str, float | tuple[float, float, float]],
    *,
    level: float = 0.95,
    threads: int | None = None,
    method: str = DEFAULT_METHOD,
    rtol: float = TIGHT,
    **settings: Any,
) -> Fit:
    """Identify parameters of `model` from a measurement.

    Parameters
    ----------
    parameters : for each name of a parameter, or place of a number ("spring.damping"), where the search starts; or
        (low, start, high).
    level : of the confidence intervals.
    threads, method, rtol, settings : of the runs.

    Raises
    ------
    ModelError : for names, bounds or data that cannot be, and for parameters that the data say nothing about.
    SimulationError : if a run fails: says with which parameters.
    """
    from scipy.optimize import least_squares
    from scipy.stats import t as student

    names, start, low, high = _parameters(parameters)
    if not 0.0 < level < 1.0:
        raise ModelError(f"level = {level!r} of the confidence intervals must be between 0 and 1")
    settings.setdefault("atol", 0.01 * rtol)
    compiled = compile_model(model, method, rtol, settings.pop("atol"), **settings)
    compiled.variant(dict(zip(names, start.tolist(), strict=True)))  # refuses names that mean nothing
    problem = _Problem(compiled, data, names, threads)
    step = CHANGE * np.where(start != 0.0, np.abs(start), 1.0)

    def jacobian(x: Floats) -> Floats:
        # at a bound the difference is taken to the inner side
        below, above = np.maximum(x - step, low), np.minimum(x + step, high)
        rows = np.tile(x, (2 * len(x), 1))
        for k in range(len(x)):
            rows[2 * k, k], rows[2 * k + 1, k] = below[k], above[k]
        found = problem.residuals(rows)
        return np.array([(found[2 * k + 1] - found[2 * k]) / (above[k] - below[k]) for k in range(len(x))]).T

    found = least_squares(
        lambda x: problem.residuals(x[None, :])[0], start, jacobian, (low, high), x_scale="jac", xtol=1e-10, ftol=1e-12,
        gtol=1e-12,
    )  # fmt: skip
    free = len(found.fun) - len(names)
    if free < 1:
        raise ModelError(f"{len(found.fun)} numbers were measured for {len(names)} parameters: more are needed")
    slopes = np.linalg.norm(found.jac, axis=0)
    scaled = found.jac / np.where(slopes > 0.0, slopes, 1.0)
    weak = np.linalg.svd(scaled, compute_uv=False)
    if np.any(slopes == 0.0) or weak[-1] < 1e-8 * weak[0]:
        raise ModelError(
            f"the data do not tell {list(names)} apart (their effects on what was measured are zero, or multiples of "
            "one another): fit fewer of them, or measure more"
        )
    noise = float(np.sqrt(np.sum(found.fun**2) / free))
    covariance = noise**2 * np.linalg.inv(scaled.T @ scaled) / np.outer(slopes, slopes)
    errors = np.sqrt(np.diag(covariance))

    def around(missed: float) -> Floats:
        """Intervals that a parameter is beside with this probability."""
        reach = float(student.isf(0.5 * missed, free)) * errors
        return np.stack([found.x - reach, found.x + reach], axis=1)

    each, all_at_once = around(1.0 - level), around((1.0 - level) / len(names))
    fitted = compiled.variant(dict(zip(names, found.x.tolist(), strict=True)))
    return Fit(names, found.x, errors, covariance, each, all_at_once, level, found.fun, noise, problem.runs, fitted)


def _parameters(given: Mapping[str, Any]) -> tuple[tuple[str, ...], Floats, Floats, Floats]:
    """Names, starts and bounds."""
    if not given:
        raise ModelError("name at least one parameter and where its search starts, such as {'restitution': 0.5}")
    start, low, high = [], [], []
    for name, x in given.items():
        a, b, c = x if isinstance(x, tuple | list) and len(x) == 3 else (-np.inf, x, np.inf)
        try:
            a, b, c = float(a), float(b), float(c)
        except (TypeError, ValueError):
            raise ModelError(f"'{name}': a start, or (low, start, high) is needed, not {x!r}") from None
        if not a < b < c or not np.isfinite(b):
            raise ModelError(f"'{name}': the start {b:g} must lie between its bounds {a:g} and {c:g}")
        start.append(b)
        low.append(a)
        high.append(c)
    return tuple(given), np.array(start), np.array(low), np.array(high)


class _Problem:
    """Residuals of runs with given parameters."""

    def __init__(self, compiled: CompiledModel, data: Measurement, names: tuple[str, ...], threads: int | None) -> None:
        self.compiled, self.names, self.threads, self.runs = compiled, names, threads, 0
        given = np.atleast_1d(np.asarray(data.t, dtype=float))
        self.times = check_times(given, compiled.t0, float(given[-1]) if len(given) else compiled.t0)
        channels = tuple(data.channels)
        unknown = [name for name in channels if name not in compiled.channels]
        if unknown:
            raise ModelError(f"there are no channels {unknown}; there are {list(compiled.channels)}")
        if len(channels) + bool(data.impacts) > 1 and (
            set(channels) - set(data.sigma) or (data.impacts and data.impact_sigma is None)
        ):
            raise ModelError(
                "several things were measured, in different units: give the standard deviation of each (sigma, "
                "impact_sigma), by which they are weighed"
            )
        self.place = [compiled.channels.index(name) for name in channels]
        self.sigma = np.array([float(data.sigma.get(name, 1.0)) for name in channels])
        self.measured = np.full((len(self.times), len(channels)), np.nan)
        for k, (name, x) in enumerate(data.channels.items()):
            values = np.asarray(x, dtype=float)
            if values.shape != self.times.shape:
                raise ModelError(f"'{name}' has {values.size} values for {len(self.times)} times: give as many")
            self.measured[:, k] = values
        self.impacts = {name: np.atleast_1d(np.asarray(t, dtype=float)) for name, t in data.impacts.items()}
        contacts = [contact.name for contact in getattr(compiled.system, "contacts", ())]
        if lost := sorted(set(self.impacts) - set(contacts)):
            raise ModelError(f"there are no contacts {lost}; there are {contacts}")
        self.impact_sigma = 1.0 if data.impact_sigma is None else float(data.impact_sigma)
        last = [float(t[-1]) for t in self.impacts.values() if len(t)]
        self.t_end = max([float(self.times[-1]) if len(self.times) else compiled.t0, *last])
        # impacts that are due may come a little later
        self.wait = self.t_end + 0.1 * (self.t_end - compiled.t0) if last else self.t_end

    def residuals(self, rows: Floats) -> Floats:
        """(rows, r): what is left with each row of parameters, in parts of sigma."""
        found: list[Floats | Exception] = [np.zeros(0)] * len(rows)

        def one(k: int) -> None:
            try:
                found[k] = self._run(rows[k])
            except TlismniError as error:
                found[k] = error

        in_threads(one, len(rows), self.threads)
        self.runs += len(rows)
        for row, x in zip(rows, found, strict=True):
            if isinstance(x, Exception):
                values = ", ".join(f"{name} = {p:.9g}" for name, p in zip(self.names, row, strict=True))
                raise SimulationError(
                    f"the run with {values} failed: {x}. Bounds (low, start, high) keep a search where it makes sense",
                    t=self.compiled.t0,
                    loop="fit",
                ) from x
        return np.array(found)

    def _run(self, parameters: Floats) -> Floats:
        sim = self.compiled.simulation(dict(zip(self.names, parameters.tolist(), strict=True)))
        seen = np.zeros(self.measured.shape)
        for k, t in enumerate(self.times.tolist()):
            sim.run_to(self.wait, until=t)
            seen[k] = sim.values()[self.place]
        sim.run_to(self.wait)
        left = ((seen - self.measured) / self.sigma).ravel()
        parts = [left[np.isfinite(self.measured).ravel()]]
        for name, times in self.impacts.items():
            struck = [event.t for event in sim.events if event.kind == "impact" and event.contact == name]
            struck += [self.wait] * max(len(times) - len(struck), 0)
            parts.append((np.array(struck[: len(times)]) - times) / self.impact_sigma)
        return np.concatenate(parts)
