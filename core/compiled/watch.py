"""How long a run takes, without what is compiled or loaded for the first time on the way."""

import time

from numba.core import event

KIND = "numba:compiler_lock"
"""numba holds it while it compiles a function or loads one from the cache."""


class RunWatch:
    """A stop watch: it runs from its making to `stop`."""

    def __init__(self) -> None:
        self._compiling = event.TimingListener()
        event.register(KIND, self._compiling)
        self._taken: float | None = None
        self._started = time.perf_counter()

    def stop(self) -> float:
        """Seconds until the first call of this, without compiling and loading."""
        if self._taken is None:
            elapsed = time.perf_counter() - self._started
            event.unregister(KIND, self._compiling)
            self._taken = max(elapsed - (self._compiling.duration if self._compiling.done else 0.0), 0.0)
        return self._taken
