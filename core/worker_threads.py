"""Rows of a table of runs, computed by threads."""

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event as Flag
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .batch_result import Runs
from .errors import ModelError, SimulationError

if TYPE_CHECKING:
    from .simulation.simulation import Simulation


def run_into(
    found: Runs,
    row: int,
    place: list[int],
    begin: "Callable[[], Simulation]",
    t0: float,
    t_end: float,
    times: NDArray[np.float64] | None,
) -> None:
    """One run from its start at t0, which `begin` makes, to t_end (s).

    The channels at `place` go into its row, at `times` or at the end; a failure is the row's cause.
    """
    sim = None
    try:
        sim = begin()
        for k, t in enumerate(() if times is None else times.tolist()):
            sim.run_to(t_end, until=t)
            found.put(row, k, sim.values()[place])
        sim.run_to(t_end)
        if times is None:
            found.put(row, 0, sim.values()[place])
    except Exception as error:  # of own functions too: the other runs go on
        reached = error.t if isinstance(error, SimulationError) else t0
        found.close(row, reached, sim, error)
    else:
        found.close(row, t_end, sim, None)


def processors() -> int:
    """How many this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_threads(
    work: Callable[[int], None],
    count: int,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> None:
    """`work` on all rows in small parts, as threads become free.

    Raises
    ------
    ModelError : for a number of threads that is none.
    """
    most = processors() if threads is None else threads
    if isinstance(most, bool) or not isinstance(most, int) or most < 1:
        raise ModelError(f"threads must be a whole number of at least 1, not {threads!r}")
    size = max(1, min(64, count // (4 * most)))
    parts: Sequence[range] = [range(k, min(k + size, count)) for k in range(0, count, size)]
    done, stopped = 0, Flag()

    def part(rows: range) -> int:
        for row in rows:
            if stopped.is_set():
                break
            work(row)
        return len(rows)

    with ThreadPoolExecutor(most, "simulate_many") as pool:
        try:
            for finished in pool.map(part, parts):
                done += finished
                if progress is not None:
                    progress(done)
        except BaseException:
            stopped.set()
            raise
