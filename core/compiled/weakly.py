"""Methods that are handed on without what they belong to.

What a run is made of refers to each other all round: a structure asks its workspace for memory, and the workspace holds
its structures. References in a circle are freed only when Python looks for such circles, which it rarely does, and by
the number of objects, of which a run has few, not by their memory.
"""

from collections.abc import Callable
from typing import Any
from weakref import WeakMethod


class Weakly:
    """Calls a method of an object that it does not keep alive.

    Parameters
    ----------
    method : a bound one.
    """

    __slots__ = ("_method",)

    def __init__(self, method: Callable[..., Any]) -> None:
        self._method = WeakMethod(method)

    def __call__(self, *arguments: Any) -> Any:
        """What the method returns.

        Raises
        ------
        ReferenceError : if the object is no more: keep the simulation as long as what it has handed out.
        """
        method = self._method()
        if method is None:
            raise ReferenceError("the run that this belonged to is no more: keep its simulation as long as its parts")
        return method(*arguments)
