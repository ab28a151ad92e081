"""Does a user's function take the arguments that it will be called with?"""

import inspect
from typing import Any

from .errors import EquationError


def check_arity(name: str, arguments: str, function: Any) -> None:
    """Refuse a `function` that cannot be called with the positional `arguments` ("t, q, v").

    What does not show its signature (some compiled functions) passes: its call will tell.

    Raises
    ------
    EquationError : names the function, the arguments that it takes, and those that are needed.
    """
    try:
        signature = inspect.signature(getattr(function, "py_func", function))
    except (TypeError, ValueError):
        return
    needed = arguments.split(", ")
    try:
        signature.bind(*needed)
    except TypeError:
        own = getattr(function, "__name__", type(function).__name__)
        count = len(signature.parameters)
        raise EquationError(
            f"{name} is the function '{own}', which takes {count} argument{'' if count == 1 else 's'} {signature}; "
            f"needed is a function of {len(needed)}: {name}({arguments})"
        ) from None
