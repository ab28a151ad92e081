"""sweep: one problem at many points, resumable, as one table."""

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ModelError
from ..extras import require
from ..multibody_model import Model
from .cluster import run_on_cluster
from .problem import ModelProblem, Problem
from .sampling import Sampling, grid, sampled
from .store import Store

PART = 100
"""Runs of a part, unless told otherwise: what a killed process loses at most, of each thread."""


class Sweep:
    """Answers of a sweep: a table with a row for each run and time.

    Columns: "run", the names that were swept, "time", "reached", "events", "steps", "cause" (empty: the run did not
    fail), and channels, which are NaN where a run did not get.
    """

    def __init__(self, store: Store) -> None:
        self._store, self._table = store, store.table()

    @property
    def names(self) -> tuple[str, ...]:
        """What was swept."""
        return tuple(self._store.points)

    @property
    def units(self) -> dict[str, str]:
        """Units of columns, as far as they are known."""
        return self._store.units

    @property
    def columns(self) -> tuple[str, ...]:
        """All columns."""
        return tuple(self._table.column_names)

    def __len__(self) -> int:
        """Number of runs that have answers."""
        return len(np.unique(self["run"]))

    @property
    def complete(self) -> bool:
        """True if every point has its answer."""
        return not self._store.missing()

    @property
    def failures(self) -> dict[int, str]:
        """Cause of each run that failed."""
        run, cause = self["run"], self["cause"]
        return {int(run[k]): str(cause[k]) for k in np.flatnonzero(cause != "")}

    def __getitem__(self, name: str) -> NDArray[Any]:
        """One column. Raises KeyError for an unknown name."""
        if name not in self._table.column_names:
            raise KeyError(f"there is no column '{name}'; there are {list(self._table.column_names)}")
        return np.asarray(self._table.column(name).to_numpy(zero_copy_only=False))

    def to_pandas(self) -> Any:
        """The table as a DataFrame. Raises MissingExtraError without pandas."""
        require("a table of pandas", "data", pandas="")
        return self._table.to_pandas()

    def plot(self, y: str, x: str | None = None, colour: str | None = None, path: str | Path | None = None) -> Any:
        """Any column over any other, as points; with `colour` as a map. See `plots.plot_sweep`."""
        from .plots import plot_sweep

        return plot_sweep(self, y, x, colour, path)

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"Sweep({len(self)} of {self._store.count} runs over {', '.join(self.names)}{failed})"


def sweep(
    problem: Model | Problem,
    vary: Mapping[str, ArrayLike],
    t_end: float | None = None,
    *,
    out: str | Path | None = None,
    samples: int | None = None,
    sampling: Sampling | str = "latin",
    seed: int = 0,
    channels: Any = None,
    t_eval: ArrayLike | None = None,
    cluster: Any = None,
    threads: int | None = None,
    part: int = PART,
    progress: Callable[[int, int], None] | None = None,
    **settings: Any,
) -> Sweep:
    """Run a model at many points of its parameters, start values and inputs.

    Parameters
    ----------
    problem : a Model, or anything that answers points (`Problem`).
    vary : values of each name, all combinations of which are run; with `samples` ranges (low, high).
    t_end : end time of a Model's runs, s.
    out : folder of the answers. The same call again goes on where it ended: no run is repeated. Left out: nothing is
        kept on disk.
    samples, sampling, seed : so many points within the ranges instead of a grid, see `sampled`.
    channels, t_eval : which channels are kept (left out: all), at which times (left out: at the end).
    cluster : address of a Dask scheduler, or a `distributed.Client`; left out: threads of this process.
    threads : how many, without a cluster; left out: as many as the process may use.
    part : runs that are kept together.
    progress : called with the numbers of runs done and wanted.
    settings : those of `Simulation`, of a Model's runs.

    Raises
    ------
    ModelError : for names and values that mean nothing, and a folder that holds another sweep.
    MissingExtraError : without the libraries of the extra [sweep].
    SimulationError : if parts were lost with workers; the others are kept. Runs that fail are rows with their cause.
    """
    question = _question(problem, t_end, t_eval, channels, settings)
    points = (
        grid(vary) if samples is None else sampled({k: _pair(k, x) for k, x in vary.items()}, samples, sampling, seed)
    )
    question.check(tuple(points))
    if isinstance(part, bool) or not isinstance(part, int) or part < 1:
        raise ModelError(f"part must be a whole number of at least 1, not {part!r}")
    if out is None:
        with tempfile.TemporaryDirectory(prefix="tlismni-sweep-") as folder:
            return _answered(question, Store.open(Path(folder), question, points, part), cluster, threads, progress)
    return _answered(question, Store.open(Path(out), question, points, part), cluster, threads, progress)


def load_sweep(out: str | Path) -> Sweep:
    """The answers in a folder, complete or not. Raises ModelError if it holds no sweep."""
    return Sweep(Store.found(Path(out)))


def _question(problem: Any, t_end: float | None, t_eval: Any, channels: Any, settings: dict[str, Any]) -> Problem:
    if isinstance(problem, Model):
        if t_end is None:
            raise ModelError("a model says nothing about how long to run: give t_end, s")
        return ModelProblem.of(problem, t_end, t_eval, channels, settings)
    if not hasattr(problem, "identity"):
        raise ModelError(f"a Model or a Problem is needed to sweep, not {type(problem).__name__}")
    if t_end is not None or t_eval is not None or channels is not None or settings:
        raise ModelError("t_end, t_eval, channels and settings belong to the problem: it says itself how it is run")
    found: Problem = problem
    return found


def _pair(name: str, bounds: Any) -> tuple[float, float]:
    try:
        low, high = bounds
    except (TypeError, ValueError):
        raise ModelError(f"'{name}': a range (low, high) is needed to sample it, not {bounds!r}") from None
    return low, high


def _answered(problem: Problem, store: Store, cluster: Any, threads: int | None, progress: Any) -> Sweep:
    count = [sum(len(next(iter(store.points_of(k).values()))) for k in range(store.parts) if store.part(k).exists())]

    def done(k: int) -> None:
        count[0] += len(next(iter(store.points_of(k).values())))
        if progress is not None:
            progress(count[0], store.count)

    if progress is not None:
        progress(count[0], store.count)
    if cluster is not None:
        run_on_cluster(cluster, problem, store, done)
    else:
        for k in store.missing():
            store.put(k, problem.run(store.points_of(k), threads))
            done(k)
    store.write_table()
    return Sweep(store)
