"""Who hears that functions are compiled, which takes half a minute in all on a machine's first run.

Everything goes to `logging`, the logger of this module, and in this thread to whoever listens.
"""

import logging
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from .cache import cache_folder

logger = logging.getLogger(__name__)

Tell = Callable[[int, str], None]
"""Called with a level of `logging` and a message."""


@dataclass
class Compiled:
    """What was compiled: number of functions that were asked for, and the time it took, s."""

    functions: int = 0
    seconds: float = 0.0


class _Thread(threading.local):
    """Of one thread: what it compiles belongs to what it does."""

    def __init__(self) -> None:
        self.tells: list[Tell] = []
        self.what = ""
        self.done: Compiled | None = None
        self.total = Compiled()


_here = _Thread()


def compiled_so_far() -> Compiled:
    """What this thread has compiled; what was loaded does not count."""
    return replace(_here.total)


@contextmanager
def hear(tell: Tell) -> Iterator[None]:
    """Let `tell` hear what is said about compiling."""
    _here.tells.append(tell)
    try:
        yield
    finally:
        _here.tells.remove(tell)


@contextmanager
def compile_notices(what: str) -> Iterator[None]:
    """Say when compiling for `what` begins, and what it took. Within another one nothing is said twice."""
    if _here.done is not None:
        yield
        return
    done = _here.done = Compiled()
    _here.what = what
    try:
        yield
    finally:
        _here.done = None
        if done.functions:
            count = "1 function" if done.functions == 1 else f"{done.functions} functions"
            place = cache_folder()
            text = "" if place is None else f"; the cache is '{place}'"
            tell(logging.INFO, f"compiled {count} in {done.seconds:.1f} s for {what}{text}")


def tell(level: int, text: str) -> None:
    """A message about compiling, or about what was compiled."""
    logger.log(level, text)
    for other in list(_here.tells):
        other(level, text)


def begin(name: str) -> None:
    """The function `name` is not in the cache, and will be compiled with all that it calls."""
    if _here.done is None:
        tell(logging.INFO, f"compiling {name} for this machine, once")
        return
    if not _here.done.functions:
        text = f"compiling for this machine what {_here.what} needs, once: it can take a minute"
        tell(logging.INFO, text)
    logger.debug("compiling %s", name)


def end(name: str, seconds: float) -> None:
    """The function `name` is compiled, or has failed to be, after `seconds`."""
    _here.total.functions += 1
    _here.total.seconds += seconds
    text = f"compiled {name} in {seconds:.1f} s"
    if _here.done is None:
        tell(logging.INFO, text)
        return
    logger.debug(text)
    _here.done.functions += 1
    _here.done.seconds += seconds
