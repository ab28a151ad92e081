"""Log of a slave: categories, and who hears what."""

import logging
from collections.abc import Callable, Iterable

from .errors import FmuValueError, Status

EVENTS, WARNING, DISCARD, ERROR = "logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError"
COMPILATION, TRACEBACK, ALL = "logCompilation", "logTraceback", "logAll"

CATEGORIES = {
    EVENTS: "impacts and other contact events",
    WARNING: "warnings",
    DISCARD: "figures that were asked and are not available",
    ERROR: "errors; these are logged even when logging is off",
    COMPILATION: "compiling for this machine, which takes long and happens once",
    TRACEBACK: "Python traceback of each error",
    ALL: "all messages",
}

LogCallback = Callable[[int, str, str], None]
"""Called with status, category and message."""

_LEVELS = {Status.OK: logging.INFO, Status.WARNING: logging.WARNING}


def to_python_logging(status: int, category: str, message: str) -> None:
    """Where messages go when nobody else listens: the logger `tlismni.fmu`."""
    level = _LEVELS.get(Status(status), logging.ERROR)
    logging.getLogger("tlismni.fmu").log(level, "[%s] %s", category, message)


class Log:
    """Passes messages on to `callback`: errors always, others if logging is on for their category."""

    def __init__(self, callback: LogCallback | None = None, on: bool = False) -> None:
        self._callback = to_python_logging if callback is None else callback
        self._heard = frozenset(CATEGORIES) if on else frozenset()
        self.passed_on = callback is not None
        """Whether messages go elsewhere than to `logging`."""
        self.last_problem = ""
        """Text of the last warning or error."""

    def choose(self, on: bool, categories: Iterable[str] = ()) -> None:
        """Turn logging on or off; no categories means all.

        Raises
        ------
        FmuValueError : for an unknown category.
        """
        chosen = frozenset(categories)
        unknown = chosen - set(CATEGORIES)
        if unknown:
            raise FmuValueError(f"unknown log categories {sorted(unknown)}; known are {sorted(CATEGORIES)}")
        every = frozenset(CATEGORIES)
        if not chosen or ALL in chosen:
            chosen = every
        # switching off some categories leaves the others as they are
        self._heard = chosen if on else self._heard - chosen

    def tell(self, level: int, message: str) -> None:
        """Pass on what is said about compiling, with a level of `logging`, which has it already."""
        if self.passed_on:
            self.write(Status.WARNING if level >= logging.WARNING else Status.OK, COMPILATION, message)

    def wants(self, category: str) -> bool:
        """True if a message of this category would be passed on."""
        return category == ERROR or category in self._heard

    def write(self, status: Status, category: str, message: str) -> None:
        """Pass on one message if somebody wants it."""
        if status != Status.OK and category != TRACEBACK:
            self.last_problem = message
        if self.wants(category):
            self._callback(int(status), category, message.replace("\0", "\\0"))
