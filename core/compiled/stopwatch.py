"""How long a run takes, without what is compiled or loaded for the first time on the way."""

import sys
import time
from typing import Any

from .library import LIBRARY

KIND = "numba:compiler_lock"
"""numba holds it while it compiles a function or loads one from the cache."""


class RunWatch:
    """A stop watch: it runs from its making to `stop`."""

    def __init__(self) -> None:
        # with a library nothing is compiled, unless something has been before
        self._compiling = _listen() if LIBRARY is None or "numba" in sys.modules else None
        self._taken: float | None = None
        self._started = time.perf_counter()

    def stop(self) -> float:
        """Seconds until the first call of this, without compiling and loading."""
        if self._taken is None:
            elapsed = time.perf_counter() - self._started
            self._taken = max(elapsed - (0.0 if self._compiling is None else _heard(self._compiling)), 0.0)
        return self._taken


def _listen() -> Any:
    from numba.core import event

    listener = event.TimingListener()
    event.register(KIND, listener)
    return listener


def _heard(listener: Any) -> float:
    from numba.core import event

    event.unregister(KIND, listener)
    return float(listener.duration) if listener.done else 0.0
