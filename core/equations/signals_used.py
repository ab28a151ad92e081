"""Time functions that a user's functions refer to, so that a run knows when these jump."""

import functools
import inspect
import types
from collections.abc import Iterable, Iterator
from typing import Any

from ..model.signals import TimeFunction

_FOREIGN = ("numpy", "scipy", "numba", "math", "builtins", "functools", "itertools")


def signals_used(functions: Iterable[Any]) -> list[TimeFunction]:
    """The time functions that `functions` refer to: by name, as defaults or bound arguments, in lists and dictionaries,
    as attributes of callable objects, and in functions that they call by name."""
    found: list[TimeFunction] = []
    seen: set[int] = set()
    # what has been seen is kept alive, or another object could have its id
    ahead, kept = list(functions), []
    while ahead:
        here = ahead.pop()
        if id(here) in seen:
            continue
        seen.add(id(here))
        kept.append(here)
        if isinstance(here, TimeFunction):
            found.append(here)
        else:
            ahead += _referred(here)
    return found


def _referred(here: Any) -> Iterable[Any]:
    """What `here` refers to, as far as a time function may stand there."""
    if isinstance(here, list | tuple | set | frozenset):
        return here
    if isinstance(here, dict):
        return here.values()
    if isinstance(here, functools.partial):
        return (here.func, *here.args, *here.keywords.values())
    if isinstance(here, types.MethodType):
        owner = here.__self__
        return (here.__func__, *vars(owner).values()) if _has_fields(owner) else (here.__func__,)
    python = inspect.getattr_static(here, "py_func", None)
    if python is not None:  # of functions that numba has compiled
        return (here.py_func,)
    if isinstance(here, types.FunctionType):
        return () if (here.__module__ or "").split(".")[0] in _FOREIGN else _of_function(here)
    if callable(here) and not isinstance(here, type) and _has_fields(here):
        call = inspect.getattr_static(type(here), "__call__", None)
        return (call, *vars(here).values())
    return ()


def _has_fields(x: Any) -> bool:
    return inspect.getattr_static(x, "__dict__", None) is not None


def _of_function(function: types.FunctionType) -> Iterator[Any]:
    yield from function.__defaults__ or ()
    yield from (function.__kwdefaults__ or {}).values()
    for cell in function.__closure__ or ():
        try:
            yield cell.cell_contents
        except ValueError:  # not yet assigned
            continue
    for name in _names(function.__code__):
        if name in function.__globals__:
            yield function.__globals__[name]


def _names(code: types.CodeType) -> Iterator[str]:
    """Global names of a function and of those written in it."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _names(constant)
