"""Runs: the results of many runs as one table."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Runs:
    """Results of `simulate_many`. Row k belongs to run k.

    Attributes
    ----------
    parameters : the given columns (runs,) by name; start values as "start.NAME".
    channels : names of the channels that were wanted.
    t : (times,) times at which they are known, s; None: at the end.
    values : (runs, times, channels), NaN where a run did not get; without `t_eval` there is one time, the end.
    reached : (runs,) time that each run reached, s.
    events, steps : (runs,) number of contact events, of steps.
    failures : what went wrong, an exception for each row that failed, in the order of the rows.
    """

    def __init__(
        self,
        parameters: Mapping[str, NDArray[np.float64]],
        channels: tuple[str, ...],
        count: int,
        t: NDArray[np.float64] | None,
    ) -> None:
        self.parameters, self.channels, self.t = dict(parameters), channels, t
        self.values = np.full((count, 1 if t is None else len(t), len(channels)), np.nan)
        self.reached = np.full(count, np.nan)
        self.events, self.steps = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
        self._failures: dict[int, Exception] = {}

    def put(self, row: int, k: int, values: NDArray[np.float64]) -> None:
        """Channels of one run at its k-th time."""
        self.values[row, k] = values

    def close(self, row: int, t: float, sim: Any, error: Exception | None) -> None:
        """A run has ended at t, s."""
        self.reached[row] = t
        if sim is not None:
            self.events[row], self.steps[row] = len(sim.events), sim.stats["steps"]
        if error is not None:
            self._failures[row] = error.with_traceback(None)  # which would keep the run's memory

    @property
    def failures(self) -> dict[int, Exception]:
        """What went wrong, by row, in the order of the rows: threads end in any order."""
        return dict(sorted(self._failures.items()))

    def __len__(self) -> int:
        return len(self.reached)

    @property
    def failed(self) -> NDArray[np.bool_]:
        """(runs,) which runs failed."""
        found = np.zeros(len(self), dtype=bool)
        found[list(self.failures)] = True
        return found

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """One channel: (runs,) at the end, or (runs, times) with `t_eval`; or a given column (runs,)."""
        if name in self.channels:
            found = self.values[:, :, self.channels.index(name)]
            return found[:, 0] if self.t is None else found
        if name in self.parameters:
            return self.parameters[name]
        raise KeyError(f"there is no column '{name}'; there are {[*self.parameters, *self.channels]}")

    @property
    def table(self) -> NDArray[Any]:
        """All columns as a structured array (runs,), to sort, select and store: the given ones, "reached", "events",
        "steps", "cause" (empty: the run did not fail), and the channels, with `t_eval` as fields (times,)."""
        causes = [str(self.failures.get(row, "")) for row in range(len(self))]
        columns: dict[str, NDArray[Any]] = {
            **self.parameters,
            "reached": self.reached, "events": self.events, "steps": self.steps,
            "cause": np.array(causes, dtype=f"U{max([1, *map(len, causes)])}"),
            **{name: self[name] for name in self.channels},
        }  # fmt: skip
        table = np.zeros(len(self), [(name, x.dtype, x.shape[1:]) for name, x in columns.items()])
        for name, x in columns.items():
            table[name] = x
        return table

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"Runs({len(self)} runs{failed}, {len(self.channels)} channels)"
