"""Tables of functions by name, which others may add to."""

from collections.abc import Callable
from typing import TypeVar

Function = TypeVar("Function", bound=Callable[..., object])


def registering(table: dict[str, Function]) -> Callable[[str], Callable[[Function], Function]]:
    """A decorator with a name: it puts the function into the table under that name."""

    def named(name: str) -> Callable[[Function], Function]:
        def register(function: Function) -> Function:
            table[name] = function
            return function

        return register

    return named
