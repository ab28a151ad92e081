"""A run that ends when it has cost too much, and what its CPU time is without compilation."""

import time
from types import TracebackType
from typing import Any

from numba.core import event

from ....core import Simulation

SLICES = 100
"""Looks at the clock in a run, beside those of its own reports of progress."""
MOST_NUMBERS = 2e7
"""Recorded numbers in a run: 160 MB."""


class LimitReached(Exception):
    """A run has cost too much."""


class CpuClock(event.Listener):
    """CPU time of this process without that of numba's compiler."""

    def __init__(self) -> None:
        self.depth, self.began, self.compiled, self.start = 0, 0.0, 0.0, 0.0

    def __enter__(self) -> "CpuClock":
        event.register("numba:compile", self)
        self.start = time.process_time()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        event.unregister("numba:compile", self)

    def on_start(self, event: Any) -> None:
        """A compilation begins, maybe inside another."""
        if self.depth == 0:
            self.began = time.process_time()
        self.depth += 1

    def on_end(self, event: Any) -> None:
        """A compilation ends."""
        self.depth -= 1
        if self.depth == 0:
            self.compiled += time.process_time() - self.began

    @property
    def seconds(self) -> float:
        """CPU time since the beginning, s."""
        return time.process_time() - self.start - self.compiled


def run_limited(sim: Simulation, t_end: float, limit: float) -> float:
    """Run `sim` to `t_end` (s); gives the CPU time, s.

    Raises
    ------
    LimitReached : beyond `limit` (s), or if the record would not fit. SimulationError : as the run.
    """
    clock = CpuClock()

    def look(t: float) -> None:
        steps = sim.stats["steps"]
        where = f"at t = {t:.4g} of {t_end:.4g} s, after {steps} steps"
        if clock.seconds > limit:
            raise LimitReached(f"CPU time above {limit:g} s {where}")
        if steps * sim.buffer.shape[1] > MOST_NUMBERS:
            raise LimitReached(f"record above {8e-6 * MOST_NUMBERS:.0f} MB {where}")

    sim.progress = look
    with clock:
        for k in range(1, SLICES + 1):
            # until: where the run pauses; its steps stay those of a run in one go
            sim.run_to(t_end, until=t_end if k == SLICES else t_end * k / SLICES)
            look(sim.t)
        return clock.seconds
