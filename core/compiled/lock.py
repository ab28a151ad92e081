"""A lock between processes, so that those that start together compile each function once.

The operating system holds it, and drops it with the process: there are no stale ones. It is a courtesy: who cannot
have it (no such folder, no such file system, or held beyond all patience) goes on without, and at worst compiles what
another one compiles too.
"""

import logging
import os
import sys
import time
from pathlib import Path
from typing import Any

from .notices import tell

PATIENCE = 600.0
"""s: a whole model is compiled in a minute, and the lock is let go between its functions."""
_SHORTEST, _LONGEST = 0.01, 0.25
"""s between two looks whether it is free."""
_FAR = 1 << 30  # where Windows locks: the bytes before can be read then

if sys.platform == "win32":
    import msvcrt

    def _try(handle: int) -> bool:
        os.lseek(handle, _FAR, os.SEEK_SET)
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except PermissionError:
            return False
        return True

else:
    import fcntl

    def _try(handle: int) -> bool:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True


class ProcessLock:
    """The lock on the file `path`, which is made if need be; one for a process, which is not taken twice."""

    def __init__(self, path: Path, patience: float = PATIENCE) -> None:
        self.path, self.patience = path, patience
        self._handle: int | None = None
        if sys.platform != "win32":
            # a child made by fork shares the lock, and would hold it beyond its parent's death
            os.register_at_fork(after_in_child=self._close)

    def acquire(self) -> bool:
        """Wait until the lock is ours. True if others held it meanwhile, who may have done what we were up to."""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._handle = os.open(self.path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o666)
            return self._wait(self._handle)
        except OSError as error:
            logging.getLogger(__name__).debug("no lock on '%s': %s", self.path, error)
            self._close()
            return False

    def release(self) -> None:
        """Let others have it."""
        self._close()

    def _wait(self, handle: int) -> bool:
        waited, pause, began = False, _SHORTEST, time.monotonic()
        while not _try(handle):
            if not waited:
                tell(logging.INFO, f"waiting for {_owner(handle)}, which compiles the same for this machine")
            waited = True
            if time.monotonic() - began > self.patience:
                tell(
                    logging.WARNING,
                    f"{_owner(handle)} has held the lock '{self.path}' for {self.patience:.0f} s: compiling without it",
                )
                self._close()
                return True
            time.sleep(pause)
            pause = min(2.0 * pause, _LONGEST)
        os.lseek(handle, 0, os.SEEK_SET)
        os.truncate(handle, 0)
        os.write(handle, str(os.getpid()).encode())
        return waited

    def _close(self) -> None:
        handle, self._handle = self._handle, None
        if handle is not None:
            os.close(handle)  # which lets go of the lock


def _owner(handle: int) -> str:
    """Who holds the lock, in words."""
    os.lseek(handle, 0, os.SEEK_SET)
    number: Any = os.read(handle, 32).decode("ascii", "replace").strip()
    return f"process {number}" if number else "another process"
