"""numba's front end without work that leaves nothing in the texts: they are the same, in two thirds of the time.

Recording spends nearly all its time in Python code of numba. What is spared here: a search, which fails and writes a
message, at each use of an array; settings that are gathered one by one at each look-up; sizes of types, for which LLVM
reads a text each time; the passes over an inlined helper at each of its calls; wrappers for Python of functions that
others call; and walks of the collector over millions of objects that stay. This leans on numba's internals, of 0.68, as
`record.py` does.
"""

import gc
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from typing import Any

from numba import types
from numba.core.base import BaseContext
from numba.core.inline_closurecall import InlineWorker
from numba.core.lowering import BaseLower
from numba.core.targetconfig import TargetConfig
from numba.np import arrayobj

_COLLECTOR = (100_000, 50, 1000)
"""New objects before the collector looks at them, and how often it looks at older ones: a few hundred MB at most."""


@contextmanager
def quick_front_end() -> Iterator[None]:
    """numba makes the same texts in less time meanwhile."""
    with ExitStack() as stack:
        stack.enter_context(_rare_collections())
        stack.enter_context(replaced(arrayobj, "make_array", _array_structure(arrayobj.make_array)))
        stack.enter_context(replaced(InlineWorker, "run_untyped_passes", _kept(InlineWorker.run_untyped_passes)))
        stack.enter_context(replaced(TargetConfig, "values", _settings))
        stack.enter_context(replaced(BaseContext, "get_abi_sizeof", _kept_sizes(BaseContext.get_abi_sizeof)))
        for wrapper in ("create_cpython_wrapper", "create_cfunc_wrapper"):
            stack.enter_context(replaced(BaseLower, wrapper, lambda *arguments, **named: None))
        yield


@contextmanager
def replaced(owner: Any, name: str, other: Any) -> Iterator[None]:
    """An attribute is another one meanwhile."""
    before = vars(owner)[name]
    setattr(owner, name, other)
    try:
        yield
    finally:
        setattr(owner, name, before)


@contextmanager
def _rare_collections() -> Iterator[None]:
    before = gc.get_threshold()
    gc.freeze()
    gc.set_threshold(*_COLLECTOR)
    try:
        yield
    finally:
        gc.set_threshold(*before)
        gc.unfreeze()


def _settings(config: Any) -> dict[str, Any]:
    """`TargetConfig.values`: all settings, those that are not set by their defaults."""
    return {name: option.default for name, option in type(config).options.items()} | config._values


def _kept_sizes(get_abi_sizeof: Callable[[Any, Any], int]) -> Callable[[Any, Any], int]:
    """`get_abi_sizeof`, once for each type."""
    kept: dict[Any, int] = {}

    def size(context: Any, kind: Any) -> int:
        if kind not in kept:
            kept[kind] = get_abi_sizeof(context, kind)
        return kept[kind]

    return size


def _array_structure(make_array: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """`make_array`, once for each type; it looks for an `__array__` of the type at each use, which arrays have not."""

    @cache
    def structure(array_type: Any) -> Any:
        made = make_array(array_type)
        if type(array_type) is types.Array:
            del made._make_refs
        return made

    return structure


def _kept(run_untyped_passes: Callable[..., Any]) -> Callable[..., Any]:
    """`run_untyped_passes`, once for each helper that is inlined before types are known: its caller takes a copy."""
    kept: dict[Any, Any] = {}

    def run(worker: Any, function: Any, enable_ssa: bool = False) -> Any:
        if enable_ssa:
            return run_untyped_passes(worker, function, enable_ssa)
        # left behind in the flags of the function that calls, each time
        worker.flags.enable_ssa = enable_ssa
        if function not in kept:
            kept[function] = run_untyped_passes(worker, function, enable_ssa)
        return kept[function]

    return run
