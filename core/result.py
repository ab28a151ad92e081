"""Result of a run: arrays, channels by name, events, statistics."""

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import ModelError
from .events import Event, Fallback
from .integrate.output import ChannelTable
from .integrate.records import LOG_COLUMNS
from .model.channels import Channel
from .system.redundancy import RedundantRow


class Result:
    """What a run has recorded.

    At an impact there are two samples with the same time: before and after.
    """

    def __init__(
        self,
        samples: NDArray[np.float64],
        table: ChannelTable,
        events: Sequence[Event],
        stats: Mapping[str, float],
        fallbacks: Sequence[Fallback] = (),
        step_log: NDArray[np.float64] | None = None,
        redundant: Sequence[RedundantRow] = (),
        system: Any = None,
    ) -> None:
        self._samples = samples
        self._table = table
        self.events = list(events)
        """What happened at contacts (`Event`)."""
        self.stats = dict(stats)
        """steps, rejected, outer_iterations, inner_iterations, factorizations, partitions ...; wall_time, s: of the
        run alone, without building the simulation and without compiling."""
        self.fallbacks = tuple(fallbacks)
        """Where another outer loop took over (only with fallback=True)."""
        self._step_log = step_log
        self.redundant = tuple(redundant)
        """Constraint rows that others imply (`RedundantRow`): left out of the equations but checked. Multipliers of
        these joints and of those they repeat are not unique; those of the rows left out are zero."""
        self.system = system
        """The Model or EquationSystem of the run; None if it is not known."""

    @property
    def t(self) -> NDArray[np.float64]:
        """Times (N,), s."""
        return self._samples[:, 0]

    @property
    def q(self) -> NDArray[np.float64]:
        """Coordinates (N, n)."""
        return self._samples[:, self._table.layout.q]

    @property
    def v(self) -> NDArray[np.float64]:
        """Velocities (N, n)."""
        return self._samples[:, self._table.layout.v]

    @property
    def a(self) -> NDArray[np.float64]:
        """Accelerations (N, n): those of the equations of motion, at the recorded times."""
        return self._samples[:, self._table.layout.a]

    @property
    def multipliers(self) -> NDArray[np.float64]:
        """Multipliers (N, m): joints, then one column a contact (zero while it is open)."""
        return self._samples[:, self._table.layout.multipliers]

    @property
    def steps(self) -> dict[str, NDArray[np.float64]]:
        """What each accepted step took, arrays (steps,) by name: t (its end, s), h (s), error (norm; at most 1), k
        (of a multistep formula), rejected (trials before it), outer, inner, factorizations, evaluations and krylov.

        Raises
        ------
        ModelError : if they were not asked for (`step_records=True`).
        """
        if self._step_log is None:
            raise ModelError("no per-step records were kept: ask for them with simulate(..., step_records=True)")
        columns = dict(zip(LOG_COLUMNS, self._step_log.T, strict=True))
        running = ("outer", "inner", "factorizations", "evaluations", "krylov")
        return {name: np.diff(x, prepend=0.0) if name in running else x.copy() for name, x in columns.items()}

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels."""
        return tuple(channel.name for channel in self._table.channels)

    @property
    def channel_records(self) -> tuple[Channel, ...]:
        """The channels with units and descriptions."""
        return self._table.channels

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """One channel (N,). Raises KeyError with the nearest names."""
        if name == "time":
            return self.t
        if name not in self._table.index:
            near = get_close_matches(name, self.channels, 3)
            hint = f"; did you mean {near}?" if near else ""
            raise KeyError(f"there is no channel '{name}'{hint} `result.channels` lists all {len(self.channels)}")
        return self._table.column(self._samples, name)

    def __len__(self) -> int:
        return len(self._samples)

    def to_dict(self, channels: Sequence[str] | None = None) -> dict[str, Any]:
        """Plain data: times, channels, events, statistics."""
        names = self.channels if channels is None else channels
        return {
            "t": self.t.tolist(),
            "channels": {name: self[name].tolist() for name in names},
            "events": [event.to_dict() for event in self.events],
            "stats": self.stats,
        }
