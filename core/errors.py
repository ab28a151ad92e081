"""The errors that the solver raises. Each message says what was given, what was needed and how to mend it."""

from typing import Any


class TlismniError(Exception):
    """Base of all errors of this library that are not plain bad arguments."""


class ModelError(TlismniError, ValueError):
    """A model, or something said about one, is wrong.

    Attributes
    ----------
    problems : of a record with several faults: what is wrong, and where in its data (keys and numbers in lists).
    """

    def __init__(self, message: str = "", problems: tuple[tuple[str, tuple[Any, ...]], ...] = ()) -> None:
        super().__init__(message)
        self.problems = problems


class UnknownNameError(TlismniError, KeyError):
    """A name that there is not. Says near ones."""

    def __str__(self) -> str:
        return str(self.args[0])  # a KeyError shows the text in quotes


class ConsistencyError(TlismniError):
    """No consistent start could be found from the given q0, v0, or the constraints contradict each other."""


class ConvergenceError(TlismniError):
    """An iteration did not reach its tolerance, and was asked to raise then.

    Attributes
    ----------
    solution : the best that was found, with its residual.
    """

    def __init__(self, message: str, *, solution: Any) -> None:
        super().__init__(message)
        self.solution = solution


class SimulationError(TlismniError):
    """A run failed. Says when, in which loop, what was tried and what to change; carries what was computed.

    Attributes
    ----------
    t : time reached, s.
    loop : "outer", "inner", "step size", "event", "contact" or "impact".
    partial : the `Result` up to that time, or None.
    """

    def __init__(self, message: str, *, t: float, loop: str, partial: Any = None) -> None:
        super().__init__(message)
        self.t = t
        self.loop = loop
        self.partial = partial


class CallbackError(Exception):
    """Raised by compiled code when a user's function failed; replaced by the user's own exception."""
